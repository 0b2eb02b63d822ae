//! How long decisions took.

use serde::Serialize;

use crate::tick::Tick;

/// Times of single decisions against the period.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Timing {
    /// In µs
    pub median_us: f64,
    /// In µs
    pub p99_us: f64,
    /// In µs
    pub max_us: f64,
    /// Steps in which all robots together took longer than the period
    pub missed: usize,
}

/// The value below which a share of sorted ones lies; NaN of none.
#[must_use]
pub fn at_share(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    let index = (share * last as f64).round() as usize;
    sorted.get(index).copied().unwrap_or(f64::NAN)
}

impl Timing {
    /// Of a run in the order in which it was decided.
    #[must_use]
    pub fn new(ticks: &[Tick], period_s: f64) -> Self {
        let mut times: Vec<f64> = ticks.iter().map(|tick| tick.step_us).collect();
        times.sort_by(f64::total_cmp);
        let at = |share: f64| at_share(&times, share);
        let steps = ticks.chunk_by(|a, b| a.tick == b.tick);
        let late = |step: &&[Tick]| step.iter().map(|t| t.step_us).sum::<f64>() > period_s * 1e6;
        Self {
            median_us: at(0.5),
            p99_us: at(0.99),
            max_us: at(1.0),
            missed: steps.filter(late).count(),
        }
    }
}
