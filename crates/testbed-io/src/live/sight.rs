//! For how long a robot was not seen, and whether it can have left its lane meanwhile.

use unicycle_cbf::StampedPose;

/// What was seen of one robot over a session.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight {
    /// Older poses are not acted on, in s
    most_age_s: f64,
    /// Stamp of the newest pose that came in time to act on it, in s
    usable_s: f64,
    unseen_s: f64,
    longest_s: f64,
    /// The newest pose of all, with its distance from the edge of the lane in m
    last: Option<(f64, f64)>,
    /// It may have been outside unseen
    lost: bool,
}

impl Sight {
    pub(super) fn new(most_age_s: f64) -> Self {
        Self {
            most_age_s,
            usable_s: 0.0,
            unseen_s: 0.0,
            longest_s: 0.0,
            last: None,
            lost: false,
        }
    }

    /// A pose that there is at `now_s`.
    pub(super) fn has(&mut self, seen: &StampedPose, now_s: f64) {
        if now_s - seen.stamp_s <= self.most_age_s {
            self.add_gap(seen.stamp_s);
        }
    }

    /// Any pose that is believed, in the order of stamps; `told_m` gives the way that the robot was told between two times, in m.
    pub(super) fn saw(&mut self, stamp_s: f64, clearance_m: f64, told_m: impl Fn(f64, f64) -> f64) {
        self.check(stamp_s, told_m);
        self.last = Some((stamp_s, clearance_m));
    }

    /// The session is over; without a start, at no time.
    pub(super) fn over(&mut self, time_s: f64, told_m: impl Fn(f64, f64) -> f64) {
        self.add_gap(time_s);
        self.check(time_s, told_m);
    }

    /// In all, in s.
    pub(super) fn unseen_s(&self) -> f64 {
        self.unseen_s
    }

    /// At one time, in s.
    pub(super) fn longest_s(&self) -> f64 {
        self.longest_s
    }

    /// Whether it cannot have left its lane unseen.
    pub(super) fn is_enough(&self) -> bool {
        self.last.is_some() && !self.lost
    }

    fn add_gap(&mut self, until_s: f64) {
        let gap_s = until_s - self.usable_s;
        self.usable_s = self.usable_s.max(until_s);
        if gap_s > self.most_age_s {
            self.unseen_s += gap_s;
            self.longest_s = self.longest_s.max(gap_s);
        }
    }

    fn check(&mut self, until_s: f64, told_m: impl Fn(f64, f64) -> f64) {
        let Some((last_s, clearance_m)) = self.last else {
            return;
        };
        if until_s - last_s > self.most_age_s && told_m(last_s, until_s) > clearance_m.max(0.0) {
            self.lost = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use unicycle_cbf::Pose;

    use super::*;

    fn seen(stamp_s: f64) -> StampedPose {
        let pose = Pose {
            x_m: 0.0,
            y_m: 0.0,
            heading_rad: 0.0,
        };
        StampedPose { stamp_s, pose }
    }

    /// 0.1 m/s until 2 s, then it stands.
    fn told_m(from_s: f64, to_s: f64) -> f64 {
        0.1 * (to_s.min(2.0) - from_s.min(2.0))
    }

    #[test]
    fn seconds_without_a_usable_pose_are_counted_whole() {
        let mut sight = Sight::new(0.3);
        for stamp_s in [0.1, 0.3, 1.3, 1.5, 3.5, 3.6] {
            sight.has(&seen(stamp_s), stamp_s + 0.1);
            sight.has(&seen(stamp_s + 0.2), stamp_s + 0.6);
        }
        sight.over(4.0, told_m);
        assert!((sight.unseen_s() - 3.4).abs() < 1e-9, "{sight:?}");
        assert!((sight.longest_s() - 2.0).abs() < 1e-9);
    }

    #[test]
    fn it_is_enough_where_commands_do_not_lead_to_the_edge_meanwhile() {
        for (clearance_m, again_s, enough) in [
            (0.15, 1.4, true),
            (0.05, 1.4, false),
            (0.15, 9.0, false),
            (0.25, 9.0, true),
        ] {
            let mut sight = Sight::new(0.3);
            sight.saw(0.0, clearance_m, told_m);
            sight.saw(again_s, clearance_m, told_m);
            assert_eq!(sight.is_enough(), enough, "{clearance_m} m, {again_s} s");
        }
        assert!(!Sight::new(0.3).is_enough());
    }
}
