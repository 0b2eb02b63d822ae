//! Step responses of second and higher order, and how one is identified from a single curve.

use serde::{Deserialize, Serialize};

/// What the transition-point method reads off a rising curve (figure 3.14).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StepCharacteristics {
    /// `K = v_end − v0` (corrected: the thesis takes the largest speed).
    pub gain_mps: f64,
    /// When the curve is steepest.
    pub transition_s: f64,
    /// Speed there.
    pub transition_speed_mps: f64,
    /// Slope there.
    pub slope_mps2: f64,
    /// `T_U`, when the tangent leaves `v0`; below 0 for a curve that is steepest from the beginning.
    pub dead_time_s: f64,
    /// `T_G`, how long the tangent takes from `v0` to `v_end`.
    pub build_up_time_s: f64,
}

/// Slopes are those of least-squares cubics over this long to either side, less where a curve is short. A line over half of it has
/// as much noise, and takes 2.5 % off the slope of a curve with `T_c = 0.7 s`.
const SLOPE_REACH_S: f64 = 0.6;

const FEWEST_SAMPLES: usize = 5;

impl StepCharacteristics {
    /// Of a rising curve. `None` below five samples, without a gain, or for speeds that are not finite.
    #[must_use]
    pub fn of(step_s: f64, speed_mps: &[f64]) -> Option<Self> {
        let n = speed_mps.len();
        let (first, last) = (*speed_mps.first()?, *speed_mps.last()?);
        let gain_mps = last - first;
        let finite = step_s > 0.0 && speed_mps.iter().all(|v| v.is_finite());
        if n < FEWEST_SAMPLES || !finite || gain_mps <= 0.0 {
            return None;
        }
        let reach = ((SLOPE_REACH_S / step_s).round() as usize).clamp(2, ((n - 1) / 4).max(2));
        let fits =
            (reach..n - reach).map(|k| (k, local_cubic(&speed_mps[k - reach..=k + reach], step_s)));
        let steepest = fits.reduce(|best, next| if next.1.1 > best.1.1 { next } else { best })?;
        let (k, (transition_speed_mps, slope_mps2)) = steepest;
        if slope_mps2 <= 0.0 {
            return None;
        }
        let transition_s = k as f64 * step_s;
        Some(Self {
            gain_mps,
            transition_s,
            transition_speed_mps,
            slope_mps2,
            dead_time_s: transition_s - (transition_speed_mps - first) / slope_mps2,
            build_up_time_s: gain_mps / slope_mps2,
        })
    }
}

/// Value and slope in the middle of the least-squares cubic through an odd number of samples, at least five.
fn local_cubic(speed_mps: &[f64], step_s: f64) -> (f64, f64) {
    let middle = (speed_mps.len() / 2) as f64;
    let (mut powers, mut moments) = ([0.0; 7], [0.0; 4]);
    for (k, v) in speed_mps.iter().enumerate() {
        let x = k as f64 - middle;
        powers
            .iter_mut()
            .zip(0..)
            .for_each(|(sum, p)| *sum += x.powi(p));
        moments
            .iter_mut()
            .zip(0..)
            .for_each(|(sum, p)| *sum += x.powi(p) * v);
    }
    let [n, _, s2, _, s4, _, s6] = powers;
    let [m0, m1, m2, m3] = moments;
    let value = (s4 * m0 - s2 * m2) / (n * s4 - s2 * s2);
    let slope = (s6 * m1 - s4 * m3) / (s2 * s6 - s4 * s4);
    (value, slope / step_s)
}

/// The unit step response of a chain of first-order lags.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum StepResponse {
    /// `1/((T_1 s + 1)(T_2 s + 1))` (3.34), `T_1 ≤ T_2`.
    Distinct {
        /// The smaller time constant.
        t1_s: f64,
        /// The larger one.
        t2_s: f64,
    },
    /// `1/(T s + 1)ⁿ` (3.32).
    Equal {
        /// `n`, 2 to 10.
        order: u8,
        /// `T`.
        time_constant_s: f64,
    },
}

