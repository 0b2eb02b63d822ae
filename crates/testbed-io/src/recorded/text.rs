//! The lines of recordings.

use std::collections::HashMap;
use std::path::Path;

use super::layout::RecordingLayout;
use super::recording::RecordedPose;
use crate::Error;

pub(super) const GROUNDTRUTH: &str = "_Groundtruth.dat";
const ODOMETRY: &str = "_Odometry.dat";
const PIONEER: [&str; 4] = ["t_s", "x_m", "y_m", "theta_rad"];
const CSV: [&str; 4] = ["time_s", "x_m", "y_m", "heading_rad"];

/// In s, m or rad: far beyond every clock and every hall, so that differences stay finite.
const LIMIT: f64 = 1e12;

/// A robot as in the file, with its times.
pub(super) struct RawRobot {
    pub(super) name: String,
    pub(super) poses: Vec<RecordedPose>,
    /// The number of lines that are no poses
    pub(super) bad_lines: usize,
    /// The first of them, and the number of poses before it
    pub(super) first_bad: Option<(usize, usize)>,
}

/// Where the fields of a line are.
struct Shape {
    /// None for blanks
    delimiter: Option<char>,
    /// Time, x, y and heading
    fields: [usize; 4],
    robot: Option<usize>,
    columns: usize,
    /// Lines before the first pose
    before: usize,
}

/// Reads the robots of a file, each with at least one pose.
pub(super) fn read(
    path: &Path,
    text: &str,
    layout: RecordingLayout,
) -> Result<Vec<RawRobot>, Error> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let shape = shape(path, text, layout)?;
    let file_name = robot_name(path);
    let mut robots: Vec<RawRobot> = Vec::new();
    let mut by_name: HashMap<&str, usize> = HashMap::new();
    let mut bad: Vec<(Option<usize>, usize, usize)> = Vec::new();
    let mut last = None;
    for (index, line) in text.lines().enumerate().skip(shape.before) {
        if line.trim_start().starts_with('#') || line.trim().is_empty() {
            continue;
        }
        let (name, pose) = shape.split(line);
        let name = name.unwrap_or(&file_name);
        let Some(pose) = pose else {
            // a cut line may name half a robot: it counts for the one before
            let robot = by_name.get(name).copied().or(last);
            let poses = robot.map_or(0, |robot: usize| robots[robot].poses.len());
            bad.push((robot, index + 1, poses));
            continue;
        };
        let robot = *by_name.entry(name).or_insert_with(|| {
            robots.push(RawRobot {
                name: name.to_owned(),
                poses: Vec::new(),
                bad_lines: 0,
                first_bad: None,
            });
            robots.len() - 1
        });
        robots[robot].poses.push(pose);
        last = Some(robot);
    }
    if robots.is_empty() {
        let found = "no line with a time and a pose in numbers";
        return Err(content(path, None, found, "record the robots again"));
    }
    for (robot, line, poses) in bad {
        let robot = &mut robots[robot.unwrap_or(0)];
        robot.bad_lines += 1;
        robot.first_bad.get_or_insert((line, poses));
    }
    Ok(robots)
}

impl Shape {
    /// A column that is read and whose name the header has twice.
    fn twice<'a>(&self, header: &'a str) -> Option<&'a str> {
        let names: Vec<&str> = header.split(self.delimiter?).map(clean).collect();
        let read = self.fields.into_iter().chain(self.robot);
        let mut read = read.filter_map(|field| names.get(field).copied());
        read.find(|name| {
            names
                .iter()
                .filter(|other| other.eq_ignore_ascii_case(name))
                .count()
                > 1
        })
    }

    /// The robot of a line if it names one, and the pose if it has one.
    fn split<'a>(&self, line: &'a str) -> (Option<&'a str>, Option<RecordedPose>) {
        match self.delimiter {
            None => self.take(line.split_whitespace()),
            Some(delimiter) => self.take(line.split(delimiter).map(clean)),
        }
    }

    fn take<'a>(
        &self,
        fields: impl Iterator<Item = &'a str>,
    ) -> (Option<&'a str>, Option<RecordedPose>) {
        let mut robot = None;
        let mut values = [f64::NAN; 4];
        let mut has_room = true;
        for (index, field) in fields.enumerate() {
            if self.robot == Some(index) && !field.is_empty() {
                robot = Some(field);
            }
            has_room &= index < self.columns || field.is_empty();
            if let Some(of) = self.fields.iter().position(|field| *field == index) {
                values[of] = field.parse().unwrap_or(f64::NAN);
            }
        }
        let [time_s, x_m, y_m, heading_rad] = values;
        let pose = RecordedPose {
            time_s,
            x_m,
            y_m,
            heading_rad,
        };
        let whole = has_room
            && values.iter().all(|value| value.abs() < LIMIT)
            && (self.robot.is_none() || robot.is_some());
        (robot, whole.then_some(pose))
    }
}

