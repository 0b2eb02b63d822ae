use driver_model::{Error as ModelError, ModelKind, PhaseKind, PhaseModel, TrainingSet};
use rayon::prelude::*;
use serde::Serialize;

use super::{EvaluationData, EvaluationSettings, PhasePrediction};
use crate::Error;

/// How well a model predicts a driver of whom it has seen so many trips.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LearningPoint {
    /// The model.
    pub model: ModelKind,
    /// Units of the driver's own that it is fitted to.
    pub own_trips: usize,
    /// What it is fitted to.
    pub training: TrainingSource,
    /// Held-out phases.
    pub phases: usize,
    /// Mean over them.
    pub rmse_mps: f64,
    /// Mean over them.
    pub in_band_pct: f64,
}

/// Whose phases a model learns from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum TrainingSource {
    /// The driver's own.
    #[serde(rename = "own")]
    Own,
    /// The driver's own, and other drivers' with the prior weight.
    #[serde(rename = "own and prior")]
    OwnAndPrior,
    /// Other drivers' alone.
    #[serde(rename = "prior")]
    Prior,
}

impl TrainingSource {
    /// As in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Own => "own",
            Self::OwnAndPrior => "own and prior",
            Self::Prior => "prior",
        }
    }
}

/// Error over the number of own units: 1, 2, 4, … and all but one. Every unit is held out once and predicted from the units
/// that follow it in a circle; points for which some fit has too little to learn from, or
/// does not converge, are left out.
///
/// # Errors
/// As [`super::leave_one_out`].
pub fn learning_curve(
    kind: PhaseKind,
    data: &EvaluationData<'_>,
    settings: &EvaluationSettings,
) -> Result<Vec<LearningPoint>, Error> {
    data.check(kind)?;
    settings.check()?;
    let most = data.hold_out.units().len() - 1;
    let mut counts: Vec<usize> = std::iter::successors(Some(1), |n| Some(n * 2))
        .take_while(|&n| n < most)
        .collect();
    counts.push(most);
    let mut plans: Vec<(usize, TrainingSource)> = Vec::new();
    if !data.prior.is_empty() {
        plans.push((0, TrainingSource::Prior));
        plans.extend(counts.iter().map(|&n| (n, TrainingSource::OwnAndPrior)));
    }
    plans.extend(counts.iter().map(|&n| (n, TrainingSource::Own)));

    let models = settings.models.iter().filter(|model| !model.is_baseline());
    let jobs: Vec<(ModelKind, usize, TrainingSource)> = models
        .flat_map(|&model| plans.iter().map(move |&(own, source)| (model, own, source)))
        .collect();
    let points = jobs
        .into_par_iter()
        .map(|(model, own, source)| point(kind, data, settings, model, own, source))
        .collect::<Result<Vec<_>, _>>()?;
    Ok(points.into_iter().flatten().collect())
}

fn point(
    kind: PhaseKind,
    data: &EvaluationData<'_>,
    settings: &EvaluationSettings,
    model: ModelKind,
    own_trips: usize,
    training: TrainingSource,
) -> Result<Option<LearningPoint>, Error> {
    let units = data.hold_out.units().len();
    let prior_weight = match training {
        TrainingSource::Own => 0.0,
        TrainingSource::OwnAndPrior => settings.prior_weight,
        TrainingSource::Prior => 1.0,
    };
    let (mut phases, mut rmse_mps, mut in_band_pct) = (0, 0.0, 0.0);
    for held_out in 0..units {
        let seen = |unit: usize| (1..=own_trips).contains(&((unit + units - held_out) % units));
        let set = TrainingSet::from_trips(kind, data.trips_where(seen)).with_prior(
            kind,
            data.prior,
            prior_weight,
        );
        let fitted = match PhaseModel::fit(model, &set) {
            Err(ModelError::TooFewPhases { .. } | ModelError::Fit { .. }) => return Ok(None),
            fitted => fitted?,
        };
        for curve in data
            .trips_where(|u| u == held_out)
            .flat_map(|t| t.phases_of(kind))
        {
            let prediction = PhasePrediction::new(&fitted, curve, settings.band_mps);
            phases += 1;
            rmse_mps += prediction.rmse_mps;
            in_band_pct += prediction.in_band_pct;
        }
    }
    Ok((phases > 0).then(|| LearningPoint {
        model,
        own_trips,
        training,
        phases,
        rmse_mps: rmse_mps / phases as f64,
        in_band_pct: in_band_pct / phases as f64,
    }))
}
