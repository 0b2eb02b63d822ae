/// What this crate refuses, with the offending value and where it was. Indices are 0-based.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A series without variables.
    #[error("the series has no variable; give at least one")]
    NoVariables,
    /// An input without samples.
    #[error("the input has no sample; give at least one")]
    NoSamples,
    /// Inputs that should have one value per sample differ in length.
    #[error(
        "variable {variable} has {len} samples where {expected} were expected; cut or resample it"
    )]
    Length {
        /// Index of the variable; 0 where there is only one.
        variable: usize,
        /// Its number of samples.
        len: usize,
        /// The number of samples of the others.
        expected: usize,
    },
    /// A sample of a stream has not one value per variable.
    #[error("the sample has {found} values where the stream has {expected} variables")]
    Variables {
        /// Number of values given.
        found: usize,
        /// Number of variables.
        expected: usize,
    },
    /// A sample is NaN or infinite.
    #[error("variable {variable}, sample {sample} is {value}; fill or drop it first")]
    NotFinite {
        /// Index of the variable; 0 where there is only one.
        variable: usize,
        /// Index of the sample.
        sample: usize,
        /// The value found.
        value: f64,
    },
    /// A sample is so large that sums on the grid of 2⁻³² would overflow.
    #[error(
        "variable {variable}, sample {sample} is {value}, beyond ±{limit} for this number of samples; \
         scale the variable or split the series"
    )]
    TooLarge {
        /// Index of the variable.
        variable: usize,
        /// Index of the sample.
        sample: usize,
        /// The value found.
        value: f64,
        /// The largest magnitude allowed.
        limit: f64,
    },
    /// A weight is negative, NaN or infinite.
    #[error("variable {variable} has weight {weight}; weights are finite and at least 0")]
    Weight {
        /// Index of the variable.
        variable: usize,
        /// The weight given.
        weight: f64,
    },
    /// A threshold is negative, NaN or infinite.
    #[error("the threshold is {value}; it must be finite and at least 0")]
    Threshold {
        /// The threshold given.
        value: f64,
    },
    /// A segmentation into no segments.
    #[error("0 segments were asked for; give at least 1")]
    NoSegments,
    /// More segments than the series has room for.
    #[error(
        "{segments} segments of at least {min_length} samples need {} samples, the series has {samples}; \
         ask for fewer or shorter segments",
        .segments.saturating_mul(*.min_length)
    )]
    TooManySegments {
        /// The number of segments asked for.
        segments: usize,
        /// The least number of samples of each.
        min_length: usize,
        /// The number of samples of the series.
        samples: usize,
    },
    /// Costs may exceed the largest `f64`.
    #[error("the weights are so large that costs overflow; scale them down")]
    CostOverflow,
    /// The caller cancelled a long computation.
    #[error("cancelled")]
    Cancelled,
    /// A window of no samples.
    #[error("the window has 0 samples; give at least 1")]
    Window,
    /// Boundaries that do not start at 0 or do not increase strictly.
    #[error(
        "boundary {index} is {boundary}; boundaries start at 0, increase strictly and number at least 2"
    )]
    Boundaries {
        /// Index of the first boundary that breaks the rule.
        index: usize,
        /// Its value.
        boundary: usize,
    },
    /// A segment that is empty or ends after the last sample.
    #[error("the segment {start}..{end} is empty or exceeds the {len} samples of the series")]
    Segment {
        /// First sample.
        start: usize,
        /// One past the last sample.
        end: usize,
        /// Number of samples of the series.
        len: usize,
    },
}

/// Refuses a threshold that is negative or not finite.
pub(crate) fn check_threshold(value: f64) -> Result<f64, Error> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(Error::Threshold { value })
    }
}

/// Refuses samples of the given variable that are NaN or infinite.
pub(crate) fn check_finite(variable: usize, samples: &[f64]) -> Result<(), Error> {
    match samples.iter().position(|x| !x.is_finite()) {
        Some(sample) => Err(Error::NotFinite {
            variable,
            sample,
            value: samples[sample],
        }),
        None => Ok(()),
    }
}

/// Refuses a variable that has not the expected number of samples.
pub(crate) fn check_length(variable: usize, len: usize, expected: usize) -> Result<(), Error> {
    if len == expected {
        Ok(())
    } else {
        Err(Error::Length {
            variable,
            len,
            expected,
        })
    }
}
