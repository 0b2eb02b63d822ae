//! The NatNet client when the server or the network misbehaves.

use std::net::{Ipv4Addr, SocketAddrV4, UdpSocket};
use std::thread;
use std::time::{Duration, Instant};

use testbed_io::live::natnet::{NatNetSpec, Version};

use super::natnet_client::{Client, RATE_HZ, circles, unicast};
use super::natnet_server::{NatNetServer, To};

#[test]
fn another_version_without_notice_is_noticed() {
    let versions = [(2, 9), (3, 1), (2, 5), (4, 1), (4, 0), (2, 1)];
    let server = NatNetServer::start(Version::new(2, 11), RATE_HZ, circles);
    let mut client = Client::start(&unicast(&server));
    client.until_poses();
    let mut before = Version::new(2, 11);
    for (major, minor) in versions {
        let version = Version::new(major, minor);
        let poses = client.counts().poses;
        server.set_version(version);
        let recovered = client.until(|counts| counts.poses >= poses + 10);
        println!("from {before} to {version}: poses again after {recovered:?}");
        assert!(recovered < Duration::from_secs(1), "{version}");
        let note = format!("the NatNet server now speaks {version}, it spoke {before} before");
        assert!(client.notes().contains(&note), "{:?}", client.notes());
        before = version;
    }
    assert!(client.counts().malformed > 0);
}

#[test]
fn versions_that_are_not_read_are_told() {
    let server = NatNetServer::start(Version::new(4, 2), RATE_HZ, circles);
    let mut client = Client::start(&unicast(&server));
    client.until_note("NatNet 4.2 is not read, only 2.0 to 4.1");
    assert_eq!(client.poses_within(Duration::from_millis(100)), 0);
    assert_eq!(client.counts().malformed, 0);
    server.set_version(Version::new(4, 1));
    client.until_poses();
}

#[test]
fn strangers_are_not_heard() {
    let server = NatNetServer::start(Version::new(3, 1), RATE_HZ, circles);
    let taken = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let data_port = taken.local_addr().unwrap().port();
    drop(taken);
    let spec = NatNetSpec {
        data_port,
        ..unicast(&server)
    };
    let mut client = Client::start(&spec);
    client.until_poses();
    let stranger = UdpSocket::bind((Ipv4Addr::new(127, 0, 0, 2), 0)).unwrap();
    for _ in 0..20 {
        let frame = [7, 0, 4, 0, 1, 0, 0, 0];
        stranger
            .send_to(&frame, (Ipv4Addr::LOCALHOST, data_port))
            .unwrap();
    }
    client.until(|counts| counts.stranger == 20);
    // The right address, but not the command port
    let liar = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let mut info = vec![1, 0, 8, 1];
    info.resize(268, 0);
    info[264] = 2;
    liar.send_to(&info, (Ipv4Addr::LOCALHOST, data_port))
        .unwrap();
    client.until(|counts| counts.stranger == 21);
    assert_eq!(client.counts().malformed, 0);
    assert!(!client.notes().contains("now speaks"));
    client.until_poses();
}

#[test]
fn a_server_may_come_late_and_go() {
    let server = NatNetServer::start(Version::new(3, 1), RATE_HZ, circles);
    let spec = unicast(&server);
    let address = SocketAddrV4::new(Ipv4Addr::LOCALHOST, server.command_port());
    drop(server);
    let mut client = Client::start(&spec);
    client.until_note("no answer; does it stream");
    for version in [Version::new(2, 9), Version::new(4, 1)] {
        let server = NatNetServer::start_at(address, To::Clients, version, RATE_HZ, circles);
        let back = client.until_poses();
        println!("server of {version} started: poses after {back:?}");
        assert!(back < Duration::from_secs(1));
        drop(server);
        assert!(client.poses_within(Duration::from_millis(300)) < 10);
    }
}

#[test]
fn outages_and_jumps_of_the_clock_pass() {
    let server = NatNetServer::start(Version::new(3, 1), RATE_HZ, circles);
    let client = Client::start(&unicast(&server));
    client.until_poses();
    server.silence(true);
    let start = Instant::now();
    while client.poses_within(Duration::from_millis(300)) > 0 {
        assert!(start.elapsed().as_secs() < 5);
    }
    server.silence(false);
    client.until_poses();
    for offset_s in [1000.0, -300.0] {
        server.set_clock_offset_s(offset_s);
        let jumps = client.counts().clock_jumps;
        client.until(|counts| counts.clock_jumps > jumps);
        client.until_poses();
    }
}

#[test]
fn lost_repeated_and_cut_frames_do_no_harm() {
    for version in [Version::new(2, 5), Version::new(2, 9), Version::new(3, 1)] {
        let server = NatNetServer::start(version, RATE_HZ, circles);
        let client = Client::start(&unicast(&server));
        client.until_poses();
        let (mut count, mut held) = (0, None);
        server.tamper(move |datagram| {
            count += 1;
            match count % 5 {
                0 => vec![],
                1 => vec![datagram.clone(), datagram],
                2 => vec![datagram[..datagram.len() / 2].to_vec()],
                3 => {
                    held = Some(datagram);
                    vec![]
                }
                // Newer before older
                _ => [Some(datagram), held.take()]
                    .into_iter()
                    .flatten()
                    .collect(),
            }
        });
        let (before, start) = (client.counts(), Instant::now());
        thread::sleep(Duration::from_secs(1));
        let frames = RATE_HZ * start.elapsed().as_secs_f64();
        let after = client.counts();
        // Of five frames, the first and the last are used; a repeated stamp can by rounding seem newer.
        let used = (after.poses - before.poses) as f64 / (2.0 * frames);
        let old = (after.old - before.old) as f64 / frames;
        let cut = (after.malformed - before.malformed) as f64 / frames;
        println!("{version}: used {used:.2}, old {old:.2}, cut {cut:.2} per frame");
        assert!((0.3..0.65).contains(&used) && (0.1..0.3).contains(&cut));
        assert!(old > 0.3);
    }
}

#[test]
fn numbers_that_are_none_are_counted() {
    for version in [Version::new(2, 9), Version::new(4, 1)] {
        let odd = |time_s| {
            let mut robots = circles(time_s);
            robots[0].3 = f64::NAN;
            robots
        };
        let server = NatNetServer::start(version, RATE_HZ, odd);
        let client = Client::start(&unicast(&server));
        client.until_poses();
        assert!(client.inbox.newest()[0].is_none());
        assert!(client.counts().not_finite >= 10);
    }
}
