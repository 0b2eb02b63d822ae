//! What a robot was told over time, and how far that leads.

use std::collections::VecDeque;

use unicycle_cbf::{Pose, Speeds, StampedPose};

/// Commands that are remembered: a minute and more of one that changes at every step. One that stays is one.
const MOST_LEGS: usize = 4096;

/// Sums over all that a robot was told up to a time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Way {
    /// Forward less backward, in m
    pub along_m: f64,
    /// Counter-clockwise less clockwise, in rad
    pub turn_rad: f64,
    /// Of the axle, forward and backward, in m
    pub path_m: f64,
    /// Of the left and of the right wheel, forward and backward, in m
    pub wheels_m: [f64; 2],
    /// Either way, in rad
    pub turned_rad: f64,
    /// For how long it was told to move, in s
    pub moving_s: f64,
}

/// The commands of one robot, held until the next.
#[derive(Debug, Clone)]
pub struct Commanded {
    wheel_base_m: f64,
    legs: VecDeque<Leg>,
}

#[derive(Debug, Clone, Copy)]
struct Leg {
    from_s: f64,
    speeds: Speeds,
    /// Up to its beginning
    before: Way,
}

impl Way {
    /// What came since.
    #[must_use]
    pub fn since(self, earlier: Self) -> Self {
        let [left_m, right_m] = self.wheels_m;
        let [left_before_m, right_before_m] = earlier.wheels_m;
        Self {
            along_m: self.along_m - earlier.along_m,
            turn_rad: self.turn_rad - earlier.turn_rad,
            path_m: self.path_m - earlier.path_m,
            wheels_m: [left_m - left_before_m, right_m - right_before_m],
            turned_rad: self.turned_rad - earlier.turned_rad,
            moving_s: self.moving_s - earlier.moving_s,
        }
    }
}

impl Commanded {
    /// No command yet; `wheel_base_m` is the distance between the wheels.
    #[must_use]
    pub fn new(wheel_base_m: f64) -> Self {
        Self {
            wheel_base_m,
            legs: VecDeque::new(),
        }
    }

    /// From `time_s` on; times do not decrease.
    pub fn sent(&mut self, time_s: f64, speeds: Speeds) {
        if self.legs.back().is_some_and(|leg| leg.speeds == speeds) {
            return;
        }
        let before = self.until(time_s);
        self.legs.push_back(Leg {
            from_s: time_s,
            speeds,
            before,
        });
        if self.legs.len() > MOST_LEGS {
            self.legs.pop_front();
        }
    }

