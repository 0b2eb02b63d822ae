//! Poses that jump across the heading: nothing that wheels do moves a robot there at once.
//!
//! The way across the heading is what the way along it, at a constant angle, and the turn make of it. Where one jump explains the poses
//! better by much more than noise does, it was there. Jumps are added up: those to and fro are noise.

use super::moved::{KEPT_S, Moved, Trail};

/// Poses on either side of a jump at least: fewer are an outlier.
const BESIDE: usize = 7;
/// How many standard deviations of noise make a jump certain, and how many times the noise it has to be to count: noise that lasts for
/// a while looks like small jumps to and fro.
const CERTAIN: f64 = 5.0;
const COUNTED: f64 = 2.5;
/// How many times the noise all jumps together have to be: what rounds to a centimetre jumps by that.
const TIMES_NOISE: f64 = 5.0;
/// Jumps nearer to each other in time are one, in s, and one is forgotten in this time, in s.
const APART_S: f64 = 0.25;
const FORGOTTEN_S: f64 = 20.0;
/// What is shorter has no direction, in squares of m or rad.
const LEAST: f64 = 1e-12;

/// The jumps of one robot, to the left, added up.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Jumps {
    /// Those before the last, in m
    before_m: f64,
    last: Option<Jump>,
}

#[derive(Debug, Clone, Copy)]
struct Jump {
    at_s: f64,
    size_m: f64,
    /// How much better it explains the poses, in squares of m
    better_m2: f64,
    /// What it leaves of each
    left_m2: f64,
}

impl Jumps {
    /// Gives how far they lead in all, in m, if that is more than noise makes of it.
    pub(super) fn look(&mut self, trail: &Trail, noise_m: f64) -> Option<f64> {
        let moved: Vec<&Moved> = trail.last(KEPT_S).collect();
        if let Some(jump) = jump(&moved, noise_m) {
            self.add(jump);
        }
        let sum_m = self.before_m + self.last.map_or(0.0, |last| last.size_m);
        (sum_m.abs() > TIMES_NOISE * noise_m).then_some(sum_m)
    }

    fn add(&mut self, jump: Jump) {
        if let Some(last) = self.last {
            let since_s = jump.at_s - last.at_s;
            if since_s < -APART_S {
                return;
            }
            if since_s > APART_S {
                self.before_m = (self.before_m + last.size_m) * (-since_s / FORGOTTEN_S).exp();
            }
        }
        self.last = Some(jump);
    }
}

/// The jump that explains the poses best, if it was certainly there.
fn jump(moved: &[&Moved], noise_m: f64) -> Option<Jump> {
    let count = moved.len();
    let mut across: Vec<f64> = moved.iter().map(|own| own.across_m).collect();
    let explained = explained(moved);
    explained
        .iter()
        .for_each(|axis| take_off(axis, &mut across));
    let places = moved.iter().enumerate().skip(BESIDE);
    let places = places.take((count + 1).saturating_sub(2 * BESIDE));
    let jumps = places.filter_map(|(at, from)| {
        // The angle between heading and motion may change there, too.
        let bend = moved
            .iter()
            .map(|own| (own.along_m - from.along_m).max(0.0));
        let bend = beside(bend.collect(), &explained);
        let mut rest = across.clone();
        bend.iter().for_each(|bend| take_off(bend, &mut rest));
        let mut after: Vec<f64> = (0..count).map(|i| f64::from(u8::from(i >= at))).collect();
        explained
            .iter()
            .chain(&bend)
            .for_each(|axis| take_off(axis, &mut after));
        let after2 = square(&after);
        let size_m = dot(&rest, &after) / after2;
        let better_m2 = size_m * size_m * after2;
        (after2 > LEAST).then_some(Jump {
            at_s: from.seen.stamp_s,
            size_m,
            better_m2,
            left_m2: (square(&rest) - better_m2).max(0.0) / (count as f64 - 5.0).max(1.0),
        })
    });
    // At the end there may be a larger one a little later.
    let newest_s = moved.get(count.checked_sub(BESIDE)?)?.seen.stamp_s;
    let best = jumps.min_by(|a, b| a.left_m2.total_cmp(&b.left_m2))?;
    let certain_m2 = CERTAIN * CERTAIN * best.left_m2.max(noise_m * noise_m);
    let is_certain = best.better_m2 > certain_m2 && best.size_m.abs() > COUNTED * noise_m;
    (is_certain && best.at_s < newest_s).then_some(best)
}

