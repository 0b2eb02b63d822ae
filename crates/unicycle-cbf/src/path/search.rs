//! One-dimensional searches.

/// Bound of the error that is left, in units of the parameter.
const TOLERANCE: f64 = 1e-16;
const MAX_STEPS: usize = 60;

/// The minimum between `lo` and `hi` of a function from its first three derivatives: Chebyshev's method from `at`, and bisection
/// where that leaves the bracket.
#[inline]
pub(super) fn minimum(
    [mut lo, mut hi]: [f64; 2],
    mut at: f64,
    derivatives: impl Fn(f64) -> [f64; 3],
) -> f64 {
    for _ in 0..MAX_STEPS {
        let [slope, bend, third] = derivatives(at);
        if slope.is_nan() {
            return f64::NAN;
        }
        if slope > 0.0 {
            hi = at;
        } else {
            lo = at;
        }
        let inverse = 1.0 / bend;
        let newton = slope * inverse;
        let skew = newton * third * inverse;
        let next = at - newton * (1.0 + 0.5 * skew.clamp(-1.0, 1.0));
        if bend > 0.0 && next >= lo && next <= hi {
            at = next;
            // The error is of the third order in the step.
            if newton.abs() * (newton * newton + skew * skew) < TOLERANCE {
                break;
            }
        } else {
            at = 0.5 * (lo + hi);
            if hi - lo < TOLERANCE {
                break;
            }
        }
    }
    at
}

/// Maxima between samples that are refined.
const PEAKS: usize = 8;

/// The largest value of a function of period `end`: the largest local maxima of samples, each refined by golden section on both
/// sides.
pub(super) fn peak(end: f64, samples: usize, value: impl Fn(f64) -> f64) -> f64 {
    let step = end / samples as f64;
    let values: Vec<f64> = (0..samples).map(|i| value(i as f64 * step)).collect();
    let mut maxima: Vec<usize> = (0..samples)
        .filter(|i| {
            let [before, after] = [samples - 1, 1].map(|by| values[(i + by) % samples]);
            values[*i] >= before.max(after)
        })
        .collect();
    maxima.sort_by(|a, b| values[*b].total_cmp(&values[*a]));
    maxima.truncate(PEAKS);

    let section = 0.5 * (5f64.sqrt() - 1.0);
    let mut most = 0.0f64;
    for maximum in maxima {
        most = most.max(values[maximum]);
        let at = maximum as f64 * step;
        for (mut lo, mut hi) in [(at - step, at), (at, at + step)] {
            for _ in 0..40 {
                let (left, right) = (hi - section * (hi - lo), lo + section * (hi - lo));
                let (at_left, at_right) = (value(left), value(right));
                most = most.max(at_left).max(at_right);
                if at_left > at_right {
                    hi = right;
                } else {
                    lo = left;
                }
            }
        }
    }
    most
}

/// The nearest of some points, by parameter; NaN while there is none.
pub(super) struct Nearest {
    pub(super) parameter: f64,
    pub(super) distance_m: f64,
}

impl Nearest {
    pub(super) fn none() -> Self {
        Self {
            parameter: f64::NAN,
            distance_m: f64::INFINITY,
        }
    }

    pub(super) fn offer(&mut self, parameter: f64, distance_m: f64) {
        if distance_m < self.distance_m {
            *self = Self {
                parameter,
                distance_m,
            };
        }
    }
}
