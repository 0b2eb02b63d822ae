//! What the page shows of one instant.

use std::collections::BTreeMap;

use serde::Serialize;

/// The robots, and how the loop that drives them keeps up, at one instant. What is not finite is not known.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Snapshot {
    /// In s from the start.
    pub time_s: f64,
    /// Length of the run, in s.
    pub duration_s: f64,
    /// In the order of the lane: each follows the one before it.
    pub robots: Vec<RobotNow>,
    /// How late the last step of the loop began.
    pub late_us: f64,
    /// Steps that missed their deadline.
    pub missed: u64,
    /// Packets dropped by reason, those with a count.
    pub dropped: BTreeMap<&'static str, u64>,
}

/// One robot; the pose is that of its point of interest.
#[derive(Clone, Debug, Default, Serialize)]
pub struct RobotNow {
    /// As the tracker calls it.
    pub id: u32,
    /// In m.
    pub x_m: f64,
    /// In m.
    pub y_m: f64,
    /// In rad.
    pub heading_rad: f64,
    /// As commanded, in m/s.
    pub speed_mps: f64,
    /// As commanded, in rad/s.
    pub turn_rate_rad_s: f64,
    /// By the newest measured place, as the two that follow; none without a robot ahead.
    pub h_headway_m: Option<f64>,
    /// What is left of the lane beside it; none before the first.
    pub lane_clearance_m: Option<f64>,
    /// From the path, in m.
    pub deviation_m: Option<f64>,
    /// How its step ended: `optimal`, `relaxed…`, or `braking…` with the reason.
    pub outcome: String,
    /// Of its newest pose, in s.
    pub pose_age_s: Option<f64>,
    /// From where half a second of commands would have led it to where it was measured.
    pub innovation_position_m: Option<f64>,
    /// The same of its heading, in rad.
    pub innovation_heading_rad: Option<f64>,
}
