//! Robots in real time: what trackers and robots speak, and the loop between them.
//!
//! ```text
//! thread of a tracker ─decode→ Seen ─Inbox { StampMap, Gate }→ newest StampedPose
//! Pacer ─deadline→ ControlLoop ─Convoy→ Decisions ─DeadMan { CommandSink }→ robots       every step as an Update to the caller
//! ```
//!
//! A [`LinkSpec`] says who the robots are, where poses come from and where commands go; a [`Session`] runs a scenario on it. On every
//! way out robots are told to stand, and those that may not have heard it are named.
//!
//! ```
//! use testbed_io::live::LinkSpec;
//!
//! let link: LinkSpec = toml::from_str(
//!     r#"
//!     robots = [1, 2]
//!     poses = { kind = "natnet", server = "192.168.0.2" }
//!     commands = { kind = "khepera", addresses = ["192.168.0.11:4555", "192.168.0.12:4555"] }
//!     "#,
//! )?;
//! assert_eq!(link.lost_after_s, 5.0);
//! # Ok::<(), toml::de::Error>(())
//! ```

mod clock;
mod clock_rate;
pub mod commands;
mod control_loop;
mod counts;
mod disbelieved;
mod displaced;
mod fit;
mod gate;
mod heading;
mod inbox;
pub mod json_lines;
mod jump;
mod led;
mod line;
mod link;
mod lookout;
mod moved;
pub mod natnet;
pub mod note;
mod pacer;
pub mod poses;
mod real_time;
mod report;
pub mod robotarium;
mod roll_call;
mod seen;
mod senders;
mod session;
mod spec;
mod stamps;
mod starts;
mod template;
mod watch;
mod words;

use testbed_sim::commanded;

pub use clock::Clock;
pub use counts::{Counts, Dropped};
pub use gate::{Arena, Bounds};
pub use inbox::Inbox;
pub use note::Note;
pub use pacer::Deadlines;
pub use report::{Ending, LiveReport, StopSwitch, Update};
pub use seen::Seen;
pub use session::Session;
pub use spec::{CommandsSpec, JsonCommandsSpec, LinkSpec, PosesSpec};
pub use template::LinkTemplate;
