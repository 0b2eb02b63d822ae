//! Robots of any kind: JSON lines over UDP and from a program, a recording, and many robots at once.

use std::net::UdpSocket;
use std::time::Instant;

use testbed_io::live::poses::{Pace, ProgramSpec, RecordingSpec};
use testbed_io::live::{
    CommandsSpec, Ending, JsonCommandsSpec, LinkSpec, PosesSpec, Session, StopSwitch,
};
use testbed_io::log_file::{LogFormat, write};
use testbed_io::{LoggedRun, RunFile};
use testbed_sim::{Disturbances, Verdict};
use unicycle_cbf::{Preset, RobotSpec, Scenario, ScenarioSpec, Testbed};

use super::faulty::{self, Faults};
use super::testbed::run;
use crate::python::has_python;

fn scenario(robots: usize, duration_s: f64) -> ScenarioSpec {
    let mut spec = Testbed::Khepera
        .scenario("straight", Preset::Hardened)
        .unwrap();
    spec.duration_s = duration_s;
    spec.rate_hz = 30.0;
    spec.robots = (0..robots)
        .rev()
        .map(|place| RobotSpec::steady(0.6 * place as f64, 0.1))
        .collect();
    spec
}

fn link(robots: usize, poses: PosesSpec, commands: CommandsSpec) -> LinkSpec {
    LinkSpec {
        robots: (1..=robots as u32).collect(),
        lost_after_s: 5.0,
        arena: None,
        poses,
        commands,
    }
}

#[test]
fn twenty_robots_at_30_hz() {
    let spec = scenario(20, 20.0);
    let scenario = Scenario::new(spec.clone()).unwrap();
    let (link, _, robots) = faulty::start(&spec, Faults::NONE);
    let (ticks, _, report) = run(&scenario, &link, &StopSwitch::default(), |_| {});
    let world = robots.join().unwrap();
    assert_eq!(report.ending, Ending::Finished);
    let least = world.least();
    println!("{least:?}");
    assert!(world.stands());
    assert!(least.headway_m >= 0.0 && least.lane_clearance_m >= 0.0);
    let steps = ticks.len() / 20;
    println!("missed {} of {steps}", report.deadlines.missed);
    assert!(report.deadlines.missed as f64 <= 0.005 * steps as f64);
}

#[test]
fn a_recording_is_played_fast_and_in_real_time() {
    let spec = scenario(2, 6.0);
    let scenario = Scenario::new(spec.clone()).unwrap();
    let (first, _, robots) = faulty::start(&spec, Faults::NONE);
    let (ticks, ..) = run(&scenario, &first, &StopSwitch::default(), |_| {});
    robots.join().unwrap();
    let recorded = ticks.len();
    let run_spec = RunFile {
        seed: 1,
        scenario: spec,
        disturbances: Disturbances::default(),
        link: Some(first),
    };
    let table = LoggedRun {
        judged: None,
        spec: run_spec,
        ticks,
        started_unix_s: None,
    }
    .to_table()
    .unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.mcap");
    let mut out = std::fs::File::create(&file).unwrap();
    write(&table, LogFormat::Mcap, &mut out).unwrap();
    for (pace, least_s, most_s) in [(Pace::Fast, 0.0, 2.0), (Pace::RealTime, 5.0, 9.0)] {
        let poses = PosesSpec::Recording(RecordingSpec {
            file: file.clone(),
            pace,
        });
        let start = Instant::now();
        let again = link(2, poses, CommandsSpec::None);
        let (ticks, summary, report) = run(&scenario, &again, &StopSwitch::default(), |_| {});
        let took_s = start.elapsed().as_secs_f64();
        assert!((least_s..most_s).contains(&took_s), "{took_s} s");
        assert_eq!(report.ending, Ending::Finished);
        assert_eq!(summary.safe, Some(true));
        assert!(ticks.len() > recorded * 9 / 10);
        let seen = ticks.iter().filter(|tick| tick.seen.is_some()).count();
        assert!(seen > recorded * 8 / 10, "{seen} of {recorded}");
    }
}

#[test]
fn a_program_is_the_robots() {
    let robots = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/robots.py");
    if !has_python() {
        return;
    }
    let program = PosesSpec::Program(ProgramSpec {
        command: vec!["python3".to_owned(), robots.to_owned()],
        latency_s: 0.0,
    });
    let mut spec = Testbed::Robotarium
        .scenario("track", Preset::Hardened)
        .unwrap();
    spec.duration_s = 5.0;
    let scenario = Scenario::new(spec).unwrap();
    let link = link(2, program, CommandsSpec::Program);
    let (_, summary, report) = run(&scenario, &link, &StopSwitch::default(), |_| {});
    assert_eq!(report.ending, Ending::Finished);
    assert!(report.untold.is_empty() && summary.safe == Some(true));
    assert!(summary.mean_speed_mps > 0.05, "{}", summary.mean_speed_mps);
}

#[test]
fn a_program_that_ends_before_the_start_is_an_error() {
    let program = PosesSpec::Program(ProgramSpec {
        command: ["sh", "-c", "echo; exec sleep 0.2"]
            .map(str::to_owned)
            .to_vec(),
        latency_s: 0.0,
    });
    let scenario = Scenario::new(scenario(2, 5.0)).unwrap();
    let link = link(2, program, CommandsSpec::Program);
    let session = Session {
        scenario: &scenario,
        link: &link,
    };
    let error = session.run(&StopSwitch::default(), |_| {}).unwrap_err();
    assert!(error.to_string().contains("1 malformed") || error.to_string().contains("1 packets"));
}

#[test]
fn a_program_gives_the_poses_of_robots_that_hear_elsewhere() {
    if !has_python() {
        return;
    }
    let robots = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/robots.py");
    let program = PosesSpec::Program(ProgramSpec {
        command: vec!["python3".to_owned(), robots.to_owned()],
        latency_s: 0.0,
    });
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.set_nonblocking(true).unwrap();
    let address = socket.local_addr().unwrap();
    let commands = CommandsSpec::JsonUdp(JsonCommandsSpec { address });
    let scenario = Scenario::new(scenario(2, 3.0)).unwrap();
    let link = link(2, program, commands);
    let (ticks, _, report) = run(&scenario, &link, &StopSwitch::default(), |_| {});
    assert_eq!(report.ending, Ending::Finished);
    assert!(report.untold.is_empty());
    let mut buffer = [0; 1024];
    let told = std::iter::from_fn(|| socket.recv_from(&mut buffer).ok());
    assert!(told.count() >= ticks.len() / 2);
}

#[test]
fn a_program_that_ends_leaves_robots_that_may_move_and_no_safe_verdict() {
    if !has_python() {
        return;
    }
    let robots = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/robots.py");
    let program = PosesSpec::Program(ProgramSpec {
        command: ["timeout", "-s", "KILL", "4", "python3", robots]
            .map(str::to_owned)
            .to_vec(),
        latency_s: 0.0,
    });
    let scenario = Scenario::new(scenario(2, 10.0)).unwrap();
    let link = link(2, program, CommandsSpec::Program);
    let (_, summary, report) = run(&scenario, &link, &StopSwitch::default(), |_| {});
    assert!(matches!(report.ending, Ending::Lost(_)), "{report:?}");
    assert_eq!(report.untold, [1, 2]);
    assert_eq!(summary.verdict, Verdict::NotKnown);
    let doubt = "robot 1 may not have got the command to stand";
    assert!(report.doubts.iter().any(|text| text == doubt), "{report:?}");
}
