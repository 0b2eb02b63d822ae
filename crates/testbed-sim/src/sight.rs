//! For how long robots were not seen, and whether one can have left its lane or touched another meanwhile.

mod doubt;

pub use doubt::Doubt;

/// Poses of two robots that are farther apart than this in time are not compared, in s.
pub const BESIDE_S: f64 = 0.3;

/// For how long a robot has to be seen without a break, in s, before it is known to do as it is told: the shorter time over which poses
/// are compared with commands.
const COMPARED_S: f64 = 0.8;

/// A robot that is not seen may not have heard anything either, and go on as it was told over this time before, in s.
const GOES_ON_S: f64 = 0.2;

/// A robot that is seen again has heard its commands if it is no farther from where it was seen than they led it and this, in m.
const HEARD_M: f64 = 0.05;

/// A pose that is believed.
#[derive(Debug, Clone, Copy)]
pub struct Glimpse {
    /// When it was true, in s
    pub stamp_s: f64,
    /// Middle of the axle, in m
    pub place_m: [f64; 2],
    /// To the edge of the lane, in m
    pub clearance_m: f64,
}

/// What was seen of all robots over a session.
#[derive(Debug)]
pub struct Sights {
    /// Older poses are not acted on, in s
    most_age_s: f64,
    /// Between the middles of two axles, in m
    least_distance_m: f64,
    /// What a robot may drive that does not do as it is told, in m/s
    most_mps: f64,
    robots: Vec<Sight>,
    doubts: Vec<Doubt>,
    /// Of robots that are not seen, if they do not hear; forgotten where it is seen that they did
    unheard: Vec<(usize, Doubt)>,
}

/// What was seen of one.
#[derive(Debug, Clone, Copy, Default)]
struct Sight {
    /// Stamp of the newest pose that came in time to act on it, in s
    usable_s: f64,
    unseen_s: f64,
    longest_s: f64,
    /// Stamp of the pose since which it is seen without a break, in s
    steady_from_s: f64,
    /// The newest pose of all, with the way that the robot can have gone up to then, in m
    last: Option<(Glimpse, f64)>,
}

impl Sights {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(robots: usize, most_age_s: f64, least_distance_m: f64, most_mps: f64) -> Self {
        Self {
            most_age_s,
            least_distance_m,
            most_mps,
            robots: vec![Sight::default(); robots],
            doubts: Vec::new(),
            unheard: Vec::new(),
        }
    }

    /// A pose with this stamp is there at `now_s`.
    pub fn has(&mut self, robot: usize, stamp_s: f64, now_s: f64) {
        if now_s - stamp_s <= self.most_age_s {
            self.robots[robot].add_gap(stamp_s, self.most_age_s);
        }
    }

    /// Any pose that is believed, in the order of stamps; `way_m` gives how far a robot can have gone in all up to a time, in m.
    /// Before the start robots may be carried about.
    pub fn saw(&mut self, robot: usize, seen: Glimpse, way_m: impl Fn(usize, f64) -> f64 + Copy) {
        let started = seen.stamp_s >= 0.0;
        if started {
            self.check(robot, seen.stamp_s, way_m);
            self.check_before(robot, &seen);
            self.hears(robot, &seen, way_m);
        }
        let most_age_s = self.most_age_s;
        self.robots[robot].take(seen, way_m(robot, seen.stamp_s), most_age_s);
        if started {
            self.check(robot, seen.stamp_s, way_m);
        }
    }

    /// Robots are told to stand: from now on nobody acts on poses.
    pub fn stopped(&mut self, time_s: f64) {
        for sight in &mut self.robots {
            sight.add_gap(time_s, self.most_age_s);
            sight.usable_s = f64::INFINITY;
        }
    }

    /// The session is over; without a start, at no time.
    pub fn over(&mut self, time_s: f64, way_m: impl Fn(usize, f64) -> f64 + Copy) {
        for robot in 0..self.robots.len() {
            self.robots[robot].add_gap(time_s, self.most_age_s);
            self.check(robot, time_s, way_m);
            if self.robots[robot].last.is_none() {
                self.doubt(Doubt::NeverSeen(robot));
            }
        }
        for (_, doubt) in std::mem::take(&mut self.unheard) {
            self.doubt(doubt);
        }
    }

