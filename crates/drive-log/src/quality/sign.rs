//! The sign of the battery current.

use super::Checked;
use crate::{Action, Channel, FindingKind};

/// Pairs of samples that a correlation needs, and the correlation that turns the sign: one minute
/// of driving at 10 Hz, and power that explains a quarter of the variance. Trips with the right
/// sign have +0.82 to +0.97 (33 trips of a BMW i3).
const MIN_SAMPLES: usize = 600;
const FLIP_BELOW: f64 = -0.5;

/// Seconds over which the acceleration is taken: less is noise, more blurs gear changes and
/// regeneration.
const SPAN_S: f64 = 1.0;

/// Flips a current that is negative while the car accelerates.
///
/// `v·dv/dt` is the power of inertia per mass, which dominates the battery power of a drive in
/// traffic; their correlation is positive where discharge is positive.
pub(super) fn flip_current(checked: &mut Checked) {
    let Some(current_a) = checked.values(Channel::BatteryCurrent) else {
        return;
    };
    let voltage_v = checked.values(Channel::BatteryVoltage);
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let mut pairs = Vec::new();
    let mut from = 0;
    for to in 0..time_s.len() {
        while from < to && time_s[to] - time_s[from + 1] >= SPAN_S {
            from += 1;
        }
        let span_s = time_s[to] - time_s[from];
        if !(SPAN_S * 0.99..SPAN_S * 3.0).contains(&span_s) {
            continue;
        }
        let middle = usize::midpoint(from, to);
        let inertia = speed_mps[middle] * (speed_mps[to] - speed_mps[from]) / span_s;
        let battery = current_a[middle] * voltage_v.map_or(1.0, |v| v[middle]);
        if inertia.is_finite() && battery.is_finite() && speed_mps[middle] > 1.0 {
            pairs.push((inertia, battery));
        }
    }
    let r = correlation(&pairs);
    if pairs.len() < MIN_SAMPLES || r > FLIP_BELOW || r.is_nan() {
        return;
    }
    let samples = 0..time_s.len();
    let detail = format!(
        "battery power and v·dv/dt correlate with {r:.2} over {} samples",
        pairs.len()
    );
    if let Some(values) = checked.log.channels.get_mut(&Channel::BatteryCurrent) {
        values.iter_mut().for_each(|a| *a = -*a);
    }
    checked.report(
        FindingKind::CurrentSign,
        Channel::BatteryCurrent,
        &samples,
        Action::SignFlipped,
        detail,
    );
}

fn correlation(pairs: &[(f64, f64)]) -> f64 {
    let n = pairs.len() as f64;
    let (mean_x, mean_y) = pairs
        .iter()
        .fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for (x, y) in pairs {
        xx += (x - mean_x) * (x - mean_x);
        yy += (y - mean_y) * (y - mean_y);
        xy += (x - mean_x) * (y - mean_y);
    }
    xy / (xx * yy).sqrt()
}
