//! The NatNet client against a server on the loopback.

use std::net::{Ipv4Addr, SocketAddrV4, UdpSocket};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use testbed_io::Error;
use testbed_io::live::natnet::{NatNetSpec, Transport, Version, start};
use testbed_io::live::{Arena, Bounds, Clock, Counts, Inbox};
use unicycle_cbf::StampedPose;

use super::natnet_server::{AGE_S, NatNetServer, Robot, To};

pub(crate) const RATE_HZ: f64 = 100.0;
const GROUP: Ipv4Addr = Ipv4Addr::new(239, 255, 42, 99);

/// Two robots on circles, of which the server also sees a third that does not take part.
pub(crate) fn circles(time_s: f64) -> Vec<Robot> {
    let robot = |id: i32| {
        let angle_rad = 0.5 * time_s + f64::from(id);
        let (sin, cos) = angle_rad.sin_cos();
        (
            id,
            f64::from(id) * cos,
            f64::from(id) * sin,
            angle_rad,
            true,
        )
    };
    (1..=3).map(robot).collect()
}

pub(crate) fn unicast(server: &NatNetServer) -> NatNetSpec {
    NatNetSpec {
        command_port: server.command_port(),
        data_port: 0,
        transport: Transport::Unicast,
        local: Ipv4Addr::LOCALHOST.into(),
        ..NatNetSpec::new(server.address().ip())
    }
}

/// A client that ends when it is dropped.
pub(crate) struct Client {
    pub(crate) inbox: Inbox,
    notes: Vec<String>,
    thread: Option<JoinHandle<()>>,
}

impl Client {
    pub(crate) fn start(spec: &NatNetSpec) -> Self {
        let bounds = Bounds {
            arena: Arena {
                x_m: [-5.0, 5.0],
                y_m: [-5.0, 5.0],
            },
            speed_mps: 3.0,
            turn_rate_rad_s: 3.0,
            wheel_base_m: 0.1,
            wheel_error: 0.1,
            spacing_m: 0.1,
        };
        let inbox = Inbox::new(Clock::start(), &[1, 2], bounds);
        let thread = start(spec, inbox.clone()).unwrap();
        Self {
            inbox,
            notes: Vec::new(),
            thread: Some(thread),
        }
    }

    pub(crate) fn counts(&self) -> Counts {
        self.inbox.counts()
    }

    /// Poses that arrive within a time.
    pub(crate) fn poses_within(&self, time: Duration) -> u64 {
        let before = self.counts().poses;
        thread::sleep(time);
        self.counts().poses - before
    }

    /// How long it takes until something holds; fails after 3 s.
    pub(crate) fn until(&self, holds: impl Fn(&Counts) -> bool) -> Duration {
        let start = Instant::now();
        while !holds(&self.counts()) {
            assert!(start.elapsed().as_secs() < 3, "{:?}", self.counts());
            thread::sleep(Duration::from_millis(2));
        }
        start.elapsed()
    }

    pub(crate) fn until_poses(&self) -> Duration {
        let before = self.counts().poses;
        self.until(|counts| counts.poses >= before + 10)
    }

    pub(crate) fn newest(&self) -> Vec<StampedPose> {
        let _ = self.inbox.newest();
        self.until_poses();
        self.inbox.newest().into_iter().flatten().collect()
    }

    /// Waits until the user is told; fails after 5 s.
    pub(crate) fn until_note(&mut self, note: &str) {
        let start = Instant::now();
        while !self.notes().contains(note) {
            assert!(start.elapsed().as_secs() < 5, "{:?}", self.notes);
            thread::sleep(Duration::from_millis(2));
        }
    }

    pub(crate) fn notes(&mut self) -> String {
        self.notes.extend(self.inbox.notes());
        self.notes.join("\n")
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        self.inbox.end();
        if let Some(thread) = self.thread.take() {
            let start = Instant::now();
            let ended = thread.join();
            assert!(thread::panicking() || ended.is_ok());
            assert!(thread::panicking() || start.elapsed().as_secs() < 10);
        }
    }
}

#[test]
fn poses_of_every_version_arrive() {
    for (major, minor) in [
        (2, 1),
        (2, 5),
        (2, 6),
        (2, 7),
        (2, 9),
        (2, 11),
        (3, 1),
        (4, 0),
        (4, 1),
    ] {
        let version = Version::new(major, minor);
        let server = NatNetServer::start(version, RATE_HZ, circles);
        let mut client = Client::start(&unicast(&server));
        let first = client.until_poses();
        let newest = client.newest();
        assert_eq!(newest.len(), 2, "{version}");
        for (robot, seen) in newest.iter().enumerate() {
            let radius_m = 1.0 + robot as f64;
            let pose = seen.pose;
            let angle_rad = pose.y_m.atan2(pose.x_m);
            let off_rad = (pose.heading_rad - angle_rad).sin().abs();
            assert!(
                (pose.x_m.hypot(pose.y_m) - radius_m).abs() < 1e-4,
                "{version}"
            );
            assert!(off_rad < 1e-4, "{version}: {off_rad}");
        }
        let age_s = client.inbox.clock().now_s() - newest[0].stamp_s;
        let least_s = if version >= Version::new(3, 0) {
            AGE_S
        } else {
            0.0
        };
        assert!((least_s..0.1).contains(&age_s), "{version}: {age_s}");
        let counts = client.counts();
        println!("{version}: 10 poses after {first:?}, {counts:?}");
        assert_eq!(
            (counts.malformed, counts.stranger, counts.untracked),
            (0, 0, 0)
        );
        assert!(counts.other_robot > 0);
        let notes = client.notes();
        assert_eq!(
            notes,
            format!("the NatNet server loopback speaks {version}")
        );
    }
}

