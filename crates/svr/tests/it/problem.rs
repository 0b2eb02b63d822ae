//! Random problems, and everything a solution is checked against, written down naively.

use svr::{Fit, Kernel, Model, Penalty, Response, Samples, Settings, Stopping, fit};

pub(crate) const KERNELS: [Kernel; 4] = [
    Kernel::Linear,
    Kernel::Quadratic,
    Kernel::Cubic,
    Kernel::Rbf,
];

/// SplitMix64.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From 0 to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From −1 to 1.
    pub(crate) fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// About normal, by the sum of twelve.
    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}

/// Predictors and a response with one kink and noise.
pub(crate) fn noisy(n: usize, d: usize, noise: f64, seed: u64) -> (Vec<f64>, Vec<f64>) {
    let mut random = Random(seed);
    let x: Vec<f64> = (0..n * d).map(|_| random.normal()).collect();
    let y = x
        .chunks(d)
        .map(|row| smooth(row) + noise * random.normal())
        .collect();
    (x, y)
}

pub(crate) fn smooth(row: &[f64]) -> f64 {
    let slope = |k: usize| 1.0 / (1.0 + k as f64);
    let sum: f64 = row.iter().enumerate().map(|(k, x)| slope(k) * x).sum();
    sum + (1.5 * row[0]).sin()
}

pub(crate) fn precise(kernel: Kernel, tolerance: f64) -> Settings {
    Settings {
        kernel,
        stopping: Stopping {
            tolerance: Some(tolerance),
            ..Stopping::default()
        },
        ..Settings::default()
    }
}

/// A tolerance tight enough to compare solutions by, for responses of about 1.
pub(crate) fn tight(kernel: Kernel) -> Settings {
    precise(
        kernel,
        if kernel == Kernel::Linear {
            1e-12
        } else {
            1e-9
        },
    )
}

pub(crate) fn penalty(box_constraint: f64, tube_epsilon: f64) -> Penalty {
    Penalty {
        box_constraint: Some(box_constraint),
        tube_epsilon: Some(tube_epsilon),
    }
}

pub(crate) fn fit_to(
    x: &[f64],
    d: usize,
    y: &[f64],
    settings: &Settings,
    penalty: &Penalty,
) -> Fit {
    let samples = Samples::new(x, d).expect("samples");
    fit(
        &samples,
        &Response::new(y).expect("responses"),
        settings,
        penalty,
    )
    .expect("a fit")
}

pub(crate) fn predict(model: &Model, x: &[f64]) -> Vec<f64> {
    let samples = Samples::new(x, model.predictors()).expect("samples");
    model.predict(&samples).expect("predictions")
}

pub(crate) fn greatest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    // A NaN counts as far off.
    let apart = |(a, b): (&f64, &f64)| {
        let difference = (a - b).abs();
        if difference.is_nan() {
            f64::INFINITY
        } else {
            difference
        }
    };
    a.iter().zip(b).map(apart).fold(0.0, f64::max)
}

pub(crate) fn naive_kernel(kernel: Kernel, scale: f64, a: &[f64], b: &[f64]) -> f64 {
    let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / (scale * scale);
    let distance: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
    match kernel {
        Kernel::Linear => product,
        Kernel::Quadratic => (1.0 + product).powi(2),
        Kernel::Cubic => (1.0 + product).powi(3),
        Kernel::Rbf => (-distance / (scale * scale)).exp(),
    }
}

/// Means and standard deviations of the columns; a deviation of 0 makes the column 0.
pub(crate) fn standardised(x: &[f64], d: usize, like: &[f64]) -> Vec<f64> {
    let n = (like.len() / d) as f64;
    let column = |k: usize| like.iter().skip(k).step_by(d);
    let scales: Vec<(f64, f64)> = (0..d)
        .map(|k| {
            let mean = column(k).sum::<f64>() / n;
            let square: f64 = column(k).map(|x| (x - mean) * (x - mean)).sum();
            let deviation = (square / (n - 1.0).max(1.0)).sqrt();
            let most = column(k).fold(0.0_f64, |most, x| most.max(x.abs()));
            (
                mean,
                if deviation > 1e-12 * most {
                    deviation
                } else {
                    f64::INFINITY
                },
            )
        })
        .collect();
    let scaled = |(i, x): (usize, &f64)| (x - scales[i % d].0) / scales[i % d].1;
    x.iter().enumerate().map(scaled).collect()
}

/// A problem on the scale on which it is solved.
pub(crate) struct Naive {
    pub(crate) kernel: Vec<Vec<f64>>,
    pub(crate) response: Vec<f64>,
    pub(crate) bound: Vec<f64>,
    pub(crate) tube_epsilon: f64,
}

/// What a solution of it is worth.
pub(crate) struct Worth {
    pub(crate) primal: f64,
    pub(crate) dual: f64,
    /// `(Kβ)_i`.
    pub(crate) products: Vec<f64>,
}

impl Naive {
    pub(crate) fn new(
        kernel: Kernel,
        scale: f64,
        scaled: &[f64],
        d: usize,
        response: &[f64],
        bound: Vec<f64>,
        tube_epsilon: f64,
    ) -> Self {
        let rows = || scaled.chunks(d);
        let row = |a: &[f64]| rows().map(|b| naive_kernel(kernel, scale, a, b)).collect();
        Self {
            kernel: rows().map(row).collect(),
            response: response.to_vec(),
            bound,
            tube_epsilon,
        }
    }

    /// `Kβ`.
    pub(crate) fn products(&self, beta: &[f64]) -> Vec<f64> {
        let product = |row: &Vec<f64>| row.iter().zip(beta).map(|(k, b)| k * b).sum();
        self.kernel.iter().map(product).collect()
    }

    pub(crate) fn worth(&self, beta: &[f64], products: Vec<f64>, bias: f64) -> Worth {
        let (mut square, mut loss, mut gain) = (0.0, 0.0, 0.0);
        for (i, &y) in self.response.iter().enumerate() {
            square += beta[i] * products[i];
            gain += y * beta[i] - self.tube_epsilon * beta[i].abs();
            loss += self.bound[i] * ((y - products[i] - bias).abs() - self.tube_epsilon).max(0.0);
        }
        Worth {
            primal: 0.5 * square + loss,
            dual: gain - 0.5 * square,
            products,
        }
    }

    /// Greatest difference of what raising one coefficient gains and lowering another costs. Coefficients nearer than
    /// the share `near` of the bound to the bound or 0, or of the greatest to 0, count as there.
    pub(crate) fn violation(&self, beta: &[f64], products: &[f64], near: f64) -> f64 {
        let most = beta.iter().fold(0.0_f64, |most, b| most.max(b.abs()));
        let (mut gain, mut cost) = (f64::NEG_INFINITY, f64::INFINITY);
        for (i, (&b, &c)) in beta.iter().zip(&self.bound).enumerate() {
            // Residual without bias: raising gains r − ε where β ≥ 0, r + ε where β < 0; lowering likewise.
            let r = self.response[i] - products[i];
            let (zero, full) = (b.abs() <= near * c.min(most), b.abs() >= (1.0 - near) * c);
            if c > 0.0 && !(full && b > 0.0) {
                let negative = b < 0.0 && !zero;
                gain = gain.max(if negative {
                    r + self.tube_epsilon
                } else {
                    r - self.tube_epsilon
                });
            }
            if c > 0.0 && !(full && b < 0.0) {
                let positive = b > 0.0 && !zero;
                cost = cost.min(if positive {
                    r - self.tube_epsilon
                } else {
                    r + self.tube_epsilon
                });
            }
        }
        (gain - cost).max(0.0)
    }
}
