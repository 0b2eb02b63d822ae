//! Support vector regression.
mod deadline;
mod error;
mod expansion;
mod folds;
mod kernel;
mod kernel_rows;
mod linear;
mod model;
mod nystrom;
mod quantile;
mod samples;
mod scaler;
mod search;
mod settings;
mod subproblem;
mod trainer;
mod two_variable;
mod vectorised;

pub use error::Error;
pub use folds::{Fold, blocked_folds, grouped_folds, hold_out};
pub use kernel::Kernel;
pub use model::Model;
pub use samples::{Response, Samples};
pub use scaler::{Scaler, Scaling};
pub use search::{Candidate, Grid, search};
pub use settings::{Landmarks, Penalty, Settings, Stopping, UsedPenalty};
pub use trainer::{Fit, Status, Trainer, fit};