impl StepResponse {
    /// Highest order that is identified; the thesis's Table 3.7 ends at 8.
    pub const HIGHEST_ORDER: u8 = 10;

    /// `T_U/T_G` below which two distinct constants are identified: `3/e − 1`, that of two equal ones.
    #[must_use]
    pub fn limit_ratio() -> f64 {
        3.0 / std::f64::consts::E - 1.0
    }

    /// The response with these characteristics. `None` where `T_U` is not above 0 or nearer to an order beyond the highest.
    ///
    /// Below the limit the ratio of the two constants solves (3.35); from there on the order is that of the nearest `T_U/T_G` in
    /// Table 3.7, and its constant follows from (3.37).
    #[must_use]
    pub fn identify(characteristics: &StepCharacteristics) -> Option<Self> {
        let StepCharacteristics {
            dead_time_s,
            build_up_time_s,
            ..
        } = *characteristics;
        let ratio = dead_time_s / build_up_time_s;
        if !(ratio > 0.0 && ratio.is_finite()) {
            return None;
        }
        if ratio < Self::limit_ratio() {
            let alpha = alpha_of(ratio);
            let t1_s = build_up_time_s / build_up_over_t1(alpha);
            return Some(Self::Distinct {
                t1_s,
                t2_s: alpha * t1_s,
            });
        }
        let distance = |order: u8| (order_ratio(order) - ratio).abs();
        let order =
            (2..=Self::HIGHEST_ORDER + 1).min_by(|&a, &b| distance(a).total_cmp(&distance(b)))?;
        (order <= Self::HIGHEST_ORDER).then(|| Self::Equal {
            order,
            time_constant_s: build_up_time_s / build_up_over_t(order),
        })
    }

    /// The rise-time method's response of a single curve that lasts `t_r`: second order, `T_c = t_r/5` (3.43).
    #[must_use]
    pub fn of_rise_time(rise_time_s: f64) -> Self {
        Self::Equal {
            order: 2,
            time_constant_s: rise_time_s / super::RiseTime::RISE_TIME_CONSTANTS,
        }
    }

    /// The order.
    #[must_use]
    pub fn order(&self) -> u8 {
        match self {
            Self::Distinct { .. } => 2,
            Self::Equal { order, .. } => *order,
        }
    }

    /// The response to a unit step at `t_s ≥ 0`, in 0 to 1 (right sides of 3.38 and 3.39).
    #[must_use]
    pub fn share(&self, t_s: f64) -> f64 {
        match *self {
            Self::Distinct { t1_s, t2_s } => {
                let (fast, slow) = (t_s / t1_s, t_s / t2_s);
                if (t2_s - t1_s).abs() <= 1e-6 * t2_s {
                    return 1.0 - (1.0 + slow) * (-slow).exp();
                }
                // T2 e^(−t/T2) − T1 e^(−t/T1), written so that near constants do not cancel.
                let difference = (-slow).exp() * -(slow - fast).exp_m1();
                1.0 - (-slow).exp() - t1_s / (t2_s - t1_s) * difference
            }
            Self::Equal {
                order,
                time_constant_s,
            } => {
                let x = t_s / time_constant_s;
                let mut term = (-x).exp();
                let mut left = term;
                for i in 1..order {
                    term *= x / f64::from(i);
                    left += term;
                }
                if left.is_finite() { 1.0 - left } else { 1.0 }
            }
        }
    }

    /// Speed in m/s at `t_s` seconds of a phase from `start_speed_mps` towards `end_speed_mps` (3.40 and 3.41, corrected:
    /// `K = v_end − v0`).
    #[must_use]
    pub fn speed_mps(&self, start_speed_mps: f64, end_speed_mps: f64, t_s: f64) -> f64 {
        start_speed_mps + (end_speed_mps - start_speed_mps) * self.share(t_s)
    }

