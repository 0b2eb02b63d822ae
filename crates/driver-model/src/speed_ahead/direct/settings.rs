use strum::VariantArray;

use crate::{DriverChannel, Error, error};

/// What direct predictions are made of.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectSettings {
    /// Seconds ahead, ascending; 1 to 10.
    pub horizons_s: Vec<f64>,
    /// Training samples, spread evenly over the drives; 16,000.
    pub max_samples: usize,
    /// Distance of training samples; 1 s.
    pub sample_step_s: f64,
    /// Whether the slope ahead is a predictor. Off: where the slope comes from the elevation that was recorded on the same drive,
    /// its errors tell where the drive stood still or went slowly.
    pub slope_ahead: bool,
    /// What models may be told of the driver beside speed and limits; all.
    pub channels: Vec<DriverChannel>,
    /// Share of drives that prediction intervals hold; 0.9.
    pub coverage: f64,
}

impl Default for DirectSettings {
    fn default() -> Self {
        Self {
            horizons_s: (1..=10).map(f64::from).collect(),
            max_samples: 16_000,
            sample_step_s: 1.0,
            slope_ahead: false,
            channels: DriverChannel::VARIANTS.to_vec(),
            coverage: 0.9,
        }
    }
}

impl DirectSettings {
    /// At these horizons, in any order; the rest by default.
    #[must_use]
    pub fn at(horizons_s: &[f64]) -> Self {
        let mut horizons_s = horizons_s.to_vec();
        horizons_s.sort_by(f64::total_cmp);
        horizons_s.dedup();
        Self {
            horizons_s,
            ..Self::default()
        }
    }

    pub(in crate::speed_ahead) fn check(&self) -> Result<(), Error> {
        let longest = self.horizons_s.iter().copied().fold(0.0, f64::max);
        error::at_least(
            "the number of horizons",
            self.horizons_s.len() as f64,
            1.0,
            "at least 1",
        )?;
        for &horizon_s in &self.horizons_s {
            error::at_least("horizon_s", horizon_s, 0.1, "0.1 s to 60 s")?;
        }
        if longest > 60.0 {
            return Err(Error::Option {
                name: "horizon_s",
                value: longest,
                expected: "0.1 s to 60 s",
            });
        }
        if !(self.coverage > 0.0 && self.coverage < 1.0) {
            return Err(Error::Option {
                name: "coverage",
                value: self.coverage,
                expected: "between 0 and 1",
            });
        }
        error::at_least("sample_step_s", self.sample_step_s, 0.0, "at least 0 s")
    }
}
