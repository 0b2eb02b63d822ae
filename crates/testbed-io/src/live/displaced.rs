//! Poses that are elsewhere at once, where nothing on wheels goes: along the heading, across it, or turned.
//!
//! A line through five poses before a moment and one through five after it, each with a speed of its own, are continued to that moment.
//! Where they miss each other by more than noise does, there was a jump. Jumps add up, whether poses are believed or not, and those to
//! and fro cancel: what is left stays until poses jump back.

use std::collections::VecDeque;

use unicycle_cbf::StampedPose;

use super::gate::wrapped;

/// Poses on either side of a jump.
const BESIDE: usize = 5;
/// Poses nearer to the last in time are left out, in s.
const APART_S: f64 = 0.015;
/// Poses farther apart in time do not say whether it jumped in between, in s.
pub(super) const GAP_S: f64 = 0.3;
/// After a longer time nobody knows what a robot did that may not have heard that it shall stand, in s.
const LONGEST_GAP_S: f64 = 1.0;
/// How many times the scatter of poses about their lines is a jump, with what noise makes of a line that is continued.
const CERTAIN: f64 = 7.5;
/// Times between two poses that are longer than so many usual ones may be those of a tracker that hangs, and then catches up.
const HANGS: f64 = 3.0;
/// Smaller jumps of headings look like wheels that change their speed, in rad.
pub(super) const LEAST_TURN_RAD: f64 = 0.15;
/// Share by which newer poses count for their scatter.
const NEWER: f64 = 0.02;
/// Freedoms of the lines of one coordinate.
const FREEDOMS: f64 = 2.0 * (BESIDE as f64 - 2.0);

/// What poses and robots are taken to do at most.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steady {
    pub(super) noise_m: f64,
    pub(super) noise_rad: f64,
    pub(super) speed_mps: f64,
    pub(super) turn_rate_rad_s: f64,
}

/// A way that was not driven.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Off {
    /// In the plane of the poses, in m
    pub(super) place_m: [f64; 2],
    /// In rad
    pub(super) heading_rad: f64,
}

/// A time without poses, between two of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gap {
    pub(super) from: StampedPose,
    pub(super) to: StampedPose,
}

/// The jumps of one robot.
#[derive(Debug, Clone, Default)]
pub(super) struct Displaced {
    recent: VecDeque<StampedPose>,
    off: Off,
    /// Since when it is off, in s
    since_s: Option<f64>,
    /// The last pose before it was
    before: Option<StampedPose>,
    /// Poses before this are counted, in s
    counted_s: f64,
    gap: Option<Gap>,
    /// Of places and headings about their lines, squared, averaged
    scatter: [f64; 2],
}

impl Displaced {
    /// Any pose, believed or not, in the order of stamps.
    pub(super) fn add(&mut self, seen: StampedPose, steady: &Steady) {
        if let Some(last) = self.recent.back().copied() {
            let since_s = seen.stamp_s - last.stamp_s;
            if since_s < APART_S {
                return;
            }
            if since_s > GAP_S {
                self.recent.clear();
                let gap = Gap {
                    from: last,
                    to: seen,
                };
                self.gap = (since_s <= LONGEST_GAP_S).then_some(gap);
            }
        }
        self.recent.push_back(seen);
        if self.recent.len() > 2 * BESIDE {
            self.recent.pop_front();
        }
        if let Some(jump) = self.jump(steady) {
            self.counted_s = self.recent[BESIDE].stamp_s;
            let place = Gap {
                from: self.recent[BESIDE - 1],
                to: self.recent[BESIDE],
            };
            self.count(jump, &place, steady);
        }
    }

    /// A jump between two poses.
    pub(super) fn count(&mut self, jump: Off, place: &Gap, steady: &Steady) {
        let Off {
            place_m: [x_m, y_m],
            heading_rad,
        } = self.off;
        self.off = Off {
            place_m: [x_m + jump.place_m[0], y_m + jump.place_m[1]],
            heading_rad: wrapped(heading_rad + jump.heading_rad),
        };
        let is_off = self.off.way_m() > CERTAIN * steady.noise_m
            || self.off.heading_rad.abs() > LEAST_TURN_RAD;
        if self.since_s.is_none() {
            self.before = Some(place.from);
        }
        self.since_s = is_off.then_some(self.since_s.unwrap_or(place.to.stamp_s));
    }

    /// The last pose before it was off.
    pub(super) fn before(&self) -> Option<StampedPose> {
        self.before.filter(|_| self.since_s.is_some())
    }

    /// From a time on, in s, it is where it was led from there.
    pub(super) fn is_back(&mut self, from_s: f64) {
        self.counted_s = from_s;
        self.off = Off::default();
        self.since_s = None;
    }

    /// How far it is off, and since when, in s, if it is.
    pub(super) fn off(&self) -> Option<(Off, f64)> {
        Some((self.off, self.since_s?))
    }