    /// Whether a fit can give this.
    pub(super) fn is_sane(&self) -> bool {
        let usable = |t: f64| t.is_finite() && t > 0.0;
        match *self {
            Self::Distinct { t1_s, t2_s } => usable(t1_s) && usable(t2_s) && t1_s <= t2_s,
            Self::Equal {
                order,
                time_constant_s,
            } => (2..=Self::HIGHEST_ORDER).contains(&order) && usable(time_constant_s),
        }
    }
}

/// `T_G/T_1 = α^(α/(α − 1))` (3.36), `e` at `α = 1`.
fn build_up_over_t1(alpha: f64) -> f64 {
    if (alpha - 1.0).abs() < 1e-8 {
        return std::f64::consts::E;
    }
    (alpha * alpha.ln() / (alpha - 1.0)).exp()
}

/// `T_U/T_G` of two constants with the ratio `α ≥ 1` (3.35, corrected exponent).
fn distinct_ratio(alpha: f64) -> f64 {
    if alpha - 1.0 < 1e-4 {
        return StepResponse::limit_ratio();
    }
    let bracket = (alpha * alpha.ln() + alpha * alpha - 1.0) / (alpha - 1.0);
    (-alpha * alpha.ln() / (alpha - 1.0)).exp() * bracket - 1.0
}

/// The root `α ≥ 1` of (3.35); `1/α` is the other. The ratio falls from its limit to 0 as `α` grows.
fn alpha_of(ratio: f64) -> f64 {
    let (mut low, mut high) = (0.0_f64, 40.0_f64);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if distinct_ratio(middle.exp()) > ratio {
            low = middle;
        } else {
            high = middle;
        }
    }
    (0.5 * (low + high)).exp()
}

/// `T_G/T` of `n` equal constants: `(n − 2)!/(n − 1)^(n − 2) · e^(n − 1)` (3.37).
fn build_up_over_t(order: u8) -> f64 {
    let m = f64::from(order) - 1.0;
    // (n − 2)!/m^(n − 2) as a product of small factors.
    let quotient: f64 = (1..order - 1).map(|i| f64::from(i) / m).product();
    quotient * m.exp()
}

/// `T_U/T_G` of `n` equal constants (Table 3.7): the tangent at the inflexion `t = (n − 1)T`.
fn order_ratio(order: u8) -> f64 {
    let response = StepResponse::Equal {
        order,
        time_constant_s: 1.0,
    };
    let inflexion = f64::from(order) - 1.0;
    let build_up = build_up_over_t(order);
    inflexion / build_up - response.share(inflexion)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_those_of_table_3_7() {
        let table = [0.1036, 0.2180, 0.3194, 0.4103, 0.4933, 0.5700, 0.6417];
        for (order, expected) in (2..).zip(table) {
            let found = order_ratio(order);
            assert!(
                (found - expected).abs() < 1e-4,
                "{order}: {found} for {expected}"
            );
        }
        let build_up = [9.6489, 4.5868, 3.1313, 2.4372, 2.0272, 1.7543, 1.5583];
        for (order, expected) in (2..).zip(build_up) {
            assert!(
                (1.0 / order_ratio(order) - expected).abs() < 2e-3,
                "{order}"
            );
        }
    }

    #[test]
    fn the_ratio_of_distinct_constants_has_its_limits_and_two_roots() {
        assert!((StepResponse::limit_ratio() - 0.103_638).abs() < 1e-6);
        assert!((distinct_ratio(1.001) - StepResponse::limit_ratio()).abs() < 1e-4);
        assert!(distinct_ratio(1e9) < 1e-6);
        let printed = |a: f64| a.powf(a / (1.0 - a)) * (a * a.ln() + a * a - 1.0) / (a - 1.0) - 1.0;
        for alpha in [1.1_f64, 2.0, 5.0, 40.0] {
            assert!((printed(alpha) - distinct_ratio(alpha)).abs() < 1e-12);
            assert!((printed(alpha) - printed(1.0 / alpha)).abs() < 1e-10);
            assert!((alpha_of(distinct_ratio(alpha)) / alpha - 1.0).abs() < 1e-6);
        }
    }
}
