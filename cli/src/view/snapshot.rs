//! What the page shows of one instant.

use std::collections::BTreeMap;

use serde::Serialize;

/// The robots, and how the loop that drives them keeps up, at one instant. What is not finite is not known.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Snapshot {
    pub(crate) time_s: f64,
    pub(crate) duration_s: f64,
    /// In the order of the lane: each follows the one before it.
    pub(crate) robots: Vec<RobotNow>,
    /// How late the last step of the loop began.
    pub(crate) late_us: f64,
    /// Steps that missed their deadline.
    pub(crate) missed: u64,
    /// Packets dropped by reason, those with a count.
    pub(crate) dropped: BTreeMap<&'static str, u64>,
}

/// One robot; the pose is that of its point of interest.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct RobotNow {
    pub(crate) id: u32,
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    pub(crate) heading_rad: f64,
    pub(crate) speed_mps: f64,
    pub(crate) turn_rate_rad_s: f64,
    /// By the newest measured place, as the two that follow; none without a robot ahead.
    pub(crate) h_headway_m: Option<f64>,
    /// What is left of the lane beside it; none before the first.
    pub(crate) lane_clearance_m: Option<f64>,
    pub(crate) deviation_m: Option<f64>,
    /// How its step ended: `optimal`, `relaxed…`, or `braking…` with the reason.
    pub(crate) outcome: String,
    pub(crate) pose_age_s: Option<f64>,
    /// From where half a second of commands would have led it to where it was measured.
    pub(crate) innovation_position_m: Option<f64>,
    pub(crate) innovation_heading_rad: Option<f64>,
}
