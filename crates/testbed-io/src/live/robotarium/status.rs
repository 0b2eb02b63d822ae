//! Which connections there are.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use rumqttc::{AsyncClient, Event, EventLoop, MqttOptions, NetworkOptions, Outgoing};
use tokio::sync::watch;

use super::super::inbox::Inbox;
use super::problem::Problem;
use super::{Password, RobotariumSpec};

/// Between attempts to connect.
pub(super) const RETRY: Duration = Duration::from_millis(200);
/// Before the first attempt, so that a broker that accepts and hangs up does not keep us busy.
const BEFORE: Duration = Duration::from_millis(20);
/// An attempt, or a write that the network does not take, ends after this time, in s: the shortest that there is.
const TIMEOUT_S: u64 = 1;
/// Robots try to connect again every 10 s at worst.
const ROBOTS_AWAY_S: f64 = 12.0;
/// For the last packet to leave.
const LEAVING: Duration = Duration::from_millis(200);

/// Of all connections: those of the robots from the front, then that of the poses.
#[derive(Debug)]
pub(super) struct Status {
    inbox: Inbox,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    /// Since when there is none, for each
    lost_s: Vec<Option<f64>>,
    /// Why the last attempt failed
    problem: Problem,
    /// Whether all were there once
    complete: bool,
    /// When one that was lost came back last
    back_s: Option<f64>,
    /// Whether the user knows that one was lost
    noted: bool,
}

impl Status {
    pub(super) fn new(inbox: Inbox, connections: usize) -> Self {
        let now_s = inbox.clock().now_s();
        let state = State {
            lost_s: vec![Some(now_s); connections],
            problem: Problem::NoAnswer("no answer".to_owned()),
            complete: false,
            back_s: None,
            noted: false,
        };
        Self {
            inbox,
            state: Mutex::new(state),
        }
    }

    pub(super) fn inbox(&self) -> &Inbox {
        &self.inbox
    }

    /// The connection is there until the guard is dropped.
    pub(super) fn up(&self, connection: usize) -> Up<'_> {
        let mut state = self.lock();
        state.lost_s[connection] = None;
        if state.complete {
            state.back_s = Some(self.inbox.clock().now_s());
        }
        if state.lost_s.iter().all(Option::is_none) {
            state.complete = true;
            if std::mem::take(&mut state.noted) {
                let note = "the connection to the broker is back";
                self.inbox.note(note.to_owned());
            }
        }
        Up {
            status: self,
            connection,
        }
    }

    fn lost(&self, connection: usize) {
        let mut state = self.lock();
        state.lost_s[connection] = Some(self.inbox.clock().now_s());
        let first = state.complete && !state.noted;
        if first && !self.inbox.has_ended() {
            state.noted = true;
            let note = "the connection to the broker was lost";
            self.inbox.note(note.to_owned());
        }
    }

    /// Connections that are lost from now on are not worth a note.
    pub(super) fn end(&self) {
        self.lock().noted = true;
    }

    pub(super) fn failed(&self, problem: impl Into<Problem>) {
        self.lock().problem = problem.into();
    }

    pub(super) fn problem(&self) -> Problem {
        self.lock().problem.clone()
    }

    /// Since when the first of the connections that are lost has been, on the inbox's clock in s.
    pub(super) fn lost_since_s(&self) -> Option<f64> {
        let state = self.lock();
        state.lost_s.iter().flatten().copied().reduce(f64::min)
    }

    /// Whether the broker may have been away so shortly ago that robots are still trying to connect to it again.
    pub(super) fn robots_may_be_away(&self) -> bool {
        let now_s = self.inbox.clock().now_s();
        let back_s = self.lock().back_s;
        back_s.is_some_and(|back_s| now_s - back_s < ROBOTS_AWAY_S)
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A connection that is there. It counts as lost however its task ends.
pub(super) struct Up<'a> {
    status: &'a Status,
    connection: usize,
}

impl Drop for Up<'_> {
    fn drop(&mut self) {
        self.status.lost(self.connection);
    }
}

/// With limits on what the broker can make us hold.
pub(super) fn client(
    options: &mut MqttOptions,
    keep_alive: Duration,
    largest_bytes: usize,
) -> (AsyncClient, EventLoop) {
    const REQUESTS: usize = 4;
    options.set_keep_alive(keep_alive);
    options.set_clean_session(true);
    options.set_max_packet_size(largest_bytes, 1024);
    let (client, mut connection) = AsyncClient::new(options.clone(), REQUESTS);
    let mut network = NetworkOptions::new();
    network.set_connection_timeout(TIMEOUT_S);
    network.set_tcp_nodelay(true);
    connection.set_network_options(network);
    (client, connection)
}

pub(super) fn options(spec: &RobotariumSpec, client_id: &str) -> MqttOptions {
    let mut options = MqttOptions::new(client_id, &spec.broker, spec.port);
    if let Some(user) = &spec.user {
        let password = spec.password.as_ref();
        options.set_credentials(user, password.map_or("", Password::as_str));
    }
    options
}

/// Connects, with as many attempts as it takes. False if the session ended before.
pub(super) async fn connect(
    connection: &mut EventLoop,
    status: &Status,
    end: &mut watch::Receiver<()>,
) -> bool {
    discard_queued(connection);
    let attempts = async {
        tokio::time::sleep(BEFORE).await;
        while let Err(error) = connection.poll().await {
            status.failed(error);
            tokio::time::sleep(RETRY).await;
        }
    };
    tokio::select! {
        () = attempts => true,
        _ = end.changed() => false,
    }
}

/// Closes the connection and discards what was to be sent on it: the library would send it after the next connect.
fn discard_queued(connection: &mut EventLoop) {
    connection.clean();
    connection.pending.clear();
    connection.state.events.clear();
}

/// Ends a connection properly, so that its last will is not sent.
pub(super) async fn leave(client: &AsyncClient, connection: &mut EventLoop) {
    if client.try_disconnect().is_err() {
        return;
    }
    let left = async {
        while let Ok(event) = connection.poll().await {
            if event == Event::Outgoing(Outgoing::Disconnect) {
                break;
            }
        }
    };
    // Nobody waits for it: the broker sends the will at worst, which is a stop.
    let _ = tokio::time::timeout(LEAVING, left).await;
}
