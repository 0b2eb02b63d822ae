//! A robot and its place along the path.

use crate::pose::State;

/// A robot, and about where it is along the path as far as that is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Located {
    /// Of its point of interest
    pub state: State,
    /// Where its foot is, or was a moment before, in m along the path
    pub near_m: Option<f64>,
}

impl From<State> for Located {
    fn from(state: State) -> Self {
        let near_m = None;
        Self { state, near_m }
    }
}