    /// A robot that is seen again: whether it heard meanwhile.
    fn hears(&mut self, robot: usize, seen: &Glimpse, way_m: impl Fn(usize, f64) -> f64) {
        let Some((from, before_m)) = self.robots[robot].last else {
            return;
        };
        let told_m = way_m(robot, seen.stamp_s) - before_m;
        let has_heard = distance_m(from.place_m, seen.place_m) <= told_m + HEARD_M;
        let (own, others) = std::mem::take(&mut self.unheard)
            .into_iter()
            .partition::<Vec<_>, _>(|(of, _)| *of == robot);
        self.unheard = others;
        for (_, doubt) in own.into_iter().filter(|_| !has_heard) {
            self.doubt(doubt);
        }
    }

    fn doubt_unheard(&mut self, robot: usize, doubt: Doubt) {
        if !self.unheard.contains(&(robot, doubt)) {
            self.unheard.push((robot, doubt));
        }
    }

    /// Takes note of a reason, once.
    pub fn doubt(&mut self, doubt: Doubt) {
        if !self.doubts.contains(&doubt) {
            self.doubts.push(doubt);
        }
    }

    /// Why it is not known whether the session was safe; nothing where it is.
    #[must_use]
    pub fn doubts(&self) -> &[Doubt] {
        &self.doubts
    }

    /// In all, of each robot, in s.
    #[must_use]
    pub fn unseen_s(&self) -> Vec<f64> {
        self.robots.iter().map(|sight| sight.unseen_s).collect()
    }

    /// At one time, of each robot, in s.
    #[must_use]
    pub fn longest_s(&self) -> Vec<f64> {
        self.robots.iter().map(|sight| sight.longest_s).collect()
    }

    /// Whether the ways that robots can have gone since they were seen lead a robot to the edge of its lane or to another one.
    fn check(&mut self, robot: usize, until_s: f64, way_m: impl Fn(usize, f64) -> f64 + Copy) {
        let Some(own) = self.reach(robot, until_s, way_m) else {
            return;
        };
        let is_unseen = until_s - own.from.stamp_s > self.most_age_s;
        if is_unseen && own.way_m > own.from.clearance_m.max(0.0) {
            self.doubt(if own.is_known {
                Doubt::Lane(robot)
            } else {
                Doubt::LaneAtWill(robot)
            });
        } else if is_unseen && own.unheard_m > own.from.clearance_m.max(0.0) {
            self.doubt_unheard(robot, Doubt::LaneUnheard(robot));
        }
        for other in (0..self.robots.len()).filter(|other| *other != robot) {
            let Some(theirs) = self.reach(other, until_s, way_m) else {
                continue;
            };
            let apart_m = distance_m(own.from.place_m, theirs.from.place_m) - self.least_distance_m;
            let is_unseen = until_s - own.from.stamp_s.min(theirs.from.stamp_s) > BESIDE_S;
            let pair = [robot.min(other), robot.max(other)];
            if is_unseen && apart_m < own.way_m + theirs.way_m {
                self.doubt(if own.is_known && theirs.is_known {
                    Doubt::Touch(pair)
                } else {
                    Doubt::TouchAtWill(pair)
                });
            } else if is_unseen && apart_m < own.unheard_m + theirs.unheard_m {
                let is_older = own.from.stamp_s <= theirs.from.stamp_s;
                let unseen = if is_older { robot } else { other };
                self.doubt_unheard(unseen, Doubt::TouchUnheard(pair));
            }
        }
    }

    /// The same of the time before a robot was seen for the first time, if that was long after the start.
    fn check_before(&mut self, robot: usize, first: &Glimpse) {
        if self.robots[robot].last.is_some() || first.stamp_s <= self.most_age_s {
            return;
        }
        let way_m = self.most_mps * first.stamp_s;
        if way_m > first.clearance_m.max(0.0) {
            self.doubt(Doubt::LaneAtWill(robot));
        }
        for other in (0..self.robots.len()).filter(|other| *other != robot) {
            let last = self.robots[other].last;
            let apart_m = last.map(|(from, _)| distance_m(first.place_m, from.place_m));
            if apart_m.is_some_and(|apart_m| apart_m - 2.0 * way_m < self.least_distance_m) {
                let pair = [robot.min(other), robot.max(other)];
                self.doubt(Doubt::TouchAtWill(pair));
            }
        }
    }

