/// What is wrong with what assistance is asked for.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The road is none that the driver can drive.
    #[error(transparent)]
    Driver(#[from] driver_model::Error),
    /// The problem cannot be.
    #[error(transparent)]
    Plan(#[from] speed_plan::Error),
    /// The driver's own way over the road cannot be driven.
    #[error("the driver's own way cannot be driven: {0}")]
    OwnWay(speed_plan::Obstacle),
    /// The driver stands at a signal for ever.
    #[error(
        "the driver's own way does not pass the signal at {position_m:.0} m: it is red from {arrival_s:.0} s on"
    )]
    Red {
        /// Where it is.
        position_m: f64,
        /// When the driver is there.
        arrival_s: f64,
    },
    /// A style out of range.
    #[error("`style` is {value}: give half-widths of the driver's band from 0 to 100")]
    Style {
        /// The style.
        value: f64,
    },
}
