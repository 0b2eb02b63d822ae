//! Poses recorded elsewhere.

use proptest::prelude::*;
use tempfile::TempDir;
use testbed_io::Error;
use testbed_io::recorded::{Finding, FindingKind, Recording, RecordingLayout, read_recording};

use crate::shared::shared;

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn read(name: &str, text: &str, layout: RecordingLayout) -> Result<Recording, Error> {
    let folder = folder(&[(name, text)]);
    read_recording(&[folder.path().join(name)], layout)
}

fn auto(name: &str, text: &str) -> Recording {
    read(name, text, RecordingLayout::Auto).unwrap()
}

fn message(name: &str, text: &str) -> String {
    read(name, text, RecordingLayout::Auto)
        .unwrap_err()
        .to_string()
}

/// Time, x, y and heading of a robot's poses.
fn poses(recording: &Recording, robot: usize) -> Vec<[f64; 4]> {
    let poses = recording.robots[robot].poses.iter();
    poses
        .map(|p| [p.time_s, p.x_m, p.y_m, p.heading_rad])
        .collect()
}

fn found(recording: &Recording, kind: FindingKind) -> Option<&Finding> {
    recording.robots[0]
        .findings
        .iter()
        .find(|finding| finding.kind == kind)
}

#[test]
fn a_folder_gives_its_ground_truth() {
    let comment = "# UTIAS\n# Time [s]    x [m]\n";
    let folder = folder(&[
        (
            "Robot2_Groundtruth.dat",
            &format!("{comment}100.5 \t 1.0 \t 2.0 \t 0.5 \n"),
        ),
        (
            "Robot1_Groundtruth.dat",
            &format!("{comment}101 3 4 -0.5\n101.25 5 6 -1e-1\n"),
        ),
        ("Robot1_Odometry.dat", "1 2 3\n"),
    ]);
    let path = folder.path().to_owned();
    let recording = read_recording(&[path], RecordingLayout::Mrclam).unwrap();
    assert_eq!(recording.start_s, 100.5);
    assert_eq!(recording.robots[0].name, "Robot1");
    assert_eq!(recording.robots[1].name, "Robot2");
    assert_eq!(
        poses(&recording, 0),
        [[0.5, 3.0, 4.0, -0.5], [0.75, 5.0, 6.0, -0.1]]
    );
    assert_eq!(poses(&recording, 1), [[0.0, 1.0, 2.0, 0.5]]);

    let twice = folder.path().join("Robot1_Groundtruth.dat");
    let twice = read_recording(&[twice.clone(), twice], RecordingLayout::Auto).unwrap_err();
    assert!(
        twice
            .to_string()
            .contains("robot \"Robot1\", which an earlier file"),
        "{twice}"
    );
}

#[test]
fn odometry_is_refused() {
    let mrclam = message("Robot1_Odometry.dat", "1 0.5 0.1\n");
    assert!(
        mrclam.contains("name Robot1_Groundtruth.dat instead"),
        "{mrclam}"
    );
    let pioneer = message(
        "a_odom.csv",
        "t_s,x_m,y_m,theta_rad,v_mps,w_radps\n1,2,3,4,5,6\n",
    );
    assert!(pioneer.contains("_mocap_ground_pose.csv"), "{pioneer}");
}

#[test]
fn motion_capture_of_pioneers() {
    let recording = auto(
        "duarte_mocap_ground_pose.csv",
        "t_s,x_m,y_m,theta_rad\n7.5,-3,1,-2\n",
    );
    assert_eq!(recording.robots[0].name, "duarte");
    assert_eq!(poses(&recording, 0), [[0.0, -3.0, 1.0, -2.0]]);
}

#[test]
fn csv_with_any_delimiter_and_order() {
    let text = "\u{feff}robot,note,time_s,\"y_m\",x_m,heading_rad\r\nb,,1,2,3,0\r\na,,1,4,5,0\r\nb,,2,2,3,0\r\n";
    for delimiter in [",", ";", "\t"] {
        let recording = auto("two.csv", &text.replace(',', delimiter));
        let names: Vec<&str> = recording.robots.iter().map(|r| r.name.as_str()).collect();
        assert_eq!(names, ["b", "a"]);
        assert_eq!(
            poses(&recording, 0),
            [[0.0, 3.0, 2.0, 0.0], [1.0, 3.0, 2.0, 0.0]]
        );
        assert_eq!(poses(&recording, 1), [[0.0, 5.0, 4.0, 0.0]]);
    }
    let one = auto("leader.csv", "time_s, x_m, y_m, heading_rad\n0, 1, 2, 3\n");
    assert_eq!(one.robots[0].name, "leader");
    assert_eq!(poses(&one, 0), [[0.0, 1.0, 2.0, 3.0]]);
}

