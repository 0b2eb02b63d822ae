//! What is known of a server, and when to ask it.

use super::frame::{Frame, ServerInfo, Version};

/// Time between connects while the server says nothing, in s.
const ASKING_S: f64 = 0.5;
/// The same while its frames cannot be read.
const PUZZLED_S: f64 = 0.2;
/// The same while all is well: the server can have been restarted.
const CONTENT_S: f64 = 2.0;
/// Time between keep-alives, in s.
const KEEP_ALIVE_S: f64 = 1.0;
/// Frames in a row that cannot be read, after which the version is doubted.
pub(super) const PUZZLING: u32 = 5;
/// A frame without a stamp whose number is by less than this behind the last is late.
const LATE_FRAMES: u32 = 100;
/// An exposure longer ago counts as this long, in s: too old to be driven on.
const OLDEST_EXPOSURE_S: f64 = 1.0;

/// Times are those of the inbox, in s.
#[derive(Default)]
pub(super) struct ServerState {
    pub(super) info: Option<ServerInfo>,
    pub(super) unreadable: u32,
    pub(super) last_number: Option<u32>,
    pub(super) last_frame_s: Option<f64>,
    pub(super) connected_s: Option<f64>,
    pub(super) kept_alive_s: f64,
    pub(super) told_unanswered: bool,
    pub(super) told_unreadable: bool,
}

impl ServerState {
    pub(super) fn version(&self) -> Option<Version> {
        self.info.as_ref().map(|info| info.version)
    }

    /// Whether to connect, and for which version, and whether to send a keep-alive.
    pub(super) fn due(&mut self, now_s: f64) -> (Option<Option<Version>>, bool) {
        let version = self.version();
        let silent = self
            .last_frame_s
            .is_none_or(|last_s| now_s - last_s > ASKING_S);
        let every_s = if version.is_some() && self.unreadable >= PUZZLING {
            PUZZLED_S
        } else if version.is_none() || silent {
            ASKING_S
        } else {
            CONTENT_S
        };
        let connect = self
            .connected_s
            .is_none_or(|last_s| now_s - last_s >= every_s);
        let keep_alive = version.is_some() && now_s - self.kept_alive_s >= KEEP_ALIVE_S;
        if connect {
            self.connected_s = Some(now_s);
        }
        if keep_alive {
            self.kept_alive_s = now_s;
        }
        let too_new = version.is_some_and(|version| version > Version::NEWEST);
        let wanted = too_new.then_some(Version::NEWEST);
        (connect.then_some(wanted), keep_alive)
    }

    /// Stamp and age of the poses of a frame, in s.
    pub(super) fn stamp(&self, frame: &Frame, version: Version) -> (Option<f64>, f64) {
        let channel = self.info.as_ref().and_then(|info| info.channel);
        let ticking = channel.filter(|channel| channel.clock_hz > 0);
        if let (Some(stamps), Some(channel)) = (frame.stamps, ticking)
            && stamps.transmit > 0
        {
            let seconds = |ticks: u64| ticks as f64 / channel.clock_hz as f64;
            let since = stamps.transmit.checked_sub(stamps.mid_exposure);
            let age_s = since.filter(|_| stamps.mid_exposure > 0).map(seconds);
            let age_s = age_s.unwrap_or_default().min(OLDEST_EXPOSURE_S);
            return (Some(seconds(stamps.transmit)), age_s);
        }
        // In single precision, frames are no longer told apart after some hours.
        let precise = version >= Version::DOUBLE_TIMESTAMP;
        (frame.timestamp_s.filter(|_| precise), 0.0)
    }

    /// Whether a frame without a stamp is not newer than the last.
    pub(super) fn is_late(&mut self, number: u32) -> bool {
        let behind = self.last_number.map(|last| last.wrapping_sub(number));
        let late = behind.is_some_and(|behind| behind < LATE_FRAMES);
        if !late {
            self.last_number = Some(number);
        }
        late
    }
}
