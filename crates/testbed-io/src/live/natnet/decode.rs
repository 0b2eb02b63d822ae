//! From datagrams to messages.
//!
//! Only rigid bodies and times are kept. Every byte is accounted for all the same: a frame of another version than the one
//! it is read as has, as a rule, bytes too few or too many.

use super::cursor::Cursor;
use super::frame::{Body, Channel, Frame, Malformed, Message, ServerInfo, Stamps, Version};

/// Bytes of the name in a server info.
pub(super) const NAME_BYTES: usize = 256;
/// Bytes of a position.
const POSITION_BYTES: usize = 12;
/// Bytes of the flags of a frame and its end tag.
const END_BYTES: usize = 6;

/// Reads a datagram of a server whose frames are of `version`.
///
/// # Errors
/// If it is anything but one whole message.
pub fn decode(datagram: &[u8], version: Version) -> Result<Message, Malformed> {
    let mut cursor = Cursor::new(datagram);
    let id = cursor.u16()?;
    let said = usize::from(cursor.u16()?);
    let came = cursor.left();
    if said != came {
        return Err(Malformed::Size { said, came });
    }
    let message = match id {
        Message::SERVER_INFO => Message::ServerInfo(server_info(&mut cursor)?),
        Message::FRAME => Message::Frame(frame(&mut cursor, version)?),
        other => return Ok(Message::Other(other)),
    };
    match cursor.left() {
        0 => Ok(message),
        rest => Err(Malformed::Rest(rest)),
    }
}

/// Whether a datagram says that it is a frame.
pub(super) fn is_frame(datagram: &[u8]) -> bool {
    Cursor::new(datagram).u16() == Ok(Message::FRAME)
}

fn server_info(cursor: &mut Cursor<'_>) -> Result<ServerInfo, Malformed> {
    // Old bytes can follow the end of the name.
    let mut field = Cursor::new(cursor.take(NAME_BYTES)?);
    let name = String::from_utf8_lossy(field.name()?).into_owned();
    let program = cursor.array()?;
    let [major, minor, ..] = cursor.array::<4>()?;
    let version = Version { major, minor };
    let channel = (version >= Version::STAMPS).then(|| channel(cursor));
    if version > Version::NEWEST {
        // What newer servers append is not known, and their version must be known to be refused.
        cursor.skip(cursor.left())?;
    }
    Ok(ServerInfo {
        name,
        program,
        version,
        channel: channel.transpose()?,
    })
}

fn channel(cursor: &mut Cursor<'_>) -> Result<Channel, Malformed> {
    Ok(Channel {
        clock_hz: cursor.u64()?,
        port: cursor.u16()?,
        multicast: cursor.u8()? != 0,
        group: cursor.array::<4>()?.into(),
    })
}

fn frame(cursor: &mut Cursor<'_>, version: Version) -> Result<Frame, Malformed> {
    if !version.is_supported() {
        return Err(Malformed::Version(version));
    }
    let number = cursor.u32()?;
    skip_section(cursor, version, 5, skip_marker_set)?;
    skip_section(cursor, version, POSITION_BYTES, |cursor| {
        cursor.skip(POSITION_BYTES)
    })?;
    let bodies = bodies(cursor, version)?;
    if version >= Version::SKELETONS {
        skip_section(cursor, version, 8, |cursor| skip_skeleton(cursor, version))?;
    }
    if version >= Version::SIZES {
        skip_sized(cursor)?;
    }
    if version >= Version::LABELLED_MARKERS {
        let bytes = labelled_marker_bytes(version);
        skip_section(cursor, version, bytes, |cursor| cursor.skip(bytes))?;
    }
    if version >= Version::FORCE_PLATES {
        skip_section(cursor, version, 8, skip_analog)?;
    }
    if version >= Version::DEVICES {
        skip_section(cursor, version, 8, skip_analog)?;
    }
    let (timestamp_s, stamps) = suffix(cursor, version)?;
    Ok(Frame {
        number,
        bodies,
        timestamp_s,
        stamps,
    })
}

