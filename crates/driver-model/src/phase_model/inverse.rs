use serde::{Deserialize, Serialize};

use crate::least_squares::Curve;
use crate::{AccelPoint, Error};

/// `a(v) = 1/(p1 v + p2)` (thesis 3.29).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Inverse {
    /// `p1` in s³/m², at least 0: acceleration does not grow with speed.
    pub p1: f64,
    /// `p2` in s²/m, above 0: the inverse of the acceleration at standstill.
    pub p2: f64,
}

const CURVE: Curve<2> = Curve {
    model: "inverse",
    value: |p, v| 1.0 / (p[0] * v + p[1]),
    gradient: |p, v| {
        let a = 1.0 / (p[0] * v + p[1]);
        [-v * a * a, -a * a]
    },
    lower: [0.0, 0.05],
    upper: [1.0, 20.0],
    starts: &[[0.03, 0.5], [0.3, 0.1], [0.005, 2.0]],
};

impl Inverse {
    /// Fits to points of acceleration over speed, `0 ≤ p1 ≤ 1`, `0.05 ≤ p2 ≤ 20`.
    ///
    /// # Errors
    /// [`Error::TooFewPhases`] below two points, [`Error::Fit`] when the optimiser fails.
    pub fn fit(points: &[AccelPoint]) -> Result<Self, Error> {
        super::need_points("inverse", points, 2)?;
        let [p1, p2] = CURVE.fit(points)?.parameters;
        Ok(Self { p1, p2 })
    }

    /// Sum of squared residuals in (m/s²)², the entry of Table 3.6; weights are not applied.
    #[must_use]
    pub fn residual_sum_of_squares(&self, points: &[AccelPoint]) -> f64 {
        points
            .iter()
            .map(|p| (1.0 / (self.p1 * p.speed_mps + self.p2) - p.accel_mps2).powi(2))
            .sum()
    }

    /// Speed in m/s at `t_s` seconds after the phase began at `start_speed_mps` (thesis 3.31, corrected: the root
    /// that holds while braking too and as `p1 → 0`). Braking is acceleration in reversed time, `t_s` below 0.
    #[must_use]
    pub fn speed_mps(&self, start_speed_mps: f64, t_s: f64) -> f64 {
        let d = self.p1 * start_speed_mps + self.p2;
        let root = (d * d + 2.0 * self.p1 * t_s).max(0.0).sqrt();
        start_speed_mps + 2.0 * t_s / (d + root.copysign(d))
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        CURVE.check(["p1", "p2"], &[self.p1, self.p2])
    }
}
