//! Commands and poses over a broker.

use std::time::{Duration, Instant};

use testbed_io::Error;
use testbed_io::live::robotarium::{Robotarium, RobotariumSpec, connect};
use testbed_io::live::{Arena, Bounds, Clock, Inbox};
use unicycle_cbf::{Pose, Speeds};

use crate::mosquitto::{Mosquitto, free_port};
use crate::robotarium_peer::{PeerSpec, Received, RobotariumPeer};

pub const IDS: [u32; 2] = [5, 12];
pub const PERIOD_S: f64 = 1.0 / 30.0;
/// For a command to arrive on a busy machine.
const OLDEST_S: f64 = 0.5;

pub fn spec(port: u16) -> RobotariumSpec {
    RobotariumSpec {
        port,
        ..RobotariumSpec::default()
    }
}

pub fn inbox() -> Inbox {
    let bounds = Bounds {
        arena: Arena {
            x_m: [-1.6, 1.6],
            y_m: [-1.0, 1.0],
        },
        speed_mps: 0.2,
        turn_rate_rad_s: 3.64,
        wheel_base_m: 0.1,
        wheel_error: 0.1,
        spacing_m: 0.1,
    };
    Inbox::new(Clock::start(), &IDS, bounds)
}

pub fn peer(port: u16, spec: PeerSpec) -> RobotariumPeer {
    let at = |x_m| Pose {
        x_m,
        y_m: 0.2,
        heading_rad: 0.0,
    };
    RobotariumPeer::start(port, &[(5, at(0.4)), (12, at(-0.4))], spec)
}

pub fn pause(seconds: f64) {
    std::thread::sleep(Duration::from_secs_f64(seconds));
}

/// Tells both robots in every period how late it is on this clock, in s as rad/s, so that the age of a command can be seen.
pub fn drive(robotarium: &mut Robotarium, clock: Clock, seconds: f64) {
    let start_s = clock.now_s();
    let mut tick = 0.0;
    while clock.now_s() - start_s < seconds {
        for robot in 0..IDS.len() {
            robotarium.send(robot, stamped(clock.now_s()));
        }
        tick += 1.0;
        clock.sleep_until(start_s + tick * PERIOD_S);
    }
}

pub fn stamped(now_s: f64) -> Speeds {
    Speeds {
        speed_mps: 0.01,
        turn_rate_rad_s: now_s,
    }
}

pub fn driving(commands: &[Received]) -> Vec<Received> {
    let commands = commands.iter().copied();
    commands
        .filter(|command| command.speeds != Speeds::ZERO)
        .collect()
}

pub fn age_s(command: &Received) -> f64 {
    command.at_s - command.speeds.turn_rate_rad_s
}

/// Waits for it, and says how long it took in s.
pub fn took_s(most_s: f64, mut what: impl FnMut() -> bool) -> f64 {
    let start = Instant::now();
    while !what() {
        assert!(start.elapsed().as_secs_f64() < most_s, "not in {most_s} s");
        pause(0.001);
    }
    start.elapsed().as_secs_f64()
}

#[test]
fn poses_arrive() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    for older in [false, true] {
        let spec_of_peer = PeerSpec {
            older,
            ..PeerSpec::default()
        };
        let peer = peer(broker.port(), spec_of_peer);
        let inbox = inbox();
        let robotarium = connect(&spec(broker.port()), &IDS, inbox.clone()).unwrap();
        pause(2.0);
        let counts = inbox.counts();
        let newest = inbox.newest();
        let age_s = inbox.clock().now_s() - newest[1].unwrap().stamp_s;
        assert!((45..=65).contains(&counts.packets), "{counts:?}");
        // The last packet may be half read; on a busy machine two may arrive as one.
        assert!(
            counts.poses + counts.old + 2 >= 2 * counts.packets,
            "{counts:?}"
        );
        assert!(counts.old <= 4, "{counts:?}");
        for (seen, id) in newest.iter().zip(IDS) {
            assert_eq!(seen.unwrap().pose, peer.pose(id));
        }
        assert!((0.03..0.3).contains(&age_s), "{age_s}");
        assert!(robotarium.connected() && inbox.notes().is_empty());
    }
}

#[test]
fn poses_are_quick() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    let peer = peer(broker.port(), PeerSpec::default());
    let clock = peer.clock();
    peer.tamper(move |_| {
        let message = format!(r#"{{"5": {{"x": {}, "y": 0, "theta": 0}}}}"#, clock.now_s());
        vec![message.into_bytes()]
    });
    let bounds = Bounds {
        arena: Arena {
            x_m: [0.0, 1e3],
            y_m: [0.0, 0.0],
        },
        speed_mps: 100.0,
        turn_rate_rad_s: 0.0,
        wheel_base_m: 0.1,
        wheel_error: 0.1,
        spacing_m: 0.0,
    };
    let inbox = Inbox::new(clock, &IDS, bounds);
    let _robotarium = connect(&spec(broker.port()), &IDS, inbox.clone()).unwrap();
    let mut late_s = Vec::new();
    took_s(5.0, || {
        let seen = inbox.newest()[0];
        late_s.extend(seen.map(|seen| seen.stamp_s + 0.03 - seen.pose.x_m));
        late_s.len() == 90
    });
    late_s.sort_by(f64::total_cmp);
    println!(
        "late by {:.4} s, {:.4} s, {:.4} s",
        late_s[0], late_s[45], late_s[89]
    );
    assert!(late_s[45] < 0.02);
}

