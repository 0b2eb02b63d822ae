//! A broker that dies, comes back, or falls silent, and clients that do.

use std::io::Write;
use std::net::TcpListener;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use testbed_io::live::Clock;
use testbed_io::live::robotarium::connect;
use unicycle_cbf::Speeds;

use crate::mosquitto::Mosquitto;
use crate::mqtt::{IDS, PERIOD_S, age_s, drive, driving, inbox, pause, peer, spec, took_s};
use crate::proxy::Proxy;
use crate::robotarium_peer::{PeerSpec, Received};

/// A command may be this old when it leaves.
const OLDEST_S: f64 = 0.2;

/// On the peer's clock, in s
fn given_s(command: &Received) -> f64 {
    command.speeds.turn_rate_rad_s
}

#[test]
fn no_old_command_after_the_broker_was_away() {
    let Some(mut broker) = Mosquitto::start() else {
        return;
    };
    let peer = peer(broker.port(), PeerSpec::default());
    let inbox = inbox();
    let mut robotarium = connect(&spec(broker.port()), &IDS, inbox.clone()).unwrap();
    drive(&mut robotarium, peer.clock(), 0.5);
    broker.kill();
    drive(&mut robotarium, peer.clock(), 2.0);
    assert!(robotarium.disconnected_for_s().unwrap() > 1.8);
    let before = IDS.map(|id| peer.commands(id).len());
    let restart_s = peer.clock().now_s();
    broker.restart();
    let restarted = Instant::now();
    let mut back_s = None;
    while restarted.elapsed().as_secs_f64() < 1.5 {
        drive(&mut robotarium, peer.clock(), PERIOD_S);
        if robotarium.connected() {
            back_s.get_or_insert(restarted.elapsed().as_secs_f64());
        }
    }
    pause(0.1);
    println!("back after {back_s:?} s");
    assert!(back_s.unwrap() < 1.0);
    for (id, before) in IDS.into_iter().zip(before) {
        let commands = peer.commands(id).split_off(before);
        assert!(commands.len() > 10, "{}", commands.len());
        let fresh = |command: &Received| given_s(command) > restart_s - OLDEST_S;
        assert!(driving(&commands).iter().all(fresh), "{commands:?}");
    }
    let notes = inbox.notes();
    assert_eq!(notes.len(), 2, "{notes:?}");
    assert!(notes[0].ends_with("was lost") && notes[1].ends_with("is back"));
}

#[test]
fn broker_stops_robots_of_a_client_that_died() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    let peer = peer(broker.port(), PeerSpec::default());
    let proxy = Proxy::start(broker.port());
    let mut robotarium = connect(&spec(proxy.port()), &IDS, inbox()).unwrap();
    drive(&mut robotarium, peer.clock(), 0.5);
    proxy.cut();
    let stopped_s = IDS.map(|id| {
        took_s(2.0, || {
            peer.commands(id).last().unwrap().speeds == Speeds::ZERO
        })
    });
    println!("stopped by the broker after {stopped_s:?} s");
    assert!(stopped_s.iter().all(|stopped_s| *stopped_s < 0.2));
    assert_eq!(robotarium.stop(Duration::from_millis(300)), [0, 1]);
}

#[test]
fn broker_stops_robots_of_a_process_that_was_killed() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    let peer = peer(broker.port(), PeerSpec::default());
    let mut process = Command::new(std::env::current_exe().unwrap())
        .args([
            "mqtt_faults::drives_until_it_is_killed",
            "--exact",
            "--ignored",
        ])
        .env("ROBOTARIUM_PORT", broker.port().to_string())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let moving = || IDS.iter().all(|id| peer.standing_since_s(*id).is_none());
    took_s(5.0, moving);
    process.kill().unwrap();
    let stopped_s = took_s(2.0, || {
        IDS.iter().all(|id| peer.standing_since_s(*id).is_some())
    });
    process.wait().unwrap();
    println!("standing after {stopped_s:.3} s");
    assert!(stopped_s < 0.2);
}

#[test]
#[ignore = "run by the test that kills it"]
fn drives_until_it_is_killed() {
    let Some(port) = std::env::var_os("ROBOTARIUM_PORT") else {
        return;
    };
    let port = port.to_str().unwrap().parse().unwrap();
    let mut robotarium = connect(&spec(port), &IDS, inbox()).unwrap();
    drive(&mut robotarium, Clock::start(), 10.0);
}

