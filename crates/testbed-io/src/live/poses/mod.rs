//! From trackers to the inbox.

mod json_udp;
mod program;
mod recording;

use std::thread::JoinHandle;

use super::inbox::Inbox;
use super::real_time::into_real_time_class;
use crate::Error;

pub use json_udp::JsonUdpSpec;
pub(super) use json_udp::listen;
pub use program::ProgramSpec;
pub(super) use program::{Program, Running};
pub(super) use recording::Recorded;
pub use recording::{Pace, RecordingSpec};

/// A thread that receives until the inbox ends, or until nothing can come any more.
pub(super) type Receiver = JoinHandle<()>;

/// Starts one; a thread is named for debuggers and messages.
pub(super) fn receiver(
    name: &str,
    inbox: Inbox,
    run: impl FnOnce(&Inbox) + Send + 'static,
) -> Result<Receiver, Error> {
    let thread = std::thread::Builder::new().name(name.to_owned());
    let spawned = thread.spawn(move || {
        into_real_time_class();
        run(&inbox);
    });
    spawned.map_err(|source| Error::no_thread(name, &source))
}