/// Skips a section of things of at least `bytes` each.
fn skip_section(
    cursor: &mut Cursor<'_>,
    version: Version,
    bytes: usize,
    skip: impl Fn(&mut Cursor<'_>) -> Result<(), Malformed>,
) -> Result<(), Malformed> {
    if version >= Version::SIZES {
        return skip_sized(cursor);
    }
    for _ in 0..cursor.count(bytes)? {
        skip(cursor)?;
    }
    Ok(())
}

fn skip_sized(cursor: &mut Cursor<'_>) -> Result<(), Malformed> {
    let _count = cursor.u32()?;
    let size = cursor.size()?;
    cursor.skip(size)
}

fn skip_marker_set(cursor: &mut Cursor<'_>) -> Result<(), Malformed> {
    let _name = cursor.name()?;
    let count = cursor.count(POSITION_BYTES)?;
    cursor.skip(count * POSITION_BYTES)
}

fn skip_skeleton(cursor: &mut Cursor<'_>, version: Version) -> Result<(), Malformed> {
    let _id = cursor.u32()?;
    for _ in 0..cursor.count(body_bytes(version))? {
        body(cursor, version)?;
    }
    Ok(())
}

/// A force plate or a device: channels of samples.
fn skip_analog(cursor: &mut Cursor<'_>) -> Result<(), Malformed> {
    let _id = cursor.u32()?;
    for _ in 0..cursor.count(4)? {
        let samples = cursor.count(4)?;
        cursor.skip(samples * 4)?;
    }
    Ok(())
}

fn labelled_marker_bytes(version: Version) -> usize {
    let flags = if version >= Version::FLAGS { 2 } else { 0 };
    let residual = if version >= Version::STAMPS { 4 } else { 0 };
    20 + flags + residual
}

fn bodies(cursor: &mut Cursor<'_>, version: Version) -> Result<Vec<Body>, Malformed> {
    let count = cursor.u32()?;
    let size = match version >= Version::SIZES {
        true => Some(cursor.u32()?),
        false => None,
    };
    let before = cursor.left();
    let count = cursor.fits(count, body_bytes(version))?;
    let mut bodies = Vec::with_capacity(count);
    for _ in 0..count {
        bodies.push(body(cursor, version)?);
    }
    let found = before - cursor.left();
    match size {
        Some(said) if usize::try_from(said) != Ok(found) => Err(Malformed::Section { said, found }),
        _ => Ok(bodies),
    }
}

/// Bytes of a body without markers.
fn body_bytes(version: Version) -> usize {
    let markers = if version < Version::STAMPS { 4 } else { 0 };
    let flags = if version >= Version::FLAGS { 2 } else { 0 };
    36 + markers + flags
}

fn body(cursor: &mut Cursor<'_>, version: Version) -> Result<Body, Malformed> {
    let id = cursor.u32()?;
    let position_m = cursor.floats()?;
    let quaternion = cursor.floats()?;
    if version < Version::STAMPS {
        // Positions, ids and sizes
        let bytes = POSITION_BYTES + 8;
        let markers = cursor.count(bytes)?;
        cursor.skip(markers * bytes)?;
    }
    let mean_error_m = cursor.f32()?;
    let tracked = match version >= Version::FLAGS {
        true => cursor.u16()? & 1 == 1,
        false => seems_tracked(position_m, mean_error_m),
    };
    Ok(Body {
        id,
        position_m,
        quaternion,
        mean_error_m,
        tracked,
    })
}

/// Without a flag: those servers send a mean error of exactly zero, with the last pose or with none, for a body that the
/// cameras lost, and measured markers never fit exactly.
pub(super) fn seems_tracked(position_m: [f32; 3], mean_error_m: f32) -> bool {
    let is_zero = |value: f32| value.to_bits() << 1 == 0;
    !is_zero(mean_error_m) && !position_m.into_iter().all(is_zero)
}

/// Time stamp and stamps, with everything around them up to the end tag.
fn suffix(
    cursor: &mut Cursor<'_>,
    version: Version,
) -> Result<(Option<f64>, Option<Stamps>), Malformed> {
    if version < Version::STAMPS {
        let _latency = cursor.f32()?;
    }
    if version >= Version::TIMECODE {
        cursor.skip(8)?;
    }
    let timestamp_s = if version >= Version::DOUBLE_TIMESTAMP {
        Some(cursor.f64()?)
    } else if version >= Version::FLAGS {
        Some(f64::from(cursor.f32()?))
    } else {
        None
    };
    let stamps = (version >= Version::STAMPS).then(|| stamps(cursor));
    let stamps = stamps.transpose()?;
    if version >= Version::SIZES || version >= Version::PRECISION && cursor.left() > END_BYTES {
        cursor.skip(8)?;
    }
    if version >= Version::FLAGS {
        cursor.skip(2)?;
    }
    match cursor.u32()? {
        0 => Ok((timestamp_s, stamps)),
        tag => Err(Malformed::EndTag(tag)),
    }
}

fn stamps(cursor: &mut Cursor<'_>) -> Result<Stamps, Malformed> {
    Ok(Stamps {
        mid_exposure: cursor.u64()?,
        received: cursor.u64()?,
        transmit: cursor.u64()?,
    })
}