    pub(super) fn newest(&self) -> Option<&StampedPose> {
        self.recent.back()
    }

    /// The last time without poses that nobody looked at, as soon as poses after it show how the robot moves, in m/s.
    pub(super) fn gap(&mut self) -> Option<(Gap, f64)> {
        let after = || self.recent.iter().take(BESIDE);
        if self.recent.len() < BESIDE {
            return None;
        }
        let gap = self.gap.take()?;
        let slope =
            |of: fn(&StampedPose) -> f64| Fitted::through(&after(), of, gap.to.stamp_s).slope;
        Some((
            gap,
            slope(|own| own.pose.x_m).hypot(slope(|own| own.pose.y_m)),
        ))
    }

    /// Whether poses came as of a tracker that hangs, but for the time in the middle of them.
    fn hangs(&self) -> bool {
        let next = self.recent.iter().skip(1);
        let times_s = self.recent.iter().zip(next).enumerate();
        let times_s = times_s.filter(|(at, _)| *at != BESIDE - 1);
        let times_s = times_s.map(|(_, (from, to))| to.stamp_s - from.stamp_s);
        let (least_s, most_s) = times_s.fold((f64::INFINITY, 0.0), |(least, most), time_s| {
            (time_s.min(least), time_s.max(most))
        });
        most_s > HANGS * least_s.max(APART_S)
    }

    /// That in the middle of the last poses, if there is one.
    fn jump(&mut self, steady: &Steady) -> Option<Off> {
        let is_new = self.recent.len() == 2 * BESIDE && self.recent[0].stamp_s >= self.counted_s;
        if !is_new || self.hangs() {
            return None;
        }
        let between_s = self.recent[BESIDE].stamp_s - self.recent[BESIDE - 1].stamp_s;
        let at_s = self.recent[BESIDE].stamp_s - 0.5 * between_s;
        let first_rad = self.recent[0].pose.heading_rad;
        let missed = |of: &dyn Fn(&StampedPose) -> f64| {
            let before = Fitted::through(&self.recent.iter().take(BESIDE), of, at_s);
            let after = Fitted::through(&self.recent.iter().skip(BESIDE), of, at_s);
            (after.value - before.value, before.rest + after.rest)
        };
        let (x_m, x_rest) = missed(&|own| own.pose.x_m);
        let (y_m, y_rest) = missed(&|own| own.pose.y_m);
        let (turn_rad, turn_rest) = missed(&|own| wrapped(own.pose.heading_rad - first_rad));
        let now = [(x_rest + y_rest) / (2.0 * FREEDOMS), turn_rest / FREEDOMS];
        let [scatter_m, scatter_rad] = [0, 1].map(|part| now[part].max(self.scatter[part]).sqrt());
        let least_m = CERTAIN * scatter_m.max(steady.noise_m) + 0.5 * steady.speed_mps * between_s;
        let least_rad =
            CERTAIN * scatter_rad.max(steady.noise_rad) + 0.5 * steady.turn_rate_rad_s * between_s;
        let jump = Off {
            place_m: if x_m.hypot(y_m) > least_m {
                [x_m, y_m]
            } else {
                [0.0; 2]
            },
            heading_rad: if turn_rad.abs() > least_rad.max(LEAST_TURN_RAD) {
                turn_rad
            } else {
                0.0
            },
        };
        if jump != Off::default() {
            return Some(jump);
        }
        for (average, now) in self.scatter.iter_mut().zip(now) {
            *average += NEWER * (now - *average);
        }
        None
    }
}

impl Off {
    pub(super) fn way_m(&self) -> f64 {
        let [x_m, y_m] = self.place_m;
        x_m.hypot(y_m)
    }

    /// Ahead of and to the left of a heading, in m.
    pub(super) fn seen_along_m(&self, heading_rad: f64) -> [f64; 2] {
        let ([x_m, y_m], (sin, cos)) = (self.place_m, heading_rad.sin_cos());
        [x_m * cos + y_m * sin, y_m * cos - x_m * sin]
    }
}

/// A line through some poses, by time.
struct Fitted {
    /// At the time that was asked for
    value: f64,
    slope: f64,
    /// Squares of what it leaves
    rest: f64,
}

