//! Robots and trackers that are not as stated: named, slowed down, and stopped before the lane ends.

use std::time::Duration;

use testbed_io::live::{LinkSpec, LiveReport, Session, StopSwitch, Update};
use testbed_io::log_file::{LogFormat, read_bytes, write};
use testbed_io::{Error, LoggedRun, RunFile};
use testbed_sim::{Disturbances, Replay, Summary, Tick, Verdict};
use unicycle_cbf::{Preset, Scenario, ScenarioSpec, Testbed};

use super::faulty::{self, Faults};
use super::world::Least;

/// How far beyond the edge of its lane a robot may come, in m.
const BEYOND_M: f64 = 0.01;

pub struct Driven {
    /// With the time of the step before, in s
    pub notes: Vec<(f64, String)>,
    pub ended: Result<(Summary, LiveReport), Error>,
    pub least: Least,
    spec: ScenarioSpec,
    link: LinkSpec,
    pub ticks: Vec<Tick>,
}

impl Driven {
    pub fn new(name: &str, duration_s: f64, faults: Faults) -> Self {
        let mut spec = Testbed::Khepera.scenario(name, Preset::Hardened).unwrap();
        spec.duration_s = duration_s;
        Self::of(spec, faults, f64::INFINITY)
    }

    /// The loop stands still for two seconds from a time on.
    pub fn of(spec: ScenarioSpec, faults: Faults, stall_s: f64) -> Self {
        let mut stalled = false;
        let mut kept = Vec::new();
        let scenario = Scenario::new(spec.clone()).unwrap();
        let (link, _, robots) = faulty::start(&spec, faults);
        let mut notes = Vec::new();
        let mut now_s = 0.0;
        let session = Session {
            scenario: &scenario,
            link: &link,
        };
        let ended = session.run(&StopSwitch::default(), |update| match update {
            Update::Note(text) => {
                println!("{now_s:.2} s: {text}");
                notes.push((now_s, text.to_string()));
            }
            Update::Step { ticks, .. } => {
                now_s = ticks[0].time_s;
                kept.extend_from_slice(ticks);
                if now_s > stall_s && !std::mem::replace(&mut stalled, true) {
                    std::thread::sleep(Duration::from_secs(2));
                }
            }
        });
        let least = robots.join().unwrap().least();
        println!("{least:?}");
        Self {
            notes,
            ended,
            least,
            spec,
            link,
            ticks: kept,
        }
    }

    /// Of its log as CSV.
    pub fn replay(&self) -> Replay {
        let spec = RunFile {
            seed: 1,
            scenario: self.spec.clone(),
            disturbances: Disturbances::default(),
            link: Some(self.link.clone()),
        };
        let run = LoggedRun {
            judged: None,
            spec,
            ticks: self.ticks.clone(),
            started_unix_s: None,
        };
        let mut bytes = Vec::new();
        write(&run.to_table().unwrap(), LogFormat::Csv, &mut bytes).unwrap();
        let table = read_bytes(&bytes, LogFormat::Csv).unwrap();
        let replay = table.run_log().unwrap().replay().unwrap();
        assert!(replay.different == 0 && !replay.truncated, "{replay:?}");
        replay
    }

    /// Whether a robot was named for this, at a time that is given.
    pub fn named_at_s(&self, what: &str) -> f64 {
        let mut notes = self.notes.iter();
        let found = notes.find(|(_, text)| text.contains(what));
        found
            .unwrap_or_else(|| panic!("`{what}` is not in {:?}", self.notes))
            .0
    }

    pub fn stays(&self) {
        assert!(self.least.lane_clearance_m > -BEYOND_M, "{:?}", self.least);
        assert!(self.least.headway_m > -BEYOND_M, "{:?}", self.least);
    }

    pub fn refused(&self, what: &str) {
        let error = self.ended.as_ref().unwrap_err().to_string();
        assert!(error.contains(what), "{error}");
    }
}

