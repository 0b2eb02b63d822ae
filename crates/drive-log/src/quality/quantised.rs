//! A speed in steps so coarse that its differences are steps too.
//!
//! Rounding is a noise of variance `q²/12`.

use super::checked::Checked;
use super::lattice::Lattice;
use super::runs::constant_runs;
use super::whittaker;
use crate::statistics::median_step_s;
use crate::{Action, Channel, FindingKind};

/// Steps whose differences are under this, m/s², are lost in the smoothing: whole km/h at 1 Hz.
const LEAST_STEP_MPS2: f64 = 0.3;

/// Samples that follow each other faster than this are rounded alike, s.
const INDEPENDENT_S: f64 = 0.1;

/// A speed of 0 this far from any other is a standstill, s.
const STANDSTILL_S: f64 = 0.3;

/// How a speed was rounded, and how often it was renewed, s, where rows are faster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rounding {
    pub(super) lattice: Lattice,
    pub(super) interval_s: f64,
}

impl Rounding {
    /// Looks at the values as they were recorded, before lines between them are drawn.
    pub(super) fn of(speed_mps: &[f64]) -> Option<Self> {
        Lattice::of(speed_mps).map(|lattice| Self {
            lattice,
            interval_s: 0.0,
        })
    }

    /// The same in another unit.
    pub(super) fn scale(&mut self, factor: f64) {
        self.lattice.step_mps *= factor;
        self.lattice.reach_mps *= factor;
    }
}

/// Smooths a rounded speed. It stays within half a step of every sample.
pub(super) fn smooth_speed(checked: &mut Checked) {
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let Some(rounding) = checked.rounding else {
        return;
    };
    let step_mps = rounding.lattice.step_mps;
    if step_mps < LEAST_STEP_MPS2 * median_step_s(time_s).max(rounding.interval_s) {
        return;
    }
    let noise = whittaker::Noise {
        variance: step_mps.powi(2) / 12.0,
        independent_s: INDEPENDENT_S.max(rounding.interval_s),
    };
    let mut smooth_mps = whittaker::smooth(time_s, speed_mps, &checked.cuts, noise);
    let reach_mps = rounding.lattice.reach_mps;
    for (smooth, v) in smooth_mps.iter_mut().zip(speed_mps) {
        *smooth = smooth.max(*v - reach_mps).min(*v + reach_mps);
    }
    stand_still(time_s, speed_mps, &mut smooth_mps);
    let detail = format!(
        "in steps of {:.3} km/h, taken as rounded to the nearest; smoothed within half a step",
        3.6 * step_mps
    );
    checked.report_all(
        FindingKind::Quantised,
        Channel::Speed,
        Action::Smoothed,
        detail,
    );
    checked.log.channels.insert(Channel::Speed, smooth_mps);
}

/// A recorded 0 is no motion backward, and none at all where it lasts.
pub(super) fn stand_still(time_s: &[f64], speed_mps: &[f64], smooth_mps: &mut [f64]) {
    let stands = |i: usize| speed_mps[i] == 0.0;
    for run in constant_runs(speed_mps).filter(|run| stands(run.start)) {
        let (from_s, to_s) = (time_s[run.start], time_s[run.end - 1]);
        let (starts, ends) = (run.start == 0, run.end == speed_mps.len());
        for i in run {
            let settled = (starts || time_s[i] - from_s >= STANDSTILL_S)
                && (ends || to_s - time_s[i] >= STANDSTILL_S);
            smooth_mps[i] = if settled { 0.0 } else { smooth_mps[i].max(0.0) };
        }
    }
}
