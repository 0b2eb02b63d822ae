//! The conversation with a server.

use std::io::{self, ErrorKind};
use std::net::{IpAddr, SocketAddr, UdpSocket};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::super::counts::Dropped;
use super::super::inbox::Inbox;
use super::super::seen::Seen;
use super::axes::floor_pose;
use super::decode::{decode, is_frame};
use super::encode::{encode_connect, encode_keep_alive};
use super::frame::{Frame, Malformed, Message, ServerInfo, Version};
use super::server_state::{PUZZLING, ServerState};
use super::spec::{NatNetSpec, Transport};

/// The user is told after this time without an answer, in s.
const UNANSWERED_S: f64 = 3.0;
/// After an error that is no timeout, so that it does not keep the processor busy.
const PAUSE: Duration = Duration::from_millis(10);
/// No datagram is larger.
const DATAGRAM_BYTES: usize = 65536;

/// Shared by the threads of the sockets.
pub(super) struct Conversation {
    spec: NatNetSpec,
    started_s: f64,
    inbox: Inbox,
    state: Mutex<ServerState>,
}

impl Conversation {
    pub(super) fn new(spec: NatNetSpec, inbox: Inbox) -> Self {
        Self {
            spec,
            started_s: inbox.clock().now_s(),
            inbox,
            state: Mutex::default(),
        }
    }

    pub(super) fn note(&self, text: String) {
        self.inbox.note(text);
    }

    /// Receives until the inbox ends.
    pub(super) fn listen(&self, socket: &UdpSocket) {
        let mut buffer = vec![0; DATAGRAM_BYTES];
        while !self.inbox.has_ended() {
            self.receive(socket, &mut buffer);
        }
    }

    /// Receives and sends what is due until the inbox ends.
    pub(super) fn converse(&self, socket: &UdpSocket) {
        let mut buffer = vec![0; DATAGRAM_BYTES];
        while !self.inbox.has_ended() {
            if let Err(source) = self.send_due(socket) {
                self.report_unanswered(&source.to_string());
            }
            self.receive(socket, &mut buffer);
        }
    }

    fn send_due(&self, socket: &UdpSocket) -> io::Result<()> {
        let now_s = self.inbox.clock().now_s();
        let (connect, keep_alive) = self.lock().due(now_s);
        let address = self.spec.command_address();
        if let Some(wanted) = connect {
            socket.send_to(&encode_connect(wanted), address)?;
        }
        if keep_alive {
            socket.send_to(&encode_keep_alive(), address)?;
        }
        let asked_for_long = now_s - self.started_s > UNANSWERED_S;
        if asked_for_long && self.lock().info.is_none() {
            self.report_unanswered("no answer");
        }
        Ok(())
    }

