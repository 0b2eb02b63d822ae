//! Controllers beside recorded robots.

use testbed_io::recorded::{Recording, RecordingLayout, read_recording};
use testbed_io::{Lane, Shadow, lengthen, scenario_of, shadow};
use testbed_sim::Verdict;
use testbed_sim::summary::outcomes_of;
use unicycle_cbf::{Preset, Scenario, Testbed};

use crate::shared::shared;

fn settings() -> unicycle_cbf::ControllerSettings {
    Testbed::Robotarium
        .scenario("straight", Preset::Hardened)
        .unwrap()
        .controller
}

fn recorded(text: &str) -> Recording {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("poses.csv");
    std::fs::write(&file, text).unwrap();
    read_recording(&[file], RecordingLayout::Csv).unwrap()
}

/// Two robots that go round a circle, seen every so often.
fn round(duration_s: f64, every_s: f64, radians: f64, second_from_s: f64) -> Shadow {
    let mut text = "time_s,robot,x_m,y_m,heading_rad\n".to_owned();
    for i in 0..(duration_s / every_s) as u32 {
        let time_s = f64::from(i) * every_s;
        for (robot, ahead) in [("a", 0.8), ("b", 0.0)] {
            if robot == "b" && time_s < second_from_s {
                continue;
            }
            let angle = 0.2 * time_s + ahead;
            let heading = radians * (angle + std::f64::consts::FRAC_PI_2);
            let (sin, cos) = angle.sin_cos();
            text += &format!("{time_s},{robot},{cos},{sin},{heading}\n");
        }
    }
    let recording = recorded(&text);
    let spec = scenario_of(&recording, Testbed::Robotarium, settings()).unwrap();
    shadow(&Scenario::new(spec).unwrap(), &recording, Lane::Laid).unwrap()
}

/// The first stands, the second drives into it at 8 s.
#[test]
fn all_of_a_recording_is_judged() {
    let mut text = "time_s,robot,x_m,y_m,heading_rad\n".to_owned();
    for i in 0..200 {
        let time_s = 0.05 * f64::from(i);
        text += &format!("{time_s},a,0.9,0,0\n{time_s},b,{},0,0\n", 0.1 * time_s);
    }
    let recording = recorded(&text);
    let mut spec = Testbed::Robotarium
        .scenario("straight", Preset::Hardened)
        .unwrap();
    spec.robots.truncate(2);
    spec.duration_s = 4.0;
    let judge = |spec: &unicycle_cbf::ScenarioSpec| {
        let scenario = Scenario::new(spec.clone()).unwrap();
        let shadow = shadow(&scenario, &recording, Lane::Given).unwrap();
        shadow.summary.first_unsafe_s
    };
    assert_eq!(judge(&spec), None);
    assert_eq!(lengthen(&mut spec, &recording), Some(4.0));
    assert!(judge(&spec).is_some_and(|first_s| first_s > 5.0));
    assert_eq!(lengthen(&mut spec, &recording), None);
}

#[test]
fn robots_of_which_little_was_recorded_are_not_called_safe() {
    for (every_s, radians, second_from_s, doubt) in [
        (0.05, 1.0, 0.0, None),
        (0.2, 1.0, 0.0, None),
        (5.0, 1.0, 0.0, Some("robot a was seen too seldom")),
        (0.05, 1.0, 28.6, Some("robot b was seen too seldom")),
        (
            0.05,
            57.3,
            0.0,
            Some("headings of robot b are not the direction"),
        ),
    ] {
        let Shadow {
            summary, doubts, ..
        } = round(60.0, every_s, radians, second_from_s);
        let expected = doubt.map_or(Verdict::Safe, |_| Verdict::NotKnown);
        assert_eq!(summary.verdict, expected, "{every_s} {radians} {doubts:?}");
        let found = doubt.is_none_or(|doubt| doubts.iter().any(|text| text.contains(doubt)));
        assert!(found && doubts.is_empty() == doubt.is_none(), "{doubts:?}");
    }
}

/// A quarter of a circle does not say what circle it was.
#[test]
fn a_lane_that_nobody_gave_makes_nobody_unsafe() {
    for (seconds, verdict) in [
        (60.0, Verdict::Safe),
        (4.0, Verdict::NotKnown),
        (0.5, Verdict::NotKnown),
    ] {
        let Shadow {
            summary, doubts, ..
        } = round(seconds, 0.05, 1.0, 0.0);
        assert_eq!(summary.verdict, verdict, "{seconds} s: {doubts:?}");
        let said = doubts.iter().any(|text| text.contains("no lane was given"));
        assert_eq!(said, verdict == Verdict::NotKnown, "{doubts:?}");
    }
}