fn clean(field: &str) -> &str {
    field.trim().trim_matches('"')
}

/// Recognises the layout, or checks that it is the one asked for.
fn shape(path: &Path, text: &str, layout: RecordingLayout) -> Result<Shape, Error> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if name.ends_with(ODOMETRY) {
        let found = "odometry of MRCLAM: speeds, not poses";
        let help = format!("name {} instead", name.replace(ODOMETRY, GROUNDTRUTH));
        return Err(content(path, None, found, &help));
    }
    let mut lines = text.lines().enumerate();
    let first = lines.find(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let Some((before, first)) = first else {
        let help = "record the robots again";
        return Err(content(path, None, "the file is empty", help));
    };
    let shape = match layout {
        RecordingLayout::Mrclam => mrclam(first, before),
        RecordingLayout::PioneerMocap => table(first, before, PIONEER),
        RecordingLayout::Csv => table(first, before, CSV),
        RecordingLayout::Auto => table(first, before, CSV)
            .or_else(|| table(first, before, PIONEER))
            .or_else(|| mrclam(first, before)),
    };
    let odometry = first.split(',').any(|field| clean(field) == "v_mps");
    if let Some(twice) = shape.as_ref().and_then(|shape| shape.twice(first)) {
        let found = format!("two columns are called {twice}");
        let help = "leave one in the file";
        return Err(content(path, Some(before + 1), &found, help));
    }
    match shape {
        Some(_) if odometry && layout != RecordingLayout::Csv => {
            let found = "odometry, which drifts: it has a column v_mps";
            let help = "name the file of the motion capture, <robot>_mocap_ground_pose.csv";
            Err(content(path, Some(before + 1), found, help))
        }
        Some(shape) => Ok(shape),
        None => {
            let found = format!("{:?}", first.chars().take(60).collect::<String>());
            let help = format!("a recording begins with {}", beginning(layout));
            Err(content(path, Some(before + 1), &found, &help))
        }
    }
}

fn beginning(layout: RecordingLayout) -> String {
    let numbers = "four numbers between blanks (time in s, x and y in m, heading in rad)";
    let header = |names: [&str; 4]| format!("a header with {}", names.join(","));
    match layout {
        RecordingLayout::Mrclam => numbers.to_owned(),
        RecordingLayout::PioneerMocap => header(PIONEER),
        RecordingLayout::Csv => header(CSV),
        RecordingLayout::Auto => {
            format!("{}, {}, or {numbers}", header(CSV), header(PIONEER))
        }
    }
}

fn mrclam(first: &str, before: usize) -> Option<Shape> {
    let fields = first.split_whitespace();
    let numbers = fields.map(|field| field.parse::<f64>().ok());
    let numbers = numbers.collect::<Option<Vec<f64>>>()?;
    (numbers.len() == 4).then_some(Shape {
        delimiter: None,
        fields: [0, 1, 2, 3],
        robot: None,
        columns: 4,
        before,
    })
}

fn table(header: &str, before: usize, names: [&str; 4]) -> Option<Shape> {
    [',', ';', '\t'].into_iter().find_map(|delimiter| {
        let position = |name: &str| {
            let mut fields = header.split(delimiter).map(clean);
            fields.position(|field| field.eq_ignore_ascii_case(name))
        };
        let [Some(time), Some(x), Some(y), Some(heading)] = names.map(position) else {
            return None;
        };
        Some(Shape {
            delimiter: Some(delimiter),
            fields: [time, x, y, heading],
            robot: position("robot"),
            columns: header.split(delimiter).count(),
            before: before + 1,
        })
    })
}

/// `Robot1` of `Robot1_Groundtruth.dat`.
fn robot_name(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let suffixes = ["_Groundtruth", "_mocap_ground_pose"];
    let name = suffixes.iter().find_map(|suffix| stem.strip_suffix(suffix));
    name.unwrap_or(&stem).to_owned()
}

fn content(path: &Path, line: Option<usize>, found: &str, help: &str) -> Error {
    Error::Content {
        path: path.to_owned(),
        place: line.map_or_else(String::new, |line| format!(", line {line}")),
        found: found.to_owned(),
        help: help.to_owned(),
    }
}
