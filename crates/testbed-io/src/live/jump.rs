//! Poses that jump across the heading: nothing that wheels do moves a robot there at once.
//!
//! The way across the heading is what the way along it, at a constant angle, and the turn make of it. Where one jump explains the poses
//! better by much more than noise does, it was there. A step is thus found however slowly the robot goes, and steps do not add up.

use super::moved::Moved;

/// Poses on either side of a jump at least: fewer are an outlier.
const BESIDE: usize = 7;
/// How many standard deviations of noise make a jump certain, and how many times the noise it has to be: what rounds to a centimetre
/// jumps by that.
const CERTAIN: f64 = 6.0;
const TIMES_NOISE: f64 = 5.0;
/// What is shorter has no direction, in squares of m or rad.
const LEAST: f64 = 1e-12;

/// How far to the left the poses jumped at some time, in m, if they certainly did.
pub(super) fn jump_m<'a>(
    moved: impl Iterator<Item = &'a Moved> + Clone,
    noise_m: f64,
) -> Option<f64> {
    let count = moved.clone().count();
    let mut across: Vec<f64> = moved.clone().map(|own| own.across_m).collect();
    let explained = explained(moved);
    explained
        .iter()
        .for_each(|axis| take_off(axis, &mut across));
    let rest_m2 = square(&across);
    let sizes = (BESIDE..(count + 1).saturating_sub(BESIDE)).filter_map(|at| {
        let mut after: Vec<f64> = (0..count).map(|i| f64::from(u8::from(i >= at))).collect();
        explained.iter().for_each(|axis| take_off(axis, &mut after));
        let after2 = square(&after);
        let jump_m = dot(&across, &after) / after2;
        (after2 > LEAST).then_some((jump_m, jump_m * jump_m * after2))
    });
    let (jump_m, better_m2) = sizes.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let left_m2 = (rest_m2 - better_m2).max(0.0) / (count as f64 - 4.0).max(1.0);
    let noise_m2 = left_m2.max(noise_m * noise_m);
    let is_certain = better_m2 > CERTAIN * CERTAIN * noise_m2;
    (is_certain && jump_m.abs() > TIMES_NOISE * noise_m).then_some(jump_m)
}

/// What moves a robot across its heading: nothing, its way along it, and its turn, at right angles to each other.
fn explained<'a>(moved: impl Iterator<Item = &'a Moved> + Clone) -> Vec<Vec<f64>> {
    let parts: [fn(&Moved) -> f64; 3] = [|_| 1.0, |own| own.along_m, |own| own.turned_rad];
    let mut axes: Vec<Vec<f64>> = Vec::new();
    for part in parts {
        let mut axis: Vec<f64> = moved.clone().map(part).collect();
        axes.iter().for_each(|known| take_off(known, &mut axis));
        let length = square(&axis).sqrt();
        if length * length > LEAST {
            axis.iter_mut().for_each(|value| *value /= length);
            axes.push(axis);
        }
    }
    axes
}

fn take_off(axis: &[f64], values: &mut [f64]) {
    let share = dot(axis, values);
    for (value, axis) in values.iter_mut().zip(axis) {
        *value -= share * axis;
    }
}

fn square(values: &[f64]) -> f64 {
    dot(values, values)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use unicycle_cbf::{Pose, StampedPose};

    use super::*;
    use crate::live::moved::{KEPT_S, Trail};

    const NOISE_M: f64 = 3e-3;

    /// Of variance one.
    fn random(seed: u32) -> f64 {
        let mixed = f64::from(seed).sin() * 43_758.547;
        12.0_f64.sqrt() * (mixed - mixed.floor() - 0.5)
    }

    /// What every look finds at a robot that goes along a wave at 0.1 m/s, its heading off by 0.1 rad, with steps to the left.
    fn found(step_m: f64, every_s: f64, noise_m: f64, rounded_m: f64) -> Vec<(f64, Option<f64>)> {
        let mut trail = Trail::default();
        let mut found = Vec::new();
        let mut pose = Pose {
            x_m: 0.0,
            y_m: 0.0,
            heading_rad: 0.0,
        };
        for i in 1..1000_u32 {
            let stamp_s = 0.02 * f64::from(i);
            pose.heading_rad = 0.4 * (0.8 * stamp_s).sin();
            let (sin, cos) = pose.heading_rad.sin_cos();
            (pose.x_m, pose.y_m) = (pose.x_m + 0.002 * cos, pose.y_m + 0.002 * sin);
            let steps = ((stamp_s - 5.0) / every_s).floor().max(0.0);
            let noise = |salt: u32| noise_m * random(3 * i + salt);
            let round = |m: f64| {
                if rounded_m > 0.0 {
                    (m / rounded_m).round() * rounded_m
                } else {
                    m
                }
            };
            let seen = Pose {
                x_m: round(pose.x_m + noise(0)),
                y_m: round(pose.y_m + steps * step_m + noise(1)),
                heading_rad: pose.heading_rad + 0.1 + 2.9 * noise(2),
            };
            trail.add(StampedPose {
                stamp_s,
                pose: seen,
            });
            if i.is_multiple_of(5) {
                found.push((stamp_s, jump_m(trail.last(KEPT_S), NOISE_M)));
            }
        }
        found
    }

    #[test]
    fn a_step_across_the_heading_is_found_with_its_size_within_a_second() {
        for step_m in [0.04, -0.04, 0.025, 0.1] {
            for noise_m in [0.0, 2e-3] {
                let found = found(step_m, 4.0, noise_m, 0.0);
                let first = found
                    .iter()
                    .find_map(|(time_s, jump)| Some((*time_s, (*jump)?)));
                let (time_s, jump_m) = first.unwrap_or((f64::INFINITY, 0.0));
                assert!(
                    (9.0..9.8).contains(&time_s),
                    "{step_m} {noise_m}: {time_s} s"
                );
                assert!(
                    (jump_m - step_m).abs() < 0.01,
                    "{step_m} {noise_m}: {jump_m}"
                );
            }
        }
    }

    #[test]
    fn noise_rounding_and_a_heading_that_is_off_are_no_steps() {
        for (noise_m, rounded_m) in [
            (0.0, 0.0),
            (3e-3, 0.0),
            (1e-2, 0.0),
            (0.0, 0.01),
            (1e-3, 0.01),
        ] {
            let found = found(0.0, 4.0, noise_m, rounded_m);
            let jumps: Vec<_> = found.iter().filter(|(_, jump)| jump.is_some()).collect();
            assert!(jumps.is_empty(), "{noise_m} {rounded_m} {jumps:?}");
        }
    }
}
