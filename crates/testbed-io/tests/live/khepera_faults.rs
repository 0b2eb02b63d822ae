//! A minute with two Khepera in which everything goes wrong that can.

use std::net::UdpSocket;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use testbed_io::RunFile;
use testbed_io::live::natnet::{Body, Frame, Message, Version, decode, encode_frame};
use testbed_io::live::{Ending, StopSwitch};
use testbed_io::log_file::{Journal, read};
use testbed_sim::Disturbances;

use super::testbed::{IDS, KheperaTestbed, run};

/// The watchdog of the hardened preset, a period, and the time of a packet on a busy machine.
const STATED: Duration = Duration::from_millis(300 + 20 + 60);
const OUTAGE: Duration = Duration::from_secs(2);

/// What happens when; each thing happens once.
struct Plan(Vec<Event>);

type Event = (f64, Box<dyn FnMut(&KheperaTestbed) + Send>);

impl Plan {
    fn due(&mut self, time_s: f64, testbed: &KheperaTestbed) {
        while self.0.first().is_some_and(|(at_s, _)| time_s >= *at_s) {
            let (at_s, mut act) = self.0.remove(0);
            println!("at {at_s} s");
            act(testbed);
        }
    }
}

fn at(time_s: f64, act: impl FnMut(&KheperaTestbed) + Send + 'static) -> Event {
    (time_s, Box::new(act))
}

/// Each packet is lost, repeated, or overtaken by the next, with a probability of 0.3 each.
fn unreliable() -> impl FnMut(Vec<u8>) -> Vec<Vec<u8>> + Send {
    let mut random = 1_u32;
    let mut chance = move || {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (random >> 16) % 100 < 30
    };
    let mut late = Vec::new();
    move |packet: Vec<u8>| {
        let mut out = Vec::new();
        if !chance() {
            out.push(packet.clone());
            if chance() {
                out.push(packet.clone());
            }
            if chance() {
                std::mem::swap(&mut late, &mut out);
            }
            out.append(&mut late);
        }
        out
    }
}

/// The robots' names exchanged, as when a tracker mixes markers up.
fn exchanged(version: Version) -> impl FnMut(Vec<u8>) -> Vec<Vec<u8>> + Send {
    move |packet| match decode(&packet, version) {
        Ok(Message::Frame(mut frame)) => {
            for body in &mut frame.bodies {
                body.id = match body.id {
                    id if id == IDS[0] => IDS[1],
                    id if id == IDS[1] => IDS[0],
                    id => id,
                };
            }
            vec![encode_frame(&frame, version)]
        }
        _ => vec![packet],
    }
}

/// Numbers that are none, in every position.
fn not_numbers(version: Version) -> impl FnMut(Vec<u8>) -> Vec<Vec<u8>> + Send {
    move |packet| match decode(&packet, version) {
        Ok(Message::Frame(mut frame)) => {
            for body in &mut frame.bodies {
                body.position_m[0] = f32::NAN;
            }
            vec![encode_frame(&frame, version)]
        }
        _ => vec![packet],
    }
}

fn garbage() -> impl FnMut(Vec<u8>) -> Vec<Vec<u8>> + Send {
    let mut number = 0_u8;
    move |packet| {
        number = number.wrapping_add(1);
        let cut = packet[..packet.len() * usize::from(number % 16) / 16].to_vec();
        let noise = packet
            .iter()
            .map(|byte| byte.wrapping_mul(number))
            .collect();
        vec![cut, noise]
    }
}

/// What somebody else says of the robots.
fn elsewhere(time_s: f64) -> Frame {
    let body = |id| Body {
        id,
        position_m: [0.0, 0.0, 0.9],
        quaternion: [0.0, 0.0, 0.0, 1.0],
        mean_error_m: 1e-4,
        tracked: true,
    };
    Frame {
        number: 1,
        bodies: IDS.map(body).to_vec(),
        timestamp_s: Some(time_s),
        stamps: None,
    }
}

fn as_it_is(packet: Vec<u8>) -> Vec<Vec<u8>> {
    vec![packet]
}