/// What moves a robot across its heading: nothing, its way along it, and its turn, at right angles to each other.
fn explained(moved: &[&Moved]) -> Vec<Vec<f64>> {
    let parts: [fn(&Moved) -> f64; 3] = [|_| 1.0, |own| own.along_m, |own| own.turned_rad];
    let mut axes: Vec<Vec<f64>> = Vec::new();
    for part in parts {
        let axis = beside(moved.iter().map(|own| part(own)).collect(), &axes);
        axes.extend(axis);
    }
    axes
}

/// The part of an axis at right angles to others, of length one, if there is one.
fn beside(mut axis: Vec<f64>, others: &[Vec<f64>]) -> Option<Vec<f64>> {
    others.iter().for_each(|known| take_off(known, &mut axis));
    let length = square(&axis).sqrt();
    axis.iter_mut().for_each(|value| *value /= length);
    (length * length > LEAST).then_some(axis)
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

    const NOISE_M: f64 = 3e-3;

    /// Of variance one.
    fn random(seed: u32) -> f64 {
        let mixed = f64::from(seed).sin() * 43_758.547;
        12.0_f64.sqrt() * (mixed - mixed.floor() - 0.5)
    }

    /// What every look finds at a robot that goes along a wave at 0.1 m/s, its heading off by 0.1 rad, with steps to the left.
    fn found(step_m: f64, every_s: f64, noise_m: f64, rounded_m: f64) -> Vec<(f64, Option<f64>)> {
        let (mut trail, mut jumps) = (Trail::default(), Jumps::default());
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
                found.push((stamp_s, jumps.look(&trail, NOISE_M)));
            }
        }
        found
    }

    #[test]
    fn a_step_across_the_heading_is_found_with_its_size_within_a_second() {
        for step_m in [0.04, -0.04, 0.025, 0.1] {
            for noise_m in [0.0, 2e-3] {
                let found = found(step_m, 4.0, noise_m, 0.0);
                let first = found.iter().position(|(_, jump)| jump.is_some());
                // It is known better a little later.
                let looks =
                    first.and_then(|first| Some((found[first].0, found.get(first + 3)?.1?)));
                let (time_s, jump_m) = looks.unwrap_or((f64::INFINITY, 0.0));
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
    fn small_steps_add_up_to_one_that_is_found() {
        for (step_m, every_s) in [(0.01, 1.0), (-0.015, 1.5), (0.012, 3.0)] {
            let found = found(step_m, every_s, 1e-3, 0.0);
            let first = found.iter().find(|(_, jump)| jump.is_some());
            let time_s = first.map_or(f64::INFINITY, |(time_s, _)| *time_s);
            assert!(time_s < 5.0 + 3.5 * every_s, "{step_m} {every_s}: {time_s}");
        }
    }

    #[test]
    fn a_heading_that_jumps_is_no_step() {
        for (turn_rad, noise_m) in [(0.45, 0.0), (-0.3, 2e-3)] {
            let (mut trail, mut jumps) = (Trail::default(), Jumps::default());
            for i in 1..500_u32 {
                let stamp_s = 0.02 * f64::from(i);
                let off_rad = if stamp_s > 5.0 { turn_rad } else { 0.0 };
                let pose = Pose {
                    x_m: 0.2 * stamp_s + noise_m * random(2 * i),
                    y_m: noise_m * random(2 * i + 1),
                    heading_rad: off_rad,
                };
                trail.add(StampedPose { stamp_s, pose });
                assert_eq!(jumps.look(&trail, NOISE_M), None, "{turn_rad} {stamp_s}");
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
