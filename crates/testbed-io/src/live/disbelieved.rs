//! Robots of which poses say for long that they are where they cannot be: who is near such a place stands.

use unicycle_cbf::{Pose, Scenario, StampedPose};

use super::gate::distance_m;
use super::note::Note;

/// Poses that are not believed contradict where a robot is taken to be after this time, in s, and so many in a row.
const LONG_S: f64 = 0.5;
const IN_A_ROW: u32 = 5;
/// Whoever can be there within this time is near, in s.
const NEAR_S: f64 = 0.5;

/// Poses of a robot in a row that are not believed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Disbelieved {
    since_s: f64,
    newest: StampedPose,
    poses: u32,
    /// From where its commands led it, in m and rad
    off: Option<[f64; 2]>,
}

impl Disbelieved {
    /// One more.
    pub(super) fn after(before: Option<Self>, newest: StampedPose, off: Option<[f64; 2]>) -> Self {
        Self {
            since_s: before.map_or(newest.stamp_s, |before| before.since_s),
            newest,
            poses: before.map_or(1, |before| before.poses.saturating_add(1)),
            off,
        }
    }

    pub(super) fn newest(&self) -> StampedPose {
        self.newest
    }

    /// For how long, in s, if that is long.
    fn long_s(&self) -> Option<f64> {
        let lasted_s = self.newest.stamp_s - self.since_s;
        (lasted_s > LONG_S && self.poses >= IN_A_ROW).then_some(lasted_s)
    }
}

/// Those of all robots, at one step.
#[derive(Debug)]
pub(super) struct Contradictions {
    ids: Vec<u32>,
    near_m: f64,
    pub(super) now: Vec<Option<Disbelieved>>,
    /// Of which the user was told
    told: Vec<bool>,
}

impl Contradictions {
    pub(super) fn new(scenario: &Scenario, ids: &[u32]) -> Self {
        let controller = scenario.controller();
        let way_m = NEAR_S * controller.body().max_wheel_speed_mps;
        Self {
            ids: ids.to_vec(),
            near_m: controller.least_distance_m() + way_m,
            now: vec![None; ids.len()],
            told: vec![false; ids.len()],
        }
    }

    /// For how long poses of a robot have contradicted where it is taken to be, in s, if they do.
    pub(super) fn lasted_s(&self, robot: usize) -> Option<f64> {
        self.now[robot]?.long_s()
    }

    /// Whether a robot is near a place where another one may be.
    pub(super) fn is_near(&self, robot: usize, pose: &Pose) -> bool {
        let mut others = self.now.iter().enumerate();
        others.any(|(other, disbelieved)| {
            other != robot
                && disbelieved.is_some_and(|disbelieved| {
                    disbelieved.long_s().is_some()
                        && distance_m(&disbelieved.newest.pose, pose) < self.near_m
                })
        })
    }

    /// What the user should know, once of each robot.
    pub(super) fn note(&mut self, robot: usize) -> Option<Note> {
        let lasted_s = self.lasted_s(robot)?;
        if std::mem::replace(&mut self.told[robot], true) {
            return None;
        }
        let Disbelieved { newest, off, .. } = self.now[robot]?;
        Some(Note::Disbelieved {
            id: self.ids[robot],
            lasted_s,
            place_m: [newest.pose.x_m, newest.pose.y_m],
            off,
        })
    }
}

#[cfg(test)]
mod tests {
    use unicycle_cbf::{Preset, Testbed};

    use super::*;

    fn seen(stamp_s: f64, x_m: f64) -> StampedPose {
        let pose = Pose {
            x_m,
            y_m: 0.0,
            heading_rad: 0.0,
        };
        StampedPose { stamp_s, pose }
    }

    #[test]
    fn who_is_near_a_place_where_another_robot_may_be_is_known_after_half_a_second()
    -> Result<(), unicycle_cbf::Error> {
        let spec = Testbed::Khepera.scenario("straight", Preset::Hardened)?;
        let scenario = Scenario::new(spec)?;
        let mut all = Contradictions::new(&scenario, &[7, 8]);
        for step in 0..60 {
            let stamp_s = 10.0 + 0.02 * f64::from(step);
            all.now[1] = Some(Disbelieved::after(
                all.now[1],
                seen(stamp_s, 2.0),
                Some([0.4, 0.0]),
            ));
            let is_long = stamp_s > 10.51;
            assert_eq!(all.lasted_s(1).is_some(), is_long, "{stamp_s}");
            assert_eq!(all.is_near(0, &seen(stamp_s, 1.8).pose), is_long);
            assert!(!all.is_near(0, &seen(stamp_s, 1.5).pose));
            assert!(!all.is_near(1, &seen(stamp_s, 2.0).pose));
        }
        let note = all.note(1).map(|note| note.to_string());
        let note = note.unwrap_or_default();
        assert!(
            note.contains("robot 8: for 1.2 s")
                && note.contains("(2.00, 0.00) m")
                && note.contains(", 400 mm and 0° off"),
            "{note}"
        );
        assert!(all.note(1).is_none() && all.note(0).is_none());
        Ok(())
    }
}
