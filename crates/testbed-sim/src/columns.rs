//! The columns of a run log by name, and how each is read from a tick.

use crate::tick::Tick;

/// The speed that a live session lets a robot have at most, where it limits it.
pub const ALLOWED: (&str, Read) = ("allowed_speed_mps", |t| {
    t.watched.and_then(|w| w.allowed_mps).unwrap_or(f64::NAN)
});

/// For how long poses of a robot have contradicted where a live session took it to be.
pub const DISBELIEVED: (&str, Read) = ("disbelieved_s", |t| {
    t.watched.and_then(|w| w.disbelieved_s).unwrap_or(f64::NAN)
});

/// How far the point of interest of a robot was found to be from where a live session took it to be.
pub const MISPLACED: (&str, Read) = ("misplaced_m", |t| {
    t.watched.and_then(|w| w.misplaced_m).unwrap_or(f64::NAN)
});

/// How a column reads a tick; NaN where there is nothing.
pub type Read = fn(&Tick) -> f64;

/// What arrived; together with the settings it determines every decision.
pub const SEEN: [(&str, Read); 4] = [
    ("pose_stamp_s", |t| t.seen.map_or(f64::NAN, |s| s.stamp_s)),
    ("pose_x_m", |t| t.seen.map_or(f64::NAN, |s| s.pose.x_m)),
    ("pose_y_m", |t| t.seen.map_or(f64::NAN, |s| s.pose.y_m)),
    ("pose_heading_rad", |t| {
        t.seen.map_or(f64::NAN, |s| s.pose.heading_rad)
    }),
];

/// The least lane barrier of a decision as it stands in its row: with exponential rows in m/s, or else in the barrier's own units.
pub const LANE_ROW: &str = "lane_row";

/// What was decided, and from what.
pub const DECIDED: [(&str, Read); 26] = [
    ("x_m", |t| t.decision.state.map_or(f64::NAN, |s| s.x_m)),
    ("y_m", |t| t.decision.state.map_or(f64::NAN, |s| s.y_m)),
    ("speed_mps", |t| {
        t.decision.state.map_or(f64::NAN, |s| s.speed_mps)
    }),
    ("heading_rad", |t| {
        t.decision.state.map_or(f64::NAN, |s| s.heading_rad)
    }),
    ("turn_rate_rad_s", |t| {
        t.decision.state.map_or(f64::NAN, |s| s.turn_rate_rad_s)
    }),
    ("v1", |t| t.lyapunov(0)),
    ("v2", |t| t.lyapunov(1)),
    ("v3", |t| t.lyapunov(2)),
    ("h_headway_m", |t| t.headway_m()),
    (LANE_ROW, |t| t.lane()),
    ("deviation_m", |t| t.deviation_m()),
    ("force_n", |t| t.decision.input.force_n),
    ("torque_nm", |t| t.decision.input.torque_nm),
    ("slack_v1", |t| t.slack(0)),
    ("slack_v2", |t| t.slack(1)),
    ("slack_v3", |t| t.slack(2)),
    ("relaxed_by", |t| t.relaxed_by()),
    ("multiplier_1", |t| t.multiplier(0)),
    ("multiplier_2", |t| t.multiplier(1)),
    ("multiplier_3", |t| t.multiplier(2)),
    ("multiplier_4", |t| t.multiplier(3)),
    ("multiplier_5", |t| t.multiplier(4)),
    ("command_speed_mps", |t| t.decision.speeds.speed_mps),
    ("command_turn_rate_rad_s", |t| {
        t.decision.speeds.turn_rate_rad_s
    }),
    ("left_wheel_mps", |t| t.decision.wheels.left_mps),
    ("right_wheel_mps", |t| t.decision.wheels.right_mps),
];

/// What a simulation knows besides, and the time that the decision took.
pub const KNOWN: [(&str, Read); 12] = [
    ("true_x_m", |t| t.true_pose(0)),
    ("true_y_m", |t| t.true_pose(1)),
    ("true_heading_rad", |t| t.true_pose(2)),
    ("true_speed_mps", |t| {
        t.truth.map_or(f64::NAN, |t| t.state.speed_mps)
    }),
    ("true_turn_rate_rad_s", |t| {
        t.truth.map_or(f64::NAN, |t| t.state.turn_rate_rad_s)
    }),
    ("true_h_headway_m", |t| {
        t.truth.and_then(|t| t.safety.headway_m).unwrap_or(f64::NAN)
    }),
    ("true_h_lane", |t| {
        t.truth.map_or(f64::NAN, |t| t.safety.lane)
    }),
    ("true_deviation_m", |t| {
        t.truth.map_or(f64::NAN, |t| t.safety.deviation_m)
    }),
    ("innovation_position_m", |t| {
        t.watched.map_or(f64::NAN, |w| w.innovation_position_m)
    }),
    ("innovation_heading_rad", |t| {
        t.watched.map_or(f64::NAN, |w| w.innovation_heading_rad)
    }),
    ("step_us", |t| t.step_us),
    ("late_us", |t| t.late_us),
];
