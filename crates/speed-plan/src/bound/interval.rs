//! Intervals of numbers. Rounding is not directed; [`super`] takes a share of the bound for it.

use std::ops::{Add, Mul, Neg, Sub};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Interval {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Interval {
    pub(super) const EVERYTHING: Self = Self {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
    };

    pub(super) fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    pub(super) fn point(value: f64) -> Self {
        Self::new(value, value)
    }

    /// The smallest with all of several numbers.
    pub(super) fn hull(values: impl Iterator<Item = f64>) -> Self {
        values.fold(
            Self::new(f64::INFINITY, f64::NEG_INFINITY),
            |hull, value| Self::new(hull.low.min(value), hull.high.max(value)),
        )
    }

    /// Of a function that does not fall, from its values at both ends.
    pub(super) fn rising(self, function: impl Fn(f64) -> f64) -> Self {
        Self::new(function(self.low), function(self.high))
    }

    /// Of a function that does not rise.
    pub(super) fn falling(self, function: impl Fn(f64) -> f64) -> Self {
        Self::new(function(self.high), function(self.low))
    }

    pub(super) fn squared(self) -> Self {
        let (low, high) = (self.low * self.low, self.high * self.high);
        if self.low >= 0.0 {
            Self::new(low, high)
        } else if self.high <= 0.0 {
            Self::new(high, low)
        } else {
            Self::new(0.0, low.max(high))
        }
    }

    pub(super) fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// Largest magnitude.
    pub(super) fn magnitude(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }
}

impl Add for Interval {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.low + other.low, self.high + other.high)
    }
}

impl Sub for Interval {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.low - other.high, self.high - other.low)
    }
}

impl Neg for Interval {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.high, -self.low)
    }
}

impl Mul for Interval {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let products = [
            self.low * other.low,
            self.low * other.high,
            self.high * other.low,
            self.high * other.high,
        ];
        let smaller = |a: f64, b: f64| if a < b { a } else { b };
        let larger = |a: f64, b: f64| if a > b { a } else { b };
        Self::new(
            smaller(
                smaller(products[0], products[1]),
                smaller(products[2], products[3]),
            ),
            larger(
                larger(products[0], products[1]),
                larger(products[2], products[3]),
            ),
        )
    }
}

impl Mul<f64> for Interval {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        if factor >= 0.0 {
            Self::new(self.low * factor, self.high * factor)
        } else {
            Self::new(self.high * factor, self.low * factor)
        }
    }
}
