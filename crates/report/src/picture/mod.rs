//! Pictures of speeds as SVG.

mod bands;
mod speed;

use plotters::drawing::DrawingAreaErrorKind;

pub use bands::{SpeedCurve, speeds_with_bands};
pub use speed::{Behaviour, SpeedPlot, Stretch, speed_with_phases};

/// The drawing library failed.
#[derive(Debug, thiserror::Error)]
#[error("the picture could not be drawn")]
pub struct PictureError(#[from] DrawingAreaErrorKind<std::io::Error>);
