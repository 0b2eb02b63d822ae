//! Does measured motion follow what was told, within what was stated?
//!
//! Over a window each wheel's measured way is a line over its told way some time before, and the way across the heading one over the
//! way along it. The slopes are the wheels' gains and the direction of motion. What is compared is how well the poses are explained
//! by any lag and any slopes, and how well by those within what was stated: where the second is worse by much more than noise makes
//! of it, no robot that is as stated moves like this.

mod candidate;

use super::commanded::Commanded;
use super::line::Line;
use super::moved::Trail;
use candidate::Candidate;

/// Lags that are tried, in s: stated latencies may be too large by the first.
const FROM_S: f64 = -0.3;
const STEP_S: f64 = 0.05;
const STEPS: u32 = 31;
/// How many standard deviations of noise make a difference certain.
const CERTAIN: f64 = 6.0;
/// What poses scatter at least, in m, by rounding and steps of time.
const LEAST_SCATTER_M: f64 = 5e-4;
/// Fewer poses say nothing.
const FEWEST: usize = 7;
/// What poses and wheels may be off by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stated {
    pub(super) noise_m: f64,
    pub(super) noise_rad: f64,
    /// Of each wheel, as a share
    pub(super) wheel_error: f64,
    pub(super) wheel_base_m: f64,
    /// Between heading and direction of motion, in rad
    pub(super) course_rad: f64,
    /// Latency beyond what is stated, in s
    pub(super) lag_s: f64,
}

/// How a robot moves that is not as stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Differs {
    /// Later than told by this, in s
    Lag(f64),
    /// Not where it heads: by this angle to the left, in rad
    Course(f64),
    /// Its left and right wheel by these shares of what they are told
    Wheels([f64; 2]),
    /// At once to the left of where it was, by this in m
    Jump(f64),
}

/// Between heading and direction of motion, in rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CourseAngle {
    /// To the left
    pub(super) angle_rad: f64,
    /// What noise makes of it
    pub(super) sigma_rad: f64,
}

/// What explains the poses best.
#[derive(Debug, Clone, Copy)]
struct Best<'a> {
    /// With any lag and any wheels
    free_m2: f64,
    /// Worse than that by what noise does not make of it
    certain_m2: f64,
    /// With any lag, and wheels as stated
    late: &'a Candidate,
    /// With any wheels, and a lag as stated
    in_time: &'a Candidate,
    /// With both as stated
    as_stated_m2: f64,
}

/// What a window shows.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    stated: Stated,
    course: Line,
    candidates: Vec<Candidate>,
    count: usize,
}

impl Fit {
    /// Over the last so many seconds; none of too few poses.
    pub(super) fn new(
        trail: &Trail,
        window_s: f64,
        told: &Commanded,
        stated: Stated,
    ) -> Option<Self> {
        let moved = trail.last(window_s);
        let count = moved.clone().count();
        let course = Line::through(moved.clone().map(|own| (own.along_m, own.across_m)));
        let lags_s = (0..STEPS).map(|step| FROM_S + STEP_S * f64::from(step));
        let candidate = |lag_s| Candidate::new(moved.clone(), told, &stated, lag_s);
        (count >= FEWEST).then(|| Self {
            stated,
            course,
            candidates: lags_s.map(candidate).collect(),
            count,
        })
    }

    /// What cannot be explained by anything within what was stated.
    pub(super) fn differs(&self) -> Option<Differs> {
        let most_rad = self.stated.course_rad;
        let slope = self.course.slope();
        let off = slope - slope.clamp(-most_rad.tan(), most_rad.tan());
        let noise_m2 = self.noise_m2(self.course.rest(slope), self.stated.noise_m.powi(2));
        if self.course.xx * off * off > CERTAIN * CERTAIN * noise_m2 {
            return Some(Differs::Course(slope.atan()));
        }
        let best = self.best(self.stated.lag_s)?;
        if best.as_stated_m2 - best.free_m2 <= best.certain_m2 {
            return None;
        }
        let late_m2 = best.late.bound - best.free_m2;
        Some(
            if late_m2 <= best.certain_m2 && best.late.bound <= best.in_time.free {
                Differs::Lag(best.late.lag_s)
            } else {
                Differs::Wheels(best.in_time.wheels.map(|line| line.slope()))
            },
        )
    }

