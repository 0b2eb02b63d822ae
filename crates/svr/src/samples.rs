use crate::Error;

/// Predictors of samples, row by row: value `k` of sample `i` is at `i·predictors + k`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Samples<'a> {
    values: &'a [f64],
    predictors: usize,
}

impl<'a> Samples<'a> {
    /// Takes the rows of `predictors` values each.
    ///
    /// # Errors
    /// [`Error::NoSamples`], [`Error::Shape`] and [`Error::NotFinite`].
    pub fn new(values: &'a [f64], predictors: usize) -> Result<Self, Error> {
        if predictors == 0 || !values.len().is_multiple_of(predictors) {
            return Err(Error::Shape {
                values: values.len(),
                predictors,
            });
        }
        if values.is_empty() {
            return Err(Error::NoSamples);
        }
        match values.iter().position(|value| !value.is_finite()) {
            Some(at) => Err(Error::NotFinite {
                what: "a predictor",
                sample: at / predictors,
                value: values[at],
            }),
            None => Ok(Self { values, predictors }),
        }
    }

    /// Number of samples, at least one.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "never empty")]
    pub fn len(&self) -> usize {
        self.values.len() / self.predictors
    }

    /// Predictors per sample.
    #[must_use]
    pub fn predictors(&self) -> usize {
        self.predictors
    }

    /// All values, row by row.
    #[must_use]
    pub fn values(&self) -> &'a [f64] {
        self.values
    }

    /// One sample after the other.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &'a [f64]> {
        self.values.chunks_exact(self.predictors)
    }
}

/// What is to be learnt: one value per sample, and how much each counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response<'a> {
    values: &'a [f64],
    weights: Option<&'a [f64]>,
}

impl<'a> Response<'a> {
    /// All samples count the same.
    ///
    /// # Errors
    /// [`Error::NoSamples`] and [`Error::NotFinite`].
    pub fn new(values: &'a [f64]) -> Result<Self, Error> {
        if values.is_empty() {
            return Err(Error::NoSamples);
        }
        match values.iter().position(|value| !value.is_finite()) {
            Some(sample) => Err(Error::NotFinite {
                what: "the response",
                sample,
                value: values[sample],
            }),
            None => Ok(Self {
                values,
                weights: None,
            }),
        }
    }

    /// Weight `w_i ≥ 0` multiplies the box constraint of sample `i`; a weight of 0 leaves it out.
    ///
    /// # Errors
    /// [`Error::Length`], and [`Error::Setting`] for a weight that is negative or not finite.
    pub fn weighted(self, weights: &'a [f64]) -> Result<Self, Error> {
        if weights.len() != self.values.len() {
            return Err(Error::Length {
                what: "weights",
                found: weights.len(),
                expected: self.values.len(),
            });
        }
        let worst = weights.iter().find(|w| !(w.is_finite() && **w >= 0.0));
        if let Some(&value) = worst {
            return Err(Error::Setting {
                name: "a sample weight",
                value,
                must_be: "finite and at least 0",
            });
        }
        Ok(Self {
            weights: Some(weights),
            ..self
        })
    }

    /// The values, one per sample.
    #[must_use]
    pub fn values(&self) -> &'a [f64] {
        self.values
    }

    pub(crate) fn weight(&self, sample: usize) -> f64 {
        self.weights.map_or(1.0, |weights| weights[sample])
    }
}
