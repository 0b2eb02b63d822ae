//! What a speed plan means: its energy budget, its comfort, its motion over time, as a document that says so.
//!
//! [`planned_road`] takes a road file to the planner. [`PlanDocument`] is one plan as `drivekit/plan/1` gives it, [`SampledPlan`] its motion at an even rate, as a log would record it.

mod document;
mod error;
mod own;
mod road;
mod sampled;

pub use document::{
    Bound, CertificateDocument, CertificateStatus, FrontierPoint, Nodes, ObstacleDocument,
    PlanDocument, PlanOutcome, RoadDocument, RunDocument, SignalPassage,
};
pub use error::Error;
pub use own::{Band, OwnWay, Style, StyleDistance};
pub use road::{RoadSettings, planned_road};
pub use sampled::SampledPlan;
