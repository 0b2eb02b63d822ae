//! Rises and falls of the speed, and the laws from the time that they lose.
//!
//! The distance over time must not be biased, so the laws are fitted to lost time and not to accelerations.

use super::habit::WantedSpeed;
use super::law::{ACCEL_MPS2, AccelerationLaw, BRAKING_MPS2, BRAKING_SCALE_MPS2, BrakingLaw};
use super::recording::{Recording, interpolated};
use super::zigzag::Extremum;
use super::STANDSTILL_MPS;
use crate::statistics::quantile;

/// A rise ends at this share of the wanted speed; a fall begins at the other or, if there is none, at a high from the third.
const RISEN: f64 = 0.93;
const CRUISING: f64 = 0.95;
const NEAR_CRUISING: f64 = 0.85;

/// The limit may change in the first moments of a rise, s.
const LIMIT_MAY_CHANGE_S: f64 = 1.5;

/// Smaller differences of speed and lost times say nothing.
const LEAST_RISE_MPS: f64 = 1.5;
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

struct Rise {
    duration_s: f64,
    distance_m: f64,
    from_mps: f64,
    to_mps: f64,
    wanted_mps: f64,
}

struct Fall {
    duration_s: f64,
    distance_m: f64,
    from_mps: f64,
    to_mps: f64,
}

/// Both laws of a driver whose wanted speeds are known.
pub(super) fn laws(
    recordings: &[&Recording],
    wanted: &WantedSpeed,
) -> (AccelerationLaw, BrakingLaw) {
    let (mut rises, mut falls) = (Vec::new(), Vec::new());
    for recording in recordings {
        let wanted_mps: Vec<f64> = recording.limit_mps.iter().map(|&l| wanted.mps(l)).collect();
        for pair in recording.extrema.windows(2) {
            match (pair[0], pair[1]) {
                (Extremum::Low(low), Extremum::High(high)) => {
                    rises.extend(rise(recording, &wanted_mps, low, high));
                }
                (Extremum::High(high), Extremum::Low(low)) => {
                    falls.extend(fall(recording, &wanted_mps, high, low));
                }
                _ => {}
            }
        }
    }
    let (max_accel_mps2, max_braking_mps2) = limits(recordings);
    (
        acceleration(&rises, max_accel_mps2),
        braking(&falls, max_braking_mps2),
    )
}

fn rise(recording: &Recording, wanted_mps: &[f64], low: usize, high: usize) -> Option<Rise> {
    let (v, step_s) = (&recording.speed_mps, recording.step_s);
    // Not in the first samples: they may lie before a limit that has just been raised.
    let risen = (low + 3..=high).find(|&k| v[k] >= RISEN * wanted_mps[k])?;
    let late = (LIMIT_MAY_CHANGE_S / step_s).round() as usize;
    let limits = &recording.limit_mps[(low + late).min(risen)..=risen];
    let wanted = wanted_mps[risen];
    if limits.iter().any(|l| *l != limits[0]) || wanted - v[low] < LEAST_RISE_MPS {
        return None;
    }
    let start_s = match v[low] < STANDSTILL_MPS && v[low + 2] > v[low + 1] {
        true => {
            // Extrapolated to standstill, which at 1 Hz is not at a sample.
            let since = v[low + 1] / (v[low + 2] - v[low + 1]);
            (low as f64 + (1.0 - since).clamp(0.0, 1.0)) * step_s
        }
        false => low as f64 * step_s,
    };
    let end_s = recording.crossing_s(risen - 1, RISEN * wanted);
    Some(Rise {
        duration_s: end_s - start_s,
        distance_m: interpolated(&recording.distance_m, end_s / step_s) - recording.distance_m[low],
        from_mps: v[low],
        to_mps: interpolated(v, end_s / step_s),
        wanted_mps: wanted,
    })
}

fn fall(recording: &Recording, wanted_mps: &[f64], high: usize, low: usize) -> Option<Fall> {
    let (v, step_s) = (&recording.speed_mps, recording.step_s);
    let cruising = (high..=low).rfind(|&k| v[k] >= CRUISING * wanted_mps[k]);
    let (start, start_s) = match cruising {
        Some(k) if k < low => (k, recording.crossing_s(k, CRUISING * wanted_mps[k])),
        Some(k) => (k, k as f64 * step_s),
        None if v[high] >= NEAR_CRUISING * wanted_mps[high] => (high, high as f64 * step_s),
        None => return None,
    };
    // The same threshold as that of a stop, so that no time is lost or counted twice.
    let end_s = match (start..=low).find(|&k| v[k] < STANDSTILL_MPS) {
        Some(k) if k > start => recording.crossing_s(k - 1, STANDSTILL_MPS),
        Some(k) => k as f64 * step_s,
        None => low as f64 * step_s,
    };
    let at = |values: &[f64], t_s: f64| interpolated(values, t_s / step_s);
    Some(Fall {
        duration_s: end_s - start_s,
        distance_m: at(&recording.distance_m, end_s) - at(&recording.distance_m, start_s),
        from_mps: at(v, start_s),
        to_mps: at(v, end_s),
    })
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
        let counts = fall.from_mps > LEAST_RISE_MPS
            && difference_mps > LEAST_FALL_MPS
            && lost_s > LEAST_LOST_S;
        let decel_mps2 = difference_mps.powi(2) / (2.0 * fall.from_mps * lost_s);
        counts.then(|| (difference_mps.ln(), decel_mps2.ln()))
    };
    let points: Vec<(f64, f64)> = falls.iter().filter_map(logarithms).collect();
    let exponent = theil_sen(&points).unwrap_or(BRAKING_EXPONENT).clamp(0.0, 1.0);
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
        pairs.filter_map(|(dx, dy)| (dx.abs() > 1e-3).then(|| dy / dx))
    });
    median(slopes.collect())
}

/// Largest acceleration and deceleration, from speeds a second apart.
fn limits(recordings: &[&Recording]) -> (f64, f64) {
    let (mut rising, mut falling) = (Vec::new(), Vec::new());
    for recording in recordings {
        let seconds = recording.duration_s().ceil() as usize;
        let at = |second: usize| interpolated(&recording.speed_mps, second as f64 / recording.step_s);
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

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    quantile(&values, 0.5)
}

#[cfg(test)]
mod tests {
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
        assert_eq!((found.scale_mps2, found.exponent, found.falls), (0.4, 0.5, 0));
    }

    #[test]
    fn many_falls_are_thinned_out() {
        let points: Vec<(f64, f64)> = (0..20_000).map(|k| f64::from(k) / 1e3).map(|x| (x, 0.5 * x)).collect();
        assert!((theil_sen(&points).unwrap() - 0.5).abs() < 1e-9);
        assert_eq!(theil_sen(&[(1.0, 2.0), (1.0, 3.0)]), None);
    }
}