/// Two robots that go round a circle, with a gap in the poses of the second.
#[test]
fn gaps_stop_the_robot_and_all_else_does_not() {
    let mut text = "time_s,robot,x_m,y_m,heading_rad\n".to_owned();
    for i in 0..600 {
        let time_s = f64::from(i) / 30.0;
        for (robot, ahead) in [("a", 0.8), ("b", 0.0)] {
            if robot == "b" && (200..260).contains(&i) {
                continue;
            }
            let angle = 0.1 * time_s + ahead;
            let heading = angle + std::f64::consts::FRAC_PI_2;
            text += &format!(
                "{time_s},{robot},{},{},{heading}\n",
                angle.cos(),
                angle.sin()
            );
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("poses.csv");
    std::fs::write(&file, text).unwrap();
    let recording = read_recording(&[file], RecordingLayout::Csv).unwrap();
    let spec = scenario_of(&recording, Testbed::Robotarium, settings()).unwrap();
    let scenario = Scenario::new(spec).unwrap();
    let Shadow { ticks, summary, .. } = shadow(&scenario, &recording, Lane::Laid).unwrap();
    let outcomes = outcomes_of(&ticks, 1);
    let stale = outcomes.get("braking-stale-pose").copied().unwrap_or(0);
    assert!((48..=54).contains(&stale), "{outcomes:?}");
    assert!(
        outcomes["optimal"] + stale + 2 >= summary.steps,
        "{outcomes:?}"
    );
    let speed = ticks
        .iter()
        .rev()
        .find_map(|tick| tick.truth)
        .unwrap()
        .state
        .speed_mps;
    assert!((speed - 0.1).abs() < 1e-3, "{speed}");
}

#[test]
fn recorded_robots_give_decisions_throughout() {
    let Some(folder) = shared("data/mrclam") else {
        return;
    };
    let files = [1, 2, 3, 4, 5].map(|robot| folder.join(format!("Robot{robot}_Groundtruth.dat")));
    let recording = read_recording(&files, RecordingLayout::Mrclam).unwrap();
    let spec = scenario_of(&recording, Testbed::Robotarium, settings()).unwrap();
    let scenario = Scenario::new(spec).unwrap();
    let Shadow { ticks, summary, .. } = shadow(&scenario, &recording, Lane::Laid).unwrap();
    assert_eq!(ticks.len(), 5 * scenario.steps());
    for robot in 0..5 {
        let outcomes = outcomes_of(&ticks, robot);
        println!("{robot}: {outcomes:?}");
        assert!(!outcomes.contains_key("braking-not-finite"));
    }
    assert!(summary.steps > 20_000);
}

#[test]
fn another_number_of_robots_is_refused() {
    let Some(file) = shared("data/pioneer-mocap/duarte_mocap_ground_pose.csv") else {
        return;
    };
    let recording = read_recording(&[file], RecordingLayout::Auto).unwrap();
    let scenario = Testbed::Robotarium
        .scenario("track", Preset::Thesis)
        .unwrap();
    let error = shadow(&Scenario::new(scenario).unwrap(), &recording, Lane::Laid).unwrap_err();
    assert!(
        error.to_string().contains("2 robots and the recording 1"),
        "{error}"
    );
}

fn verdict_on_a_straight(recording: &Recording) -> Verdict {
    let mut spec = Testbed::Robotarium
        .scenario("straight", Preset::Hardened)
        .unwrap();
    spec.robots.truncate(2);
    spec.duration_s = recording.end_s();
    let scenario = Scenario::new(spec).unwrap();
    let shadow = shadow(&scenario, recording, Lane::Given).unwrap();
    shadow.summary.verdict
}

/// Whether it is known that two robots on a straight were safe, with lines added to their recording.
fn verdict_with(heading: f64, more: &str) -> Verdict {
    let mut text = "time_s,robot,x_m,y_m,heading_rad\n".to_owned();
    for i in 0..200 {
        let time_s = 0.05 * f64::from(i);
        for (robot, ahead_m) in [("a", 1.0), ("b", 0.0)] {
            let x_m = ahead_m + 0.1 * time_s;
            text += &format!("{time_s},{robot},{x_m},0,{heading}\n");
        }
    }
    let recording = recorded(&(text + more));
    verdict_on_a_straight(&recording)
}

#[test]
fn headings_across_the_motion_and_two_places_at_once_are_not_known_to_be_safe() {
    assert_eq!(verdict_with(0.0, ""), Verdict::Safe);
    assert_eq!(verdict_with(1.5, ""), Verdict::NotKnown, "degrees");
    for more in ["5,b,1.4,0,0\n5,b,0.5,0,0\n", "5,b,0.5,0,0\n5,b,0.9,0,0\n"] {
        assert_ne!(verdict_with(0.0, more), Verdict::Safe, "{more}");
    }
}

/// The follower drives on while the robot ahead, which goes as fast, is not seen for 4 s.
#[test]
fn a_robot_ahead_that_is_not_seen_makes_nobody_unsafe() {
    let mut text = "time_s,robot,x_m,y_m,heading_rad\n".to_owned();
    for i in 0..400 {
        let time_s = 0.05 * f64::from(i);
        for (robot, ahead_m) in [("a", 0.6), ("b", 0.0)] {
            if robot == "b" || !(100..180).contains(&i) {
                text += &format!("{time_s},{robot},{},0,0\n", ahead_m + 0.15 * time_s);
            }
        }
    }
    let recording = recorded(&text);
    assert_eq!(verdict_on_a_straight(&recording), Verdict::NotKnown);
}
