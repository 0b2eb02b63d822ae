//! Robot testbeds: run logs in files, recorded poses, and real robots in real time ([`live`]).
//!
//! ```text
//! RunFile ─simulate→ LoggedRun ─to_table→ LogTable ─write→ file
//! file ─read→ LogTable ─run_log→ RunLog ─replay→ Replay                   every decision once more, bit for bit
//! Recording ─shadow→ ticks                                                controllers beside robots that do what they did
//! LinkSpec ─Session→ poses ─Convoy→ Decisions ─→ robots                   at a fixed rate, every step as an Update
//! ```
//!
//! What knows no file and no socket, the simulated robots, verdicts and the replay, is the crate `testbed-sim`. The principal type is
//! [`RunFile`]: it is what scenario files hold, and stands in every run log, so that a log is replayed without anything else.
//!
//! ```
//! use testbed_io::RunFile;
//! use testbed_io::log_file::{LogFormat, read_bytes, write};
//! use testbed_sim::Disturbances;
//! use unicycle_cbf::{Preset, Testbed};
//!
//! let mut scenario = Testbed::Robotarium.scenario("track", Preset::Hardened)?;
//! scenario.duration_s = 2.0;
//! let spec = RunFile { seed: 7, scenario, disturbances: Disturbances::HARD, link: None };
//! let (run, _) = spec.simulate()?;
//! let mut bytes = Vec::new();
//! write(&run.to_table()?, LogFormat::Mcap, &mut bytes)?;
//!
//! let replay = read_bytes(&bytes, LogFormat::Mcap)?.run_log()?.replay()?;
//! assert_eq!((replay.decisions, replay.different), (2 * 60, 0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # References
//!
//! - MCAP file format, <https://mcap.dev/spec>; NatNet SDK, NaturalPoint; MQTT 3.1.1, OASIS Standard, 2014.
//! - K. Y. K. Leung, Y. Halpern, T. D. Barfoot, H. H. T. Liu, "The UTIAS multi-robot cooperative localization and mapping dataset",
//!   International Journal of Robotics Research 30(8), 2011.

mod error;
pub mod live;
pub mod log_file;
mod path_file;
pub mod recorded;
mod run_file;
mod run_table;
mod shadow;

use testbed_sim::timing;

pub use error::Error;
pub use path_file::PathFile;
pub use run_file::{Judged, LoggedRun, RunFile};
pub use shadow::{Lane, Shadow, lengthen, scenario_of, shadow};

/// The examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
