use serde::{Deserialize, Serialize};

use crate::least_squares::Curve;
use crate::{AccelPoint, Error, ModelKind};

/// `a(v) = p0·e^(−p1 v) + p2` (thesis 3.2; the printed form has `p0 = 1`, which fixes the amplitude at 1 m/s²).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exponential {
    /// Amplitude `p0` in m/s², 1 in the printed form.
    pub p0: f64,
    /// Decay `p1` in s/m, at least 0.
    pub p1: f64,
    /// Offset `p2` in m/s².
    pub p2: f64,
}

const PRINTED: Curve<2> = Curve {
    model: "exponential",
    value: |p, v| (-p[0] * v).exp() + p[1],
    gradient: |p, v| [-v * (-p[0] * v).exp(), 1.0],
    lower: [0.0, -1.0],
    upper: [2.0, 5.0],
    starts: &[[0.05, 0.3], [0.5, 0.8], [0.01, 0.0]],
};

const WITH_AMPLITUDE: Curve<3> = Curve {
    model: "exponential-amplitude",
    value: |p, v| p[0] * (-p[1] * v).exp() + p[2],
    gradient: |p, v| {
        let e = (-p[1] * v).exp();
        [e, -v * p[0] * e, 1.0]
    },
    lower: [0.0, 0.0, -1.0],
    upper: [10.0, 2.0, 5.0],
    starts: &[[1.0, 0.05, 0.3], [2.5, 0.2, 0.5], [2.0, 0.01, -0.2]],
};

impl Exponential {
    /// Fits the printed form, `p0 = 1`, `0 ≤ p1 ≤ 2`, `−1 ≤ p2 ≤ 5`, to points of acceleration over speed.
    ///
    /// # Errors
    /// [`Error::TooFewPhases`] below two points, [`Error::Fit`] when the optimiser fails.
    pub fn fit_printed(points: &[AccelPoint]) -> Result<Self, Error> {
        super::need_points(PRINTED.model, points, 2)?;
        let [p1, p2] = PRINTED.fit(points)?.parameters;
        Ok(Self { p0: 1.0, p1, p2 })
    }

    /// Fits all three parameters, `0 ≤ p0 ≤ 10` and the others as in [`Self::fit_printed`].
    ///
    /// # Errors
    /// [`Error::TooFewPhases`] below three points, [`Error::Fit`] when the optimiser fails.
    pub fn fit_with_amplitude(points: &[AccelPoint]) -> Result<Self, Error> {
        super::need_points(WITH_AMPLITUDE.model, points, 3)?;
        let [p0, p1, p2] = WITH_AMPLITUDE.fit(points)?.parameters;
        Ok(Self { p0, p1, p2 })
    }

    /// Sum of squared residuals in (m/s²)², the entry of Table 3.6; weights are not applied.
    #[must_use]
    pub fn residual_sum_of_squares(&self, points: &[AccelPoint]) -> f64 {
        let Self { p0, p1, p2 } = *self;
        points
            .iter()
            .map(|p| (p0 * (-p1 * p.speed_mps).exp() + p2 - p.accel_mps2).powi(2))
            .sum()
    }

    /// Speed in m/s at `t_s` seconds after the phase began at `start_speed_mps`; braking is acceleration in reversed time,
    /// `t_s` below 0.
    ///
    /// With `x = p1 p2 t` the solution of `v̇ = a(v)` is
    /// `v = v0 + p2 t + ln(1 + p0 p1 t e^(−p1 v0) (1 − e^(−x))/x)/p1`, which is the closed form of the thesis
    /// without its singularity at `p2 = 0`, and neither overflows nor cancels. In reversed time the logarithm ends where the
    /// speed has fallen without bound: 0.
    #[must_use]
    pub fn speed_mps(&self, start_speed_mps: f64, t_s: f64) -> f64 {
        let Self { p0, p1, p2 } = *self;
        if p1 * t_s.abs() < 1e-12 {
            return start_speed_mps + (p0 * (-p1 * start_speed_mps).exp() + p2) * t_s;
        }
        let x = p1 * p2 * t_s;
        let d = (p0 * p1 * t_s.abs()).ln() + ln_mean_decay(x) - p1 * start_speed_mps;
        if t_s > 0.0 {
            let softplus = d.max(0.0) + (-d.abs()).exp().ln_1p();
            return start_speed_mps + p2 * t_s + softplus / p1;
        }
        let left = -d.exp();
        if left <= -1.0 {
            return 0.0;
        }
        start_speed_mps + p2 * t_s + left.ln_1p() / p1
    }

    pub(crate) fn check(&self, kind: ModelKind) -> Result<(), Error> {
        if kind == ModelKind::Exponential {
            super::parameter(
                PRINTED.model,
                "p0",
                self.p0,
                (self.p0 - 1.0).abs() < f64::EPSILON,
                "1 in the printed form",
            )?;
        }
        WITH_AMPLITUDE.check(["p0", "p1", "p2"], &[self.p0, self.p1, self.p2])
    }
}

/// `ln((1 − e^(−x))/x)`, 0 at `x = 0`.
fn ln_mean_decay(x: f64) -> f64 {
    let magnitude = x.abs();
    let of_magnitude = if magnitude < 1e-8 {
        -0.5 * magnitude
    } else {
        (-(-magnitude).exp_m1() / magnitude).ln()
    };
    of_magnitude + (-x).max(0.0)
}
