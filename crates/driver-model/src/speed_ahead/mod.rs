//! The speed of the next seconds, or of a whole trip, from speed limits and own past: chapter 4 of the thesis, and beyond it.

mod boosted_trees;
mod direct;
mod interval;
mod kind;
mod predictors;
mod selection;
mod trial;

pub(crate) use direct::LEAST_PAST_S;
pub use direct::{DirectModel, DirectSettings, HorizonScore, SpeedAhead, origins};
pub use trial::{FittedTrial, Trial, TrialSettings};

/// Memory of the kernel rows of one fit; as many fits run at once as there are threads.
const FIT_MEMORY_BYTES: usize = 400_000_000;