    fn receive(&self, socket: &UdpSocket, buffer: &mut [u8]) {
        match socket.recv_from(buffer) {
            Ok((bytes, from)) => {
                let arrival_s = self.inbox.clock().now_s();
                let datagram = buffer.get(..bytes).unwrap_or_default();
                self.take(datagram, from, arrival_s);
            }
            Err(source) => match source.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut => {}
                // Such as a server that is down: it may come back.
                _ => std::thread::sleep(PAUSE),
            },
        }
    }

    fn take(&self, datagram: &[u8], from: SocketAddr, arrival_s: f64) {
        self.inbox.packet();
        if from.ip().to_canonical() != self.spec.server.to_canonical() {
            return self.inbox.dropped(Dropped::Stranger);
        }
        let Some(version) = self.version_for(datagram) else {
            return;
        };
        match decode(datagram, version) {
            Ok(Message::Frame(frame)) => self.take_frame(&frame, version, arrival_s),
            Ok(Message::ServerInfo(_)) if from.port() != self.spec.command_port => {
                self.inbox.dropped(Dropped::Stranger);
            }
            Ok(Message::ServerInfo(info)) => self.take_info(info),
            Ok(Message::Other(Message::DISCONNECT | Message::DISCONNECT_BY_TIMEOUT)) => {
                self.lock().last_frame_s = None;
            }
            Ok(Message::Other(_)) => {}
            Err(reason) => self.take_malformed(is_frame(datagram), version, reason),
        }
    }

    /// The version to read a datagram by; none for a frame whose version is not known or not read.
    fn version_for(&self, datagram: &[u8]) -> Option<Version> {
        let known = self.lock().version();
        match is_frame(datagram) {
            true => known.filter(|version| version.is_supported()),
            false => known.or(Some(Version::NEWEST)),
        }
    }

    fn take_malformed(&self, is_frame: bool, version: Version, reason: Malformed) {
        self.inbox.dropped(Dropped::Malformed);
        if !is_frame {
            return;
        }
        let mut state = self.lock();
        state.unreadable = state.unreadable.saturating_add(1);
        if state.unreadable >= PUZZLING && !state.told_unreadable {
            state.told_unreadable = true;
            self.inbox.note(format!(
                "{PUZZLING} frames in a row are not NatNet {version} as the server announced it: {reason}"
            ));
        }
    }

    fn take_info(&self, info: ServerInfo) {
        let mut state = self.lock();
        state.told_unanswered = false;
        if state.info.as_ref() == Some(&info) {
            return;
        }
        for note in self.notes_of(&info, state.version()) {
            self.inbox.note(note);
        }
        if state.version() != Some(info.version) {
            state.unreadable = 0;
            state.told_unreadable = false;
            state.last_number = None;
        }
        state.info = Some(info);
    }

    fn notes_of(&self, info: &ServerInfo, before: Option<Version>) -> Vec<String> {
        let version = info.version;
        let mut notes = Vec::new();
        match before {
            Some(before) if before == version => {}
            Some(before) => notes.push(format!(
                "the NatNet server now speaks {version}, it spoke {before} before"
            )),
            None => {
                // It comes from the network and goes to a terminal.
                let name = info.name.escape_debug();
                notes.push(format!("the NatNet server {name} speaks {version}"));
            }
        }
        if !version.is_supported() {
            let reason = Malformed::Version(version);
            notes.push(format!(
                "{reason}: set the bit stream version of the server"
            ));
        }
        let Some(channel) = &info.channel else {
            return notes;
        };
        let multicast = self.spec.transport == Transport::Multicast;
        if channel.multicast != multicast {
            let transport = match channel.multicast {
                true => "multicast",
                false => "unicast",
            };
            notes.push(format!(
                "the NatNet server sends {transport}: set `transport` so"
            ));
        } else if multicast
            && (channel.port, channel.group) != (self.spec.data_port, self.spec.group)
        {
            notes.push(format!(
                "the NatNet server sends to group {} at port {}: set `group` and `data_port` so",
                channel.group, channel.port
            ));
        }
        notes
    }

    fn take_frame(&self, frame: &Frame, version: Version, arrival_s: f64) {
        let (stamp_s, age_s) = {
            let mut state = self.lock();
            state.unreadable = 0;
            state.last_frame_s = Some(arrival_s);
            let (stamp_s, age_s) = state.stamp(frame, version);
            if stamp_s.is_none() && state.is_late(frame.number) {
                drop(state);
                for _ in &frame.bodies {
                    self.inbox.dropped(Dropped::Old);
                }
                return;
            }
            (stamp_s, age_s)
        };
        for body in &frame.bodies {
            if !body.tracked {
                self.inbox.dropped(Dropped::Untracked);
            } else if let Some(pose) = floor_pose(body, self.spec.up) {
                let seen = Seen {
                    id: body.id,
                    pose,
                    stamp_s,
                    age_s: age_s + self.spec.latency_s,
                };
                self.inbox.pose(arrival_s, seen);
            } else {
                self.inbox.dropped(Dropped::Malformed);
            }
        }
    }

    fn report_unanswered(&self, problem: &str) {
        let mut state = self.lock();
        if state.told_unanswered {
            return;
        }
        state.told_unanswered = true;
        let NatNetSpec {
            server,
            command_port,
            local,
            ..
        } = &self.spec;
        let from = match local {
            IpAddr::V4(local) if local.is_unspecified() => String::new(),
            _ => format!(" from {local}"),
        };
        self.inbox.note(format!(
            "NatNet server {server}{from}: {problem}; does it stream, is {command_port} its command port, is \
             `local` in its network, does a firewall let UDP through?"
        ));
    }

    /// A thread that panicked leaves a state that is whole: it is changed in single assignments.
    fn lock(&self) -> MutexGuard<'_, ServerState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
