//! Robot testbeds in memory: simulated robots under disturbances, campaigns of runs, what a run comes to, and its replay.
//!
//! ```text
//! RunSpec ─simulate→ Plant ─Delay→ poses ─Convoy→ Decisions ─→ Plant …    every tick into Run
//! RunLog ─replay→ Replay                                                  every decision once more, bit for bit
//! Campaign ─run→ CampaignReport                                           thousands of runs in parallel
//! ```
//!
//! A plant takes wheel speeds; its motors lag, its wheels and mass are off by bounded errors. A tracker sees it with noise, late, or
//! not at all. A run is *safe* when over all of it every body keeps its clearance, `|y| ≤ W` for the deviation `y` from the path and
//! the half width `W` of the lane, and `D − D0 − τ v ≥ 0` for the distance `D` to the robot ahead: judged on true states between the
//! steps, not on what the controllers saw.
//!
//! The principal type is [`RunSpec`]: a run follows from scenario, disturbances and seed alone. There is no file, no socket and no
//! clock but the stopwatch around each decision; files and real robots are the crate `testbed-io`.
//!
//! ```
//! use testbed_sim::{Disturbances, Group, RunSpec};
//! use unicycle_cbf::{Preset, Testbed};
//!
//! let mut scenario = Testbed::Robotarium.scenario("track", Preset::Hardened)?;
//! scenario.duration_s = 5.0;
//! let disturbances = Disturbances::HARD.only(Group::All);
//! let (run, summary) = RunSpec { seed: 7, scenario, disturbances }.simulate()?;
//! assert_eq!(run.ticks.len(), 2 * 150);
//! assert_eq!(summary.safe, Some(true));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # References
//!
//! - D. J. Bernstein, "ChaCha, a variant of Salsa20", SASC 2008: the same random numbers on every machine.
//! - G. Marsaglia, T. A. Bray, "A convenient method for generating normal variables", SIAM Review 6(3), 1964.

pub mod adaptation;
pub mod beyond;
pub mod campaign;
pub mod columns;
pub mod commanded;
mod convoy;
mod delay;
mod disturbances;
mod error;
pub mod explain;
pub mod figures;
mod holds;
pub mod measured;
mod plant;
pub mod replay;
mod right_of_way;
mod run;
pub mod run_log;
pub mod sight;
mod simulation;
pub mod summary;
mod tally;
pub mod tick;
pub mod timing;
pub mod verdict;

pub use adaptation::Adaptation;
pub use campaign::{Campaign, CampaignReport, NamedScenario, SettingsOf};
pub use convoy::Convoy;
pub use disturbances::{Disturbances, Group};
pub use error::Error;
pub use figures::RunFigures;
pub use replay::Replay;
pub use run::{Run, RunSpec};
pub use run_log::RunLog;
pub use simulation::Simulation;
pub use summary::Summary;
pub use tick::Tick;
pub use timing::Timing;
pub use verdict::{LeastDistance, Verdict};

/// The examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
