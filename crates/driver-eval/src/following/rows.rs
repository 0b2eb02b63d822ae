//! The figures of an evaluation in an order to be read in.

use driver_model::ModelKind;

use super::{
    DriverComparison, FollowingEvaluation, FollowingFold, FollowingSummary, HeldOutPart,
    PairedDrivers, ParametersOf, PerFollowingModel,
};
use crate::words::plural;

/// Rows with the same heading belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowingRows {
    /// What is predicted from what, in words.
    pub heading: String,
    /// A model each.
    pub rows: Vec<FollowingRow>,
}

/// A model and how it does.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowingRow {
    /// The model, and whose parameters it has.
    pub name: String,
    /// Its errors.
    pub errors: FollowingSummary,
    /// Seconds of fitting, over all folds.
    pub fit_seconds: Option<f64>,
    /// Against parameters for all drivers, and how many drivers there are.
    pub against_all: Option<(PairedDrivers, usize)>,
}

impl FollowingEvaluation {
    /// All rows: the models for all drivers, held out and in sample, and what parameters per driver change.
    #[must_use]
    pub fn rows(&self) -> Vec<FollowingRows> {
        let seconds = |of: fn(&FollowingFold) -> f64| Some(self.folds.iter().map(of).sum());
        let seconds = [
            seconds(|fold| fold.fit_seconds.idm),
            seconds(|fold| fold.fit_seconds.constant_time_gap),
        ];
        let mut found = vec![
            of_both("each unit held out", &self.held_out, seconds),
            of_both("in sample", &self.in_sample, [None, None]),
        ];
        for comparison in &self.drivers {
            let heading = comparison.heading();
            match found.last_mut().filter(|last| last.heading == heading) {
                Some(last) => last.rows.push(comparison.row()),
                None => found.push(FollowingRows {
                    heading,
                    rows: vec![comparison.row()],
                }),
            }
        }
        found
    }
}

fn of_both(
    heading: &str,
    errors: &PerFollowingModel<FollowingSummary>,
    seconds: [Option<f64>; 2],
) -> FollowingRows {
    let row = |kind: ModelKind, errors, fit_seconds| FollowingRow {
        name: kind.name().to_owned(),
        errors,
        fit_seconds,
        against_all: None,
    };
    FollowingRows {
        heading: heading.to_owned(),
        rows: vec![
            row(ModelKind::Idm, errors.idm, seconds[0]),
            row(
                ModelKind::ConstantTimeGap,
                errors.constant_time_gap,
                seconds[1],
            ),
        ],
    }
}

impl DriverComparison {
    fn heading(&self) -> String {
        let drivers = plural(self.drivers, "driver");
        match self.held_out {
            HeldOutPart::Minutes => format!(
                "every other minute of {drivers}, {} from the minutes between",
                plural(self.stretches, "piece")
            ),
            HeldOutPart::KnownDrivers => format!(
                "each unit held out, {} of {drivers} that other units know",
                plural(self.stretches, "stretch")
            ),
        }
    }

    fn row(&self) -> FollowingRow {
        let whose = match self.parameters_of {
            ParametersOf::All => "for all",
            ParametersOf::Own => "own",
            ParametersOf::OwnWithPrior => "own with prior",
        };
        FollowingRow {
            name: format!("{}, {whose}", self.model),
            errors: self.errors,
            fit_seconds: None,
            against_all: self.against_all.map(|paired| (paired, self.drivers)),
        }
    }
}
