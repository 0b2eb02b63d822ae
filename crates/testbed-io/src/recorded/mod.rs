//! Poses of robots that were recorded elsewhere, by motion capture.
//!
//! Three layouts of text are read: ground truth of the UTIAS MRCLAM dataset (Leung, Halpern,
//! Barfoot and Liu, "The UTIAS multi-robot cooperative localization and mapping dataset",
//! International Journal of Robotics Research 30(8), 2011), motion capture of Pioneer robots, and
//! CSV.

mod layout;
mod recording;
mod text;
mod tidy;

use std::path::{Path, PathBuf};

use crate::Error;
pub use layout::RecordingLayout;
pub use recording::{Finding, FindingKind, RecordedPose, RecordedRobot, Recording};
use text::RawRobot;

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
