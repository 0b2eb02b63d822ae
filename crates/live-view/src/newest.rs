//! What the live view shows of the robots after a step.

use testbed_sim::Tick;
use unicycle_cbf::{Safety, Scenario};

use crate::snapshot::RobotNow;

/// How it stood with each robot by its newest pose.
#[derive(Debug)]
pub struct NewestPlaces {
    half_width_m: f64,
    safety: Vec<Option<Safety>>,
}

impl NewestPlaces {
    /// Nobody seen yet.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        Self {
            half_width_m: scenario.spec().controller.lane.half_width_m,
            safety: vec![None; scenario.spec().robots.len()],
        }
    }

    /// Robots from the front. Distances are those measured, and not known before the first pose.
    pub fn robots(&mut self, ticks: &[Tick], pose_ages_s: &[f64], ids: &[u32]) -> Vec<RobotNow> {
        for tick in ticks {
            if let (Some(newest), Some(truth)) = (self.safety.get_mut(tick.robot), tick.truth) {
                *newest = Some(truth.safety);
            }
        }
        let finite = |value: f64| value.is_finite().then_some(value);
        let robot = |tick: &Tick| {
            let state = tick.known_state()?;
            let safety = *self.safety.get(tick.robot)?;
            let clearance = |safety: Safety| self.half_width_m - safety.deviation_m.abs();
            let pose_age_s = pose_ages_s.get(tick.robot).copied();
            Some(RobotNow {
                id: *ids.get(tick.robot)?,
                x_m: state.x_m,
                y_m: state.y_m,
                heading_rad: state.heading_rad,
                speed_mps: tick.decision.speeds.speed_mps,
                turn_rate_rad_s: tick.decision.speeds.turn_rate_rad_s,
                h_headway_m: safety.and_then(|safety| safety.headway_m),
                lane_clearance_m: safety.map(clearance),
                deviation_m: safety.map(|safety| safety.deviation_m),
                outcome: tick.outcome_name(),
                pose_age_s: pose_age_s.and_then(finite),
                innovation_position_m: tick.watched.and_then(|w| finite(w.innovation_position_m)),
                innovation_heading_rad: tick.watched.and_then(|w| finite(w.innovation_heading_rad)),
            })
        };
        ticks.iter().rev().filter_map(robot).collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use testbed_sim::{Disturbances, RunSpec};
    use unicycle_cbf::{Preset, ScenarioSpec, Testbed};

    use super::*;

    #[test]
    fn between_poses_distances_are_those_last_measured() {
        let spec = RunSpec {
            seed: 1,
            scenario: ScenarioSpec {
                duration_s: 1.0,
                ..Testbed::Khepera
                    .scenario("on-off", Preset::Hardened)
                    .unwrap()
            },
            disturbances: Disturbances::HARD,
        };
        let mut ticks = spec.simulate().unwrap().0.ticks;
        for tick in &mut ticks {
            tick.truth = tick.truth.filter(|_| tick.tick % 5 == 2);
        }
        let scenario = Scenario::new(spec.scenario).unwrap();
        let mut newest = NewestPlaces::new(&scenario);
        let mut measured = None;
        for step in ticks.chunk_by(|a, b| a.tick == b.tick) {
            let follower = step.iter().find(|tick| tick.robot == 1).unwrap();
            measured = follower.truth.or(measured);
            let shown = newest.robots(step, &[0.0, 0.0], &[7, 8]);
            let Some(shown) = shown.iter().find(|robot| robot.id == 8) else {
                continue;
            };
            let deviation_m = measured.map(|truth| truth.safety.deviation_m);
            assert_eq!(shown.deviation_m, deviation_m);
            assert_eq!(
                shown.h_headway_m,
                measured.and_then(|truth| truth.safety.headway_m)
            );
            let edge_m = deviation_m.map(|y_m| newest.half_width_m - y_m.abs());
            assert_eq!(shown.lane_clearance_m, edge_m);
        }
        assert!(measured.is_some());
    }
}