#[test]
fn every_command_arrives_in_order() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    let peer = peer(broker.port(), PeerSpec::default());
    let mut robotarium = connect(&spec(broker.port()), &IDS, inbox()).unwrap();
    drive(&mut robotarium, peer.clock(), 5.0);
    pause(0.1);
    for id in IDS {
        let commands = peer.commands(id);
        let ages: Vec<f64> = commands.iter().map(age_s).collect();
        let oldest_s = ages.iter().copied().fold(0.0, f64::max);
        println!(
            "{} commands, the oldest {oldest_s:.4} s old",
            commands.len()
        );
        // Where the machine is too busy for a period, the newest wins.
        assert!((135..=151).contains(&commands.len()), "{}", commands.len());
        assert!(commands.is_sorted_by(|a, b| a.speeds.turn_rate_rad_s < b.speeds.turn_rate_rad_s));
        assert!(oldest_s < OLDEST_S);
    }
    assert_eq!(peer.malformed(), 0);
    assert!(peer.nearest_m(5, 12) > 0.5);
}

#[test]
fn robots_stand_after_stop() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    let peer = peer(broker.port(), PeerSpec::default());
    let mut robotarium = connect(&spec(broker.port()), &IDS, inbox()).unwrap();
    drive(&mut robotarium, peer.clock(), 0.5);
    let start = Instant::now();
    assert!(robotarium.stop(Duration::from_secs(2)).is_empty());
    println!("stopped after {:.3} s", start.elapsed().as_secs_f64());
    // A robot that was stopped stays so.
    robotarium.send(0, stamped(1.0));
    pause(0.1);
    let before = IDS.map(|id| peer.commands(id));
    let start = Instant::now();
    drop(robotarium);
    println!("ended after {:.3} s", start.elapsed().as_secs_f64());
    pause(0.1);
    for (id, before) in IDS.into_iter().zip(before) {
        let zeros = before.iter().rev();
        let zeros = zeros.take_while(|command| command.speeds == Speeds::ZERO);
        assert!((3..=10).contains(&zeros.count()), "{before:?}");
        assert_eq!(peer.commands(id), before, "the will is not sent");
        assert!(peer.standing_since_s(id).is_some());
    }
}

#[test]
fn robots_stand_after_drop() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    let peer = peer(broker.port(), PeerSpec::default());
    let mut robotarium = connect(&spec(broker.port()), &IDS, inbox()).unwrap();
    drive(&mut robotarium, peer.clock(), 0.2);
    drop(robotarium);
    took_s(0.2, || {
        IDS.iter().all(|id| peer.standing_since_s(*id).is_some())
    });
}

#[test]
fn bad_messages_are_counted() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    let peer = peer(broker.port(), PeerSpec::default());
    peer.tamper(|message| {
        let cut = message.as_bytes()[..message.len() / 2].to_vec();
        let no_number = message.replace("0.2", "NaN").into_bytes();
        let stranger = message.replace("\"5\"", "\"77\"").into_bytes();
        vec![
            cut,
            no_number,
            vec![b' '; 100_000],
            stranger,
            message.into_bytes(),
        ]
    });
    let inbox = inbox();
    let robotarium = connect(&spec(broker.port()), &IDS, inbox.clone()).unwrap();
    pause(1.0);
    let counts = inbox.counts();
    println!("{counts:?}");
    assert!(counts.poses > 20);
    assert!(counts.malformed >= 3 * (counts.packets / 5));
    assert!(counts.other_robot > 20);
    assert!(robotarium.connected());
}

#[test]
fn sixty_four_robots() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    let ids: Vec<u32> = (1..=64).collect();
    let starts = ids.iter().map(|id| {
        let pose = Pose {
            x_m: f64::from(id % 8),
            y_m: f64::from(id / 8),
            heading_rad: 0.0,
        };
        (*id, pose)
    });
    let starts: Vec<(u32, Pose)> = starts.collect();
    let peer = RobotariumPeer::start(broker.port(), &starts, PeerSpec::default());
    let mut robotarium = connect(&spec(broker.port()), &ids, inbox()).unwrap();
    let (clock, start_s) = (peer.clock(), peer.clock().now_s());
    let mut slowest = Duration::ZERO;
    for tick in 1..=60 {
        let start = Instant::now();
        for robot in 0..ids.len() {
            robotarium.send(robot, stamped(clock.now_s()));
        }
        slowest = slowest.max(start.elapsed());
        clock.sleep_until(start_s + f64::from(tick) * PERIOD_S);
    }
    println!("64 commands given in {slowest:?} at most");
    assert!(robotarium.stop(Duration::from_secs(2)).is_empty());
    pause(0.1);
    for id in ids {
        let commands = driving(&peer.commands(id));
        assert!(commands.len() >= 40, "{}", commands.len());
        assert!(commands.iter().all(|command| age_s(command) < OLDEST_S));
    }
}

#[test]
fn a_wrong_port_is_named() {
    let start = Instant::now();
    let error = connect(&spec(free_port()), &IDS, inbox()).unwrap_err();
    assert!(start.elapsed() < Duration::from_secs(3));
    println!("{error}");
    assert!(matches!(error, Error::Link { .. }));
    assert!(error.to_string().contains("1883"));
}