    /// Where it moves, less where it heads; none of a robot that hardly moves.
    pub(super) fn course(&self) -> Option<CourseAngle> {
        let slope = self.course.slope();
        let noise_m2 = self.noise_m2(self.course.rest(slope), self.stated.noise_m.powi(2));
        (self.course.xx > noise_m2).then(|| CourseAngle {
            angle_rad: slope.atan(),
            sigma_rad: (noise_m2 / self.course.xx).sqrt(),
        })
    }

    /// The lag beyond `known_s` with which wheels as stated explain the poses, if no lesser one does with any wheels. Where poses
    /// scatter less than is stated, lesser lags are told apart.
    pub(super) fn lag_s(&self, known_s: f64) -> Option<f64> {
        let best = self.best(known_s)?;
        let is_late = best.late.bound - best.free_m2 <= best.certain_m2;
        let scatter_m2 = self.noise_m2(0.5 * best.free_m2, LEAST_SCATTER_M * LEAST_SCATTER_M);
        let is_in_time = best.in_time.free - best.free_m2 <= CERTAIN * CERTAIN * scatter_m2;
        (is_late && !is_in_time).then_some(best.late.lag_s)
    }

    /// Lags with which wheels as stated explain the poses about as well as with any other, from and to, in s. Where poses scatter less
    /// than is stated, they are told apart.
    pub(super) fn lags_s(&self) -> Option<[f64; 2]> {
        let best = least(self.candidates.iter(), |own| own.bound)?;
        let scatter_m2 = self.noise_m2(0.5 * best.bound, LEAST_SCATTER_M * LEAST_SCATTER_M);
        let most_m2 = best.bound + CERTAIN * CERTAIN * scatter_m2;
        let mut alike = self.candidates.iter().filter(|own| own.bound <= most_m2);
        let first_s = alike.next()?.lag_s;
        let last_s = alike.next_back().map_or(first_s, |own| own.lag_s);
        Some([first_s.max(0.0), last_s.max(0.0)])
    }

    /// The best of several kinds, with lags up to `lag_s` in time.
    fn best(&self, lag_s: f64) -> Option<Best<'_>> {
        let all = || self.candidates.iter();
        let in_time = || all().filter(|own| own.lag_s <= lag_s);
        let free = least(all(), |own| own.free)?;
        Some(Best {
            free_m2: free.free,
            certain_m2: CERTAIN * CERTAIN * self.wheels_noise_m2(free),
            late: least(all(), |own| own.bound)?,
            in_time: least(in_time(), |own| own.free)?,
            as_stated_m2: least(in_time(), |own| own.bound)?.bound,
        })
    }

    fn wheels_noise_m2(&self, free: &Candidate) -> f64 {
        let Stated {
            noise_m,
            noise_rad,
            wheel_base_m,
            ..
        } = self.stated;
        let own_m2 = noise_m.powi(2) + (0.5 * wheel_base_m * noise_rad).powi(2);
        self.noise_m2(0.5 * free.free, own_m2)
    }

    /// Noise as stated or, where poses scatter more, as measured.
    fn noise_m2(&self, rest_m2: f64, stated_m2: f64) -> f64 {
        stated_m2.max(rest_m2 / (self.count as f64 - 2.0))
    }
}

fn least<'a>(
    candidates: impl Iterator<Item = &'a Candidate>,
    of: fn(&Candidate) -> f64,
) -> Option<&'a Candidate> {
    candidates.min_by(|a, b| of(a).total_cmp(&of(b)))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic)]
mod tests {
    use unicycle_cbf::{Pose, Speeds, StampedPose};

    use super::*;

    const STATED: Stated = Stated {
        noise_m: 3e-3,
        noise_rad: 0.0087,
        wheel_error: 0.1,
        wheel_base_m: 0.09,
        course_rad: 0.2,
        lag_s: 0.4,
    };

    /// A robot that starts from rest and turns to and fro.
    struct Robot {
        gains: [f64; 2],
        yaw_rad: f64,
        lag_s: f64,
        noise_m: f64,
        rate_hz: f64,
    }

    impl Robot {
        const AS_STATED: Self = Self {
            gains: [0.95, 1.05],
            yaw_rad: 0.1,
            lag_s: 0.1,
            noise_m: 0.0,
            rate_hz: 50.0,
        };

