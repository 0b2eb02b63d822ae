//! Speed limits as numbers.

use std::ops::RangeInclusive;

/// Limits from here on are none: 400 km/h.
const NO_LIMIT_MPS: f64 = 400.0 / 3.6;

/// Range of limits in tables and on roads.
pub(crate) const LIMIT_MPS: RangeInclusive<f64> = 0.5..=NO_LIMIT_MPS;

/// Limits are told apart to 0.01 m/s.
pub(crate) const LIMITS_PER_MPS: f64 = 100.0;

pub(crate) fn rounded_limit(limit_mps: f64) -> f64 {
    (limit_mps * LIMITS_PER_MPS).round() / LIMITS_PER_MPS
}

/// Whether two rounded limits are the same.
pub(crate) fn is_same_limit(a_mps: f64, b_mps: f64) -> bool {
    (a_mps - b_mps).abs() < 0.5 / LIMITS_PER_MPS
}
