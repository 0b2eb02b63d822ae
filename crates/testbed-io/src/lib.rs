//! Robot testbeds: simulated robots under disturbances, campaigns of runs, run logs and their replay, recorded poses, and real robots
//! in real time ([`live`]).
//!
//! ```text
//! RunSpec ─simulate→ Plant ─Link→ poses ─Convoy→ Decisions ─→ Plant …     every tick into Run ─to_table→ LogTable ─write→ file
//! file ─read→ LogTable ─from_table→ RunLog ─replay→ Replay                 every decision once more, bit for bit
//! Recording ─shadow→ ticks                                                 controllers beside robots that do what they did
//! Campaign ─run→ CampaignReport                                            thousands of runs in parallel
//! ```
//!
//! A run follows from its [`RunSpec`] alone: scenario, disturbances and seed. It stands in every run log.
//!
//! ```
//! use testbed_io::{Disturbances, Group, RunSpec};
//! use unicycle_cbf::{Preset, Testbed};
//!
//! let mut scenario = Testbed::Robotarium.scenario("track", Preset::Hardened)?;
//! scenario.duration_s = 5.0;
//! let disturbances = Disturbances::HARD.only(Group::All);
//! let (run, summary) = RunSpec { seed: 7, scenario, disturbances, link: None }.simulate()?;
//! assert_eq!(run.ticks.len(), 2 * 150);
//! assert_eq!(summary.safe, Some(true));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod campaign;
mod convoy;
mod disturbances;
mod error;
mod figures;
mod holds;
mod link;
pub mod live;
pub mod log_file;
mod measured;
mod path_file;
mod plant;
pub mod recorded;
mod replay;
mod right_of_way;
mod run_log;
mod shadow;
mod sight;
mod simulation;
mod summary;
mod tick;
mod timing;
mod verdict;

pub use campaign::{
    Campaign, CampaignReport, Histogram, Histograms, NamedScenario, Row, SettingsOf, Tally, Total,
    Violation,
};
pub use convoy::Convoy;
pub use disturbances::{Disturbances, Group};
pub use error::Error;
pub use figures::{Event, Figures};
pub use path_file::PathFile;
pub use replay::{Difference, Replay};
pub use run_log::{LoggedTick, Run, RunLog, RunSpec};
pub use shadow::{Shadow, scenario_of, shadow};
pub use simulation::Simulation;
pub use summary::{Outcomes, Summarising, Summary, outcomes_of};
pub use tick::{Tick, Truth, Watched};
pub use timing::Timing;
pub use verdict::{LeastDistance, Verdict};
