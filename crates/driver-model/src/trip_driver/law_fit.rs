//! The laws of acceleration and braking from the time that rises and falls lose.
//!
//! The distance over time must not be biased, so the laws are fitted to lost time and not to accelerations.

use super::habit::WantedSpeed;
use super::law::{ACCEL_MPS2, AccelerationLaw, BRAKING_MPS2, BRAKING_SCALE_MPS2, BrakingLaw};
use super::manoeuvres::{Fall, Rise, manoeuvres};
use super::recording::{RecordedTrip, interpolated};
use crate::statistics::{median, quantile};

/// Slower starts and smaller falls and lost times say nothing about braking or rising.
const LEAST_SPEED_MPS: f64 = 1.5;
const LEAST_FALL_MPS: f64 = 2.0;
const LEAST_LOST_S: f64 = 0.3;

/// What a driver without rises, falls or accelerations does.
const SCALE_MPS2: f64 = 1.5;
const BRAKING_SCALE: f64 = 0.4;
const BRAKING_EXPONENT: f64 = 0.5;
const MAX_ACCEL_MPS2: f64 = 2.0;
const MAX_BRAKING_MPS2: f64 = 2.5;

/// Speed differences over a second that count, m/s, and the quantiles that are the limits.
const LEAST_CHANGE_MPS: f64 = 0.2;
const ACCEL_QUANTILE: f64 = 0.95;
const BRAKING_QUANTILE: f64 = 0.01;

/// Falls beyond this are thinned out: the slope looks at every pair.
const MOST_FALLS: usize = 1500;

/// Both laws of a driver whose wanted speeds are known.
pub(super) fn laws(
    recordings: &[&RecordedTrip],
    wanted: &WantedSpeed,
) -> (AccelerationLaw, BrakingLaw) {
    let (rises, falls) = manoeuvres(recordings, wanted);
    let (max_accel_mps2, max_braking_mps2) = limits(recordings);
    (
        acceleration(&rises, max_accel_mps2),
        braking(&falls, max_braking_mps2),
    )
}

/// The law loses `C/A` with `C = w/1.5 [(1 − v0/w)^1.5 − (1 − v1/w)^1.5]` against driving `w` from the beginning.
fn acceleration(rises: &[Rise], max_mps2: f64) -> AccelerationLaw {
    let scale = |rise: &Rise| {
        let missing = |v: f64| (1.0 - v / rise.wanted_mps).clamp(0.0, 1.0).powf(1.5);
        let lost_s = rise.duration_s - rise.distance_m / rise.wanted_mps;
        let c = rise.wanted_mps / 1.5 * (missing(rise.from_mps) - missing(rise.to_mps));
        (lost_s > LEAST_LOST_S && c > 0.0).then_some(c / lost_s)
    };
    let scales: Vec<f64> = rises.iter().filter_map(scale).collect();
    AccelerationLaw {
        rises: scales.len(),
        scale_mps2: median(scales)
            .unwrap_or(SCALE_MPS2)
            .clamp(*ACCEL_MPS2.start(), *ACCEL_MPS2.end()),
        max_mps2,
    }
}

/// Constant deceleration by `Δ` from `v0` loses `Δ²/(2 v0 d)` against holding `v0`.
fn braking(falls: &[Fall], max_mps2: f64) -> BrakingLaw {
    let logarithms = |fall: &Fall| {
        let difference_mps = fall.from_mps - fall.to_mps;
        let lost_s = fall.duration_s - fall.distance_m / fall.from_mps;
        let counts = fall.from_mps > LEAST_SPEED_MPS
            && difference_mps > LEAST_FALL_MPS
            && lost_s > LEAST_LOST_S;
        let decel_mps2 = difference_mps.powi(2) / (2.0 * fall.from_mps * lost_s);
        counts.then(|| (difference_mps.ln(), decel_mps2.ln()))
    };
    let points: Vec<(f64, f64)> = falls.iter().filter_map(logarithms).collect();
    let exponent = theil_sen(&points)
        .unwrap_or(BRAKING_EXPONENT)
        .clamp(0.0, 1.0);
    let scale = median(points.iter().map(|(x, y)| y - exponent * x).collect());
    BrakingLaw {
        scale_mps2: scale
            .map_or(BRAKING_SCALE, f64::exp)
            .clamp(*BRAKING_SCALE_MPS2.start(), *BRAKING_SCALE_MPS2.end()),
        exponent,
        max_mps2,
        falls: points.len(),
    }
}