    /// How far a robot can have gone since it was seen last: as its commands say where it is known to do as it is told, else at the speed
    /// of its wheels.
    fn reach(
        &self,
        robot: usize,
        until_s: f64,
        way_m: impl Fn(usize, f64) -> f64,
    ) -> Option<Reach> {
        let sight = &self.robots[robot];
        let (from, before_m) = sight.last?;
        let is_seldom = until_s - from.stamp_s > self.most_age_s;
        let is_known = !is_seldom || from.stamp_s - sight.steady_from_s >= COMPARED_S;
        let unseen_s = until_s - from.stamp_s.max(0.0);
        let (way_m, unheard_m) = if is_known {
            let told_m = way_m(robot, until_s) - before_m;
            let lately_m = before_m - way_m(robot, from.stamp_s - GOES_ON_S);
            let unheard_m = if is_seldom {
                lately_m / GOES_ON_S * unseen_s
            } else {
                0.0
            };
            (told_m, told_m.max(unheard_m))
        } else {
            (self.most_mps * unseen_s, self.most_mps * unseen_s)
        };
        Some(Reach {
            from,
            way_m,
            unheard_m,
            is_known,
        })
    }
}

/// How far a robot can have gone from where it was seen.
struct Reach {
    from: Glimpse,
    way_m: f64,
    /// The same if it goes on as it did and hears nothing
    unheard_m: f64,
    /// It does as it is told, as far as anybody knows
    is_known: bool,
}

impl Sight {
    fn take(&mut self, seen: Glimpse, way_m: f64, most_age_s: f64) {
        let last_s = self.last.map(|(last, _)| last.stamp_s);
        if last_s.is_none_or(|last_s| seen.stamp_s - last_s > most_age_s) {
            self.steady_from_s = seen.stamp_s;
        }
        self.last = Some((seen, way_m));
    }

    fn add_gap(&mut self, until_s: f64, most_age_s: f64) {
        let gap_s = until_s - self.usable_s;
        self.usable_s = self.usable_s.max(until_s);
        if gap_s > most_age_s {
            self.unseen_s += gap_s;
            self.longest_s = self.longest_s.max(gap_s);
        }
    }
}

