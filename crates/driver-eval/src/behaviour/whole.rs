//! Phases from where they begin to where they end, beside those that the threshold cuts.

use std::collections::BTreeMap;
use std::fmt;

use driver_model::statistics::mean;
use driver_model::{DriveBehaviour, ModelKind, PhaseCurve, PhaseKind};
use ev_energy::Vehicle;
use serde::Serialize;

use super::missing::Missing;
use crate::Error;
use crate::phase::{
    Evaluation, EvaluationData, EvaluationSettings, PairedComparison, leave_one_out,
};
use crate::words::plural;

/// Every model and baseline on whole phases.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct WholePhases {
    /// `None` where there is too little.
    pub acceleration: Option<WholeEvaluation>,
    /// `None` where there is too little.
    pub braking: Option<WholeEvaluation>,
}

/// Whole phases of one kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WholeEvaluation {
    /// Acceleration or braking.
    #[serde(skip)]
    pub kind: PhaseKind,
    /// What whole phases have more.
    #[serde(flatten)]
    pub reach: Reach,
    /// The baseline with the least error, which all others are compared with.
    pub best_baseline: ModelKind,
    /// Units with phases.
    pub units: usize,
    /// By model.
    pub models: BTreeMap<&'static str, WholeFigures>,
    /// By baseline.
    pub baselines: BTreeMap<&'static str, WholeFigures>,
    /// Names in the order of tables.
    #[serde(skip)]
    pub order: Vec<ModelKind>,
}

/// How long phases are and how much speed they gain or lose, beside those that the threshold cuts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Reach {
    /// Whole phases; those that meet are one.
    pub phases: usize,
    /// Phases cut at the threshold.
    pub threshold_phases: usize,
    /// Mean duration of whole phases.
    pub duration_s: f64,
    /// Mean duration of the others.
    pub threshold_duration_s: f64,
    /// Mean magnitude of the change of speed of whole phases.
    pub gain_mps: f64,
    /// The same of the others.
    pub threshold_gain_mps: f64,
    /// How much longer whole phases are.
    pub longer_pct: f64,
    /// How much more they gain or lose.
    pub gains_more_pct: f64,
}

/// One model on whole phases; means over phases.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WholeFigures {
    /// What the model is told of a phase, in words.
    pub knows: &'static str,
    /// Mean root mean square error.
    pub rmse_mps: f64,
    /// The same of the phases that the threshold cuts.
    pub threshold_rmse_mps: Option<f64>,
    /// Mean share of samples inside the band.
    pub in_band_pct: f64,
    /// Share of samples that a predictive band of 90 % holds, where the model has one.
    pub in_90_pct_band_pct: Option<f64>,
    /// Against the best baseline; `None` for itself and below two units.
    pub against_baseline: Option<PairedComparison>,
}

impl WholePhases {
    /// Evaluates what has figures of phases that the threshold cuts.
    pub(super) fn evaluate(
        data: &EvaluationData<'_>,
        at_threshold: [Option<&Evaluation>; 2],
        vehicle: &Vehicle,
        settings: &EvaluationSettings,
        missing: &mut Missing,
        progress: &(dyn Fn() + Sync),
    ) -> Result<Self, Error> {
        let [trips, prior] = [data.trips(), data.prior()].map(whole);
        let data = data.with_trips(&trips, &prior);
        let mut of = |part, cut: Option<&Evaluation>| {
            let Some(cut) = cut else {
                return Ok(None);
            };
            let evaluate = || leave_one_out(cut.kind, &data, vehicle, settings, progress);
            let evaluation = missing.unless_enough(part, evaluate)?;
            Ok::<_, Error>(evaluation.and_then(|whole| WholeEvaluation::of(&whole, cut)))
        };
        let [acceleration, braking] = at_threshold;
        Ok(Self {
            acceleration: of("whole acceleration", acceleration)?,
            braking: of("whole braking", braking)?,
        })
    }

    /// The kinds that there are.
    pub fn kinds(&self) -> impl Iterator<Item = &WholeEvaluation> {
        [&self.acceleration, &self.braking].into_iter().flatten()
    }
}

fn whole(trips: &[DriveBehaviour]) -> Vec<DriveBehaviour> {
    trips
        .iter()
        .map(DriveBehaviour::with_whole_phases)
        .collect()
}

