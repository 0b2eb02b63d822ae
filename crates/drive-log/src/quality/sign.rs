//! The sign of the battery current.

use super::checked::Checked;
use super::motion::{GRAVITY_MPS2, Span, mean_gradient, moving_spans};
use crate::statistics::{correlation, significance};
use crate::{Action, Channel, FindingKind};

/// The correlation that turns the sign, and the standard deviations that it must be off 0: power
/// that explains a quarter of the variance, and not by chance. Trips with the right sign have +0.82
/// to +0.97 (33 trips of a BMW i3).
const FLIP_BELOW: f64 = -0.5;
const CERTAIN_DEVIATIONS: f64 = 4.0;

/// Seconds of a part of the drive that has a sign of its own.
const PART: usize = 60;

/// Braking that motors take part in, W/kg: 0.2 m/s² at 10 m/s.
const BRAKING_W_PER_KG: f64 = -2.0;

/// What an offset of the sensor is of the largest current, at most.
const OFFSET_SHARE: f64 = 0.01;

/// Distance over which an energy must be positive, m; the least that a car takes, J/m: the rolling
/// resistance of 300 kg; and the descent that gives it back, as a gradient.
const WHOLE_M: f64 = 1000.0;
const LEAST_J_PER_M: f64 = 30.0;
const DESCENT: f64 = 0.005;

/// Flips a current that is negative while the car accelerates.
///
/// `v·dv/dt` is the power of inertia per mass, which dominates the battery power of a drive in
/// traffic; their correlation is positive where discharge is positive.
pub(super) fn flip_current(checked: &mut Checked) {
    if checked.values(Channel::BatteryCurrent).is_none() {
        return;
    }
    let spans = moving_spans(&checked.log);
    if let Some(detail) = has_no_sign(checked, &spans).or_else(|| turns(checked, &spans)) {
        drop_current(checked, detail);
    } else if let Some(detail) = runs_against(checked, &spans) {
        flip(checked, detail);
    } else {
        judge_energy(checked, &spans);
    }
}

/// Pairs of inertia and battery power.
fn pairs<'a>(checked: &Checked, spans: impl IntoIterator<Item = &'a Span>) -> Vec<(f64, f64)> {
    let pair = |span: &Span| Some((span.inertia(), span.battery(&checked.log)?));
    spans.into_iter().filter_map(pair).collect()
}

/// The correlation that says that a current has the wrong sign.
fn runs_against(checked: &Checked, spans: &[Span]) -> Option<String> {
    let pairs = pairs(checked, spans);
    let r = correlation(&pairs);
    (r <= FLIP_BELOW && significance(r, pairs.len()) <= -CERTAIN_DEVIATIONS).then(|| {
        let seconds = pairs.len();
        format!("battery power and v·dv/dt correlate with {r:.2} over {seconds} seconds in motion")
    })
}

/// What says that a current was recorded without its sign: all of it is on one side of 0, and yet its size is the larger the
/// harder the car brakes.
fn has_no_sign(checked: &Checked, spans: &[Span]) -> Option<String> {
    let current_a = checked.values(Channel::BatteryCurrent)?;
    let side = one_sided(current_a)?;
    let braking = spans
        .iter()
        .filter(|span| span.inertia() < BRAKING_W_PER_KG);
    let mut pairs = pairs(checked, braking);
    pairs.iter_mut().for_each(|(_, power)| *power *= side);
    let r = correlation(&pairs);
    (r <= FLIP_BELOW && significance(r, pairs.len()) <= -CERTAIN_DEVIATIONS).then(|| {
        let (seconds, beyond) = (pairs.len(), if side > 0.0 { "below" } else { "above" });
        format!(
            "never {beyond} 0, and yet the size of the battery power and v·dv/dt correlate with {r:.2} over {seconds} seconds of braking: recorded without its sign; record charging as negative"
        )
    })
}

