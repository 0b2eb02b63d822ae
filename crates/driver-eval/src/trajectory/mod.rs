//! The speed of the next seconds and of whole trips, from limits and own past, held out.

mod document;
mod free_run;

use std::collections::BTreeMap;

use driver_model::{LeftOut, Motion};
use ev_energy::Vehicle;

use crate::Error;
use crate::speed_ahead::{
    TrajectoryData, TrajectoryEvaluation, TrajectorySettings, evaluate_trajectory,
};
use crate::trip_driver::FreeRunSettings;
use crate::words::plural;
pub use document::{TrajectoryDocument, with_curves};
pub use free_run::FreeRuns;

/// Drives to evaluate, and what is left out of them.
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryTask {
    motions: Vec<Motion>,
    unit_names: Vec<String>,
    data: TrajectoryData,
    settings: TrajectorySettings,
    left_out: Vec<LeftOut>,
}

/// Everything that was found out.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectories {
    motions: Vec<Motion>,
    /// What was evaluated.
    pub data: TrajectoryData,
    /// The next seconds, and whole drives by recursion.
    pub speed_ahead: TrajectoryEvaluation,
    /// Whole trips from the road; `None` where too few drives know their limits or are long enough.
    pub free_runs: Option<FreeRuns>,
    /// Drives that cannot be used, with the reason.
    pub left_out: Vec<LeftOut>,
    /// Parts without figures, with the reason.
    pub not_evaluated: BTreeMap<&'static str, String>,
    /// Number of folds.
    pub folds: usize,
    /// Full width of the band.
    pub band_mps: f64,
}

impl TrajectoryTask {
    /// `unit_names` has one for every drive, whatever its pieces. There are as many folds as asked for, or as there are units.
    ///
    /// # Errors
    /// [`Error::OneUnit`] where nothing is left to learn from, and as [`TrajectoryData::usable`].
    pub fn new(
        motions: Vec<Motion>,
        unit_names: &[String],
        mut settings: TrajectorySettings,
    ) -> Result<Self, Error> {
        let all = TrajectoryData::new(motions.clone(), unit_names);
        let (data, left_out) = all.usable(&settings.direct)?;
        let units = data.hold_out.units();
        if units.len() < 2 {
            return Err(Error::OneUnit {
                unit: units.join(", "),
                left_out: left_out
                    .iter()
                    .map(|drive| format!("\n  left out, {}: {}", drive.log, drive.reason))
                    .collect(),
            });
        }
        settings.folds = settings.folds.min(units.len());
        Ok(Self {
            motions,
            unit_names: unit_names.to_vec(),
            data,
            settings,
            left_out,
        })
    }

    /// Drives that cannot be used, with the reason.
    #[must_use]
    pub fn left_out(&self) -> &[LeftOut] {
        &self.left_out
    }

    /// Number of folds.
    #[must_use]
    pub fn folds(&self) -> usize {
        self.settings.folds
    }

    /// How often an evaluation reports progress.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.settings.steps(&self.data)
    }

    /// Evaluates; `progress` is called [`steps`](Self::steps) times.
    ///
    /// # Errors
    /// As [`evaluate_trajectory`].
    pub fn evaluate(
        self,
        vehicle: &Vehicle,
        progress: &(dyn Fn() + Sync),
    ) -> Result<Trajectories, Error> {
        let speed_ahead = evaluate_trajectory(&self.data, vehicle, &self.settings, progress)?;
        let mut not_evaluated = BTreeMap::new();
        if !self.data.has_limits() {
            not_evaluated.insert("trials", without_limits(&self.motions));
        }
        let free_run_settings = FreeRunSettings {
            folds: Some(self.settings.folds),
            ..FreeRunSettings::default()
        };
        let free_runs =
            free_run::evaluate(&self.motions, &self.unit_names, &free_run_settings, vehicle);
        if let Err(reason) = &free_runs {
            not_evaluated.insert("free_run", reason.to_string());
        }
        Ok(Trajectories {
            speed_ahead,
            free_runs: free_runs.ok(),
            not_evaluated,
            left_out: self.left_out,
            data: self.data,
            folds: self.settings.folds,
            band_mps: self.settings.band_mps,
            motions: self.motions,
        })
    }
}

impl Trajectories {
    /// Without the times of fitting and predicting, which differ from run to run.
    #[must_use]
    pub fn without_times(mut self) -> Self {
        for row in &mut self.speed_ahead.rows {
            (row.fit_seconds, row.predict_seconds) = (f64::NAN, f64::NAN);
        }
        let trials = self.speed_ahead.trials.iter_mut();
        for fitted in trials.flat_map(|trial| &mut trial.fits) {
            fitted.fit.seconds = f64::NAN;
        }
        self
    }
}

/// Why the models do not know limits and the trials are left out.
fn without_limits(motions: &[Motion]) -> String {
    let known = motions.iter().filter(|motion| motion.limit_mps().is_some());
    match known.count() {
        0 => "no speed limits".to_owned(),
        some => format!(
            "speed limits in {some} of {}, less than half of the time or of one drive, so that no model is told of them; \
             give those logs alone to use them",
            plural(motions.len(), "drive")
        ),
    }
}
