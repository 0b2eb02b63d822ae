//! What the live view shows of the robots after a step.

use testbed_io::Tick;
use unicycle_cbf::Scenario;

use crate::view::RobotNow;

/// How far each robot is from the edge of the lane, by its newest pose.
pub(super) struct NewestPlaces {
    half_width_m: f64,
    clearance_m: Vec<Option<f64>>,
}

impl NewestPlaces {
    pub(super) fn new(scenario: &Scenario) -> Self {
        Self {
            half_width_m: scenario.spec().controller.lane.half_width_m,
            clearance_m: vec![None; scenario.spec().robots.len()],
        }
    }

    /// Robots from the front.
    pub(super) fn robots(
        &mut self,
        ticks: &[Tick],
        pose_ages_s: &[f64],
        ids: &[u32],
    ) -> Vec<RobotNow> {
        for tick in ticks {
            let measured_m = tick.lane_clearance_m(self.half_width_m);
            if let (Some(newest_m), Some(_)) = (self.clearance_m.get_mut(tick.robot), measured_m) {
                *newest_m = measured_m;
            }
        }
        let known = |value: f64| value.is_finite().then_some(value);
        let robot = |tick: &Tick| {
            let state = tick.known_state()?;
            Some(RobotNow {
                id: *ids.get(tick.robot)?,
                x_m: state.x_m,
                y_m: state.y_m,
                heading_rad: state.heading_rad,
                speed_mps: tick.decision.speeds.speed_mps,
                turn_rate_rad_s: tick.decision.speeds.turn_rate_rad_s,
                h_headway_m: known(tick.known_headway_m()),
                lane_clearance_m: self.clearance_m.get(tick.robot).copied().flatten(),
                deviation_m: known(tick.known_deviation_m()),
                outcome: tick.outcome_name(),
                pose_age_s: pose_ages_s.get(tick.robot).copied().and_then(known),
            })
        };
        ticks.iter().rev().filter_map(robot).collect()
    }
}