impl Fitted {
    fn through<'a>(
        poses: &(impl Iterator<Item = &'a StampedPose> + Clone),
        of: impl Fn(&StampedPose) -> f64,
        at_s: f64,
    ) -> Self {
        let count = poses.clone().count() as f64;
        let mean =
            |value: &dyn Fn(&StampedPose) -> f64| poses.clone().map(value).sum::<f64>() / count;
        let (time_s, middle) = (mean(&|own| own.stamp_s), mean(&of));
        let product = |a: &dyn Fn(&StampedPose) -> f64, b: &dyn Fn(&StampedPose) -> f64| {
            poses.clone().map(|own| a(own) * b(own)).sum::<f64>()
        };
        let (late, beside) = (
            |own: &StampedPose| own.stamp_s - time_s,
            |own: &StampedPose| of(own) - middle,
        );
        let xx = product(&late, &late).max(f64::MIN_POSITIVE);
        let xy = product(&late, &beside);
        Self {
            value: middle + xy / xx * (at_s - time_s),
            slope: xy / xx,
            rest: (product(&beside, &beside) - xy * xy / xx).max(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use unicycle_cbf::Pose;

    use super::*;

    const STEADY: Steady = Steady {
        noise_m: 3e-3,
        noise_rad: 0.0087,
        speed_mps: 0.35,
        turn_rate_rad_s: 2.5,
    };

    /// Of variance one.
    fn random(seed: u32) -> f64 {
        let mixed = f64::from(seed).sin() * 43_758.547;
        12.0_f64.sqrt() * (mixed - mixed.floor() - 0.5)
    }

    /// What is left after 12 s of starts, stops and bends, with jumps that are given by time.
    fn left(rate_hz: f64, noise_m: f64, jumps: &[(f64, [f64; 3])]) -> Displaced {
        let mut displaced = Displaced::default();
        let mut pose = Pose {
            x_m: 0.0,
            y_m: 0.0,
            heading_rad: 2.8,
        };
        for step in 1..(12.0 * rate_hz) as u32 {
            let stamp_s = f64::from(step) / rate_hz;
            let (speed_mps, turn_rate_rad_s) = match stamp_s % 4.0 {
                t if t < 1.0 => (0.0, 0.0),
                t if t < 2.0 => (0.3, 1.5),
                t if t < 3.0 => (0.2, -2.0),
                _ => (0.05, 2.0),
            };
            let heading_rad = pose.heading_rad;
            pose.x_m += speed_mps / rate_hz * heading_rad.cos();
            pose.y_m += speed_mps / rate_hz * heading_rad.sin();
            pose.heading_rad = wrapped(heading_rad + turn_rate_rad_s / rate_hz);
            let mut seen = pose;
            for (_, [dx_m, dy_m, turn_rad]) in jumps.iter().filter(|(at_s, _)| stamp_s > *at_s) {
                seen.x_m += dx_m;
                seen.y_m += dy_m;
                seen.heading_rad = wrapped(seen.heading_rad + turn_rad);
            }
            seen.x_m += noise_m * random(3 * step);
            seen.y_m += noise_m * random(3 * step + 1);
            seen.heading_rad += 2.9 * noise_m * random(3 * step + 2);
            displaced.add(
                StampedPose {
                    stamp_s,
                    pose: seen,
                },
                &STEADY,
            );
        }
        displaced
    }

    #[test]
    fn a_robot_that_starts_stops_and_turns_does_not_jump() {
        for rate_hz in [10.0, 30.0, 50.0, 120.0] {
            for noise_m in [0.0, 2e-3, 3e-3, 1e-2] {
                let displaced = left(rate_hz, noise_m, &[]);
                assert_eq!(displaced.off(), None, "{rate_hz} {noise_m}");
            }
        }
    }

    #[test]
    fn a_jump_stays_until_poses_jump_back() {
        for (rate_hz, noise_m) in [(50.0, 0.0), (50.0, 2e-3), (30.0, 1e-3)] {
            for jump in [[0.055_f64, 0.0, 0.0], [0.0, -0.08, 0.0], [0.3, 0.1, 0.0]] {
                let way_m = |off: Option<(Off, f64)>| off.map_or(0.0, |(off, _)| off.way_m());
                let size_m = jump[0].hypot(jump[1]);
                let once = way_m(left(rate_hz, noise_m, &[(7.3, jump)]).off());
                assert!(
                    (once - size_m).abs() < 0.02,
                    "{rate_hz} {noise_m} {jump:?}: {once}"
                );
                let again = way_m(left(rate_hz, noise_m, &[(5.4, jump), (7.3, jump)]).off());
                assert!((again - 2.0 * size_m).abs() < 0.03, "{jump:?}: {again}");
                let back = jump.map(|part| -part);
                let left = left(rate_hz, noise_m, &[(5.4, jump), (7.3, back)]);
                assert_eq!(left.off(), None, "{rate_hz} {noise_m} {jump:?}");
            }
        }
    }

    #[test]
    fn a_heading_that_jumps_is_off_by_its_size() {
        for turn_rad in [0.349, -0.349, 0.45, 3.1] {
            let (off, since_s) = left(50.0, 2e-3, &[(7.3, [0.0, 0.0, turn_rad])])
                .off()
                .unwrap_or_default();
            assert!(
                (off.heading_rad - turn_rad).abs() < 0.06,
                "{turn_rad}: {off:?}"
            );
            assert!((since_s - 7.3).abs() < 0.05, "{since_s}");
            assert!(off.way_m() < 1e-9, "{off:?}");
        }
    }
}
