//! What a recording holds.

use serde::Serialize;

/// The planar pose of a robot at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordedPose {
    /// In s from the start of the recording
    pub time_s: f64,
    /// In m
    pub x_m: f64,
    /// In m
    pub y_m: f64,
    /// In rad, from the x axis to the left, as recorded: not wrapped
    pub heading_rad: f64,
}

/// The poses of a robot, with times that increase.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedRobot {
    /// From the file's name, or from the column `robot`
    pub name: String,
    /// At least one
    pub poses: Vec<RecordedPose>,
    /// What is odd about them, at most one of each kind
    pub findings: Vec<Finding>,
}

/// The robots that were recorded together.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// The earliest time of any robot, in s of the recording's clock; all times count from here
    pub start_s: f64,
    /// In the order of the files, and within a file of their first pose; at least one
    pub robots: Vec<RecordedRobot>,
}

impl Recording {
    /// The time of the last pose of any robot, in s.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        let last = self.robots.iter().filter_map(|robot| robot.poses.last());
        last.map(|pose| pose.time_s).fold(0.0, f64::max)
    }
}

/// Something odd about a robot's poses.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// What is odd
    pub kind: FindingKind,
    /// How often
    pub count: usize,
    /// When for the first time, in s from the start of the recording; the time of the pose before
    /// for lines that are no poses, none if no pose comes before
    pub first_at_s: Option<f64>,
    /// One sentence with numbers
    pub detail: String,
}

/// What can be odd.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum FindingKind {
    /// Lines without four numbers within ±1e12, or with more fields than the first; dropped
    NoNumbers,
    /// Times earlier than the one before; sorted
    OutOfOrder,
    /// A time more than once; the newest pose is kept
    DuplicateTime,
    /// Poses of one time more than 20 mm apart; the newest is kept
    TwoPlaces,
    /// Faster than 5 m/s from one pose to the next; kept
    Jump,
    /// More than 0.5 s between poses
    Gap,
    /// Headings beyond a full turn, at least three; not converted
    Degrees,
}
