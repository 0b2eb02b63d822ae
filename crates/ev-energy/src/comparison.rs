//! Modelled and measured power, compared in means over the same time.

use crate::operating_point::OperatingPoint;

/// Time over which power is averaged before it is compared, s: shorter, and it is the noise of the logger that is compared.
pub const COMPARISON_STEP_S: f64 = 0.5;

/// Modelled and measured power at the terminals, means over [`COMPARISON_STEP_S`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerMean {
    /// Time that the means cover, s; less than [`COMPARISON_STEP_S`] at the end of a stretch.
    pub duration_s: f64,
    /// Mean speed, m/s.
    pub speed_mps: f64,
    /// By the model, W.
    pub modelled_w: f64,
    /// Measured, W.
    pub measured_w: Option<f64>,
}

/// Averages power step by step. A mean ends where measurements begin or end.
#[derive(Debug, Clone)]
pub struct PowerAverager {
    step_s: f64,
    steps_per_mean: usize,
    is_measured: bool,
    steps: usize,
    speed_mps: f64,
    modelled_w: f64,
    measured_w: f64,
}

impl PowerAverager {
    /// For steps of `step_s`.
    #[must_use]
    pub fn new(step_s: f64) -> Self {
        Self {
            step_s,
            steps_per_mean: ((COMPARISON_STEP_S / step_s).round() as usize).max(1),
            is_measured: false,
            steps: 0,
            speed_mps: 0.0,
            modelled_w: 0.0,
            measured_w: 0.0,
        }
    }

    /// Adds a step, with the measured terminal power in W, NaN where there is none. Calls `visit` with every mean that is complete.
    pub fn add(&mut self, point: &OperatingPoint, measured_w: f64, visit: impl FnMut(&PowerMean)) {
        self.add_step(point.speed_mps, point.terminal_power_w, measured_w, visit);
    }

    /// As [`Self::add`], for a speed and a power of a model.
    pub(crate) fn add_step(
        &mut self,
        speed_mps: f64,
        modelled_w: f64,
        measured_w: f64,
        mut visit: impl FnMut(&PowerMean),
    ) {
        let is_measured = measured_w.is_finite();
        if is_measured != self.is_measured {
            self.finish(&mut visit);
            self.is_measured = is_measured;
        }
        self.steps += 1;
        self.speed_mps += speed_mps;
        self.modelled_w += modelled_w;
        self.measured_w += measured_w;
        if self.steps == self.steps_per_mean {
            self.finish(&mut visit);
        }
    }

    /// Ends the mean that was begun, if any.
    pub fn finish(&mut self, mut visit: impl FnMut(&PowerMean)) {
        if self.steps == 0 {
            return;
        }
        let steps = self.steps as f64;
        visit(&PowerMean {
            duration_s: steps * self.step_s,
            speed_mps: self.speed_mps / steps,
            modelled_w: self.modelled_w / steps,
            measured_w: self.is_measured.then_some(self.measured_w / steps),
        });
        self.steps = 0;
        self.speed_mps = 0.0;
        self.modelled_w = 0.0;
        self.measured_w = 0.0;
    }
}

/// Modelled against measured power at the battery terminals.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Comparison {
    /// Energy of the model over the steps that were measured, J.
    pub modelled_j: f64,
    /// Energy measured, J.
    pub measured_j: f64,
    /// Sum of squares of the differences in power, W².
    squares_w2: f64,
    /// How many there are.
    means: usize,
}

impl Comparison {
    /// Adds a mean; nothing where it was not measured.
    pub fn add(&mut self, mean: &PowerMean) {
        let Some(measured_w) = mean.measured_w else {
            return;
        };
        let off_w = mean.modelled_w - measured_w;
        self.modelled_j += mean.modelled_w * mean.duration_s;
        self.measured_j += measured_w * mean.duration_s;
        self.squares_w2 += off_w * off_w;
        self.means += 1;
    }

    /// Whether nothing was measured.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.means == 0
    }

    /// Model minus measurement over the magnitude of the measurement, %; `None` without one.
    #[must_use]
    pub fn error_pct(&self) -> Option<f64> {
        (self.measured_j != 0.0)
            .then(|| 100.0 * (self.modelled_j - self.measured_j) / self.measured_j.abs())
    }

    /// Root mean square of the differences in power, W; `None` where nothing was measured.
    #[must_use]
    pub fn power_rmse_w(&self) -> Option<f64> {
        (self.means > 0).then(|| (self.squares_w2 / self.means as f64).sqrt())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;
    use crate::Vehicle;

    #[test]
    fn means_end_with_half_a_second_and_with_the_measurement() {
        let vehicle = Vehicle::builtin("b250e").unwrap();
        let point = vehicle.operating_point(10.0, 0.0, 0.0);
        let mut averager = PowerAverager::new(0.1);
        let (mut durations, mut measured) = (Vec::new(), Vec::new());
        let mut keep = |mean: &PowerMean| {
            durations.push((mean.duration_s * 10.0).round());
            measured.push(mean.measured_w);
            assert!((mean.modelled_w - point.terminal_power_w).abs() < 1e-9);
        };
        for power_w in [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, f64::NAN, f64::NAN, 7.0] {
            averager.add(&point, power_w, &mut keep);
        }
        averager.finish(&mut keep);
        averager.finish(&mut keep);
        assert_eq!(durations, [5.0, 1.0, 2.0, 1.0]);
        assert_eq!(measured, [Some(3.0), Some(6.0), None, Some(7.0)]);
        assert_eq!(PowerAverager::new(1.0).steps_per_mean, 1);
    }
}