#[test]
fn a_minute_of_faults() {
    let (before, after) = (Version::new(3, 1), Version::new(2, 9));
    let testbed = KheperaTestbed::start(before, 60.0);
    // Times at which robots cannot be seen, after which they have to be told to stand.
    let blind: Arc<Mutex<Vec<(Instant, Instant)>>> = Arc::default();
    let blinded = |span: Duration| {
        let blind = Arc::clone(&blind);
        move || {
            let now = Instant::now();
            blind.lock().unwrap().push((now, now + span));
        }
    };
    let (outage, swap, numbers, noise) = (
        blinded(OUTAGE),
        blinded(OUTAGE),
        blinded(OUTAGE),
        blinded(OUTAGE),
    );
    let stranger = UdpSocket::bind("127.0.0.2:0").unwrap();
    let mut plan = Plan(vec![
        at(3.0, |t| {
            t.server.tamper(unreliable());
            t.robots.wireless.lost_percent.store(30, Ordering::Relaxed);
        }),
        at(13.0, |t| {
            t.server.tamper(as_it_is);
            t.robots.wireless.lost_percent.store(0, Ordering::Relaxed);
        }),
        at(15.0, move |t| {
            outage();
            t.server.silence(true);
        }),
        at(17.0, |t| t.server.silence(false)),
        at(20.0, move |t| t.server.set_version(after)),
        at(24.0, move |t| {
            swap();
            t.server.tamper(exchanged(after));
        }),
        at(26.0, |t| t.server.tamper(as_it_is)),
        at(29.0, move |t| {
            noise();
            t.server.tamper(garbage());
        }),
        at(31.0, |t| t.server.tamper(as_it_is)),
        at(34.0, move |t| {
            numbers();
            t.server.tamper(not_numbers(after));
        }),
        at(36.0, |t| t.server.tamper(as_it_is)),
        at(39.0, |t| t.server.set_clock_offset_s(3600.0)),
        at(42.0, |t| t.server.set_clock_offset_s(-3600.0)),
        at(45.0, |t| t.server.set_clock_offset_s(0.0)),
    ]);
    let started = Instant::now();
    let (ticks, summary, report) = testbed.run(|time_s| {
        plan.due(time_s, &testbed);
        if (48.0..52.0).contains(&time_s) {
            let frame = encode_frame(&elsewhere(time_s), after);
            let _ = stranger.send_to(&frame, ("127.0.0.1", testbed.data_port));
        }
    });
    let least = testbed.world.least();
    println!("{least:?} {summary:?} after {:?}", started.elapsed());
    assert_eq!(report.ending, Ending::Finished);
    assert!(report.untold.is_empty());
    assert!(testbed.world.stands());
    assert!(least.headway_m >= 0.0 && least.lane_clearance_m >= 0.0);
    assert_eq!(ticks.len() % 2, 0);
    for (from, to) in blind.lock().unwrap().iter() {
        assert!(testbed.world.told_to_stand(*from + STATED, *to));
    }
    let received = report.received;
    for (what, count) in [
        ("old", received.old),
        ("jump or overlapping", received.jump + received.overlapping),
        ("malformed", received.malformed),
        ("not finite", received.not_finite),
        ("stamp or clock", received.stamp + received.clock_jumps),
        ("other robot", received.other_robot),
        ("stranger", received.stranger),
    ] {
        assert!(count > 0, "{what}");
    }
    // They drive again after all of it.
    let late = ticks.iter().filter(|tick| tick.time_s > 55.0);
    let mean = late
        .clone()
        .map(|t| t.decision.speeds.speed_mps)
        .sum::<f64>()
        / late.count() as f64;
    assert!(mean > 0.05, "{mean}");
}

