//! A minute with two robots of the Robotarium behind a broker.

use std::net::UdpSocket;

use testbed_io::live::commands::RobotariumUdpSpec;
use testbed_io::live::robotarium::RobotariumSpec;
use testbed_io::live::{Arena, CommandsSpec, Ending, LinkSpec, LiveReport, PosesSpec, StopSwitch};
use testbed_sim::{Summary, Tick};
use unicycle_cbf::{Pose, Preset, Scenario, Speeds, Testbed};

use super::mosquitto::Mosquitto;
use super::robotarium_peer::{PeerSpec, RobotariumPeer};
use super::testbed::run;

const IDS: [u32; 2] = [4, 9];

struct RobotariumTestbed {
    scenario: Scenario,
    link: LinkSpec,
    peer: RobotariumPeer,
}

impl RobotariumTestbed {
    fn start(broker: &Mosquitto, duration_s: f64, older: bool) -> Self {
        let mut spec = Testbed::Robotarium
            .scenario("track", Preset::Hardened)
            .unwrap();
        spec.duration_s = duration_s;
        let scenario = Scenario::new(spec).unwrap();
        let starts: Vec<(u32, Pose)> = IDS.into_iter().zip(scenario.starts().to_vec()).collect();
        let body = scenario.controller().body();
        let peer = RobotariumPeer::start(
            broker.port(),
            &starts,
            PeerSpec {
                wheel_base_m: body.wheel_base_m,
                older,
                ..PeerSpec::default()
            },
        );
        let link = LinkSpec {
            robots: IDS.to_vec(),
            lost_after_s: 5.0,
            arena: Some(Arena {
                x_m: [-1.6, 1.6],
                y_m: [-1.0, 1.0],
            }),
            poses: PosesSpec::Robotarium(RobotariumSpec {
                port: broker.port(),
                latency_s: 0.0,
                ..RobotariumSpec::default()
            }),
            commands: CommandsSpec::Robotarium,
        };
        Self {
            scenario,
            link,
            peer,
        }
    }

    fn run(&self, each: impl FnMut(f64) + Send) -> (Vec<Tick>, Summary, LiveReport) {
        run(&self.scenario, &self.link, &StopSwitch::default(), each)
    }

    fn assert_safe(&self, summary: &Summary) {
        let nearest_m = self.peer.nearest_m(IDS[0], IDS[1]);
        println!("nearest {nearest_m} m, {summary:?}");
        assert_eq!(summary.safe, Some(true));
        for id in IDS {
            assert_eq!(self.peer.commands(id).last().unwrap().speeds, Speeds::ZERO);
        }
    }
}

#[test]
fn a_minute_at_30_hz() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    let testbed = RobotariumTestbed::start(&broker, 60.0, false);
    let (ticks, summary, report) = testbed.run(|_| {});
    assert_eq!(report.ending, Ending::Finished);
    assert!(report.untold.is_empty());
    testbed.assert_safe(&summary);
    assert!(summary.mean_speed_mps > 0.05);
    let steps = ticks.len() / 2;
    println!("missed {} of {steps}", report.deadlines.missed);
    assert!(report.deadlines.missed as f64 <= 0.005 * steps as f64);
    for (robot, id) in IDS.into_iter().enumerate() {
        let told = testbed.peer.commands(id);
        let sent = ticks.iter().filter(|tick| tick.robot == robot);
        // Robots are told to stand until it is their turn.
        let moves = |speeds: Vec<Speeds>| -> Vec<Speeds> {
            let stands = |speeds: &Speeds| *speeds == Speeds::ZERO;
            speeds.into_iter().skip_while(stands).collect()
        };
        let sent = moves(sent.map(|tick| tick.decision.speeds).collect());
        let got = moves(told.iter().map(|told| told.speeds).collect());
        println!("robot {id}: {} sent, {} got", sent.len(), got.len());
        assert_eq!(got[..sent.len()], sent);
    }
}

