use serde::Serialize;

use crate::driver::SimulatedDriver;
use crate::error::{Error, check};

/// What to simulate. The default is twelve drives of 10 min, each about 0.3 MB as CSV.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SynthSettings {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Number of drives, 1 to 999.
    pub drives: usize,
    /// Duration of each, 10 s to a day.
    pub duration_s: f64,
    /// Sampling interval, 0.01 to 1 s.
    pub step_s: f64,
    /// The driver.
    pub driver: SimulatedDriver,
    /// How much phases and stretches differ: 0 not at all, 1 as with a real driver, at most 2.
    pub variation: f64,
    /// Whether sensors are noisy and coarse. Standard deviation and resolution of the noisy channels, resolution without
    /// noise: speed 0.015, 0.01, 10⁻⁴ m/s; elevation 0.1, 0.1, 10⁻³ m; gap 0.2, 0.1, 10⁻³ m; lead speed 0.1, 0.05,
    /// 10⁻⁴ m/s; voltage 0.15, 0.1, 10⁻³ V; current 0.4, 0.1, 10⁻³ A. Only coarser: slope 10⁻⁴, 10⁻⁵ rad; state of
    /// charge 0.1, 10⁻³ %. A standing wheel has no noise.
    pub sensor_noise: bool,
    /// Whether there are vehicles ahead now and then, and a sensor for them in the car.
    pub leaders: bool,
}

impl Default for SynthSettings {
    fn default() -> Self {
        Self {
            seed: 1,
            drives: 12,
            duration_s: 600.0,
            step_s: 0.1,
            driver: SimulatedDriver::default(),
            variation: 1.0,
            sensor_noise: true,
            leaders: true,
        }
    }
}

impl SynthSettings {
    /// Samples of one drive.
    pub(crate) fn samples(&self) -> usize {
        (self.duration_s / self.step_s).round() as usize
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        check("drives", self.drives as f64, 1.0..=999.0, "1 to 999")?;
        check("step_s", self.step_s, 0.01..=1.0, "0.01 to 1")?;
        check(
            "duration_s",
            self.duration_s,
            10.0..=86_400.0,
            "10 to 86400",
        )?;
        check("variation", self.variation, 0.0..=2.0, "0 to 2")?;
        let samples = self.drives as f64 * self.duration_s / self.step_s;
        check(
            "drives · duration_s / step_s",
            samples,
            1.0..=2e7,
            "at most 20 million samples",
        )?;
        self.driver.check()
    }
}