/// Median slope over all pairs.
fn theil_sen(points: &[(f64, f64)]) -> Option<f64> {
    let points: Vec<&(f64, f64)> = points
        .iter()
        .step_by(points.len().div_ceil(MOST_FALLS).max(1))
        .collect();
    let slopes = points.iter().enumerate().flat_map(|(k, a)| {
        let pairs = points[k + 1..].iter().map(move |b| (b.0 - a.0, b.1 - a.1));
        pairs
            .filter(|(dx, _)| f64::abs(*dx) > 1e-3)
            .map(|(dx, dy)| dy / dx)
    });
    median(slopes.collect())
}

/// Largest acceleration and deceleration, from speeds a second apart.
fn limits(recordings: &[&RecordedTrip]) -> (f64, f64) {
    let (mut rising, mut falling) = (Vec::new(), Vec::new());
    for recording in recordings {
        let seconds = recording.duration_s().ceil() as usize;
        let at =
            |second: usize| interpolated(&recording.speed_mps, second as f64 / recording.step_s);
        for second in 1..seconds {
            let change_mps = at(second) - at(second - 1);
            if change_mps > LEAST_CHANGE_MPS {
                rising.push(change_mps);
            } else if change_mps < -LEAST_CHANGE_MPS {
                falling.push(change_mps);
            }
        }
    }
    rising.sort_by(f64::total_cmp);
    falling.sort_by(f64::total_cmp);
    let accel = quantile(&rising, ACCEL_QUANTILE).unwrap_or(MAX_ACCEL_MPS2);
    let braking = quantile(&falling, BRAKING_QUANTILE).map_or(MAX_BRAKING_MPS2, |a| -a);
    (
        accel.clamp(*ACCEL_MPS2.start(), *ACCEL_MPS2.end()),
        braking.clamp(*BRAKING_MPS2.start(), *BRAKING_MPS2.end()),
    )
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::super::manoeuvres::RISEN;
    use super::*;

    #[test]
    fn laws_are_found_again_from_their_own_motion() {
        let law = AccelerationLaw {
            scale_mps2: 1.7,
            max_mps2: 9.0,
            rises: 0,
        };
        let rises = [10.0, 20.0, 30.0].map(|wanted_mps| {
            let (mut v, mut distance_m, mut steps) = (0.0, 0.0, 0);
            while v < RISEN * wanted_mps {
                let next = v + 1e-3 * law.mps2(v, wanted_mps);
                distance_m += 0.5e-3 * (v + next);
                (v, steps) = (next, steps + 1);
            }
            Rise {
                duration_s: f64::from(steps) * 1e-3,
                distance_m,
                from_mps: 0.0,
                to_mps: v,
                wanted_mps,
            }
        });
        let found = acceleration(&rises, 9.0);
        assert!((found.scale_mps2 - 1.7).abs() < 2e-3 && found.rises == 3);

        let falls = [(30.0, 5.0), (20.0, 16.0), (14.0, 0.0), (9.0, 3.0)].map(|(from, to)| {
            let decel_mps2 = 0.3 * f64::powf(from - to, 0.6);
            Fall {
                duration_s: (from - to) / decel_mps2,
                distance_m: (from * from - to * to) / (2.0 * decel_mps2),
                from_mps: from,
                to_mps: to,
            }
        });
        let found = braking(&falls, 9.0);
        assert!((found.scale_mps2 - 0.3).abs() < 1e-9 && (found.exponent - 0.6).abs() < 1e-9);
    }

    #[test]
    fn without_rises_and_falls_there_are_fallbacks() {
        let found = acceleration(&[], 2.0);
        assert_eq!((found.scale_mps2, found.rises), (1.5, 0));
        let found = braking(&[], 2.5);
        assert_eq!(
            (found.scale_mps2, found.exponent, found.falls),
            (0.4, 0.5, 0)
        );
    }

    #[test]
    fn many_falls_are_thinned_out() {
        let points: Vec<(f64, f64)> = (0..20_000)
            .map(|k| f64::from(k) / 1e3)
            .map(|x| (x, 0.5 * x))
            .collect();
        assert!((theil_sen(&points).unwrap() - 0.5).abs() < 1e-9);
        assert_eq!(theil_sen(&[(1.0, 2.0), (1.0, 3.0)]), None);
    }
}
