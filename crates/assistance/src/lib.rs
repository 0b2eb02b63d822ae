//! What a speed plan means: its energy budget, its comfort, its motion over time, as a document that says so.
//!
//! [`PlanDocument`] is one plan as `drivekit/plan/1` gives it, [`SampledPlan`] its motion at an even rate, as a log would record it.

mod document;
mod sampled;

pub use document::{
    Bound, FrontierPoint, Nodes, ObstacleDocument, PlanDocument, PlanOutcome, RoadDocument,
    SignalPassage,
};
pub use sampled::SampledPlan;
