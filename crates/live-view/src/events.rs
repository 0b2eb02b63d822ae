//! From the control loop to the pages: the newest snapshot, some times a second, and every note.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use axum::response::sse::Event;
use serde_json::{Value, json};
use tokio::sync::{OwnedSemaphorePermit, watch};
use tokio::time::{MissedTickBehavior, interval, timeout};

use super::snapshot::Snapshot;

const PERIOD: Duration = Duration::from_millis(50);
/// Something goes to every page this often, so that a connection that takes nothing is known.
const HEARTBEAT: Duration = Duration::from_secs(4);
/// How soon a page tries again after the connection is lost.
const RETRY: Duration = Duration::from_millis(500);
const KEPT_NOTES: usize = 200;
const NOTE_CHARACTERS: usize = 500;

/// Where the control loop leaves the newest snapshot.
pub(super) type Slot = Arc<Mutex<Option<Snapshot>>>;

pub(super) enum Message {
    Note(String),
    Ended(String),
    /// Nothing comes any more.
    Close,
}

/// Whether a connection has taken anything lately.
pub(super) type Alive = Arc<AtomicBool>;

/// What a page that opens now has to know.
#[derive(Default)]
pub(super) struct Published {
    time_s: Option<f64>,
    /// Counted, so that pages know a new one.
    snapshots: u64,
    snapshot: String,
    notes: VecDeque<(u64, String)>,
    noted: u64,
    end: Option<String>,
}

impl Published {
    /// Takes up what has come; whether that was anything.
    fn add(&mut self, newest: Option<Snapshot>, messages: Vec<Message>) -> bool {
        let changes = newest.is_some() || !messages.is_empty();
        if let Some(json) = newest.as_ref().and_then(|s| serde_json::to_string(s).ok()) {
            self.time_s = newest.map(|snapshot| snapshot.time_s);
            self.snapshot = json;
            self.snapshots += 1;
        }
        for message in messages {
            match message {
                Message::Note(text) => self.add_note(&text),
                Message::Ended(text) => self.end = Some(text),
                Message::Close => {
                    self.end.get_or_insert_with(|| "closed".to_owned());
                }
            }
        }
        changes
    }

    fn add_note(&mut self, text: &str) {
        let text: String = text.chars().take(NOTE_CHARACTERS).collect();
        self.noted += 1;
        let note = json!({ "index": self.noted, "time_s": self.time_s, "text": text });
        if self.notes.len() == KEPT_NOTES {
            self.notes.pop_front();
        }
        self.notes.push_back((self.noted, note.to_string()));
    }
}

/// Publishes what the control loop leaves, until it closes.
pub(super) async fn publish(
    slot: &Slot,
    messages: &Receiver<Message>,
    published: &watch::Sender<Published>,
) {
    let mut ticks = interval(PERIOD);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        ticks.tick().await;
        // Messages first: what was shown before the end has to come before it.
        let messages: Vec<Message> = messages.try_iter().collect();
        let newest = slot.lock().unwrap_or_else(PoisonError::into_inner).take();
        let closes = messages
            .iter()
            .any(|message| matches!(message, Message::Close));
        published.send_if_modified(|published| published.add(newest, messages));
        if closes {
            return;
        }
    }
}

/// The events of one page. It takes the newest when it has room, so that a slow page misses some and holds up nobody.
pub(super) struct Follower {
    published: watch::Receiver<Published>,
    waiting: VecDeque<Event>,
    snapshots: u64,
    noted: u64,
    ended: bool,
    alive: Alive,
    _place: Option<OwnedSemaphorePermit>,
}

impl Follower {
    pub(super) fn new(
        published: watch::Receiver<Published>,
        hello: &Value,
        alive: Alive,
        place: Option<OwnedSemaphorePermit>,
    ) -> Self {
        let first = event("hello", &hello.to_string()).retry(RETRY);
        let mut follower = Self {
            published,
            waiting: VecDeque::from([first]),
            snapshots: 0,
            noted: 0,
            ended: false,
            alive,
            _place: place,
        };
        follower.catch_up();
        follower
    }

    pub(super) async fn next(mut self) -> Option<(Result<Event, Infallible>, Self)> {
        while self.waiting.is_empty() {
            if self.ended {
                return None;
            }
            match timeout(HEARTBEAT, self.published.changed()).await {
                Ok(Ok(())) => self.catch_up(),
                Ok(Err(_)) => return None,
                Err(_) => self.waiting.push_back(Event::default().comment("")),
            }
        }
        self.alive.store(true, Ordering::Relaxed);
        let event = self.waiting.pop_front()?;
        Some((Ok(event), self))
    }

    fn catch_up(&mut self) {
        let published = self.published.borrow_and_update();
        if published.snapshots > self.snapshots {
            self.snapshots = published.snapshots;
            self.waiting
                .push_back(event("snapshot", &published.snapshot));
        }
        let seen = self.noted;
        let fresh = published.notes.iter().filter(|(index, _)| *index > seen);
        self.waiting
            .extend(fresh.map(|(_, note)| event("note", note)));
        self.noted = published.noted;
        if let Some(end) = &published.end {
            self.waiting
                .push_back(event("end", &json!(end).to_string()));
            self.ended = true;
        }
    }
}

fn event(name: &str, data: &str) -> Event {
    Event::default().event(name).data(data)
}