#[test]
fn what_is_odd_is_found() {
    let header = "time_s,x_m,y_m,heading_rad\n";
    let text =
        "1,0,0,90\n1.25,0.1,0,90\nnan,0,0,0\n1.125,0.1,0,90\nx\n1.25,0.2,0,90\n2.25,0.2,9,0\n";
    let recording = auto("odd.csv", &format!("{header}{text}"));
    let times: Vec<f64> = recording.robots[0].poses.iter().map(|p| p.time_s).collect();
    assert_eq!(times, [0.0, 0.125, 0.25, 1.25]);
    assert_eq!(recording.robots[0].poses[2].x_m, 0.2, "the newest stays");
    let expect = |kind, count, at, detail: &str| {
        let finding = found(&recording, kind).unwrap();
        assert_eq!(
            (finding.count, finding.first_at_s),
            (count, Some(at)),
            "{finding:?}"
        );
        assert!(finding.detail.contains(detail), "{finding:?}");
    };
    expect(FindingKind::NoNumbers, 2, 0.25, "first line 4");
    expect(FindingKind::OutOfOrder, 1, 0.25, "up to 0.125 s");
    expect(FindingKind::DuplicateTime, 1, 0.25, "newest");
    expect(FindingKind::TwoPlaces, 1, 0.25, "up to 0.100 m apart");
    expect(FindingKind::Jump, 1, 0.25, "9.0 m/s");
    expect(FindingKind::Gap, 1, 0.25, "at most 1.00 s");
    expect(FindingKind::Degrees, 3, 0.0, "up to 90.0");

    let fine = auto(
        "fine.csv",
        &format!("{header}0,0,0,6.3\n0.5,1,0,-6.3\n1,1,0,0"),
    );
    assert_eq!(fine.robots[0].findings, []);
}

#[test]
fn a_line_with_more_fields_than_the_first_is_dropped() {
    let header = "time_s,x_m,y_m,heading_rad\n";
    let recording = auto(
        "long.csv",
        &format!("{header}0,1,2,3,\n1,1,5,2,3\n2,1,2,3\n"),
    );
    assert_eq!(recording.robots[0].poses.len(), 2);
    assert_eq!(found(&recording, FindingKind::NoNumbers).unwrap().count, 1);
}

#[test]
fn two_columns_of_one_name_are_refused() {
    let text = "time_s,x_m,y_m,X_M,heading_rad\n0,1,2,3,4\n";
    let error = message("twice.csv", text);
    assert!(error.contains("two columns are called x_m"), "{error}");
}

#[test]
fn a_cut_line_is_no_robot() {
    let text = "robot,time_s,x_m,y_m,heading_rad\nleader,0,0,0,0\nlead";
    let recording = auto("cut.csv", text);
    assert_eq!(recording.robots.len(), 1);
    assert_eq!(found(&recording, FindingKind::NoNumbers).unwrap().count, 1);
}

#[test]
fn files_that_are_no_recordings() {
    assert!(message("a.csv", "").contains("empty"));
    assert!(
        message("a.csv", "time,x\n1,2\n").contains("line 1: \"time,x\"; a recording begins with")
    );
    assert!(message("a.csv", "time_s,x_m,y_m,heading_rad\n").contains("no line with"));
    let csv = read("a.csv", "1 2 3 4\n", RecordingLayout::Csv)
        .unwrap_err()
        .to_string();
    assert!(csv.contains("time_s,x_m,y_m,heading_rad"), "{csv}");
    let none = read_recording(&[], RecordingLayout::Auto).unwrap_err();
    assert!(matches!(none, Error::NoRecording { .. }));
    let folder = folder(&[]);
    let none = read_recording(&[folder.path().to_owned()], RecordingLayout::Auto).unwrap_err();
    assert!(
        none.to_string().contains("_Groundtruth.dat in this folder"),
        "{none}"
    );
    let absent = read_recording(&[folder.path().join("absent")], RecordingLayout::Auto);
    assert!(matches!(absent, Err(Error::Read { .. })));
}

#[test]
fn real_ground_truth() {
    let Some(path) = shared("data/mrclam") else {
        return;
    };
    let recording = read_recording(&[path], RecordingLayout::Auto).unwrap();
    assert_eq!(recording.robots.len(), 5);
    for robot in &recording.robots {
        assert!(robot.poses.len() > 50_000, "{}", robot.name);
        assert!(robot.poses.is_sorted_by(|a, b| a.time_s < b.time_s));
        let odd = [FindingKind::NoNumbers, FindingKind::Degrees];
        assert!(
            !robot.findings.iter().any(|f| odd.contains(&f.kind)),
            "{:?}",
            robot.findings
        );
    }
    let starts = recording.robots.iter().map(|robot| robot.poses[0].time_s);
    assert_eq!(starts.fold(f64::INFINITY, f64::min), 0.0);
}

#[test]
fn real_motion_capture() {
    let Some(path) = shared("data/pioneer-mocap/duarte_mocap_ground_pose.csv") else {
        return;
    };
    let recording = read_recording(&[path], RecordingLayout::PioneerMocap).unwrap();
    assert_eq!(recording.robots[0].name, "duarte");
    assert!(recording.robots[0].poses.len() > 1_000);
}

proptest! {
    #[test]
    fn any_lines_never_panic(lines in proptest::collection::vec("[0-9einft.,;#\"\t -]{0,24}", 0..12), named in any::<bool>()) {
        let header = if named { "time_s,x_m,robot,y_m,heading_rad\n0,0,a,0,0\n" } else { "0 0 0 0\n" };
        let recording = auto("any.csv", &format!("{header}{}", lines.join("\n")));
        for robot in &recording.robots {
            prop_assert!(robot.poses.is_sorted_by(|a, b| a.time_s < b.time_s));
        }
    }
}