/// What says that the sign of a current is another one from some time on.
fn turns(checked: &Checked, spans: &[Span]) -> Option<String> {
    let known = spans
        .iter()
        .filter(|span| span.battery(&checked.log).is_some());
    let known: Vec<&Span> = known.collect();
    let pairs = pairs(checked, known.iter().copied());
    let products = pairs.iter().map(|(inertia, power)| inertia * power);
    let sums = products.scan(0.0, |sum, product| {
        *sum += product;
        Some(*sum)
    });
    let sums: Vec<f64> = sums.collect();
    let all = *sums.last()?;
    let differs = |k: &usize| (2.0 * sums[*k] - all).abs();
    let last = (0..sums.len()).max_by(|a, b| differs(a).total_cmp(&differs(b)))?;
    let (before, after) = pairs.split_at(last + 1);
    let side = |part: &[(f64, f64)]| {
        let r = correlation(part);
        let is_certain = significance(r.abs(), part.len()) >= CERTAIN_DEVIATIONS;
        (part.len() >= PART && is_certain && r.abs() >= -FLIP_BELOW).then_some(r)
    };
    let (first, second) = (side(before)?, side(after)?);
    (first * second < 0.0).then(|| {
        let at_s = checked.log.time_s()[*known[last].samples.end()];
        format!(
            "battery power and v·dv/dt correlate with {first:.2} up to {at_s:.0} s and with {second:.2} afterwards: the sign turns; not used"
        )
    })
}

/// 1 where no current is below 0, −1 where none is above, but for an offset of the sensor.
fn one_sided(current_a: &[f64]) -> Option<f64> {
    let known = current_a.iter().filter(|a| a.is_finite());
    let (low, high) = known.fold((0.0_f64, 0.0_f64), |(low, high), a| {
        (low.min(*a), high.max(*a))
    });
    if -low <= OFFSET_SHARE * high {
        return Some(1.0);
    }
    (high <= -OFFSET_SHARE * low).then_some(-1.0)
}

/// A drive takes energy, unless it goes downhill. Where it is known not to, the sign is wrong; where
/// that is not known, it may be.
fn judge_energy(checked: &mut Checked, spans: &[Span]) {
    if checked.values(Channel::BatteryVoltage).is_none() {
        return;
    }
    let (energy_j, distance_m) = taken(checked, spans);
    if distance_m < WHOLE_M || energy_j > -LEAST_J_PER_M * distance_m {
        return;
    }
    let detail = format!(
        "{:.3} kWh measured over {:.2} km in motion",
        energy_j / 3.6e6,
        distance_m / 1e3
    );
    match gradient(checked, spans, distance_m) {
        Some(gradient) if gradient < -DESCENT => {}
        Some(gradient) => flip(
            checked,
            format!("{detail} at a mean gradient of {:.1} %", 100.0 * gradient),
        ),
        None => {
            let cure = "give elevation or slope, or turn the sign with sign = -1 in a layout";
            let detail = format!("{detail}: downhill, or the sign is wrong; {cure}");
            report(checked, Action::Kept, detail);
        }
    }
}

/// Energy that the battery gives in motion, J, and distance, m.
fn taken(checked: &Checked, spans: &[Span]) -> (f64, f64) {
    let known = spans.iter().filter_map(|span| {
        Some((
            span.battery(&checked.log)? * span.duration_s,
            span.distance_m(),
        ))
    });
    known.fold((0.0, 0.0), |sum, (energy_j, way_m)| {
        (sum.0 + energy_j, sum.1 + way_m)
    })
}

/// Mean gradient with the height that the change of speed is worth; `None` without a known road.
fn gradient(checked: &Checked, spans: &[Span], distance_m: f64) -> Option<f64> {
    let (first, last) = (spans.first()?, spans.last()?);
    let head_m = (last.speed_mps.powi(2) - first.speed_mps.powi(2)) / (2.0 * GRAVITY_MPS2);
    Some(mean_gradient(&checked.log, spans)? + head_m / distance_m)
}

fn drop_current(checked: &mut Checked, detail: String) {
    report(checked, Action::Dropped, detail);
    checked.log.channels.remove(&Channel::BatteryCurrent);
}

fn flip(checked: &mut Checked, detail: String) {
    if let Some(values) = checked.log.channels.get_mut(&Channel::BatteryCurrent) {
        values.iter_mut().for_each(|a| *a = -*a);
    }
    report(checked, Action::SignFlipped, detail);
}

fn report(checked: &mut Checked, action: Action, detail: String) {
    checked.report_all(
        FindingKind::CurrentSign,
        Channel::BatteryCurrent,
        action,
        detail,
    );
}
