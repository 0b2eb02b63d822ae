use serde::{Deserialize, Serialize};

use crate::{Error, PhaseCurve, TrainingSet};

/// The driver's mean normalised shape `(v − v0)/(v_end − v0)` over `t/T`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// The shape at `t/T = 0, 1/(m−1), …, 1`; the first value is 0 and the last 1.
    pub shape: Vec<f64>,
}

/// Knots of the shape; a phase of 10 s at 10 Hz has about as many samples.
const KNOTS: usize = 101;

impl Profile {
    /// Averages the normalised curves.
    ///
    /// # Errors
    /// [`Error::TooFewPhases`] without a phase.
    pub fn fit(training: &TrainingSet<'_>) -> Result<Self, Error> {
        super::need_phases("profile", &training.phases)?;
        let mut shape = vec![0.0; KNOTS];
        let mut weights = 0.0;
        for phase in &training.phases {
            for (sum, value) in shape.iter_mut().zip(normalised(phase.curve, KNOTS)) {
                *sum += phase.weight * value;
            }
            weights += phase.weight;
        }
        for value in &mut shape {
            *value /= weights;
        }
        shape[0] = 0.0;
        shape[KNOTS - 1] = 1.0;
        Ok(Self { shape })
    }

    /// Speed in m/s at the share `t/T` of the phase, in 0 to 1.
    #[must_use]
    pub fn speed_mps(&self, start_speed_mps: f64, end_speed_mps: f64, share: f64) -> f64 {
        let position = share.clamp(0.0, 1.0) * (self.shape.len() - 1) as f64;
        start_speed_mps + (end_speed_mps - start_speed_mps) * at(&self.shape, position)
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        let knots = self.shape.len();
        super::parameter(
            "profile",
            "shape",
            knots as f64,
            (2..=100_000).contains(&knots),
            "2 to 100000 values",
        )?;
        self.shape.iter().try_for_each(|&value| {
            super::parameter(
                "profile",
                "shape",
                value,
                value.abs() <= 10.0,
                "values within ±10",
            )
        })
    }
}

/// `(v − v0)/(v_end − v0)` of a measured phase at so many equal steps of `t/T`.
pub(super) fn normalised(curve: &PhaseCurve, knots: usize) -> impl Iterator<Item = f64> {
    let speed = curve.speed_mps();
    let (start, gain) = (speed[0], curve.outline().gain_mps());
    let scale = (speed.len() - 1) as f64 / (knots - 1) as f64;
    (0..knots).map(move |knot| (at(speed, knot as f64 * scale) - start) / gain)
}

/// `values` at a fractional index in `0..=len − 1`, linear in between.
pub(super) fn at(values: &[f64], position: f64) -> f64 {
    let left = (position.floor() as usize).min(values.len() - 1);
    let right = (left + 1).min(values.len() - 1);
    let share = position - left as f64;
    values[left] + (values[right] - values[left]) * share
}
