//! NatNet 4.1 frames of the crate `natnet`.

use natnet::frame::{Asset, Device, ForcePlate, LabeledMarker, MarkerSet, RigidBody, Skeleton};
use natnet::generate::PlannedSections;
use natnet::{PlannedBody, SyntheticServer};

use super::natnet_server::{AGE_S, CLOCK_HZ, Robot, placed};

/// A 4.1 frame by other hands than ours.
pub(crate) fn synthetic(number: u32, server_s: f64, robots: &[Robot]) -> Vec<u8> {
    let bodies: Vec<PlannedBody> = robots
        .iter()
        .map(|robot| {
            let (position, orientation) = placed(robot);
            let mut body = PlannedBody::tracked(robot.0, position, orientation);
            body.tracking_valid = robot.4;
            body
        })
        .collect();
    let version = natnet::Version::V4_1;
    let server = SyntheticServer::new(version, CLOCK_HZ);
    let number = number.cast_signed();
    let frame = server.frame_with_sections(number, server_s, &bodies, &sections());
    let mut frame = frame.unwrap();
    frame.timing.camera_mid_exposure -= (AGE_S * CLOCK_HZ as f64) as u64;
    frame.marker_sets = vec![MarkerSet {
        name: "all".to_owned(),
        markers: vec![[0.5; 3]; 4],
    }];
    frame.other_markers = vec![[1.0; 3]; 2];
    frame.labeled_markers = vec![marker(1), marker(2)];
    frame.to_datagram(version).unwrap()
}

fn marker(id: i32) -> LabeledMarker {
    LabeledMarker {
        id,
        position: [0.25; 3],
        size: 0.014,
        params: 2,
        residual: 0.0004,
    }
}

fn sections() -> PlannedSections {
    let body = RigidBody {
        id: 1,
        position: [0.1; 3],
        orientation: [0.0, 0.0, 0.0, 1.0],
        mean_marker_error: 0.001,
        params: 1,
    };
    let channels = || vec![vec![1.0, 2.0], Vec::new()];
    PlannedSections {
        skeletons: vec![Skeleton {
            id: 1,
            rigid_bodies: vec![body; 3],
        }],
        assets: vec![Asset {
            id: 2,
            rigid_bodies: vec![body],
            markers: vec![marker(3)],
        }],
        force_plates: vec![ForcePlate {
            id: 3,
            channels: channels(),
        }],
        devices: vec![Device {
            id: 4,
            channels: channels(),
        }],
    }
}
