//! The connection of one robot: its commands and its last will.
//!
//! At most one command is on its way. The next leaves when the broker has confirmed the last, and it is the newest: neither the
//! library nor the network holds a queue of old ones.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use rumqttc::{AsyncClient, Event, EventLoop, LastWill, Packet, QoS};
use tokio::sync::{Notify, watch};
use unicycle_cbf::Speeds;

use super::messages::encode_command;
use super::problem::Problem;
use super::status::{self, Status};
use super::{NotFinite, RobotariumSpec};

/// The shortest that the library knows: the broker misses a robot's connection soonest.
const KEEP_ALIVE: Duration = Duration::from_secs(1);
/// Without commands, the broker is asked for a sign of life this often.
const BEAT: Duration = Duration::from_millis(300);
/// A connection without an answer for this long is lost.
const PATIENCE: Duration = Duration::from_millis(500);
/// Older commands are not sent, in s.
const OLDEST_S: f64 = 0.2;
/// The broker has nothing to say to us but confirmations.
const LARGEST_PACKET: usize = 1024;

pub(super) const ZERO: &str = r#"{"v":0.0,"w":0.0}"#;

/// What a robot shall do, from the caller to its connection.
#[derive(Debug, Default)]
pub(super) struct Lane {
    slot: Mutex<Slot>,
    wake: Notify,
}

#[derive(Debug, Default)]
struct Slot {
    newest: Option<Command>,
    /// Numbers of the last command given, and of the last that the broker has
    given: u64,
    confirmed: u64,
    /// Whether the robot was stopped for good, so that its will is not needed
    stopped: bool,
}

#[derive(Debug, Clone, Copy)]
struct Command {
    number: u64,
    given_s: f64,
    speeds: Speeds,
}

impl Lane {
    /// Gives a command in place of the one before, and returns its number.
    pub(super) fn give(&self, now_s: f64, speeds: Speeds) -> u64 {
        let mut slot = self.lock();
        slot.given += 1;
        let number = slot.given;
        slot.newest = Some(Command {
            number,
            given_s: now_s,
            speeds,
        });
        drop(slot);
        self.wake.notify_one();
        number
    }

    /// Whether the broker has this command or a later one.
    pub(super) fn has_confirmed(&self, number: u64) -> bool {
        self.lock().confirmed >= number
    }

    /// The robot stands and gets no commands any more.
    pub(super) fn stopped(&self) {
        self.lock().stopped = true;
    }

    fn is_stopped(&self) -> bool {
        self.lock().stopped
    }

    fn confirm(&self, number: u64) {
        let mut slot = self.lock();
        slot.confirmed = slot.confirmed.max(number);
    }

    fn take(&self, now_s: f64) -> Option<Command> {
        let command = self.lock().newest.take()?;
        (now_s - command.given_s <= OLDEST_S).then_some(command)
    }

    fn lock(&self) -> MutexGuard<'_, Slot> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// One robot's connection.
pub(super) struct Sender {
    pub(super) lane: Arc<Lane>,
    pub(super) status: Arc<Status>,
    pub(super) index: usize,
    pub(super) client_id: String,
    pub(super) topic: String,
}

impl Sender {
    /// Sends until the session ends. The client id stays the same, so that the broker ends an old connection, with whatever is
    /// still on its way, before it accepts the new one.
    pub(super) async fn run(self, spec: RobotariumSpec, mut end: watch::Receiver<()>) {
        let mut options = status::options(&spec, &self.client_id);
        let will = LastWill::new(&self.topic, ZERO, QoS::AtMostOnce, false);
        options.set_last_will(will);
        let (client, mut connection) = status::client(&mut options, KEEP_ALIVE, LARGEST_PACKET);
        while status::connect(&mut connection, &self.status, &mut end).await {
            let _up = self.status.up(self.index);
            tokio::select! {
                () = self.send(&client, &mut connection) => {}
                _ = end.changed() => {
                    if self.lane.is_stopped() {
                        status::leave(&client, &mut connection).await;
                    }
                    return;
                }
            }
        }
    }

    /// Sends until the connection is lost.
    async fn send(&self, client: &AsyncClient, connection: &mut EventLoop) {
        let clock = self.status.inbox().clock();
        // Number of the command that waits for its confirmation, 0 for a sign of life
        let mut waiting: Option<u64> = None;
        let mut asked = tokio::time::Instant::now();
        loop {
            let span = if waiting.is_some() { PATIENCE } else { BEAT };
            let mut beat = false;
            tokio::select! {
                event = connection.poll() => match event {
                    Ok(Event::Incoming(Packet::UnsubAck(_))) => {
                        self.lane.confirm(waiting.take().unwrap_or(0));
                    }
                    Ok(_) => {}
                    Err(error) => return self.status.failed(error),
                },
                () = self.lane.wake.notified(), if waiting.is_none() => {}
                () = tokio::time::sleep_until(asked + span) => {
                    if waiting.is_some() {
                        return self.status.failed(Problem::NoAnswer("the broker does not answer".to_owned()));
                    }
                    beat = true;
                }
            }
            if waiting.is_some() {
                continue;
            }
            let command = self.lane.take(clock.now_s());
            if command.is_none() && !beat {
                continue;
            }
            if !self.put(client, command.map(|command| command.speeds)) {
                return;
            }
            waiting = Some(command.map_or(0, |command| command.number));
            asked = tokio::time::Instant::now();
        }
    }

    /// A command, if there is one, and something that the broker confirms after it: that a topic is not subscribed to that never
    /// was. A command that had to be confirmed itself could be kept for a robot that is away.
    fn put(&self, client: &AsyncClient, speeds: Option<Speeds>) -> bool {
        if let Some(speeds) = speeds {
            let message = encode_command(speeds).unwrap_or_else(|NotFinite| ZERO.to_owned());
            let sent = client.try_publish(&self.topic, QoS::AtMostOnce, false, message);
            if sent.is_err() {
                return false;
            }
        }
        client.try_unsubscribe(&self.client_id).is_ok()
    }
}
