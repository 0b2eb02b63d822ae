//! Accelerometers in another unit, turned, late or off level.

use super::checked::Checked;
use super::motion::{GRAVITY_MPS2, Span, mean_gradient, moving_spans};
use super::pace::{self, Verdict};
use crate::statistics::{correlation, mean, median_step_s, near, slope};
use crate::{Action, Channel, FindingKind};

/// Seconds in motion that say something, and by how much the car must change
/// its speed meanwhile, m/s² (root mean square).
const SECONDS: usize = 60;

/// A second with more than this holds a jump of the recorded speed, m/s².
const JUMP_MPS2: f64 = 11.0;
const LIVELY_MPS2: f64 = 0.3;

/// An accelerometer along the car follows `dv/dt`, with a correlation of 0.93 and more in 33 trips
/// of a BMW i3; a factor is told above the first figure, and below the second it feels something
/// else.
const FOLLOWS: f64 = 0.7;
const UNRELATED: f64 = 0.3;

/// One that follows so closely is along the car.
const FOLLOWS_CLOSELY: f64 = 0.85;

/// An accelerometer whose scale is off by no more than this share is left out where nothing tells whether the times are off instead:
/// the energy is then wrong by little.
const MILD: f64 = 0.25;

/// Tolerance of a factor, on top of three standard errors: 33 trips of a BMW i3 have 0.95 to 1.06.
const TOLERANCE: f64 = 0.15;
const ERRORS: f64 = 3.0;

/// The largest delay that is looked for, and the least that is one, s: buses and filters delay by
/// 0.2 s. Without the delay, so many times less of the variance must be unexplained, and this share
/// of it besides.
const LONGEST_DELAY_S: f64 = 3.0;
const LEAST_DELAY_S: f64 = 0.35;
const LESS: f64 = 2.0;
const GAIN: f64 = 0.02;

/// An offset beyond this is one of the mounting, m/s²: 1.7 degrees. Trips of a BMW i3 have up to
/// 0.06. Without a known road, the steepest mean gradient of a drive is added.
const OFFSET_MPS2: f64 = 0.3;
const UNKNOWN_ROAD_MPS2: f64 = 0.6;

/// Distance over which a mean gradient is one of the road, m.
const ROAD_M: f64 = 1000.0;

/// Mends an accelerometer that does not follow the speed: shifts it in time, turns and scales it,
/// takes its offset out; drops it where it follows nothing.
pub(super) fn mend(checked: &mut Checked) {
    if checked.values(Channel::Accelerometer).is_none() {
        return;
    }
    let mut spans = moving_spans(&checked.log);
    spans.retain(|span| span.accel_mps2.abs() < JUMP_MPS2);
    if spans.len() < SECONDS || !is_lively(checked, &spans) {
        return;
    }
    shift(checked, &spans);
    if scale(checked, &spans) {
        level(checked, &spans);
    }
}

/// Whether the car changes its speed; or, by an accelerometer that follows closely, more than times that are too slow make it.
fn is_lively(checked: &Checked, spans: &[Span]) -> bool {
    let deviates = |values: &[f64], middle: f64| {
        mean(values.iter().map(|a| (a - middle).powi(2)))
            .is_some_and(|square| square >= LIVELY_MPS2.powi(2))
    };
    let pairs = pairs(checked, spans, 0);
    let felt: Vec<f64> = pairs.iter().map(|(_, felt)| *felt).collect();
    let middle = mean(felt.iter().copied()).unwrap_or(0.0);
    let accels: Vec<f64> = spans.iter().map(|span| span.accel_mps2).collect();
    deviates(&accels, 0.0) || deviates(&felt, middle) && correlation(&pairs) >= FOLLOWS_CLOSELY
}

/// Pairs of `dv/dt` and what the accelerometer says `late` samples later.
fn pairs(checked: &Checked, spans: &[Span], late: isize) -> Vec<(f64, f64)> {
    let values = checked.values(Channel::Accelerometer).unwrap_or_default();
    let at = |i: usize| {
        i.checked_add_signed(late)
            .and_then(|i| values.get(i))
            .copied()
    };
    let pair = |span: &Span| {
        let felt = mean(span.samples.clone().filter_map(at))?;
        Some((span.accel_mps2, felt))
    };
    spans.iter().filter_map(pair).collect()
}

