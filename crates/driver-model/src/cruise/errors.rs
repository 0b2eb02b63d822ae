use serde::Serialize;

use super::{CruiseModel, CruiseStretch};

/// Root mean square errors on one stretch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CruiseErrors {
    /// Of the cruise model.
    pub cruise_mps: f64,
    /// Of holding the first speed.
    pub hold_mps: f64,
    /// Of driving the limit; `None` without one.
    pub limit_mps: Option<f64>,
    /// Share of samples in the 90 % band, the first one left out.
    pub inside_pct: f64,
}

impl CruiseErrors {
    pub(super) fn of(model: &CruiseModel, stretch: &CruiseStretch) -> Self {
        let (measured, limit) = (stretch.speed_mps(), stretch.limit_mps());
        let start = measured[0];
        let rmse = |predicted: &dyn Fn(f64) -> f64| {
            let times = (0..measured.len()).map(|k| k as f64 * stretch.step_s());
            let squares = times.zip(measured).map(|(t, v)| (predicted(t) - v).powi(2));
            (squares.sum::<f64>() / measured.len() as f64).sqrt()
        };
        let holds = |&k: &usize| {
            let t = k as f64 * stretch.step_s();
            let error = model.speed_mps(start, limit, t) - measured[k];
            error.abs() <= model.half_width_90_mps(limit, t)
        };
        let inside = (1..measured.len()).filter(holds).count();
        Self {
            cruise_mps: rmse(&|t| model.speed_mps(start, limit, t)),
            hold_mps: rmse(&|_| start),
            limit_mps: limit.map(|limit| rmse(&|_| limit)),
            inside_pct: 100.0 * inside as f64 / (measured.len() - 1) as f64,
        }
    }
}