#[test]
fn broker_stops_robots_of_a_client_that_is_silent() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    let peer = peer(broker.port(), PeerSpec::default());
    let proxy = Proxy::start(broker.port());
    let mut robotarium = connect(&spec(proxy.port()), &IDS, inbox()).unwrap();
    drive(&mut robotarium, peer.clock(), 0.5);
    proxy.silence();
    let noticed_s = took_s(2.0, || !robotarium.connected());
    let stopped_s = took_s(9.0, || {
        IDS.iter()
            .all(|id| peer.commands(*id).last().unwrap().speeds == Speeds::ZERO)
    });
    println!("noticed after {noticed_s:.2} s, stopped by the broker {stopped_s:.2} s later");
    assert!(noticed_s < 1.0);
    proxy.cut();
}

#[test]
fn silence_holds_back_one_command_at_most() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    let peer = peer(broker.port(), PeerSpec::default());
    let proxy = Proxy::start(broker.port());
    let mut robotarium = connect(&spec(proxy.port()), &IDS, inbox()).unwrap();
    drive(&mut robotarium, peer.clock(), 0.5);
    for silent_s in [0.3, 1.5] {
        let before = IDS.map(|id| peer.commands(id).len());
        proxy.silence();
        drive(&mut robotarium, peer.clock(), silent_s);
        let resume_s = peer.clock().now_s();
        proxy.resume();
        drive(&mut robotarium, peer.clock(), 1.5);
        for (id, before) in IDS.into_iter().zip(before) {
            let commands = driving(&peer.commands(id).split_off(before));
            let (oldest, fresh) = commands.split_first().unwrap();
            let is_fresh = |command: &Received| given_s(command) > resume_s - OLDEST_S;
            assert!(fresh.iter().all(is_fresh), "{commands:?}");
            println!(
                "after {silent_s} s of silence one {:.2} s old",
                age_s(oldest)
            );
            assert!(fresh.len() > 10, "{}", fresh.len());
        }
        assert!(robotarium.connected());
    }
}

#[test]
fn stop_says_which_robots_it_did_not_reach() {
    let Some(mut broker) = Mosquitto::start() else {
        return;
    };
    let peer = peer(broker.port(), PeerSpec::default());
    let mut robotarium = connect(&spec(broker.port()), &IDS, inbox()).unwrap();
    drive(&mut robotarium, peer.clock(), 0.2);
    broker.kill();
    let start = Instant::now();
    assert_eq!(robotarium.stop(Duration::from_millis(500)), [0, 1]);
    assert!(start.elapsed() < Duration::from_secs(2));
    broker.restart();
    // Robots may not be back yet when the connection is.
    assert!(robotarium.stop(Duration::from_secs(1)).is_empty());
    assert!(start.elapsed() > Duration::from_secs(1));
    took_s(0.2, || {
        IDS.iter().all(|id| peer.standing_since_s(*id).is_some())
    });
}

#[test]
fn a_server_that_is_no_broker_does_no_harm() {
    let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let port = listener.local_addr().unwrap().port();
    std::thread::spawn(move || {
        for (client, byte) in listener.incoming().zip(0_u8..) {
            let mut client = client.unwrap();
            let _ = client.write_all(&[0x20, 2, 0, 0]);
            let _ = client.write_all(&[byte.wrapping_mul(7) ^ 0x90; 300]);
        }
    });
    let error = connect(&spec(port), &IDS, inbox()).unwrap_err();
    println!("{error}");
}

#[test]
fn a_command_that_could_not_leave_is_forgotten() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    let peer = peer(broker.port(), PeerSpec::default());
    let proxy = Proxy::start(broker.port());
    let mut robotarium = connect(&spec(proxy.port()), &IDS, inbox()).unwrap();
    proxy.cut();
    took_s(1.0, || !robotarium.connected());
    drive(&mut robotarium, peer.clock(), 0.1);
    pause(0.5);
    proxy.resume();
    took_s(2.0, || robotarium.connected());
    pause(0.5);
    for id in IDS {
        assert!(driving(&peer.commands(id)).is_empty());
    }
}

#[test]
fn broker_stops_robots_that_could_not_be_told() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    let peer = peer(broker.port(), PeerSpec::default());
    let proxy = Proxy::start(broker.port());
    let mut robotarium = connect(&spec(proxy.port()), &IDS, inbox()).unwrap();
    drive(&mut robotarium, peer.clock(), 0.2);
    proxy.silence();
    drive(&mut robotarium, peer.clock(), 0.1);
    assert_eq!(robotarium.stop(Duration::from_millis(100)), [0, 1]);
    drop(robotarium);
    proxy.resume();
    took_s(1.0, || {
        IDS.iter().all(|id| peer.standing_since_s(*id).is_some())
    });
}
