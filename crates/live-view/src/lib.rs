//! A page that shows robots as they drive and can stop them, served by the program that drives them.
//!
//! A control loop has a deadline every few milliseconds and must wait for nobody; a person beside the robots wants to see them and to
//! stop them. So the loop only leaves its newest [`Snapshot`] in a slot, in some microseconds and without waiting, and a server in a
//! thread of its own takes it from there to any number of pages, twenty times a second. Whoever has the control address may stop the
//! robots; it holds a token of 128 random bits. The principal type is [`View`].
//!
//! ```
//! use live_view::{NewestPlaces, Snapshot, View};
//! use testbed_sim::Simulation;
//! use unicycle_cbf::{Preset, Scenario, Testbed};
//!
//! let mut spec = Testbed::Robotarium.scenario("track", Preset::Hardened)?;
//! spec.duration_s = 1.0;
//! let scenario = Scenario::new(spec)?;
//! let view = View::start("127.0.0.1:0".parse()?, &scenario, Box::new(|| {}))?;
//! assert!(view.control_url().contains("?token="));
//!
//! let mut newest = NewestPlaces::new(&scenario);
//! let simulation = Simulation { scenario: &scenario, disturbances: Default::default(), seed: 1 };
//! simulation.run(|tick| {
//!     view.show(Snapshot {
//!         time_s: tick.time_s,
//!         duration_s: 1.0,
//!         robots: newest.robots(&[*tick], &[0.0, 0.0], &[1, 2]),
//!         ..Snapshot::default()
//!     });
//! })?;
//! view.ended("finished");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # References
//!
//! - HTML Living Standard, "Server-sent events"; RFC 6750, "Bearer token usage"; Content Security Policy Level 3, W3C.

mod access;
mod error;
mod events;
mod newest;
mod places;
mod server;
mod snapshot;
#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]
mod tests;

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::mpsc::{self, Sender};
use std::thread::{self, JoinHandle};

use serde_json::Value;
use testbed_sim::RunFigures;
use tokio::net::{TcpListener, TcpSocket};
use tokio::runtime::{Builder, Runtime};
use unicycle_cbf::Scenario;

use access::{Access, random_hex};
use events::{Message, Slot};
use server::{BACKLOG, ShownSession, serve};

pub use error::Error;
pub use newest::NewestPlaces;
pub use snapshot::{RobotNow, Snapshot};

/// The page of a session, served until this is dropped.
pub struct View {
    slot: Slot,
    messages: Sender<Message>,
    watch_url: String,
    control_url: String,
    server: Option<JoinHandle<()>>,
}

impl View {
    /// Serves a page about the robots of a scenario. `stop` is called from another thread, each time someone asks for it, and must not
    /// block.
    ///
    /// # Errors
    ///
    /// When the address cannot be listened on, or the system gives no random numbers or no thread.
    pub fn start(
        address: SocketAddr,
        scenario: &Scenario,
        stop: Box<dyn Fn() + Send + Sync>,
    ) -> Result<Self, Error> {
        let spec = scenario.spec();
        let title = format!("{} on {}", spec.name, spec.testbed);
        Self::serve(address, lane(scenario), title, stop)
    }

    /// `lane` is that of the page of a run with its `robot`; with `headway_s` the page draws the way in that time.
    fn serve(
        address: SocketAddr,
        lane: Value,
        title: String,
        stop: Box<dyn Fn() + Send + Sync>,
    ) -> Result<Self, Error> {
        let failed = |source| Error::Serve { address, source };
        let runtime = Builder::new_current_thread()
            .enable_io()
            .enable_time()
            .build()
            .map_err(failed)?;
        let listener = listen(address, &runtime).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        let access = Access::new(address)?;
        let (watch_url, control_url) = access.urls(address);
        let session = ShownSession {
            access,
            name: random_hex::<8>()?,
            title,
            lane,
            stop,
        };
        let slot = Slot::default();
        let (messages, received) = mpsc::channel();
        let left = Arc::clone(&slot);
        let server = thread::Builder::new()
            .name("view".to_owned())
            .spawn(move || runtime.block_on(serve(listener, session, left, received)))
            .map_err(failed)?;
        Ok(Self {
            slot,
            messages,
            watch_url,
            control_url,
            server: Some(server),
        })
    }

    /// The address of the page without a stop.
    #[must_use]
    pub fn watch_url(&self) -> &str {
        &self.watch_url
    }

    /// The address of the page with the stop: who has it may stop the robots.
    #[must_use]
    pub fn control_url(&self) -> &str {
        &self.control_url
    }

    /// Leaves a snapshot for the pages in place of the one before. It never waits: while the server takes the one before,
    /// this one is left out.
    pub fn show(&self, snapshot: Snapshot) {
        let before = match self.slot.try_lock() {
            Ok(mut slot) => slot.replace(snapshot),
            Err(_) => None,
        };
        // Freed here, when the slot is free already.
        drop(before);
    }

    /// A line in the log of the pages.
    pub fn note(&self, text: &str) {
        let _ = self.messages.send(Message::Note(text.to_owned()));
    }

    /// The session is over: `finished`, `stopped`, or `lost: …` with the reason.
    pub fn ended(&self, how: &str) {
        let _ = self.messages.send(Message::Ended(how.to_owned()));
    }
}

impl Drop for View {
    fn drop(&mut self) {
        let _ = self.messages.send(Message::Close);
        if let Some(server) = self.server.take() {
            let _ = server.join();
        }
    }
}

/// What the page draws once; empty only if numbers were no numbers.
fn lane(scenario: &Scenario) -> Value {
    let figures = serde_json::to_value(RunFigures::new(scenario, &[], None)).unwrap_or_default();
    let mut lane = figures["lane"].clone();
    for key in ["robot", "headway_s"] {
        lane[key] = figures[key].clone();
    }
    lane
}

/// Listens already, so that an address that cannot be had is known before anything is driven.
fn listen(address: SocketAddr, runtime: &Runtime) -> io::Result<TcpListener> {
    let _inside = runtime.enter();
    let socket = match address {
        SocketAddr::V4(_) => TcpSocket::new_v4()?,
        SocketAddr::V6(_) => TcpSocket::new_v6()?,
    };
    // As the standard library does: the port of a session that has just ended can be had again.
    #[cfg(unix)]
    socket.set_reuseaddr(true)?;
    socket.bind(address)?;
    socket.listen(BACKLOG)
}

/// The examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
