/// What this crate refuses, with the offending value and where it was. Indices are 0-based.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is nothing to learn from or to predict.
    #[error("no samples; give at least one")]
    NoSamples,
    /// Predictors do not come in whole rows.
    #[error(
        "{values} predictor values are no whole number of samples of {predictors} predictors each"
    )]
    Shape {
        /// Number of values given.
        values: usize,
        /// Predictors per sample.
        predictors: usize,
    },
    /// Two inputs that belong together differ in size.
    #[error("{found} {what} where {expected} were expected")]
    Length {
        /// What was counted.
        what: &'static str,
        /// Number found.
        found: usize,
        /// Number expected.
        expected: usize,
    },
    /// A value is NaN or infinite.
    #[error("{what} of sample {sample} is {value}; fill it in or leave the sample out")]
    NotFinite {
        /// What was looked at.
        what: &'static str,
        /// Index of the sample.
        sample: usize,
        /// The value found.
        value: f64,
    },
    /// A setting out of range.
    #[error("{name} is {value}; it must be {must_be}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// The value given.
        value: f64,
        /// What it must be.
        must_be: &'static str,
    },
    /// The memory limit is too small for the data.
    #[error(
        "{samples} samples need at least {needed_bytes} bytes, the memory limit is {limit_bytes}; raise it or use landmarks"
    )]
    Memory {
        /// Number of samples.
        samples: usize,
        /// Least memory that would do.
        needed_bytes: usize,
        /// The limit given.
        limit_bytes: usize,
    },
    /// A model from a file contradicts itself.
    #[error("not a model: {0}")]
    Model(&'static str),
    /// A matrix of kernel values or products is not positive definite.
    #[error("kernel values overflow or are of too different size; scale the predictors")]
    NotPositiveDefinite,
}

impl Error {
    pub(crate) fn unless(
        holds: bool,
        name: &'static str,
        value: f64,
        must_be: &'static str,
    ) -> Result<(), Self> {
        if holds {
            Ok(())
        } else {
            Err(Self::Setting {
                name,
                value,
                must_be,
            })
        }
    }
}