#[test]
fn robots_as_stated_are_not_doubted() {
    let driven = Driven::new("on-off", 6.0, Faults::NONE);
    let (summary, report) = driven.ended.as_ref().unwrap();
    assert!(summary.safe == Some(true) && report.seen_enough);
    assert_eq!(report.unseen_s, [0.0, 0.0]);
    assert_eq!(driven.replay().verdict, Verdict::Safe);
    let doubts = driven
        .notes
        .iter()
        .filter(|(_, text)| text.starts_with("robot"));
    assert_eq!(doubts.count(), 0);
    driven.named_at_s("ids are checked by motion: each robot moved");
}

#[test]
fn wheels_that_differ_by_a_fifth_are_named() {
    let faults = Faults {
        gains: [1.0, 0.8],
        ..Faults::NONE
    };
    let driven = Driven::new("straight", 6.0, faults);
    let named = "does not do what it is told: its left wheel does 100 %, its right one 80 %";
    assert!(driven.named_at_s(named) < 4.0);
    driven.stays();
}

#[test]
fn a_heading_that_is_off_by_twenty_degrees_is_named() {
    let faults = Faults {
        yaw_rad: 20_f64.to_radians(),
        ..Faults::NONE
    };
    let driven = Driven::new("on-off", 6.0, faults);
    assert!(driven.named_at_s("does not move where it heads but 20° to the right") < 4.0);
    driven.stays();
}

#[test]
fn a_heading_that_turned_by_pi_is_never_believed() {
    let faults = Faults {
        flipped_after_s: 4.0,
        ..Faults::NONE
    };
    let driven = Driven::new("on-off", 8.0, faults);
    assert!(driven.named_at_s("where its commands cannot have led it") < 5.0);
    assert!(
        driven
            .notes
            .iter()
            .all(|(_, text)| !text.contains("seen again"))
    );
    driven.stays();
}

#[test]
fn headings_in_degrees_are_refused_at_the_start() {
    let faults = Faults {
        degrees: true,
        ..Faults::NONE
    };
    Driven::new("on-off", 3.0, faults).refused("degrees?");
}

#[test]
fn robots_in_each_others_place_are_refused_at_the_start() {
    let faults = Faults {
        exchanged: [true, true],
        ..Faults::NONE
    };
    Driven::new("straight", 3.0, faults).refused("is not ahead of it along the path");
}

#[test]
fn a_robot_that_moves_in_place_of_another_stops_all() {
    let faults = Faults {
        exchanged: [false, true],
        ..Faults::NONE
    };
    let driven = Driven::new("straight", 5.0, faults);
    assert!(driven.named_at_s("robot 1 was told to move and robot 2 did") < 3.0);
    driven.stays();
}

#[test]
fn wheels_that_do_a_third_of_what_is_stated_are_named() {
    let faults = Faults {
        most_mps: 0.1,
        ..Faults::NONE
    };
    let driven = Driven::new("on-off", 10.0, faults);
    assert!(driven.named_at_s("does not do what it is told") < 6.0);
    driven.stays();
}

#[test]
fn poses_that_are_always_late_are_recognised_by_the_motion() {
    let faults = Faults {
        late_s: 0.6,
        ..Faults::NONE
    };
    let driven = Driven::new("on-off", 7.0, faults);
    assert!(driven.named_at_s("0.60 s later than is stated") < 4.0);
    driven.stays();
}

#[test]
fn robots_that_do_not_hear_the_last_command_are_not_called_safe() {
    let faults = Faults {
        deaf_after_s: 5.8,
        ..Faults::NONE
    };
    let driven = Driven::new("on-off", 6.0, faults);
    let (summary, report) = driven.ended.as_ref().unwrap();
    assert_ne!(summary.verdict, Verdict::Safe, "{report:?}");
    let named = |doubt: &String| doubt.contains("go on after the command to stand");
    assert_eq!(report.doubts.iter().filter(|doubt| named(doubt)).count(), 2);
}

