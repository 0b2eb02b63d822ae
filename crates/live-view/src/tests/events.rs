//! What comes of snapshots, notes and the end.

use std::io::{ErrorKind, Read as _};
use std::net::{Ipv4Addr, TcpStream};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::{Events, PATIENCE, Served};
use crate::{RobotNow, Snapshot};

fn snapshot(time_s: f64) -> Snapshot {
    let robot = RobotNow {
        id: 1,
        outcome: "braking-stale-pose".to_owned(),
        lane_clearance_m: Some(f64::NAN),
        ..RobotNow::default()
    };
    Snapshot {
        time_s,
        duration_s: 60.0,
        robots: vec![robot; 6],
        dropped: [("out of order", 2)].into(),
        ..Snapshot::default()
    }
}

#[test]
fn events_bring_the_newest() {
    let served = Served::local();
    served.view.note("before");
    let mut events = served.events("");
    let hello = events.next("hello");
    assert_eq!(hello["title"], "A <title>");
    assert_eq!(hello["lane"]["half_width_m"], 0.07);
    assert_eq!(hello["may_stop"], false);
    assert_eq!(events.next("note")["text"], "before");
    for step in 0..300 {
        served.view.show(snapshot(f64::from(step)));
        std::thread::sleep(Duration::from_millis(1));
    }
    served.view.note("two\nlines");
    let mut seen = 0;
    loop {
        let snapshot = events.next("snapshot");
        seen += 1;
        assert_eq!(snapshot["robots"][5]["outcome"], "braking-stale-pose");
        assert!(snapshot["robots"][0]["lane_clearance_m"].is_null());
        assert_eq!(snapshot["dropped"]["out of order"], 2);
        if snapshot["time_s"] == 299.0 {
            break;
        }
    }
    assert!(seen < 50, "{seen}");
    let note = events.next("note");
    assert_eq!(note["text"], "two\nlines");
    assert_eq!(note["index"], 2);

    served.view.ended("finished");
    assert_eq!(events.next("end"), "finished");
    let mut late = served.events("");
    assert_eq!(late.next("hello")["session"], hello["session"]);
    assert_eq!(late.next("snapshot")["time_s"], 299.0);
    assert_eq!(late.next("note")["text"], "before");
    assert_eq!(late.next("end"), "finished");
    let mut rest = String::new();
    late.stream.read_to_string(&mut rest).unwrap();
}

#[test]
fn one_stream_too_many_is_refused() {
    let served = Served::local();
    let mut streams: Vec<Events> = (0..16).map(|_| served.events("")).collect();
    for events in &mut streams {
        events.next("hello");
    }
    assert_eq!(served.ask("GET /events", &[]).0, 503);
    assert_eq!(served.ask("GET /", &[]).0, 200);
    streams.pop();
    let start = Instant::now();
    while served.events("").status() != 200 {
        assert!(start.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Fifteen pages take nothing; the sixteenth gets the newest all the same.
#[test]
fn slow_pages_hold_up_nobody() {
    let served = Served::local();
    let slow: Vec<Events> = (0..15).map(|_| served.events("")).collect();
    let mut events = served.events("");
    for step in 1..=5 {
        let mut shown = snapshot(f64::from(step));
        shown.robots = vec![shown.robots[0].clone(); 20_000];
        served.view.show(shown);
        while events.next("snapshot")["time_s"] != f64::from(step) {}
    }
    let right = format!("Authorization: Bearer {}", served.control());
    assert_eq!(served.ask("POST /stop", &[&right]).0, 200);
    drop(slow);
}

#[test]
fn dropping_is_quick_and_reported() {
    let served = Served::local();
    let mut events = served.events("");
    events.next("hello");
    let idle = served.connect();
    served.view.show(snapshot(7.0));
    let start = Instant::now();
    drop(served.view);
    let took = start.elapsed();
    println!("dropped in {took:?}");
    assert!(took < Duration::from_secs(1), "{took:?}");
    assert_eq!(events.next("snapshot")["time_s"], 7.0);
    assert_eq!(events.next("end"), "closed");
    drop(idle);
    let refused = TcpStream::connect((Ipv4Addr::LOCALHOST, served.port)).unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::ConnectionRefused);
}

/// While the server takes the snapshot before.
#[test]
fn showing_does_not_wait() {
    let served = Served::local();
    let mut events = served.events("");
    events.next("hello");
    let slot = Arc::clone(&served.view.slot);
    std::thread::scope(|scope| {
        let held = slot.lock().unwrap();
        let showing = scope.spawn(|| served.view.show(snapshot(1.0)));
        let start = Instant::now();
        while !showing.is_finished() && start.elapsed() < PATIENCE {
            std::thread::sleep(Duration::from_millis(1));
        }
        let is_shown = showing.is_finished();
        drop(held);
        assert!(is_shown);
    });
    served.view.show(snapshot(2.0));
    let newest = events.next("snapshot");
    assert_eq!(newest["time_s"], 2.0, "the one before is left out");
}
