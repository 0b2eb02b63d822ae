//! From messages to datagrams.

use super::decode::{NAME_BYTES, seems_tracked};
use super::frame::{Body, Frame, Message, ServerInfo, Stamps, Version};

/// How this client calls itself.
const CLIENT: &str = "drivekit";

/// Asks the server who it is and, in unicast, for frames; for frames of another version than its own with `wanted`, which
/// servers from 3.0 can do in unicast.
#[must_use]
pub fn encode_connect(wanted: Option<Version>) -> Vec<u8> {
    let mut payload = padded(CLIENT);
    let spoken = Version::NEWEST;
    payload.extend([0, 1, 0, 0, spoken.major, spoken.minor, 0, 0]);
    if let Some(Version { major, minor }) = wanted {
        // All data and not only what was subscribed to; the version; an end
        payload.extend([0, major, minor, 0, 0, 0]);
    }
    message(Message::CONNECT, &payload)
}

/// Tells a unicast server that the client is still there.
#[must_use]
pub fn encode_keep_alive() -> Vec<u8> {
    message(Message::KEEP_ALIVE, &[])
}

/// What a server answers to a connect. Without a channel from 3.0 it is not valid.
#[must_use]
pub fn encode_server_info(info: &ServerInfo) -> Vec<u8> {
    let mut payload = padded(&info.name);
    payload.extend(info.program);
    payload.extend([info.version.major, info.version.minor, 0, 0]);
    if let Some(channel) = &info.channel {
        payload.extend(channel.clock_hz.to_le_bytes());
        payload.extend(channel.port.to_le_bytes());
        payload.push(u8::from(channel.multicast));
        payload.extend(channel.group.octets());
    }
    message(Message::SERVER_INFO, &payload)
}

/// A frame as a server of `version` would send it, without anything but rigid bodies.
///
/// What the version has no field for is not written; what it has a field for and the frame not is written as zero. Below
/// 2.6, where there is no flag, an untracked body gets a mean error of zero.
#[must_use]
pub fn encode_frame(frame: &Frame, version: Version) -> Vec<u8> {
    let mut payload = frame.number.to_le_bytes().to_vec();
    // Marker sets and unlabelled markers
    section(&mut payload, version, 0, &[]);
    section(&mut payload, version, 0, &[]);
    let mut bodies = Vec::new();
    for body in &frame.bodies {
        write_body(&mut bodies, body, version);
    }
    section(&mut payload, version, frame.bodies.len(), &bodies);
    let assets = Version::SIZES;
    for since in [
        Version::SKELETONS,
        assets,
        Version::LABELLED_MARKERS,
        Version::FORCE_PLATES,
        Version::DEVICES,
    ] {
        if version >= since {
            section(&mut payload, version, 0, &[]);
        }
    }
    write_suffix(&mut payload, frame, version);
    message(Message::FRAME, &payload)
}

fn section(payload: &mut Vec<u8>, version: Version, count: usize, content: &[u8]) {
    payload.extend(low_u32(count));
    if version >= Version::SIZES {
        payload.extend(low_u32(content.len()));
    }
    payload.extend(content);
}

fn write_body(payload: &mut Vec<u8>, body: &Body, version: Version) {
    payload.extend(body.id.to_le_bytes());
    let numbers = body.position_m.iter().chain(&body.quaternion);
    payload.extend(numbers.flat_map(|number| number.to_le_bytes()));
    if version < Version::STAMPS {
        payload.extend(0_u32.to_le_bytes());
    }
    let flagged = version >= Version::FLAGS;
    let tracked = body.tracked || !seems_tracked(body.position_m, body.mean_error_m);
    let mean_error_m = match flagged || tracked {
        true => body.mean_error_m,
        false => 0.0,
    };
    payload.extend(mean_error_m.to_le_bytes());
    if flagged {
        payload.extend(u16::from(body.tracked).to_le_bytes());
    }
}

fn write_suffix(payload: &mut Vec<u8>, frame: &Frame, version: Version) {
    if version < Version::STAMPS {
        payload.extend(0_f32.to_le_bytes());
    }
    if version >= Version::TIMECODE {
        payload.extend([0; 8]);
    }
    let timestamp_s = frame.timestamp_s.unwrap_or_default();
    if version >= Version::DOUBLE_TIMESTAMP {
        payload.extend(timestamp_s.to_le_bytes());
    } else if version >= Version::FLAGS {
        payload.extend((timestamp_s as f32).to_le_bytes());
    }
    if version >= Version::STAMPS {
        let none = Stamps {
            mid_exposure: 0,
            received: 0,
            transmit: 0,
        };
        let stamps = frame.stamps.unwrap_or(none);
        for stamp in [stamps.mid_exposure, stamps.received, stamps.transmit] {
            payload.extend(stamp.to_le_bytes());
        }
    }
    if version >= Version::SIZES {
        payload.extend([0; 8]);
    }
    if version >= Version::FLAGS {
        payload.extend([0; 2]);
    }
    payload.extend([0; 4]);
}

/// A name in its field; the last byte stays zero.
fn padded(name: &str) -> Vec<u8> {
    let mut field: Vec<u8> = name.bytes().take(NAME_BYTES - 1).collect();
    field.resize(NAME_BYTES, 0);
    field
}

fn message(id: u16, payload: &[u8]) -> Vec<u8> {
    let [low, high, ..] = low_u32(payload.len());
    let [id_low, id_high] = id.to_le_bytes();
    let mut message = vec![id_low, id_high, low, high];
    message.extend(payload);
    message
}

/// No datagram is so long that a number in it needs more.
fn low_u32(number: usize) -> [u8; 4] {
    let [a, b, c, d, ..] = (number as u64).to_le_bytes();
    [a, b, c, d]
}
