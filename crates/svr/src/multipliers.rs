use crate::vectorised::vectorised;

/// Multipliers of one side of the tube, and of their bounds.
pub(crate) struct Multipliers {
    pub(crate) m: Vec<f64>,
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
}

/// A step of them.
#[derive(Clone)]
pub(crate) struct Step {
    pub(crate) m: Vec<f64>,
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
}

impl Step {
    pub(crate) fn zero(n: usize) -> Self {
        Self {
            m: vec![0.0; n],
            lower: vec![0.0; n],
            upper: vec![0.0; n],
        }
    }
}

impl Multipliers {
    /// In the middle, with bound multipliers that differ by `slack` and have the product `tau²`.
    pub(crate) fn centred(bound: &[f64], slack: impl Iterator<Item = f64>, tau: f64) -> Self {
        let (mut lower, mut upper) = (
            Vec::with_capacity(bound.len()),
            Vec::with_capacity(bound.len()),
        );
        for s in slack {
            // The smaller of the two by the product, not by a difference.
            let large = 0.5 * (s.abs() + s.hypot(2.0 * tau));
            let small = tau * tau / large;
            lower.push(if s > 0.0 { large } else { small });
            upper.push(if s > 0.0 { small } else { large });
        }
        Self {
            m: bound.iter().map(|c| 0.5 * c).collect(),
            lower,
            upper,
        }
    }

    pub(crate) fn products(&self, bound: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (i, &c) in bound.iter().enumerate() {
            sum += self.m[i] * self.lower[i] + (c - self.m[i]) * self.upper[i];
        }
        sum
    }

    /// `θ` and `g` of `Δm = (g ∓ p)/θ`, for the centre `mu` and the second-order terms of `predictor`.
    pub(crate) fn newton(
        &self,
        bound: &[f64],
        mu: f64,
        predictor: Option<&Step>,
        theta: &mut [f64],
        g: &mut [f64],
    ) {
        vectorised(
            #[inline(always)]
            || {
                for (i, &c) in bound.iter().enumerate() {
                    let (m, rest) = (self.m[i], c - self.m[i]);
                    let (mut low, mut high) = (mu, mu);
                    if let Some(step) = predictor {
                        low -= step.m[i] * step.lower[i];
                        high += step.m[i] * step.upper[i];
                    }
                    theta[i] = self.lower[i] / m + self.upper[i] / rest;
                    g[i] = (low / m - self.lower[i]) - (high / rest - self.upper[i]);
                }
            },
        );
    }

    /// The step for the movement `p` of this side's slack, and how much of it keeps everything positive.
    #[expect(clippy::too_many_arguments, reason = "one loop over all of it")]
    pub(crate) fn resolve(
        &self,
        bound: &[f64],
        mu: f64,
        predictor: Option<&Step>,
        theta: &[f64],
        g: &[f64],
        p: &[f64],
        sign: f64,
        step: &mut Step,
    ) -> f64 {
        let mut worst = [0.0_f64; 4];
        for (i, &c) in bound.iter().enumerate() {
            let (m, rest) = (self.m[i], c - self.m[i]);
            let (mut low, mut high) = (mu, mu);
            if let Some(step) = predictor {
                low -= step.m[i] * step.lower[i];
                high += step.m[i] * step.upper[i];
            }
            let dm = (g[i] - sign * p[i]) / theta[i];
            let dlower = (low - self.lower[i] * dm) / m - self.lower[i];
            let dupper = (high + self.upper[i] * dm) / rest - self.upper[i];
            worst[0] = worst[0].max(-dm / m);
            worst[1] = worst[1].max(dm / rest);
            worst[2] = worst[2].max(-dlower / self.lower[i]);
            worst[3] = worst[3].max(-dupper / self.upper[i]);
            (step.m[i], step.lower[i], step.upper[i]) = (dm, dlower, dupper);
        }
        worst.into_iter().fold(0.0, f64::max)
    }

    pub(crate) fn products_after(&self, bound: &[f64], step: &Step, length: f64) -> f64 {
        let mut sum = 0.0;
        for (i, &c) in bound.iter().enumerate() {
            let m = self.m[i] + length * step.m[i];
            sum += m * (self.lower[i] + length * step.lower[i])
                + (c - m) * (self.upper[i] + length * step.upper[i]);
        }
        sum
    }

    pub(crate) fn advance(&mut self, step: &Step, length: f64) {
        for (values, steps) in [
            (&mut self.m, &step.m),
            (&mut self.lower, &step.lower),
            (&mut self.upper, &step.upper),
        ] {
            for (value, step) in values.iter_mut().zip(steps) {
                *value += length * step;
            }
        }
    }
}