#[test]
fn a_stopped_session_has_a_whole_log() {
    let testbed = KheperaTestbed::start(Version::new(4, 1), 60.0);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.partial.csv");
    let spec = RunFile {
        seed: 1,
        scenario: testbed.scenario.spec().clone(),
        disturbances: Disturbances::default(),
        link: Some(testbed.link.clone()),
    };
    let journal = Journal::create(&file, &spec).unwrap();
    let stop = StopSwitch::default();
    let mut asked = None;
    let session = testbed_io::live::Session {
        scenario: &testbed.scenario,
        link: &testbed.link,
    };
    let mut steps = 0;
    let ended = session.run(&stop, |update| {
        if let testbed_io::live::Update::Step { ticks, .. } = update {
            assert!(journal.add(ticks, 1e9));
            steps += 1;
            if ticks[0].time_s > 4.0 && asked.is_none() {
                // What is in the file now is what a kill would leave.
                std::thread::sleep(Duration::from_millis(5));
                let log = read(&file).unwrap().run_log().unwrap();
                assert!(log.rows.len() >= 2 * (steps - 1));
                asked = Some(Instant::now());
                stop.stop();
            }
        }
    });
    let report = ended.unwrap().1;
    let stopped = asked.unwrap() + Duration::from_millis(40);
    assert_eq!(report.ending, Ending::Stopped);
    assert!(report.untold.is_empty());
    assert!(testbed.world.told_to_stand(stopped, Instant::now()));
    assert!(testbed.world.stands());
    journal.finish().unwrap();
    let table = read(&file).unwrap();
    assert!(!table.truncated());
    let log = table.run_log().unwrap();
    assert_eq!(log.rows.len(), 2 * steps);
    let replay = log.replay().unwrap();
    assert_eq!((replay.decisions, replay.different), (2 * steps, 0));
}

#[test]
fn a_panic_stops_the_robots() {
    let testbed = KheperaTestbed::start(Version::new(4, 1), 60.0);
    let panicked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        run(
            &testbed.scenario,
            &testbed.link,
            &StopSwitch::default(),
            |time_s| {
                assert!(time_s < 3.0, "for the test");
            },
        )
    }));
    assert!(panicked.is_err());
    assert!(testbed.world.told(0).len() > 100);
    assert!(testbed.world.stands());
}

#[test]
fn robots_stand_while_the_loop_hangs() {
    let testbed = KheperaTestbed::start(Version::new(4, 1), 8.0);
    let mut hung = None;
    let (_, _, report) = testbed.run(|time_s| {
        if time_s > 3.0 && hung.is_none() {
            let start = Instant::now();
            std::thread::sleep(OUTAGE);
            hung = Some((start, Instant::now()));
        }
    });
    let (from, to) = hung.unwrap();
    let told = testbed.world.told(0);
    let meanwhile = told.iter().filter(|told| told.at > from && told.at < to);
    assert!(meanwhile.count() > 20);
    assert!(testbed.world.told_to_stand(from + STATED, to));
    assert!(testbed.world.least().lane_clearance_m >= 0.0);
    assert!(report.deadlines.missed > 50);
    assert_eq!(report.ending, Ending::Finished);
}

#[test]
fn a_tracker_that_is_gone_ends_the_session() {
    let mut testbed = KheperaTestbed::start(Version::new(4, 1), 60.0);
    testbed.link.lost_after_s = 1.0;
    let mut gone = None;
    let (_, _, report) = testbed.run(|time_s| {
        if time_s > 3.0 && gone.is_none() {
            gone = Some(Instant::now());
            testbed.server.silence(true);
        }
    });
    assert!(matches!(report.ending, Ending::Lost(_)));
    assert!(
        testbed
            .world
            .told_to_stand(gone.unwrap() + STATED, Instant::now())
    );
    assert!(testbed.world.stands());
}

#[test]
fn robots_that_do_not_answer_end_the_session_and_are_named() {
    let mut testbed = KheperaTestbed::start(Version::new(4, 1), 60.0);
    testbed.link.lost_after_s = 1.0;
    let (_, _, report) = testbed.run(|time_s| {
        if time_s > 3.0 {
            testbed
                .robots
                .wireless
                .lost_percent
                .store(100, Ordering::Relaxed);
        }
    });
    assert!(matches!(report.ending, Ending::Lost(_)));
    let mut untold = report.untold.clone();
    untold.sort_unstable();
    assert_eq!(untold, [3, 7]);
    // They stop by themselves.
    assert!(testbed.world.stands());
}
