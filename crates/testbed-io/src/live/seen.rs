use unicycle_cbf::Pose;

/// A pose as a source gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// How the tracker calls the robot
    pub id: u32,
    /// Where
    pub pose: Pose,
    /// When, on the tracker's own clock in s, if it says so
    pub stamp_s: Option<f64>,
    /// How old the pose was when the stamp was made or, without a stamp, when it was sent, in s, as far as is known
    pub age_s: f64,
}