    /// Whether nobody tells the robot anything.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.legs.is_empty()
    }

    /// What it was told last.
    #[must_use]
    pub fn speeds(&self) -> Speeds {
        self.legs.back().map_or(Speeds::ZERO, |leg| leg.speeds)
    }

    /// What it was told at a time.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Speeds {
        let begun = self.legs.partition_point(|leg| leg.from_s <= time_s);
        let leg = begun.checked_sub(1).and_then(|index| self.legs.get(index));
        leg.map_or(Speeds::ZERO, |leg| leg.speeds)
    }

    /// All up to a time; before the oldest command that is remembered, all up to that.
    #[must_use]
    pub fn until(&self, time_s: f64) -> Way {
        let begun = self.legs.partition_point(|leg| leg.from_s <= time_s);
        match begun.checked_sub(1).and_then(|index| self.legs.get(index)) {
            Some(leg) => self.after(leg, time_s - leg.from_s),
            None => self.legs.front().map_or(Way::default(), |leg| leg.before),
        }
    }

    /// What came between two times.
    #[must_use]
    pub fn between(&self, from_s: f64, to_s: f64) -> Way {
        self.until(to_s).since(self.until(from_s))
    }

    /// Where the robot is at a time if it was at a pose before and does as it is told.
    #[must_use]
    pub fn carried(&self, from: &StampedPose, to_s: f64) -> Pose {
        let next = self.legs.partition_point(|leg| leg.from_s <= from.stamp_s);
        let legs = self.legs.iter().skip(next.saturating_sub(1));
        let ends_s = legs.clone().skip(1).map(|leg| leg.from_s);
        let (mut pose, mut time_s) = (from.pose, from.stamp_s);
        for (leg, end_s) in legs.zip(ends_s.chain([f64::INFINITY])) {
            let until_s = end_s.min(to_s);
            if until_s > time_s.max(leg.from_s) {
                pose = pose.advanced(leg.speeds, until_s - time_s.max(leg.from_s));
                time_s = until_s;
            }
        }
        pose
    }

    fn after(&self, leg: &Leg, duration_s: f64) -> Way {
        let (before, speeds) = (leg.before, leg.speeds);
        let along_m = speeds.speed_mps * duration_s;
        let turn_rad = speeds.turn_rate_rad_s * duration_s;
        let half_m = 0.5 * self.wheel_base_m * turn_rad;
        let [left_m, right_m] = before.wheels_m;
        let moving_s = if speeds == Speeds::ZERO {
            0.0
        } else {
            duration_s
        };
        Way {
            along_m: before.along_m + along_m,
            turn_rad: before.turn_rad + turn_rad,
            path_m: before.path_m + along_m.abs(),
            wheels_m: [
                left_m + (along_m - half_m).abs(),
                right_m + (along_m + half_m).abs(),
            ],
            turned_rad: before.turned_rad + turn_rad.abs(),
            moving_s: before.moving_s + moving_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_hold_until_the_next() {
        let mut told = Commanded::new(0.1);
        let speeds = |speed_mps, turn_rate_rad_s| Speeds {
            speed_mps,
            turn_rate_rad_s,
        };
        assert_eq!(told.until(3.0), Way::default());
        told.sent(1.0, speeds(0.2, 0.5));
        told.sent(2.0, speeds(-0.1, 0.0));
        told.sent(4.0, Speeds::ZERO);
        let way = told.between(0.0, 9.0);
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(near(way.along_m, 0.0) && near(way.path_m, 0.4));
        assert!(near(way.turn_rad, 0.5) && near(way.moving_s, 3.0));
        assert!(near(told.between(1.5, 2.5).along_m, 0.05));
        let [left_m, right_m] = way.wheels_m;
        assert!(near(left_m, 0.375) && near(right_m, 0.425));
    }

    #[test]
    fn a_robot_is_carried_along_by_its_commands() {
        let mut told = Commanded::new(0.1);
        let speeds = |speed_mps| Speeds {
            speed_mps,
            turn_rate_rad_s: 0.0,
        };
        told.sent(1.0, speeds(0.2));
        told.sent(2.0, speeds(0.1));
        let pose = Pose {
            x_m: 0.0,
            y_m: 0.0,
            heading_rad: 0.0,
        };
        for (stamp_s, to_s, x_m) in [
            (0.0, 3.0, 0.3),
            (1.5, 3.0, 0.2),
            (2.5, 3.0, 0.05),
            (1.2, 1.7, 0.1),
        ] {
            let carried = told.carried(&StampedPose { stamp_s, pose }, to_s);
            assert!((carried.x_m - x_m).abs() < 1e-12, "{carried:?}");
        }
    }

    #[test]
    fn sums_go_on_when_old_commands_are_forgotten() {
        let mut told = Commanded::new(0.1);
        for step in 0..10_000 {
            let speeds = Speeds {
                speed_mps: 0.1,
                turn_rate_rad_s: 1e-3 * f64::from(step),
            };
            told.sent(0.02 * f64::from(step), speeds);
        }
        assert!((told.until(200.0).path_m - 20.0).abs() < 1e-9);
        assert_eq!(told.legs.len(), MOST_LEGS);
    }

    #[test]
    fn a_robot_that_stands_for_long_is_remembered_to_have_driven_before() {
        let mut told = Commanded::new(0.1);
        let speeds = |speed_mps| Speeds {
            speed_mps,
            turn_rate_rad_s: 0.0,
        };
        for step in 0..50_000 {
            let speed_mps = if step < 50 { 0.2 } else { 0.0 };
            told.sent(0.02 * f64::from(step), speeds(speed_mps));
        }
        assert!((told.between(0.5, 1000.0).path_m - 0.1).abs() < 1e-9);
        assert_eq!(told.at(0.9), speeds(0.2));
        assert_eq!(told.at(1.1), Speeds::ZERO);
    }
}
