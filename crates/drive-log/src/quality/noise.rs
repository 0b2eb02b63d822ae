//! Speeds that scatter from row to row.

use super::checked::Checked;
use super::motion::MOVING_MPS;
use super::quantised::stand_still;
use super::whittaker;
use crate::statistics::{deviation, mean, median_step_s, off_line};
use crate::{Action, Channel, FindingKind};

/// Rows in motion that tell.
const ROWS: usize = 100;

/// A scatter whose differences are under this, m/s², is lost in the smoothing.
const LEAST_MPS2: f64 = 0.3;

/// White noise lies on other sides of the line between the neighbours in two rows that follow each other: the signs
/// correlate at −0.46, in 33 trips of a BMW i3 at −0.33 or above.
const SIGNS: f64 = -0.36;

/// Of a rounded speed, what scatters by less than this many steps is the rounding.
const ROUNDING_STEPS: f64 = 1.0;

/// A smoothed speed within so many deviations of 0, for so long, s, is a standstill.
const STANDSTILL: f64 = 0.8;
const STANDSTILL_S: f64 = 1.0;

/// The standard deviation of a speed that scatters, m/s; `None` where it does not, or not by itself.
pub(super) fn scatter_mps(checked: &Checked) -> Option<f64> {
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let known: Vec<(f64, f64)> = time_s
        .iter()
        .zip(speed_mps)
        .filter(|(_, v)| v.is_finite())
        .map(|(t, v)| (*t, *v))
        .collect();
    let off_mps: Vec<f64> = known
        .windows(3)
        .filter(|around| around[1].1 > MOVING_MPS)
        .map(|around| off_line(around[0], around[1], around[2]))
        .collect();
    let scatter_mps = deviation(off_mps.iter().copied());
    let least_mps = LEAST_MPS2 * median_step_s(time_s) / 2.0_f64.sqrt();
    let step_mps = checked.rounding.map_or(0.0, |r| r.lattice.step_mps);
    let signs = off_mps.windows(2).map(|pair| (pair[0] * pair[1]).signum());
    (off_mps.len() >= ROWS
        && scatter_mps > least_mps.max(ROUNDING_STEPS * step_mps)
        && mean(signs).is_some_and(|signs| signs < SIGNS))
    .then_some(scatter_mps)
}

/// Sets to 0 what stays nearer to it than the scatter.
fn stand_in_noise(time_s: &[f64], smooth_mps: &mut [f64], scatter_mps: f64) {
    let mut start = 0;
    for i in 0..=smooth_mps.len() {
        let is_small = |v: &f64| v.abs() < STANDSTILL * scatter_mps;
        if smooth_mps.get(i).is_some_and(is_small) {
            continue;
        }
        if i > start && time_s[i - 1] - time_s[start] >= STANDSTILL_S {
            smooth_mps[start..i].fill(0.0);
        }
        start = i + 1;
    }
}

/// A speed that scatters: by how much, m/s, and what it is without; `None` where it does not.
pub(super) fn smoothed(checked: &Checked) -> Option<(f64, Vec<f64>)> {
    let scatter_mps = scatter_mps(checked)?;
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let noise = whittaker::Noise {
        variance: scatter_mps.powi(2),
        independent_s: median_step_s(time_s),
    };
    let mut smooth_mps = whittaker::smooth(time_s, speed_mps, &checked.cuts, noise);
    stand_still(time_s, speed_mps, &mut smooth_mps);
    if speed_mps.iter().any(|v| *v < -scatter_mps) {
        stand_in_noise(time_s, &mut smooth_mps, scatter_mps);
    }
    Some((scatter_mps, smooth_mps))
}

/// Smooths a speed that scatters; `true` where it did.
pub(super) fn smooth_speed(checked: &mut Checked) -> bool {
    let Some((scatter_mps, smooth_mps)) = smoothed(checked) else {
        return false;
    };
    let detail =
        format!("scatters by {scatter_mps:.2} m/s (standard deviation) from row to row; smoothed");
    checked.report_all(FindingKind::Noise, Channel::Speed, Action::Smoothed, detail);
    checked.log.channels.insert(Channel::Speed, smooth_mps);
    true
}
