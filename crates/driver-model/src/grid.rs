//! Thresholds compare on a grid.
//!
//! A log in km/h or mph gives the same speeds as one in m/s but for the rounding of its digits, and a clock that counts from
//! 1970 the same times but for 0.1 µs. Where a recorder has few digits, an acceleration of exactly 0.3 m/s² is common, and such
//! noise would decide on which side of the threshold it falls. So both sides of a comparison are rounded to multiples of 2⁻¹⁴ first
//! (0.06 mm/s², or mm/s, or mm): far above the noise, and far below what is measured. As a binary fraction, what lies half way
//! between two multiples has more decimals than any log.

const STEPS_PER_UNIT: f64 = 16384.0;

/// Grid steps, a whole number; NaN stays NaN.
fn steps(value: f64) -> f64 {
    (value * STEPS_PER_UNIT).round()
}

/// `value >= threshold`.
pub(crate) fn at_least(value: f64, threshold: f64) -> bool {
    steps(value) >= steps(threshold)
}

/// `value > threshold`.
pub(crate) fn above(value: f64, threshold: f64) -> bool {
    steps(value) > steps(threshold)
}

/// `value < threshold`.
pub(crate) fn below(value: f64, threshold: f64) -> bool {
    steps(value) < steps(threshold)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tie_stays_a_tie_under_the_noise_of_a_conversion() {
        for noise in [-4e-6, -1e-15, 0.0, 1e-15, 4e-6] {
            let value = 0.3 + noise;
            assert!(at_least(value, 0.3));
            assert!(!above(value, 0.3) && !below(value, 0.3));
        }
    }

    #[test]
    fn what_differs_is_told_apart() {
        assert!(above(0.3001, 0.3) && below(0.2999, 0.3) && !at_least(0.2999, 0.3));
        assert!(at_least(f64::INFINITY, 0.3) && below(1.0, f64::INFINITY));
        let nan = f64::NAN;
        assert!(!at_least(nan, 0.3) && !above(nan, 0.3) && !below(nan, 0.3));
    }
}
