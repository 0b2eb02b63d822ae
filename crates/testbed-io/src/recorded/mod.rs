//! Poses of robots that were recorded elsewhere, by motion capture.
//!
//! Three layouts of text are read: ground truth of the UTIAS MRCLAM dataset (Leung, Halpern,
//! Barfoot and Liu, "The UTIAS multi-robot cooperative localization and mapping dataset",
//! International Journal of Robotics Research 30(8), 2011), motion capture of Pioneer robots, and
//! CSV.

mod text;
mod tidy;

use std::path::{Path, PathBuf};

use serde::Serialize;
use strum::{EnumMessage, EnumString, IntoStaticStr, VariantArray};

use crate::Error;
use text::RawRobot;

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
    /// Lines without four numbers within ±1e12; dropped
    NoNumbers,
    /// Times earlier than the one before; sorted
    OutOfOrder,
    /// A time more than once; the newest pose is kept
    DuplicateTime,
    /// Faster than 5 m/s from one pose to the next; kept
    Jump,
    /// More than 0.5 s between poses
    Gap,
    /// Headings beyond a full turn, at least three; not converted
    Degrees,
}

/// How a recording is laid out.
///
/// - MRCLAM: time in s, x and y in m, heading in rad, between blanks; `#` begins a comment. A file per robot, named
///   `<robot>_Groundtruth.dat`
/// - Pioneer: a file per robot, named `<robot>_mocap_ground_pose.csv`
/// - CSV: these columns in any order among others, `robot` unless the file is one robot's, with comma, semicolon or tab between them
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Default,
    Serialize,
    EnumMessage,
    EnumString,
    IntoStaticStr,
    VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum RecordingLayout {
    /// By header and extension
    #[default]
    Auto,
    /// Groundtruth files of UTIAS MRCLAM: time x y heading
    Mrclam,
    /// t_s,x_m,y_m,theta_rad
    PioneerMocap,
    /// time_s,robot,x_m,y_m,heading_rad
    Csv,
}

/// Reads a recording from files. A folder stands for all `*_Groundtruth.dat` in it, by name.
///
/// # Errors
///
/// [`Error::NoRecording`] without files, or for a folder without such files; [`Error::Read`] and
/// [`Error::TooLarge`] (above 1 GiB); [`Error::Content`] for a file of another layout, with
/// odometry, without poses, or with a robot that an earlier file has.
pub fn read_recording(paths: &[PathBuf], layout: RecordingLayout) -> Result<Recording, Error> {
    let mut raw: Vec<RawRobot> = Vec::new();
    for path in files(paths)? {
        let bytes = crate::log_file::file_bytes(&path)?;
        let robots = text::read(&path, &String::from_utf8_lossy(&bytes), layout)?;
        if let Some(twice) = robots.iter().find(|r| raw.iter().any(|o| o.name == r.name)) {
            return Err(Error::Content {
                found: format!("robot {:?}, which an earlier file has too", twice.name),
                help: "name each robot's file differently, and each file once".to_owned(),
                place: String::new(),
                path,
            });
        }
        raw.extend(robots);
    }
    let times = raw
        .iter()
        .flat_map(|robot| &robot.poses)
        .map(|pose| pose.time_s);
    let start_s = times.fold(f64::INFINITY, f64::min);
    if raw.is_empty() {
        return Err(nothing(Path::new(""), "files"));
    }
    let robots = raw.into_iter().map(|robot| tidy::tidy(robot, start_s));
    Ok(Recording {
        start_s,
        robots: robots.collect(),
    })
}

fn files(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Error> {
    let mut files = Vec::new();
    for path in paths {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let entries = std::fs::read_dir(path).and_then(Iterator::collect::<Result<Vec<_>, _>>);
        let entries = entries.map_err(|source| Error::Read {
            path: path.clone(),
            source,
        })?;
        let mut found: Vec<PathBuf> = entries.iter().map(std::fs::DirEntry::path).collect();
        found.retain(|file| file.to_string_lossy().ends_with(text::GROUNDTRUTH));
        if found.is_empty() {
            return Err(nothing(path, "*_Groundtruth.dat in this folder"));
        }
        found.sort();
        files.extend(found);
    }
    Ok(files)
}

fn nothing(path: &Path, expected: &'static str) -> Error {
    Error::NoRecording {
        path: path.to_owned(),
        expected,
    }
}