#[test]
fn poses_too_late_to_act_on_count_for_the_verdict() {
    let faults = Faults {
        held_up_s: [5.0, 9.6],
        ..Faults::NONE
    };
    let driven = Driven::new("on-off", 11.0, faults);
    let (summary, report) = driven.ended.as_ref().unwrap();
    assert!(summary.safe == Some(false) && driven.least.lane_clearance_m < 0.0);
    // They arrive from 9.5 s on, and say when it was.
    assert!(summary.first_unsafe_s.is_some_and(|first_s| first_s < 9.2));
    assert!(
        report
            .unseen_s
            .iter()
            .all(|unseen_s| (4.4..5.4).contains(unseen_s))
    );
    driven.named_at_s("outside its lane: it stands for good");
}

#[test]
fn robots_that_can_have_touched_unseen_are_not_called_safe() {
    let mut spec = Testbed::Khepera
        .scenario("straight", Preset::Hardened)
        .unwrap();
    spec.duration_s = 7.0;
    // So wide that two seconds do not lead out of it.
    spec.controller.lane.half_width_m = 1.5;
    let faults = Faults {
        held_up_s: [3.5, f64::INFINITY],
        ..Faults::NONE
    };
    let driven = Driven::of(spec, faults, 3.4);
    let (summary, report) = driven.ended.as_ref().unwrap();
    assert_eq!(summary.verdict, Verdict::NotKnown, "{summary:?}");
    let touch = "robots 1 and 2 were unseen for longer than their commands needed to each other";
    assert_eq!(report.doubts, [touch]);
    assert!(!report.seen_enough);
    let replay = driven.replay();
    assert_eq!(replay.verdict, Verdict::NotKnown);
    assert_eq!(replay.doubts, [touch]);
}

/// At 1 Hz the session drives blindly most of the time, and cannot compare what robots do with what they are told.
#[test]
fn robots_that_are_seen_too_seldom_are_not_called_safe() {
    let faults = Faults {
        every_s: 1.0,
        ..Faults::NONE
    };
    let driven = Driven::new("on-off", 6.0, faults);
    driven.stays();
    let (summary, report) = driven.ended.as_ref().unwrap();
    assert_eq!(summary.verdict, Verdict::NotKnown, "{summary:?}");
    assert!(report.unseen_s.iter().all(|unseen_s| *unseen_s > 4.0));
    let lane = "seen too seldom to know that it does as it is told";
    assert!(
        report.doubts.iter().any(|text| text.contains(lane)),
        "{report:?}"
    );
    let replay = driven.replay();
    assert_eq!(
        (replay.verdict, &replay.doubts),
        (Verdict::NotKnown, &report.doubts)
    );
}

#[test]
fn poses_that_say_for_long_that_a_robot_is_on_another_stop_both_and_the_verdict_is_not_known() {
    let faults = Faults {
        on_first_after_s: 4.0,
        ..Faults::NONE
    };
    let driven = Driven::new("straight", 7.0, faults);
    let (summary, report) = driven.ended.as_ref().unwrap();
    let at_s = driven.named_at_s("robot 2: for 0.5 s its poses have said that it is at");
    assert!(at_s < 5.2, "{at_s}");
    let late = driven.ticks.iter().filter(|tick| tick.time_s > at_s + 0.5);
    let fastest_mps = late.map(|tick| tick.decision.speeds.speed_mps.abs());
    assert_eq!(fastest_mps.fold(0.0, f64::max), 0.0);
    assert_eq!(summary.verdict, Verdict::NotKnown);
    let doubt = "poses of robot 2 said that it is where its commands cannot have led it";
    assert!(report.doubts.iter().any(|text| text == doubt), "{report:?}");
    let replay = driven.replay();
    assert_eq!(replay.verdict, Verdict::NotKnown);
    assert!(replay.doubts.iter().any(|text| text == doubt), "{replay:?}");
}