/// Nobody can tell the robots anything while the broker is away, and they go on with their last commands: 2 s at 0.1 m/s here. What
/// can be asked is that they hear nothing old, hear something as soon as it is back, and return to their lane.
#[test]
fn an_older_tracker_and_a_broker_that_is_restarted() {
    let Some(mut broker) = Mosquitto::start() else {
        return;
    };
    let testbed = RobotariumTestbed::start(&broker, 25.0, true);
    let mut killed_s = None;
    let mut back_s = None;
    let (ticks, _, report) = testbed.run(|time_s| {
        if time_s > 5.0 && killed_s.is_none() {
            broker.kill();
            killed_s = Some(testbed.peer.clock().now_s());
        }
        if time_s > 7.0 && back_s.is_none() {
            broker.restart();
            back_s = Some(testbed.peer.clock().now_s());
        }
    });
    let (killed_s, back_s) = (killed_s.unwrap(), back_s.unwrap());
    assert_eq!(report.ending, Ending::Finished);
    assert!(report.untold.is_empty());
    assert!(testbed.peer.nearest_m(IDS[0], IDS[1]) > 0.15);
    for id in IDS {
        let told = testbed.peer.commands(id);
        let first = told.iter().find(|told| told.at_s > killed_s + 0.1).unwrap();
        println!("robot {id} hears {first:?}, broker back at {back_s} s");
        assert!(first.at_s - back_s < 1.0);
        assert_eq!(told.last().unwrap().speeds, Speeds::ZERO);
    }
    let blind = ticks
        .iter()
        .filter(|tick| (5.5..7.0).contains(&tick.time_s));
    assert!(
        blind
            .clone()
            .all(|tick| tick.decision.speeds == Speeds::ZERO)
    );
    let late = ticks.iter().filter(|tick| tick.time_s > 20.0);
    let safe = late.clone().filter_map(|tick| tick.truth);
    assert!(safe.clone().count() > 200);
    assert!(safe.clone().all(|truth| truth.safety.lane >= 0.0));
    assert!(
        late.clone()
            .any(|tick| tick.decision.speeds.speed_mps > 0.05)
    );
}

#[test]
fn a_broker_that_stays_away_ends_the_session_and_robots_are_named() {
    let Some(mut broker) = Mosquitto::start() else {
        return;
    };
    let mut testbed = RobotariumTestbed::start(&broker, 60.0, false);
    testbed.link.lost_after_s = 1.0;
    let mut killed = false;
    let (_, _, report) = testbed.run(|time_s| {
        if time_s > 3.0 && !killed {
            killed = true;
            broker.kill();
        }
    });
    assert!(matches!(report.ending, Ending::Lost(_)));
    assert_eq!(report.untold.len(), 2);
}

#[test]
fn robots_of_2018_are_told_over_udp_and_nothing_over_the_broker() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    let mut testbed = RobotariumTestbed::start(&broker, 3.0, true);
    let robots = IDS.map(|_| UdpSocket::bind("127.0.0.1:0").unwrap());
    testbed.link.commands = CommandsSpec::RobotariumUdp(RobotariumUdpSpec {
        addresses: robots.iter().map(|r| r.local_addr().unwrap()).collect(),
        reply_port: 0,
    });
    let (ticks, _, report) = testbed.run(|_| {});
    assert_eq!(report.ending, Ending::Finished);
    for (robot, socket) in robots.iter().enumerate() {
        socket.set_nonblocking(true).unwrap();
        let mut told = Vec::new();
        let mut buffer = [0; 256];
        while let Ok((bytes, _)) = socket.recv_from(&mut buffer) {
            let text = buffer[..bytes].strip_suffix(&[0]).unwrap();
            let message: serde_json::Value = serde_json::from_slice(text).unwrap();
            assert_eq!(message["msgType"], 3);
            told.push(message["v"].as_f64().unwrap());
        }
        let own = ticks.iter().filter(|tick| tick.robot == robot);
        let sent: Vec<f64> = own.map(|tick| tick.decision.speeds.speed_mps).collect();
        let start = told.windows(sent.len()).position(|told| told == sent);
        assert!(start.is_some());
        assert!(told.ends_with(&[0.0; 5]));
    }
    for id in IDS {
        assert!(testbed.peer.commands(id).is_empty());
    }
}

#[test]
fn messages_that_lie_are_not_believed() {
    let Some(broker) = Mosquitto::start() else {
        return;
    };
    let testbed = RobotariumTestbed::start(&broker, 14.0, false);
    let [a, b] = IDS.map(|id| format!("\"{id}\""));
    let mut step = 0;
    let (_, summary, report) = testbed.run(|time_s| {
        let (a, b) = (a.clone(), b.clone());
        if time_s > 3.0 && step == 0 {
            step = 1;
            // Names exchanged, then numbers that are none, cut messages, and a third robot.
            testbed.peer.tamper(move |text| {
                let other = text
                    .replace(&a, "\"?\"")
                    .replace(&b, &a)
                    .replace("\"?\"", &b);
                vec![
                    other.into_bytes(),
                    text.replace("\"x\":", "\"x\":NaN,\"z\":").into_bytes(),
                    text.as_bytes()[..text.len() / 2].to_vec(),
                    text.replace(&a, "\"77\"").into_bytes(),
                ]
            });
        }
        if time_s > 6.0 && step == 1 {
            step = 2;
            testbed.peer.tamper(|text| vec![text.into_bytes()]);
        }
    });
    assert_eq!(report.ending, Ending::Finished);
    testbed.assert_safe(&summary);
    let received = report.received;
    assert!(received.malformed > 0 && received.other_robot > 0);
    assert!(received.jump + received.overlapping > 0);
}