        /// What every look over 12 s finds.
        fn found(&self) -> Vec<Option<Differs>> {
            let (mut told, mut really) = (Commanded::new(0.09), Commanded::new(0.09));
            for step in 0..600_u32 {
                let time_s = 0.02 * f64::from(step);
                let speeds = Speeds {
                    speed_mps: 0.2 * (1.0 - (-time_s).exp()),
                    turn_rate_rad_s: 0.6 * (1.7 * time_s).sin(),
                };
                told.sent(time_s, speeds);
                really.sent(time_s + self.lag_s, self.turned(speeds));
            }
            let mut trail = Trail::default();
            let mut found = Vec::new();
            let start = Pose {
                x_m: 0.0,
                y_m: 0.0,
                heading_rad: 0.5,
            };
            let mut seen = StampedPose {
                stamp_s: 0.0,
                pose: start,
            };
            for step in 1..(12.0 * self.rate_hz) as u32 {
                let stamp_s = f64::from(step) / self.rate_hz;
                let pose = really.carried(&seen, stamp_s);
                seen = StampedPose { stamp_s, pose };
                let noise = |salt: u32| self.noise_m * random(3 * step + salt);
                let pose = Pose {
                    x_m: pose.x_m + noise(0),
                    y_m: pose.y_m + noise(1),
                    heading_rad: pose.heading_rad + self.yaw_rad + 3.0 * noise(2),
                };
                trail.add(StampedPose { stamp_s, pose });
                let fit = Fit::new(&trail, 2.0, &told, STATED);
                found.extend(fit.map(|fit| fit.differs()));
            }
            found
        }

        fn turned(&self, told: Speeds) -> Speeds {
            let half_mps = 0.045 * told.turn_rate_rad_s;
            let [left, right] = self.gains;
            let (left, right) = (
                left * (told.speed_mps - half_mps),
                right * (told.speed_mps + half_mps),
            );
            Speeds {
                speed_mps: 0.5 * (left + right),
                turn_rate_rad_s: (right - left) / 0.09,
            }
        }
    }

    /// Of variance one.
    fn random(seed: u32) -> f64 {
        let mixed = f64::from(seed).sin() * 43_758.547;
        12.0_f64.sqrt() * (mixed - mixed.floor() - 0.5)
    }

    #[test]
    fn robots_as_stated_are_not_found_to_differ() {
        for (lag_s, noise_m, rate_hz) in [
            (0.0, 0.0, 50.0),
            (0.3, 1e-3, 50.0),
            (0.1, 1e-2, 50.0),
            (0.0, 3e-3, 10.0),
        ] {
            let robot = Robot {
                lag_s,
                noise_m,
                rate_hz,
                ..Robot::AS_STATED
            };
            let found = robot.found();
            assert!(found.len() > 100);
            let differs: Vec<&Differs> = found.iter().flatten().collect();
            assert!(differs.is_empty(), "{lag_s} {noise_m} {differs:?}");
        }
    }

    #[test]
    fn a_lag_is_found_with_its_size() {
        let robot = Robot {
            lag_s: 0.6,
            noise_m: 1e-3,
            ..Robot::AS_STATED
        };
        let found = robot.found();
        let last = found.iter().flatten().last().unwrap();
        let Differs::Lag(lag_s) = *last else {
            panic!("{last:?}")
        };
        assert!((lag_s - 0.6).abs() < 0.06, "{lag_s}");
    }

    #[test]
    fn wheels_are_found_with_their_gains() {
        for gains in [[1.0, 0.8], [0.4, 0.4], [0.0, 0.0], [0.85, 1.15]] {
            let robot = Robot {
                gains,
                noise_m: 1e-3,
                ..Robot::AS_STATED
            };
            let found = robot.found();
            let last = found.iter().flatten().last().unwrap();
            let Differs::Wheels(measured) = *last else {
                panic!("{last:?}")
            };
            let off = measured.iter().zip(gains).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 0.06, "{gains:?} {measured:?}");
        }
    }

    #[test]
    fn a_heading_that_is_off_is_found_with_its_angle() {
        let robot = Robot {
            yaw_rad: -0.35,
            noise_m: 1e-3,
            ..Robot::AS_STATED
        };
        let found = robot.found();
        let last = found.iter().flatten().last().unwrap();
        let Differs::Course(course_rad) = *last else {
            panic!("{last:?}")
        };
        assert!((course_rad - 0.35).abs() < 0.03, "{course_rad}");
    }
}
