//! Pictures of speeds and plans as SVG.

mod bands;
mod plan;
mod sheet;
mod speed;
#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
mod well_formed;

use plotters::drawing::DrawingAreaErrorKind;

pub use bands::{SpeedCurve, speeds_with_bands};
pub use plan::{Effort, PlanPicture, RoadRun, SignalTimes, plan_over_road};
pub use speed::{Behaviour, SpeedPlot, Stretch, speed_with_phases};

/// The drawing library failed.
#[derive(Debug, thiserror::Error)]
#[error("the picture could not be drawn")]
pub struct PictureError(#[from] DrawingAreaErrorKind<std::io::Error>);
