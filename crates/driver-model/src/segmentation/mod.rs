//! Drives cut into phases: by labels of samples, or by the methods of [`tseg`] upon which segments are labelled.

mod extent;
mod heuristic;
pub(crate) mod lead;
mod segmenter;
pub(crate) mod statistical;
mod stream;

pub use crate::span::most_divided;
pub use extent::PhaseExtent;
pub use heuristic::HeuristicRules;
pub use lead::{INFLUENCE_GAP_S, lead_influenced};
pub use segmenter::{MethodFigures, Segmenter};
pub use statistical::{
    Method, Optimality, Scaling, Segmented, Segments, StatisticalRules, dead_banded,
};
pub use stream::{PhaseStream, Reading, StreamedPhase};
