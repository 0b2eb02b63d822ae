//! Whether one column is the derivative of another.

use std::fmt;

use crate::statistics::{correlation, slope};

/// Steps from which a comparison says something.
const LEAST_STEPS: usize = 20;

/// How well an acceleration follows a speed: the correlation with its difference, and the factor
/// between the two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Agreement {
    pub(crate) correlation: f64,
    pub(crate) factor: f64,
}

impl fmt::Display for Agreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let factor = if self.factor.abs() < 100.0 {
            format!("{:.2}", self.factor)
        } else {
            "over 100".to_owned()
        };
        write!(
            f,
            "the second is {factor} times the change of the first, correlation {:.2}",
            self.correlation
        )
    }
}

impl Agreement {
    /// Whether it is the acceleration of this speed, in the same unit.
    pub(crate) fn holds(self) -> bool {
        self.correlation >= 0.8 && (0.7..1.4).contains(&self.factor)
    }

    /// Whether it cannot be: neither its course nor its size.
    pub(crate) fn is_excluded(self) -> bool {
        self.correlation < 0.3 && !(0.2..5.0).contains(&self.factor.abs())
    }
}

/// Compares with the central difference; `None` where too little is there or moves.
pub(crate) fn of_speed_and_accel(
    time_s: &[f64],
    speed_mps: &[f64],
    accel_mps2: &[f64],
) -> Option<Agreement> {
    let pairs: Vec<(f64, f64)> = (1..time_s.len().saturating_sub(1))
        .map(|i| {
            let rate = (speed_mps[i + 1] - speed_mps[i - 1]) / (time_s[i + 1] - time_s[i - 1]);
            (rate, accel_mps2[i])
        })
        .filter(|(rate, accel)| rate.is_finite() && accel.is_finite())
        .collect();
    if pairs.len() < LEAST_STEPS {
        return None;
    }
    let correlation = correlation(&pairs);
    (!correlation.is_nan()).then(|| Agreement {
        correlation,
        factor: slope(&pairs) / correlation.abs(),
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_derivative_is_known_with_its_unit() {
        let time_s: Vec<f64> = (0..100).map(f64::from).collect();
        let speed: Vec<f64> = time_s
            .iter()
            .map(|t| 10.0 - 10.0 * (t / 9.0).cos())
            .collect();
        let accel: Vec<f64> = time_s
            .iter()
            .map(|t| 10.0 / 9.0 * (t / 9.0).sin())
            .collect();
        let of = |scale: f64, accel: &[f64]| {
            let speed: Vec<f64> = speed.iter().map(|v| v * scale).collect();
            of_speed_and_accel(&time_s, &speed, accel).unwrap()
        };
        assert!(of(1.0, &accel).holds());
        assert!(!of(3.6, &accel).holds() && !of(1.0 / 3.6, &accel).holds());
        assert!(!of(1.0, &time_s).holds());
        let amps: Vec<f64> = time_s.iter().map(|t| 80.0 * (t * 0.7).sin()).collect();
        assert!(of(1.0, &amps).is_excluded() && !of(1.0, &accel).is_excluded());
        assert!(of_speed_and_accel(&time_s[..10], &speed, &accel).is_none());
    }
}
