//! NatNet datagrams: what is written is read, and nothing else is.

use proptest::prelude::*;
use testbed_io::live::natnet::{
    Body, Frame, Malformed, Message, Stamps, Version, decode, encode_frame,
};

use natnet_filler::{Filler, frame_with};

#[path = "../live/natnet_filler.rs"]
pub(crate) mod natnet_filler;

pub(crate) const VERSIONS: [Version; 13] = [
    Version::new(2, 0),
    Version::new(2, 1),
    Version::new(2, 3),
    Version::new(2, 5),
    Version::new(2, 6),
    Version::new(2, 7),
    Version::new(2, 9),
    Version::new(2, 10),
    Version::new(2, 11),
    Version::new(3, 0),
    Version::new(3, 1),
    Version::new(4, 0),
    Version::new(4, 1),
];

/// What a version has no field for is left out, so that it can be compared after a round trip.
fn carried(mut frame: Frame, version: Version) -> Frame {
    if version < Version::new(2, 7) {
        frame.timestamp_s = frame.timestamp_s.map(|time_s| f64::from(time_s as f32));
    }
    if version < Version::new(2, 6) {
        frame.timestamp_s = None;
        for body in frame.bodies.iter_mut().filter(|body| !body.tracked) {
            body.mean_error_m = 0.0;
        }
    }
    if version < Version::new(3, 0) {
        frame.stamps = None;
    }
    frame
}

pub(crate) fn decoded(datagram: &[u8], version: Version) -> Frame {
    match decode(datagram, version) {
        Ok(Message::Frame(frame)) => frame,
        other => panic!("{version}: {other:?}"),
    }
}

fn bodies() -> impl Strategy<Value = Body> {
    let position_m = prop::array::uniform3(-9.0_f32..9.0);
    let quaternion = prop::array::uniform4(-1.0_f32..1.0);
    let error = 1e-6_f32..0.01;
    (any::<u32>(), position_m, quaternion, error, any::<bool>()).prop_map(
        |(id, position_m, quaternion, mean_error_m, tracked)| Body {
            id,
            position_m,
            quaternion,
            mean_error_m,
            tracked,
        },
    )
}

fn frames() -> impl Strategy<Value = Frame> {
    let stamps = prop::array::uniform3(any::<u64>());
    let bodies = prop::collection::vec(bodies(), 0..6);
    (any::<u32>(), bodies, -1e6_f64..1e6, stamps).prop_map(
        |(number, bodies, timestamp_s, [mid_exposure, received, transmit])| Frame {
            number,
            bodies,
            timestamp_s: Some(timestamp_s),
            stamps: Some(Stamps {
                mid_exposure,
                received,
                transmit,
            }),
        },
    )
}

fn fillers() -> impl Strategy<Value = Filler> {
    let counts = prop::array::uniform8(0_u32..4);
    (counts, any::<bool>()).prop_map(|([a, b, c, d, e, f, g, h], precise_4_0)| Filler {
        marker_sets: a,
        unlabelled: b,
        body_markers: c,
        skeletons: d,
        assets: e,
        labelled: f,
        force_plates: g,
        devices: h,
        precise_4_0,
    })
}

pub(crate) fn some_frame() -> Frame {
    let body = |id: u32, tracked| Body {
        id,
        position_m: [0.5 * id as f32, 0.1, -1.5],
        quaternion: [0.0, 0.6, 0.0, 0.8],
        mean_error_m: 0.0004,
        tracked,
    };
    Frame {
        number: 4711,
        bodies: vec![body(1, true), body(2, false), body(3, true)],
        timestamp_s: Some(3426.5),
        stamps: Some(Stamps {
            mid_exposure: 34_264_900_000,
            received: 34_264_930_000,
            transmit: 34_264_960_000,
        }),
    }
}

proptest! {
    #[test]
    fn frames_are_read_as_written(frame in frames()) {
        for version in VERSIONS {
            let read = decoded(&encode_frame(&frame, version), version);
            prop_assert_eq!(&read, &carried(frame.clone(), version));
            prop_assert_eq!(decoded(&encode_frame(&read, version), version), read);
        }
    }

    #[test]
    fn everything_else_in_frames_is_skipped(frame in frames(), filler in fillers()) {
        for version in VERSIONS {
            let read = decoded(&frame_with(&frame, version, &filler), version);
            prop_assert_eq!(read, carried(frame.clone(), version));
        }
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        for version in VERSIONS {
            let _ = decode(&bytes, version);
            let mut frame = vec![7, 0];
            frame.extend(u16::try_from(bytes.len()).unwrap().to_le_bytes());
            frame.extend(&bytes);
            let _ = decode(&frame, version);
        }
    }
}

/// Empty frames of a version are what both encoders agree on.
#[test]
fn the_encoder_writes_what_the_protocol_says() {
    for version in VERSIONS {
        let mut frame = some_frame();
        frame.bodies.clear();
        let datagram = encode_frame(&frame, version);
        let with_nothing = frame_with(&frame, version, &Filler::default());
        assert_eq!(datagram.len(), with_nothing.len(), "{version}");
    }
}