/// Undoes a delay between accelerometer and speed.
fn shift(checked: &mut Checked, spans: &[Span]) {
    let step_s = median_step_s(checked.log.time_s());
    let most = (LONGEST_DELAY_S / step_s) as isize;
    let explained = |late: isize| {
        let r = correlation(&pairs(checked, spans, late));
        if r.is_nan() { 0.0 } else { r * r }
    };
    let now = explained(0);
    if 1.0 - now < GAIN {
        return;
    }
    let Some((late, then)) = (-most..=most)
        .map(|late| (late, explained(late)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
    else {
        return;
    };
    let delay_s = late as f64 * step_s;
    if then < FOLLOWS * FOLLOWS
        || 1.0 - now < GAIN + LESS * (1.0 - then)
        || delay_s.abs() < LEAST_DELAY_S
    {
        return;
    }
    let detail = format!(
        "follows the speed by {delay_s:.2} s: correlates with dv/dt at {:.2}, and {:.2} without the delay",
        now.sqrt(),
        then.sqrt()
    );
    if let Some(values) = checked.log.channels.get_mut(&Channel::Accelerometer) {
        let at = |i: usize| {
            i.checked_add_signed(late)
                .and_then(|i| values.get(i))
                .copied()
        };
        *values = (0..values.len())
            .map(|i| at(i).unwrap_or(f64::NAN))
            .collect();
    }
    report(checked, FindingKind::Delay, Action::Shifted, detail);
}

/// Turns and scales to m/s² along the car, or drops the channel. Whether it is still there.
///
/// Noise of the speed lowers the share of `dv/dt` that is felt, noise of the accelerometer does not;
/// of the inverse it is the other way round. The truth is between the two.
fn scale(checked: &mut Checked, spans: &[Span]) -> bool {
    let pairs = pairs(checked, spans, 0);
    let (r, share) = (correlation(&pairs), slope(&pairs));
    if pairs.len() < SECONDS {
        return true;
    }
    if r.is_nan() {
        return drop(checked, "the same value all along while the speed changes");
    }
    let error = share.abs() * ((1.0 / (r * r) - 1.0) / pairs.len() as f64).sqrt();
    let margin = TOLERANCE + ERRORS * error;
    let may_be_one = share <= 1.0 + margin && share / (r * r) >= 1.0 - margin;
    let is_related = r + ERRORS / (pairs.len() as f64).sqrt() > UNRELATED;
    if may_be_one && is_related {
        return true;
    }
    let figures = format!("{share:.3} of dv/dt at a correlation of {r:.2}");
    let factor = [1.0, GRAVITY_MPS2, 1.0 / GRAVITY_MPS2]
        .into_iter()
        .find(|factor| near((share / r).abs() * factor, 1.0, TOLERANCE))
        .filter(|_| r.abs() >= FOLLOWS);
    if let Some(factor) = factor {
        rescale(checked, factor.copysign(share), &figures);
        return true;
    }
    if r < FOLLOWS_CLOSELY {
        return drop(
            checked,
            &format!("{figures}: not along the car, or in another unit"),
        );
    }
    match pace::by_battery(checked, share) {
        Verdict::Wrong(why) => {
            pace::refuse(checked, &format!("{figures}; {why}"));
            true
        }
        Verdict::Open if !near(share, 1.0, MILD) => {
            pace::refuse_either(checked, &figures);
            true
        }
        Verdict::Right | Verdict::Open => drop(
            checked,
            &format!(
                "{figures}: in another unit, or the times or speeds are off by that factor; check them"
            ),
        ),
    }
}

/// `false`: the channel is not there any more.
fn drop(checked: &mut Checked, why: &str) -> bool {
    report(
        checked,
        FindingKind::Mounting,
        Action::Dropped,
        why.to_owned(),
    );
    checked.log.channels.remove(&Channel::Accelerometer);
    false
}

fn rescale(checked: &mut Checked, factor: f64, figures: &str) {
    change(checked, |a| a * factor);
    let turned = if factor < 0.0 { ", turned around" } else { "" };
    let kind = if near(factor.abs(), 1.0, TOLERANCE) {
        FindingKind::Mounting
    } else {
        FindingKind::Unit
    };
    let detail = format!("{figures}{turned}: times {factor:.5}");
    report(checked, kind, Action::Scaled, detail);
}

/// Takes out an offset that is none of the road.
fn level(checked: &mut Checked, spans: &[Span]) {
    let distance_m: f64 = spans.iter().map(Span::distance_m).sum();
    let values = checked.values(Channel::Accelerometer).unwrap_or_default();
    let felt = spans.iter().filter_map(|span| {
        let rest_mps2 = span.mean(values)? - span.accel_mps2;
        Some((rest_mps2, span.distance_m()))
    });
    let (sum, felt_m) = felt.fold((0.0, 0.0), |sum, (rest, way)| {
        (sum.0 + rest * way, sum.1 + way)
    });
    let road = mean_gradient(&checked.log, spans);
    let offset_mps2 = sum / felt_m - GRAVITY_MPS2 * road.unwrap_or(0.0);
    let most_mps2 = if road.is_some() {
        OFFSET_MPS2
    } else {
        UNKNOWN_ROAD_MPS2
    };
    if distance_m < ROAD_M || offset_mps2.is_nan() || offset_mps2.abs() <= most_mps2 {
        return;
    }
    let degrees = (offset_mps2 / GRAVITY_MPS2)
        .clamp(-1.0, 1.0)
        .asin()
        .to_degrees();
    let detail = format!(
        "{offset_mps2:.2} m/s² more than speed and road explain, as if mounted {degrees:.1} degrees off level"
    );
    if road.is_none() {
        // without elevation the drive may be one long climb
        report(checked, FindingKind::Mounting, Action::Kept, detail);
        return;
    }
    change(checked, |a| a - offset_mps2);
    report(checked, FindingKind::Mounting, Action::Shifted, detail);
}

fn change(checked: &mut Checked, change: impl Fn(f64) -> f64) {
    if let Some(values) = checked.log.channels.get_mut(&Channel::Accelerometer) {
        values.iter_mut().for_each(|a| *a = change(*a));
    }
}

fn report(checked: &mut Checked, kind: FindingKind, action: Action, detail: String) {
    checked.report_all(kind, Channel::Accelerometer, action, detail);
}
