//! The live view of a session with robots: one page on a server of its own, with what the robots do and a stop.
//!
//! The control loop only leaves its newest snapshot; the server takes it from there in a thread of its own.

mod access;
mod events;
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

use anyhow::Context as _;
use serde_json::Value;
use tokio::net::{TcpListener, TcpSocket};
use tokio::runtime::{Builder, Runtime};

use access::{Access, random_hex};
use events::{Message, Slot};
use server::{BACKLOG, Session, serve};

pub(crate) use snapshot::{RobotNow, Snapshot};

/// The page of a session, served until this is dropped.
pub(crate) struct View {
    slot: Slot,
    messages: Sender<Message>,
    watch_url: String,
    control_url: String,
    server: Option<JoinHandle<()>>,
}

impl View {
    /// Serves a page about robots in a lane. `lane` is that of the page of a run with its `robot`; with `headway_s`
    /// the page draws the way in that time. `stop` is called from another thread, each time
    /// someone asks for it, and must not block.
    ///
    /// # Errors
    /// When the address cannot be listened on, or the system gives no random numbers or no thread.
    pub(crate) fn start(
        address: SocketAddr,
        lane: Value,
        title: String,
        stop: Box<dyn Fn() + Send + Sync>,
    ) -> anyhow::Result<Self> {
        let failed = || format!("cannot serve the view on {address}");
        let runtime = Builder::new_current_thread()
            .enable_io()
            .enable_time()
            .build()
            .with_context(failed)?;
        let listener = listen(address, &runtime).with_context(failed)?;
        let address = listener.local_addr().with_context(failed)?;
        let access = Access::new(address)?;
        let (watch_url, control_url) = access.urls(address);
        let session = Session {
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
            .with_context(failed)?;
        Ok(Self {
            slot,
            messages,
            watch_url,
            control_url,
            server: Some(server),
        })
    }

    /// The address of the page without a stop.
    pub(crate) fn watch_url(&self) -> &str {
        &self.watch_url
    }

    /// The address of the page with the stop: who has it may stop the robots.
    pub(crate) fn control_url(&self) -> &str {
        &self.control_url
    }

    /// Leaves a snapshot for the pages in place of the one before. It never waits: while the server takes the one before,
    /// this one is left out.
    pub(crate) fn show(&self, snapshot: Snapshot) {
        let before = match self.slot.try_lock() {
            Ok(mut slot) => slot.replace(snapshot),
            Err(_) => None,
        };
        // Freed here, when the slot is free already.
        drop(before);
    }

    /// A line in the log of the pages.
    pub(crate) fn note(&self, text: &str) {
        let _ = self.messages.send(Message::Note(text.to_owned()));
    }

    /// The session is over: `finished`, `stopped`, or `lost: …` with the reason.
    pub(crate) fn ended(&self, how: &str) {
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
