/// What is wrong with a problem.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Limits of acceleration out of range or order.
    #[error("point {index} of the acceleration limits: {problem}")]
    Envelope {
        /// Index of the point.
        index: usize,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// A channel has another number of values than its nodes or steps.
    #[error("`{channel}` has {found} values, expected {expected}")]
    Length {
        /// Name of the channel.
        channel: &'static str,
        /// Number of values.
        found: usize,
        /// Number that fits.
        expected: usize,
    },
    /// A value of a channel cannot be.
    #[error("`{channel}` at index {index} is {value}: {problem}")]
    Value {
        /// Name of the channel.
        channel: &'static str,
        /// Index of the value.
        index: usize,
        /// The value.
        value: f64,
        /// What is wrong with it, and what is allowed.
        problem: &'static str,
    },
    /// Something on the road cannot be as it is.
    #[error("at {position_m:.2} m: {problem}")]
    Place {
        /// Where, m from the start.
        position_m: f64,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// A setting is out of range.
    #[error("`{name}` is {value}: {expected}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// The value.
        value: f64,
        /// What is allowed.
        expected: &'static str,
    },
    /// A case file is not one.
    #[error("{file}: {source}")]
    Case {
        /// The file.
        file: String,
        /// What is wrong with it.
        source: serde_json::Error,
    },
    /// Signals and leaders are planned for cars whose losses are a formula.
    #[error(
        "the losses of the car are a table, with which signals and a leader cannot be planned yet; give losses by formula"
    )]
    TableInTraffic,
    /// There is no convex relaxation of the problem.
    #[cfg(feature = "convex")]
    #[error("the convex relaxation knows of no {what}; certify by the bound")]
    NotConvex {
        /// What is in the way.
        what: &'static str,
    },
    /// The vehicle cannot be.
    #[error(transparent)]
    Vehicle(#[from] ev_energy::Error),
}
