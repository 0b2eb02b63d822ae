//! What a speed plan means: its energy budget, its comfort, its motion over time, as a document that says so.
//!
//! [`planned_road`] takes a road file to the planner. [`PlanDocument`] is one plan as `drivekit/plan/1` gives it, [`SampledPlan`] its motion at an even rate, as a log would record it. [`savings_in_words`] says where a plan saves
//! most against another run of the same road, and by what. [`potential()`] is what a recorded trip could have cost.

mod document;
mod error;
mod in_words;
mod own;
mod potential;
mod road;
mod sampled;

pub use document::{
    Bound, CertificateDocument, CertificateStatus, Effort, FrontierPoint, Nodes, ObstacleDocument,
    PlanDocument, PlanOutcome, RoadDocument, RunDocument, SignalPassage,
};
pub use error::Error;
pub use in_words::{Difference, Saving, savings_in_words};
pub use own::{Band, OwnWay, Style, StyleDistance};
pub use potential::{
    NotPlanned, Potential, PotentialSettings, RecordedMotion, potential, potential_of_pieces,
};
pub use road::{RoadSettings, planned_road};
pub use sampled::SampledPlan;
