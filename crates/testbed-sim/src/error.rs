//! What can be wrong with a run, and with a run log that is to be replayed.

/// Why something cannot be run or replayed. Every message says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A disturbance out of its range.
    #[error(
        "disturbance `{name}` is {value}; it must be from 0 to {most}, in the unit of its name: m, rad, s, m/s, and shares as 0.1 for 10 %"
    )]
    Disturbance {
        /// Name of the setting.
        name: &'static str,
        /// What was given.
        value: f64,
        /// Largest allowed value.
        most: f64,
    },
    /// A scenario that cannot be.
    #[error("scenario: {0}")]
    Scenario(#[from] unicycle_cbf::Error),
    /// One of several scenarios that cannot be.
    #[error("scenario `{name}`: {source}")]
    NamedScenario {
        /// Its name or file.
        name: String,
        /// What is wrong with it.
        source: unicycle_cbf::Error,
    },
    /// A desired speed that is no number.
    #[error("desired_speed_mps is {speed_mps}; it must be finite")]
    DesiredSpeed {
        /// What was given.
        speed_mps: f64,
    },
    /// A heading of more than a turn in a state that is to be explained.
    #[error(
        "heading_rad of the {robot} is {heading_rad}, more than a turn; is it in degrees? give headings in rad, between −π and π or 0 and 2π"
    )]
    Heading {
        /// Follower or leader.
        robot: &'static str,
        /// What was given.
        heading_rad: f64,
    },
    /// Settings of a controller that cannot be.
    #[error(transparent)]
    Controller(unicycle_cbf::Error),
    /// Ticks of a run log that are not in the order in which they were decided.
    #[error("the run log is not in order at step {step}; replay it as it was written")]
    Order {
        /// The first step that is not.
        step: usize,
    },
}
