//! How a robot moved, by its poses: along its heading, across it, and round.

use std::collections::VecDeque;

use unicycle_cbf::StampedPose;

use super::gate::wrapped;

/// For how long it is remembered, in s.
pub(super) const KEPT_S: f64 = 2.0;
/// Poses nearer to the last in time add little, in s.
const APART_S: f64 = 0.035;
/// Poses farther from each other in time do not say what was between them, in s.
const GAP_S: f64 = 0.35;

/// Sums of what was measured up to a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moved {
    pub(super) seen: StampedPose,
    /// Forward less backward, in m
    pub(super) along_m: f64,
    /// To the left of the heading, in m
    pub(super) across_m: f64,
    /// Counter-clockwise less clockwise, in rad
    pub(super) turned_rad: f64,
}

/// The last poses of a robot, without a gap.
#[derive(Debug, Clone, Default)]
pub(super) struct Trail(VecDeque<Moved>);

impl Trail {
    /// Takes a pose in; stamps do not decrease.
    pub(super) fn add(&mut self, seen: StampedPose) {
        let Some(last) = self.0.back().copied() else {
            self.0.push_back(Moved::start(seen));
            return;
        };
        let since_s = seen.stamp_s - last.seen.stamp_s;
        if since_s < APART_S {
            return;
        }
        if since_s > GAP_S {
            self.0.clear();
            self.0.push_back(Moved::start(seen));
            return;
        }
        self.0.push_back(last.then(seen));
        let forgotten_s = seen.stamp_s - KEPT_S;
        while self.0.front().is_some_and(|m| m.seen.stamp_s < forgotten_s) {
            self.0.pop_front();
        }
    }

    /// Poses of the last so many seconds.
    pub(super) fn last(&self, window_s: f64) -> impl Iterator<Item = &Moved> + Clone {
        let newest_s = self.0.back().map_or(0.0, |moved| moved.seen.stamp_s);
        let within = move |moved: &&Moved| moved.seen.stamp_s >= newest_s - window_s;
        let from = self.0.partition_point(|moved| !within(&moved));
        self.0.range(from..)
    }

    pub(super) fn newest(&self) -> Option<&Moved> {
        self.0.back()
    }
}

impl Moved {
    fn start(seen: StampedPose) -> Self {
        Self {
            seen,
            along_m: 0.0,
            across_m: 0.0,
            turned_rad: 0.0,
        }
    }

    /// The way between two poses counts along the heading in the middle of the turn.
    fn then(&self, seen: StampedPose) -> Self {
        let (from, to) = (&self.seen.pose, &seen.pose);
        let turn_rad = wrapped(to.heading_rad - from.heading_rad);
        let (sin, cos) = (from.heading_rad + 0.5 * turn_rad).sin_cos();
        let (dx, dy) = (to.x_m - from.x_m, to.y_m - from.y_m);
        Self {
            seen,
            along_m: self.along_m + dx * cos + dy * sin,
            across_m: self.across_m + dy * cos - dx * sin,
            turned_rad: self.turned_rad + turn_rad,
        }
    }
}
