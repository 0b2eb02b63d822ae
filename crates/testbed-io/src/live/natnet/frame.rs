//! What NatNet messages say.

use std::fmt;
use std::net::Ipv4Addr;

/// Version of the bit stream. Ordered by number: 2.10 comes after 2.9.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Version {
    /// The 3 of 3.1
    pub major: u8,
    /// The 1 of 3.1
    pub minor: u8,
}

impl Version {
    /// The oldest that is read
    pub const OLDEST: Self = Self::new(2, 0);
    /// The newest that is read
    pub const NEWEST: Self = Self::new(4, 1);

    /// A bone is a rigid body, a skeleton a list of them
    pub(super) const SKELETONS: Self = Self::new(2, 1);
    pub(super) const LABELLED_MARKERS: Self = Self::new(2, 3);
    pub(super) const TIMECODE: Self = Self::new(2, 3);
    /// Flags of bodies, markers and frames, and a time stamp in single precision
    pub(super) const FLAGS: Self = Self::new(2, 6);
    pub(super) const DOUBLE_TIMESTAMP: Self = Self::new(2, 7);
    pub(super) const FORCE_PLATES: Self = Self::new(2, 9);
    pub(super) const DEVICES: Self = Self::new(2, 11);
    /// Stamps of camera and server come, the latency and the markers of bodies go
    pub(super) const STAMPS: Self = Self::new(3, 0);
    /// The vendor's samples disagree on whether 4.0 has a precision time stamp, so there it is optional
    pub(super) const PRECISION: Self = Self::new(4, 0);
    /// Sections have sizes, and there are assets
    pub(super) const SIZES: Self = Self::new(4, 1);

    /// From its two numbers.
    #[must_use]
    pub const fn new(major: u8, minor: u8) -> Self {
        Self { major, minor }
    }

    /// Whether frames of this version can be read.
    #[must_use]
    pub fn is_supported(self) -> bool {
        (Self::OLDEST..=Self::NEWEST).contains(&self)
    }
}

impl fmt::Display for Version {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}.{}", self.major, self.minor)
    }
}

/// A message of the server.
#[derive(Debug, Clone, PartialEq)]
pub enum Message {
    /// Answer to a connect
    ServerInfo(ServerInfo),
    /// One frame of the cameras
    Frame(Frame),
    /// Anything else, by its number
    Other(u16),
}

impl Message {
    pub(super) const CONNECT: u16 = 0;
    pub(super) const SERVER_INFO: u16 = 1;
    pub(super) const FRAME: u16 = 7;
    pub(super) const DISCONNECT: u16 = 9;
    pub(super) const KEEP_ALIVE: u16 = 10;
    pub(super) const DISCONNECT_BY_TIMEOUT: u16 = 11;
}

/// What the server says about itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ServerInfo {
    /// Name of the program, at most 255 bytes
    pub name: String,
    /// Version of the program
    pub program: [u8; 4],
    /// Version of its frames
    pub version: Version,
    /// Ticks per second of the stamps in frames and where frames are sent, from 3.0
    pub channel: Option<Channel>,
}

/// Where and on which clock frames are sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Channel {
    /// Ticks per second of the stamps
    pub clock_hz: u64,
    /// UDP port of the frames
    pub port: u16,
    /// To a group, or to each client
    pub multicast: bool,
    /// The group
    pub group: Ipv4Addr,
}

/// The rigid bodies at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Counts up while the server runs
    pub number: u32,
    /// In the order of the server
    pub bodies: Vec<Body>,
    /// Time of the frame on a clock of the server in s, from 2.6; in single precision there
    pub timestamp_s: Option<f64>,
    /// From 3.0
    pub stamps: Option<Stamps>,
}

/// Times in ticks of the server's clock; zero if unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stamps {
    /// Middle of the exposure
    pub mid_exposure: u64,
    /// Images arrived at the server
    pub received: u64,
    /// Frame was sent
    pub transmit: u64,
}

/// A rigid body in the axes of the server.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Streaming id
    pub id: u32,
    /// In m
    pub position_m: [f32; 3],
    /// x, y, z, w
    pub quaternion: [f32; 4],
    /// Mean distance of the markers from where the pose has them, in m
    pub mean_error_m: f32,
    /// Whether the cameras see it; otherwise the pose is an old one or none
    pub tracked: bool,
}

/// Why a datagram is not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Malformed {
    /// Frames of this version are not read
    #[error("NatNet {0} is not read, only {oldest} to {newest}", oldest = Version::OLDEST, newest = Version::NEWEST)]
    Version(Version),
    /// The size in the header is another than that of the datagram
    #[error("a message of {said} bytes has {came}")]
    Size {
        /// By the header
        said: usize,
        /// That came
        came: usize,
    },
    /// It ends too early
    #[error("{needed} bytes are needed where {left} are left")]
    Cut {
        /// For the next field, in bytes
        needed: usize,
        /// In bytes
        left: usize,
    },
    /// More things than the bytes that are left can hold
    #[error("{count} things in {left} bytes")]
    Count {
        /// By the message
        count: u32,
        /// In bytes
        left: usize,
    },
    /// A section is not as long as it says
    #[error("a section of {said} bytes has {found}")]
    Section {
        /// By the message
        said: u32,
        /// By its content
        found: usize,
    },
    /// A name without an end
    #[error("a name has no end")]
    Name,
    /// The tag at the end is not zero
    #[error("the end tag is {0}")]
    EndTag(u32),
    /// Bytes after the end
    #[error("{0} bytes after the end")]
    Rest(usize),
}
