//! Any bytes as a NatNet datagram, the first two as the version. Nothing may panic; a frame that is read is read again from
//! what is written for it, to the bit.
#![no_main]

use libfuzzer_sys::fuzz_target;
use testbed_io::live::natnet::{
    Message, Up, Version, decode, encode_frame, encode_server_info, floor_pose,
};

const VERSIONS: [(u8, u8); 13] = [
    (2, 0),
    (2, 1),
    (2, 3),
    (2, 5),
    (2, 6),
    (2, 7),
    (2, 9),
    (2, 10),
    (2, 11),
    (3, 0),
    (3, 1),
    (4, 0),
    (4, 1),
];

fuzz_target!(|bytes: &[u8]| {
    let [choice, whole, rest @ ..] = bytes else {
        return;
    };
    let (major, minor) = VERSIONS[usize::from(*choice) % VERSIONS.len()];
    let version = Version { major, minor };
    // Mostly with a header that fits, so that the content is looked at
    let mut datagram = vec![if whole % 8 == 1 { 1 } else { 7 }, 0];
    datagram.extend((rest.len() as u16).to_le_bytes());
    datagram.extend(rest);
    let datagram = if whole % 8 == 0 { rest } else { &datagram };
    match decode(datagram, version) {
        Ok(Message::Frame(frame)) => {
            for body in &frame.bodies {
                let _ = (floor_pose(body, Up::Y), floor_pose(body, Up::Z));
            }
            let written = encode_frame(&frame, version);
            let Ok(Message::Frame(again)) = decode(&written, version) else {
                panic!("what was written is not read");
            };
            assert_eq!(frame.bodies.len(), again.bodies.len());
            // Bytes, because NaN differs from itself
            assert_eq!(written, encode_frame(&again, version));
        }
        Ok(Message::ServerInfo(info)) if info.version <= Version::NEWEST => {
            // A name that is no UTF-8 gets longer and can be cut anywhere.
            if !info.name.contains('\u{fffd}') {
                let written = encode_server_info(&info);
                assert_eq!(decode(&written, version), Ok(Message::ServerInfo(info)));
            }
        }
        _ => {}
    }
});
