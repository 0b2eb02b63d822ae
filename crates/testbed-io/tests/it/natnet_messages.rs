//! NatNet messages other than frames, and frames by other hands.

use std::net::Ipv4Addr;

use ::natnet::command::keepalive_datagram;
use ::natnet::{PlannedBody, SyntheticServer};
use testbed_io::live::natnet::{
    Channel, Malformed, Message, ServerInfo, Version, decode, encode_connect, encode_frame,
    encode_keep_alive, encode_server_info,
};

use super::natnet::natnet_filler::{Filler, frame_with};
use super::natnet::{VERSIONS, decoded, some_frame};

fn some_info(version: Version) -> ServerInfo {
    let channel = Channel {
        clock_hz: 10_000_000,
        port: 1511,
        multicast: true,
        group: Ipv4Addr::new(239, 255, 42, 99),
    };
    ServerInfo {
        name: "Motive".to_owned(),
        program: [2, 1, 0, 0],
        version,
        channel: (version >= Version::new(3, 0)).then_some(channel),
    }
}

#[test]
fn server_infos_are_read_as_written() {
    for version in VERSIONS {
        let info = some_info(version);
        let datagram = encode_server_info(&info);
        assert_eq!(
            decode(&datagram, Version::OLDEST),
            Ok(Message::ServerInfo(info))
        );
        for length in 0..datagram.len() {
            assert!(decode(&datagram[..length], version).is_err());
        }
    }
    let mut endless = encode_server_info(&some_info(Version::new(2, 9)));
    endless[4..260].fill(b'x');
    assert_eq!(decode(&endless, Version::OLDEST), Err(Malformed::Name));
    let mut newer = encode_server_info(&some_info(Version::new(4, 9)));
    newer.extend([1, 2, 3]);
    newer[2..4].copy_from_slice(&282_u16.to_le_bytes());
    let Ok(Message::ServerInfo(info)) = decode(&newer, Version::OLDEST) else {
        panic!("newer servers must be known to be refused");
    };
    assert!(!info.version.is_supported());
}

#[test]
fn commands_have_the_bytes_that_servers_expect() {
    let connect = encode_connect(None);
    assert_eq!(connect.len(), 268);
    assert_eq!(connect[..4], [0, 0, 8, 1]);
    let wanted = encode_connect(Some(Version::new(4, 1)));
    assert_eq!(
        (wanted.len(), &wanted[268..273]),
        (274, &[0, 4, 1, 0, 0][..])
    );
    assert_eq!(encode_keep_alive(), keepalive_datagram());
}

#[test]
fn frames_of_the_crate_natnet_have_the_same_bodies() {
    let planned = [
        PlannedBody::tracked(7, [0.25, 0.1, -0.5], [0.0, 0.6, 0.0, 0.8]),
        PlannedBody::dropout(8),
    ];
    let versions = [(3, 0), (3, 1), (4, 0), (4, 1)];
    for (major, minor) in versions {
        let spoken = ::natnet::Version::new(major, minor, 0, 0);
        let server = SyntheticServer::new(spoken, 1_000_000).with_clock_offset_secs(0.5);
        let datagram = server.datagram(42, 2.5, &planned).unwrap();
        let version = Version::new(major, minor);
        let read = decoded(&datagram, version);
        assert_eq!(read.number, 42);
        assert_eq!(read.timestamp_s, Some(3.0));
        assert_eq!(read.stamps.unwrap().transmit, 2_500_000);
        let ids: Vec<(u32, bool)> = read.bodies.iter().map(|b| (b.id, b.tracked)).collect();
        assert_eq!(ids, [(7, true), (8, false)]);
        assert_eq!(read.bodies[0].position_m, planned[0].position);
        assert_eq!(read.bodies[0].quaternion, planned[0].orientation);
        let again = ::natnet::FrameOfData::parse(&encode_frame(&read, version), spoken).unwrap();
        assert_eq!(again.rigid_bodies[0].id, 7);
        assert_eq!(again.timing.transmit, 2_500_000);
    }
}

/// The hand-written sections of our test frames are what the other reader expects, to the byte.
#[test]
fn the_crate_natnet_reads_our_test_frames() {
    for (major, minor) in [(3, 0), (3, 1), (4, 0), (4, 1)] {
        let datagram = frame_with(&some_frame(), Version::new(major, minor), &Filler::SOME);
        let version = ::natnet::Version::new(major, minor, 0, 0);
        let strict = ::natnet::ParsePolicy::Strict;
        let frame = ::natnet::FrameOfData::parse_with_policy(&datagram, version, strict).unwrap();
        assert_eq!(frame.rigid_bodies.len(), 3);
        assert_eq!(frame.labeled_markers.len(), 5);
        assert_eq!((frame.skeletons.count, frame.devices.count), (2, 2));
    }
}
