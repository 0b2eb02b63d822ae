//! A session that waits for its first poses, and whose other side goes away meanwhile.

use std::time::{Duration, Instant};

use testbed_io::live::poses::ProgramSpec;
use testbed_io::live::robotarium::RobotariumSpec;
use testbed_io::live::{CommandsSpec, LinkSpec, PosesSpec, Session, StopSwitch, Update};
use unicycle_cbf::{Preset, Scenario, Testbed};

use super::mosquitto::Mosquitto;

fn link(poses: PosesSpec, commands: CommandsSpec) -> LinkSpec {
    LinkSpec {
        robots: vec![4, 9],
        lost_after_s: 2.0,
        arena: None,
        poses,
        commands,
    }
}

fn program(script: &str) -> LinkSpec {
    let poses = PosesSpec::Program(ProgramSpec {
        command: ["sh", "-c", script].map(str::to_owned).to_vec(),
        latency_s: 0.0,
    });
    link(poses, CommandsSpec::Program)
}

/// What a session ends with, after which time in s, and its notes.
fn error(link: &LinkSpec) -> (String, f64, Vec<String>) {
    let spec = Testbed::Robotarium.scenario("track", Preset::Hardened);
    let scenario = Scenario::new(spec.unwrap()).unwrap();
    let session = Session {
        scenario: &scenario,
        link,
    };
    let (start, mut notes) = (Instant::now(), Vec::new());
    let error = session.run(&StopSwitch::default(), |update| {
        if let Update::Note(text) = update {
            notes.push(text.to_string());
        }
    });
    let error = error.unwrap_err().to_string();
    let took_s = start.elapsed().as_secs_f64();
    println!("{took_s:.2} s: {error}; {notes:?}");
    (error, took_s, notes)
}

#[test]
fn a_broker_that_goes_ends_a_session_that_waits() {
    for commands in [CommandsSpec::Robotarium, CommandsSpec::None] {
        let Some(mut broker) = Mosquitto::start() else {
            return;
        };
        let spec = RobotariumSpec {
            port: broker.port(),
            ..RobotariumSpec::default()
        };
        let link = link(PosesSpec::Robotarium(spec), commands);
        let killer = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_secs(1));
            broker.kill();
        });
        let (error, took_s, _) = error(&link);
        killer.join().unwrap();
        assert!(error.contains("the broker: silent for "), "{error}");
        assert!((2.5..20.0).contains(&took_s), "{took_s}");
    }
}

#[test]
fn a_program_that_ends_ends_a_session_that_waits() {
    let (error, took_s, _) = error(&program("sleep 0.5"));
    assert!(error.contains("program `sh`: has ended before"), "{error}");
    assert!(took_s < 4.0, "{took_s}");
}

#[test]
fn what_robots_do_before_they_are_ready_is_told_once() {
    let line = r#"{"getting_ready": "robots drive to their starts"}"#;
    let script = format!("for i in 1 2 3; do echo '{line}'; sleep 0.1; done");
    let (_, _, notes) = error(&program(&script));
    let told = notes.iter().filter(|note| note.contains("robots drive"));
    assert_eq!(told.count(), 1, "{notes:?}");
}

#[test]
fn robots_that_cannot_start_there_are_named_by_their_ids_and_once() {
    let poses = |x: [f64; 2]| {
        let line =
            |robot: u32, x: f64| format!(r#"{{"robot": {robot}, "x": {x}, "y": 0, "theta": 0}}"#);
        let lines = [line(4, x[0]), line(9, x[1])].join("\n");
        program(&format!("while echo '{lines}'; do sleep 0.02; done"))
    };
    // The path goes through (-0.25, 0), and the point that is controlled is 0.04 m ahead of the axle.
    let (off, ..) = error(&poses([-0.6, 0.21]));
    assert!(off.contains("robot 4: 0.310 m off the path"), "{off}");
    assert_eq!(off.matches("robot ").count(), 1, "{off}");
}
