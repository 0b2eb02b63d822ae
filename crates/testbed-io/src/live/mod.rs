//! Robots in real time: what trackers and robots speak, and the loop between them.

mod clock;
pub mod commands;
mod counts;
mod drive;
mod gate;
mod hurry;
mod inbox;
pub mod json_lines;
mod link;
pub mod natnet;
mod pacer;
pub mod poses;
pub mod robotarium;
mod session;
mod spec;
mod stamps;

pub use clock::Clock;
pub use counts::{Counts, Dropped};
pub use gate::{Arena, Bounds};
pub use inbox::{Inbox, Seen};
pub use pacer::Deadlines;
pub use session::{Ending, LiveReport, Session, StopSwitch, Update};
pub use spec::{CommandsSpec, JsonCommandsSpec, LinkSpec, PosesSpec};