fn distance_m([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> f64 {
    (ax - bx).hypot(ay - by)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glimpse(stamp_s: f64, x_m: f64, clearance_m: f64) -> Glimpse {
        Glimpse {
            stamp_s,
            place_m: [x_m, 0.0],
            clearance_m,
        }
    }

    /// 0.1 m/s until 2 s, then it stands.
    fn way_m(_: usize, until_s: f64) -> f64 {
        0.1 * until_s.min(2.0)
    }

    /// Seen without a break for a second up to 0 s.
    fn steady(robot: usize, x_m: f64, clearance_m: f64, sights: &mut Sights) {
        for stamp_s in [-1.0, -0.8, -0.6, -0.4, -0.2, 0.0] {
            sights.saw(robot, glimpse(stamp_s, x_m, clearance_m), way_m);
        }
    }

    #[test]
    fn seconds_without_a_usable_pose_are_counted_whole() {
        let mut sights = Sights::new(1, 0.3, 0.1, 0.1);
        for stamp_s in [0.1, 0.3, 1.3, 1.5, 3.5, 3.6] {
            sights.has(0, stamp_s, stamp_s + 0.1);
            sights.has(0, stamp_s + 0.2, stamp_s + 0.6);
        }
        sights.over(4.0, way_m);
        assert!((sights.unseen_s()[0] - 3.4).abs() < 1e-9, "{sights:?}");
        assert!((sights.longest_s()[0] - 2.0).abs() < 1e-9);
        assert_eq!(sights.doubts(), [Doubt::NeverSeen(0)]);
    }

    #[test]
    fn it_is_enough_where_commands_do_not_lead_to_the_edge_meanwhile() {
        for (clearance_m, again_s, enough) in [
            (0.15, 1.4, true),
            (0.05, 1.4, false),
            (0.15, 9.0, false),
            (0.25, 9.0, true),
        ] {
            let mut sights = Sights::new(1, 0.3, 0.1, 0.1);
            steady(0, 0.0, clearance_m, &mut sights);
            sights.saw(0, glimpse(again_s, 0.0, clearance_m), way_m);
            assert_eq!(
                sights.doubts().is_empty(),
                enough,
                "{clearance_m} m, {again_s} s"
            );
        }
    }

    #[test]
    fn robots_that_can_have_touched_unseen_are_doubted() {
        // Each can have gone 0.1 m by then, or 0.2 m where neither is seen again, and 0.4 m if it hears nothing.
        for (apart_m, again, touch) in [
            (0.45, [true, true], false),
            (0.25, [true, true], true),
            (0.35, [true, false], true),
            (0.45, [false, false], true),
            (0.85, [false, false], true),
            (0.95, [false, false], false),
        ] {
            let mut sights = Sights::new(2, 0.3, 0.1, 0.1);
            let x_m = |robot: usize| apart_m * robot as f64;
            for robot in 0..2 {
                steady(robot, x_m(robot), 1.0, &mut sights);
            }
            for (robot, _) in again.into_iter().enumerate().filter(|(_, again)| *again) {
                sights.saw(robot, glimpse(1.0, x_m(robot), 1.0), way_m);
            }
            if again != [true, true] {
                sights.over(4.0, way_m);
            }
            // Whoever is seen once after a break is not known to do as it is told.
            let [Doubt::Touch([0, 1]) | Doubt::TouchAtWill([0, 1]) | Doubt::TouchUnheard([0, 1])] =
                sights.doubts()
            else {
                assert!(
                    !touch && sights.doubts().is_empty(),
                    "{apart_m} m, {again:?}"
                );
                continue;
            };
            assert!(touch, "{apart_m} m, {again:?}");
        }
    }

    /// It was told to stand at 2 s; at 9 s it can be 0.9 m farther if it did not hear.
    #[test]
    fn a_robot_that_is_seen_again_where_it_was_led_has_heard() {
        for (again_m, doubts) in [
            (Some(0.2), &[][..]),
            (Some(0.5), &[Doubt::LaneUnheard(0)][..]),
            (None, &[Doubt::LaneUnheard(0)][..]),
        ] {
            let mut sights = Sights::new(1, 0.3, 0.1, 0.1);
            steady(0, 0.0, 0.4, &mut sights);
            let told_m = |robot: usize, until_s: f64| way_m(robot, until_s.max(-1.0));
            if let Some(again_m) = again_m {
                sights.saw(0, glimpse(9.0, again_m, 0.4), told_m);
            }
            sights.over(9.0, told_m);
            assert_eq!(sights.doubts(), doubts, "{again_m:?}");
        }
    }

    /// Poses at 1 Hz: between two of them a robot that does not do as it is told goes 0.1 m, and two of them 0.2 m.
    #[test]
    fn commands_say_nothing_of_robots_that_are_seen_too_seldom_to_know_whether_they_obey() {
        for (clearance_m, apart_m, doubts) in [
            (0.12, 0.35, &[][..]),
            (
                0.09,
                0.35,
                &[Doubt::LaneAtWill(0), Doubt::LaneAtWill(1)][..],
            ),
            (0.12, 0.28, &[Doubt::TouchAtWill([0, 1])][..]),
        ] {
            let mut sights = Sights::new(2, 0.3, 0.1, 0.1);
            for second in -3..10 {
                for robot in 0..2 {
                    let x_m = apart_m * robot as f64;
                    let seen = glimpse(f64::from(second), x_m, clearance_m);
                    sights.saw(robot, seen, |_, _| 0.0);
                }
            }
            assert_eq!(sights.doubts(), doubts, "{clearance_m} m, {apart_m} m");
        }
    }

    /// 0.2 m each until the second is seen for the first time.
    #[test]
    fn a_robot_that_is_seen_late_can_have_been_elsewhere_before() {
        for (apart_m, doubts) in [(0.6, &[][..]), (0.45, &[Doubt::TouchAtWill([0, 1])][..])] {
            let mut sights = Sights::new(2, 0.3, 0.1, 0.1);
            for tenth in 0..30 {
                let stamp_s = 0.1 * f64::from(tenth);
                sights.saw(0, glimpse(stamp_s, 0.0, 0.3), |_, _| 0.0);
                if stamp_s > 1.95 {
                    sights.saw(1, glimpse(stamp_s, apart_m, 0.3), |_, _| 0.0);
                }
            }
            assert_eq!(sights.doubts(), doubts, "{apart_m} m");
        }
    }

    #[test]
    fn robots_that_stand_and_are_carried_before_the_start_are_not_doubted() {
        let mut sights = Sights::new(2, 0.3, 0.1, 0.1);
        sights.saw(0, glimpse(-5.0, 0.0, 0.1), |_, _| 0.0);
        sights.saw(1, glimpse(-5.0, 0.05, 0.1), |_, _| 0.0);
        for stamp_s in [-1.0, -0.8, -0.6, -0.4, -0.2, -0.1] {
            sights.saw(0, glimpse(stamp_s, 0.0, 0.1), |_, _| 0.0);
            sights.saw(1, glimpse(stamp_s, 0.11, 0.1), |_, _| 0.0);
        }
        sights.over(60.0, |_, _| 0.0);
        assert!(sights.doubts().is_empty());
    }
}