impl WholeEvaluation {
    /// `None` without a baseline, which all have.
    fn of(whole: &Evaluation, cut: &Evaluation) -> Option<Self> {
        let summaries = || whole.models.iter().copied().zip(&whole.summaries);
        let (best_baseline, _) = summaries()
            .filter(|(model, _)| model.is_baseline())
            .min_by(|a, b| a.1.figures.rmse_mps.total_cmp(&b.1.figures.rmse_mps))?;
        let figures = |baselines: bool| {
            whole
                .models
                .iter()
                .filter(|model| model.is_baseline() == baselines)
                .filter_map(|&model| {
                    let figures = WholeFigures::of(model, best_baseline, whole, cut)?;
                    Some((model.name(), figures))
                })
                .collect()
        };
        Some(Self {
            kind: whole.kind,
            reach: Reach::of(whole, cut)?,
            best_baseline,
            units: whole.paired.first().map_or(1, |pair| pair.units),
            models: figures(false),
            baselines: figures(true),
            order: whole.models.clone(),
        })
    }

    /// Models, then baselines, each in the order of tables.
    pub fn rows(&self) -> impl Iterator<Item = (ModelKind, &WholeFigures)> {
        [&self.models, &self.baselines]
            .into_iter()
            .flat_map(|table| {
                let named = self.order.iter();
                named.filter_map(|&model| Some((model, table.get(model.name())?)))
            })
    }
}

/// What is evaluated, as the heading of its table.
impl fmt::Display for WholeEvaluation {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let reach = &self.reach;
        write!(
            out,
            "{} from begin to end: {} of {:.1} s and {:.1} km/h in the mean, \
             {:.0} % longer and with {:.0} % more change of speed than the {} cut at the threshold\n\
             RMSE less that of {}, the best baseline, with intervals over {} held-out units",
            self.kind.name(),
            plural(reach.phases, "phase"),
            reach.duration_s,
            3.6 * reach.gain_mps,
            reach.longer_pct,
            reach.gains_more_pct,
            reach.threshold_phases,
            self.best_baseline,
            self.units,
        )
    }
}

impl WholeFigures {
    fn of(
        model: ModelKind,
        best_baseline: ModelKind,
        whole: &Evaluation,
        cut: &Evaluation,
    ) -> Option<Self> {
        let summary = whole.summary(model)?;
        let bands = whole.bands.iter().find(|(kind, _)| *kind == model);
        let of_90_pct = bands.and_then(|(_, levels)| levels.iter().find(|b| b.level_pct >= 90.0));
        let pairs = whole.paired.iter();
        Some(Self {
            knows: summary.knows,
            rmse_mps: summary.figures.rmse_mps,
            threshold_rmse_mps: cut.summary(model).map(|s| s.figures.rmse_mps),
            in_band_pct: summary.figures.in_band_pct,
            in_90_pct_band_pct: of_90_pct.map(|b| b.inside_pct),
            against_baseline: pairs
                .filter_map(|pair| pair.seen_from(model))
                .find(|pair| pair.against == best_baseline),
        })
    }
}

impl Reach {
    fn of(whole: &Evaluation, cut: &Evaluation) -> Option<Self> {
        let average = |evaluation: &Evaluation, figure: fn(&PhaseCurve) -> f64| {
            mean(evaluation.phases.iter().map(|phase| figure(&phase.curve)))
        };
        let duration_s = |evaluation| average(evaluation, |curve| curve.outline().duration_s());
        let gain_mps = |evaluation| average(evaluation, |curve| curve.outline().gain_mps().abs());
        let more_pct = |more: f64, less: f64| 100.0 * (more / less - 1.0);
        let (long_s, short_s) = (duration_s(whole)?, duration_s(cut)?);
        let (large_mps, small_mps) = (gain_mps(whole)?, gain_mps(cut)?);
        Some(Self {
            phases: whole.phases.len(),
            threshold_phases: cut.phases.len(),
            duration_s: long_s,
            threshold_duration_s: short_s,
            gain_mps: large_mps,
            threshold_gain_mps: small_mps,
            longer_pct: more_pct(long_s, short_s),
            gains_more_pct: more_pct(large_mps, small_mps),
        })
    }
}
