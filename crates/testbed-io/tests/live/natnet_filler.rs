//! Frames with everything in them, written field by field without the encoder under test.

use testbed_io::live::natnet::{Body, Frame, Version};

/// How many of each thing, besides the bodies, a frame holds.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Filler {
    pub(crate) marker_sets: u32,
    pub(crate) unlabelled: u32,
    pub(crate) body_markers: u32,
    pub(crate) skeletons: u32,
    pub(crate) assets: u32,
    pub(crate) labelled: u32,
    pub(crate) force_plates: u32,
    pub(crate) devices: u32,
    /// 4.0 with the precision time stamp that one of the vendor's samples reads
    pub(crate) precise_4_0: bool,
}

impl Filler {
    pub(crate) const SOME: Self = Self {
        marker_sets: 3,
        unlabelled: 4,
        body_markers: 3,
        skeletons: 2,
        assets: 2,
        labelled: 5,
        force_plates: 1,
        devices: 2,
        precise_4_0: false,
    };
}

struct Writer {
    bytes: Vec<u8>,
    version: (u8, u8),
    markers: u32,
}

/// A whole datagram.
pub(crate) fn frame_with(frame: &Frame, version: Version, filler: &Filler) -> Vec<u8> {
    let mut to = Writer {
        bytes: Vec::new(),
        version: (version.major, version.minor),
        markers: filler.body_markers,
    };
    to.u32(frame.number);
    to.section(filler.marker_sets, |to, set| {
        to.bytes.extend(format!("set {set}\0").bytes());
        to.u32(set + 1);
        to.floats(3 * (set + 1));
    });
    to.section(filler.unlabelled, |to, _| to.floats(3));
    let count = u32::try_from(frame.bodies.len()).unwrap();
    to.section(count, |to, index| to.body(&frame.bodies[index as usize]));
    if to.version >= (2, 1) {
        to.section(filler.skeletons, |to, id| {
            to.u32(id);
            to.u32(2);
            to.body(&bone(1));
            to.body(&bone(2));
        });
    }
    if to.version >= (4, 1) {
        to.section(filler.assets, |to, id| {
            to.u32(id);
            to.u32(1);
            to.body(&bone(id));
            to.u32(1);
            to.labelled_marker(id);
        });
    }
    if to.version >= (2, 3) {
        to.section(filler.labelled, Writer::labelled_marker);
    }
    if to.version >= (2, 9) {
        to.section(filler.force_plates, Writer::analog);
    }
    if to.version >= (2, 11) {
        to.section(filler.devices, Writer::analog);
    }
    to.suffix(frame, filler);
    let mut datagram = vec![7, 0];
    datagram.extend(u16::try_from(to.bytes.len()).unwrap().to_le_bytes());
    datagram.extend(to.bytes);
    datagram
}

fn bone(id: u32) -> Body {
    Body {
        id: (7 << 16) + id,
        position_m: [0.1, 1.2, 0.3],
        quaternion: [0.0, 0.0, 0.0, 1.0],
        mean_error_m: 0.001,
        tracked: true,
    }
}

impl Writer {
    fn u32(&mut self, number: u32) {
        self.bytes.extend(number.to_le_bytes());
    }

    fn float(&mut self, number: f32) {
        self.bytes.extend(number.to_le_bytes());
    }

    fn floats(&mut self, count: u32) {
        for index in 0..count {
            self.float(index as f32 * 0.25 - 1.0);
        }
    }

    fn flags(&mut self, flags: u16) {
        if self.version >= (2, 6) {
            self.bytes.extend(flags.to_le_bytes());
        }
    }

    fn section(&mut self, count: u32, mut thing: impl FnMut(&mut Self, u32)) {
        self.u32(count);
        let start = self.bytes.len();
        for index in 0..count {
            thing(self, index);
        }
        if self.version >= (4, 1) {
            let size = u32::try_from(self.bytes.len() - start).unwrap();
            self.bytes.splice(start..start, size.to_le_bytes());
        }
    }

    fn body(&mut self, body: &Body) {
        self.u32(body.id);
        for number in body.position_m.iter().chain(&body.quaternion) {
            self.float(*number);
        }
        if self.version < (3, 0) {
            let markers = self.markers;
            self.u32(markers);
            self.floats(3 * markers);
            (0..markers).for_each(|id| self.u32(id));
            self.floats(markers);
        }
        let lost = self.version < (2, 6) && !body.tracked;
        self.float(if lost { 0.0 } else { body.mean_error_m });
        self.flags(u16::from(body.tracked) | 0x40);
    }

    fn labelled_marker(&mut self, id: u32) {
        self.u32(id);
        self.floats(4);
        self.flags(0x0b);
        if self.version >= (3, 0) {
            self.float(0.0005);
        }
    }

    /// A force plate or a device with two channels.
    fn analog(&mut self, id: u32) {
        self.u32(id);
        self.u32(2);
        for samples in [3, 0] {
            self.u32(samples);
            self.floats(samples);
        }
    }

    fn suffix(&mut self, frame: &Frame, filler: &Filler) {
        if self.version < (3, 0) {
            self.float(0.004);
        }
        if self.version >= (2, 3) {
            self.u32(0x0102_0304);
            self.u32(5);
        }
        let timestamp_s = frame.timestamp_s.unwrap_or_default();
        if self.version >= (2, 7) {
            self.bytes.extend(timestamp_s.to_le_bytes());
        } else if self.version >= (2, 6) {
            self.float(timestamp_s as f32);
        }
        if self.version >= (3, 0) {
            let stamps = frame.stamps.unwrap();
            for stamp in [stamps.mid_exposure, stamps.received, stamps.transmit] {
                self.bytes.extend(stamp.to_le_bytes());
            }
        }
        if self.version >= (4, 1) || self.version >= (4, 0) && filler.precise_4_0 {
            self.u32(1_700_000_000);
            self.u32(99);
        }
        self.flags(1);
        self.u32(0);
    }
}