#[test]
fn prefixes_are_malformed() {
    for version in VERSIONS {
        let whole = frame_with(&some_frame(), version, &Filler::SOME);
        for length in 0..whole.len() {
            let mut prefix = whole[..length].to_vec();
            assert!(decode(&prefix, version).is_err(), "{version}: {length}");
            // The same cut with a header that fits it
            if length >= 4 {
                let size = u16::try_from(length - 4).unwrap();
                prefix[2..4].copy_from_slice(&size.to_le_bytes());
                assert!(decode(&prefix, version).is_err(), "{version}: {length}");
            }
        }
        let mut longer = whole;
        longer.push(0);
        assert!(decode(&longer, version).is_err(), "{version}");
    }
}

#[test]
fn flipped_bytes_do_no_harm() {
    let (mut read, mut refused) = (0, 0);
    for version in VERSIONS {
        let whole = frame_with(&some_frame(), version, &Filler::SOME);
        for index in 0..whole.len() {
            for flip in [0x01, 0x80, 0xff] {
                let mut flipped = whole.clone();
                flipped[index] ^= flip;
                match decode(&flipped, version) {
                    Ok(_) => read += 1,
                    Err(_) => refused += 1,
                }
            }
        }
    }
    println!("flipped bytes: {read} read, {refused} refused");
    assert!(refused > 0);
}

/// Versions whose frames with rigid bodies have the same bytes.
fn layout(version: Version) -> usize {
    let changes = [
        (2, 1),
        (2, 3),
        (2, 6),
        (2, 7),
        (2, 9),
        (2, 11),
        (3, 0),
        (4, 1),
    ];
    let later = |(major, minor): &(u8, u8)| version >= Version::new(*major, *minor);
    changes.iter().filter(|change| later(change)).count()
}

#[test]
fn frames_of_another_version_are_malformed() {
    let (mut tries, mut through) = (0, Vec::new());
    let mut frame = some_frame();
    for bodies in 1..=3 {
        frame.bodies.truncate(4 - bodies);
        for filler in [Filler::default(), Filler::SOME] {
            for (written, read) in pairs().filter(|(a, b)| layout(*a) != layout(*b)) {
                tries += 1;
                if decode(&frame_with(&frame, written, &filler), read).is_ok() {
                    through.push((written, read, frame.bodies.len()));
                }
            }
        }
    }
    println!(
        "frames with bodies as another version: {} of {tries} read",
        through.len()
    );
    assert!(through.is_empty(), "{through:?}");
}

fn pairs() -> impl Iterator<Item = (Version, Version)> {
    let with = |written| VERSIONS.into_iter().map(move |read| (written, read));
    VERSIONS.into_iter().flat_map(with)
}

#[test]
fn empty_frames_of_another_version_are_mostly_malformed() {
    let (mut tries, mut through) = (0, Vec::new());
    let mut frame = some_frame();
    frame.bodies.clear();
    for (written, read) in pairs().filter(|(a, b)| layout(*a) != layout(*b)) {
        tries += 1;
        if decode(&encode_frame(&frame, written), read).is_ok() {
            through.push((written.to_string(), read.to_string()));
        }
    }
    println!(
        "empty frames as another version: {} of {tries} read: {through:?}",
        through.len()
    );
    assert!(through.len() * 10 < tries);
}

#[test]
fn other_versions_are_refused_by_name() {
    let frame = encode_frame(&some_frame(), Version::new(4, 1));
    for version in [Version::new(1, 9), Version::new(4, 2), Version::new(0, 0)] {
        assert_eq!(decode(&frame, version), Err(Malformed::Version(version)));
    }
    let reason = Malformed::Version(Version::new(4, 2)).to_string();
    assert_eq!(reason, "NatNet 4.2 is not read, only 2.0 to 4.1");
    assert!(Version::new(2, 10) > Version::new(2, 9));
}

#[test]
fn counts_are_checked_before_anything_is_allocated() {
    for version in VERSIONS {
        let mut datagram = encode_frame(&some_frame(), version);
        let sections = if version >= Version::new(4, 1) { 16 } else { 8 };
        let count = 8 + sections;
        datagram[count..count + 4].copy_from_slice(&u32::MAX.to_le_bytes());
        let refused = decode(&datagram, version);
        let is_count = matches!(
            refused,
            Err(Malformed::Count {
                count: u32::MAX,
                ..
            })
        );
        assert!(is_count, "{version}: {refused:?}");
    }
}

/// Without a flag, a mean error of zero or no position means that the cameras do not see the body.
#[test]
fn bodies_without_a_flag_are_tracked_if_their_markers_were_measured() {
    let version = Version::new(2, 5);
    let mut frame = some_frame();
    frame.bodies[0].mean_error_m = 0.0;
    frame.bodies[2].position_m = [0.0, -0.0, 0.0];
    let read = decoded(&frame_with(&frame, version, &Filler::default()), version);
    assert!(read.bodies.iter().all(|body| !body.tracked));
    frame.bodies[2].position_m = [0.0, -0.0, 1e-6];
    let read = decoded(&frame_with(&frame, version, &Filler::default()), version);
    assert!(read.bodies[2].tracked);
}
