//! Function fits to everything a driver did, as in Table 3.6 and figures 3.12 and 3.13.

use std::collections::BTreeMap;

use rayon::prelude::*;
use serde::Serialize;

use crate::{DriveBehaviour, ModelKind, PhaseKind, PhaseModel, PointsOf, TrainingSet};

/// One function of speed, fitted to points of acceleration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FunctionFit {
    /// What it is fitted to.
    pub fitted_to: PointsOf,
    /// How many points those are.
    pub points: usize,
    /// Sum over them, in (m/s²)².
    pub residual_sum_of_squares: f64,
    /// The fitted function.
    #[serde(flatten)]
    pub model: PhaseModel,
}

/// The three functions fitted to the means and to all samples of the segments of one kind; a fit with too few points, or
/// one that does not converge, is left out.
#[must_use]
pub fn function_fits(kind: PhaseKind, trips: &[DriveBehaviour]) -> Vec<FunctionFit> {
    let sets = [PointsOf::Means, PointsOf::Samples]
        .map(|points_of| (points_of, TrainingSet::with_points(points_of, kind, trips)));
    let models = [
        ModelKind::Inverse,
        ModelKind::Exponential,
        ModelKind::ExponentialAmplitude,
    ];
    let jobs: Vec<_> = models
        .into_iter()
        .flat_map(|model| {
            sets.iter()
                .map(move |(points_of, set)| (model, *points_of, set))
        })
        .collect();
    jobs.into_par_iter()
        .filter_map(|(kind, fitted_to, training)| {
            let model = PhaseModel::fit(kind, training).ok()?;
            Some(FunctionFit {
                fitted_to,
                points: training.points.len(),
                residual_sum_of_squares: model.residual_sum_of_squares(&training.points)?,
                model,
            })
        })
        .collect()
}

/// How many samples of acceleration lie in each cell of speed and acceleration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AccelDensity {
    /// Width of a cell in speed.
    pub speed_step_mps: f64,
    /// Width of a cell in acceleration.
    pub accel_step_mps2: f64,
    /// `(i, j, samples)`: from `i` and `j` times the widths to the next multiple. Cells without samples are left out.
    pub cells: Vec<(i64, i64, usize)>,
}

impl AccelDensity {
    /// Of the segments of one kind.
    #[must_use]
    pub fn of(kind: PhaseKind, trips: &[DriveBehaviour]) -> Self {
        let (speed_step_mps, accel_step_mps2) = (0.5, 0.1);
        let mut counts = BTreeMap::<(i64, i64), usize>::new();
        for segment in trips.iter().flat_map(|trip| trip.segments_of(kind)) {
            for point in &segment.samples {
                let cell = |value: f64, step: f64| (value / step).floor() as i64;
                let key = (
                    cell(point.speed_mps, speed_step_mps),
                    cell(point.accel_mps2, accel_step_mps2),
                );
                *counts.entry(key).or_default() += 1;
            }
        }
        Self {
            speed_step_mps,
            accel_step_mps2,
            cells: counts.into_iter().map(|((i, j), n)| (i, j, n)).collect(),
        }
    }
}