#[test]
fn frames_arrive_by_multicast() {
    let taken = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).unwrap();
    let data_port = taken.local_addr().unwrap().port();
    drop(taken);
    let to = To::Group(SocketAddrV4::new(GROUP, data_port));
    let address = SocketAddrV4::new(Ipv4Addr::LOCALHOST, 0);
    let version = Version::new(3, 1);
    let server = NatNetServer::start_at(address, to, version, RATE_HZ, circles);
    let spec = NatNetSpec {
        data_port,
        transport: Transport::Multicast,
        ..unicast(&server)
    };
    // Two clients share the port.
    let (mut client, other) = (Client::start(&spec), Client::start(&spec));
    let first = client.until_poses();
    other.until_poses();
    println!("multicast: 10 poses after {first:?}");
    assert_eq!(client.notes(), "the NatNet server loopback speaks 3.1");
    drop((client, other));
    let mut wrong = Client::start(&unicast(&server));
    thread::sleep(Duration::from_millis(300));
    assert!(
        wrong
            .notes()
            .contains("sends multicast: set `transport` so")
    );
    assert_eq!(wrong.counts().poses, 0);
}

#[test]
fn untracked_bodies_are_no_poses() {
    for version in [Version::new(2, 5), Version::new(2, 9), Version::new(4, 1)] {
        let half = |time_s| {
            let mut robots = circles(time_s);
            robots[0].4 = false;
            robots
        };
        let server = NatNetServer::start(version, RATE_HZ, half);
        let client = Client::start(&unicast(&server));
        client.until_poses();
        let newest = client.inbox.newest();
        assert!(newest[0].is_none() && newest[1].is_some(), "{version}");
        assert!(client.counts().untracked >= 10);
    }
}

#[test]
fn the_server_is_kept_awake() {
    let server = NatNetServer::start(Version::new(3, 1), RATE_HZ, circles);
    let client = Client::start(&unicast(&server));
    client.until_poses();
    let start = Instant::now();
    while server.heard().0 < 2 || server.heard().1 < 3 {
        assert!(start.elapsed().as_secs() < 20, "{:?}", server.heard());
        thread::sleep(Duration::from_millis(2));
    }
    // One of each a second, and not more often.
    let (connects, keep_alives) = server.heard();
    let most = start.elapsed().as_secs() as u32 + 3;
    println!("{connects} connects, {keep_alives} keep-alives");
    assert!(connects.max(keep_alives) <= most);
}

#[test]
fn what_cannot_be_opened_is_explained() {
    let elsewhere = NatNetSpec {
        local: Ipv4Addr::new(203, 0, 113, 9).into(),
        ..NatNetSpec::new(Ipv4Addr::LOCALHOST.into())
    };
    let no_group = NatNetSpec {
        group: Ipv4Addr::new(10, 0, 0, 1),
        ..NatNetSpec::new(Ipv4Addr::LOCALHOST.into())
    };
    let mixed = NatNetSpec::new(std::net::Ipv6Addr::LOCALHOST.into());
    for (spec, help) in [(elsewhere, "`local`"), (no_group, "group"), (mixed, "IPv4")] {
        let bounds = Bounds {
            arena: Arena {
                x_m: [-5.0, 5.0],
                y_m: [-5.0, 5.0],
            },
            speed_mps: 1.0,
            turn_rate_rad_s: 1.0,
            wheel_base_m: 0.1,
            wheel_error: 0.1,
            spacing_m: 0.1,
        };
        let inbox = Inbox::new(Clock::start(), &[1], bounds);
        let refused = start(&spec, inbox).unwrap_err();
        assert!(matches!(&refused, Error::Link { help: text, .. } if text.contains(help)));
        println!("{refused}");
    }
}

#[test]
fn settings_have_defaults_and_no_others() {
    let spec: NatNetSpec = toml::from_str("server = \"192.168.1.10\"").unwrap();
    assert_eq!(spec, NatNetSpec::new("192.168.1.10".parse().unwrap()));
    let all =
        "server = \"192.168.1.10\"\ntransport = \"unicast\"\nup = \"z\"\nlocal = \"192.168.1.2\"";
    let spec: NatNetSpec = toml::from_str(all).unwrap();
    assert_eq!(
        toml::from_str::<NatNetSpec>(&toml::to_string(&spec).unwrap()).unwrap(),
        spec
    );
    let wrong = toml::from_str::<NatNetSpec>("server = \"192.168.1.10\"\nversion = \"3.1\"");
    assert!(wrong.unwrap_err().to_string().contains("version"));
}
