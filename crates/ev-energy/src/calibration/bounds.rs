//! Bounded parameters by free variables.

/// Bounds of a parameter; in its place a least-squares solver gets a free variable `q`, of whose sine the value is a linear function.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    /// Smallest value
    pub lower: f64,
    /// Largest value, above the smallest
    pub upper: f64,
}

impl Bounds {
    /// From the smallest value to the largest.
    #[must_use]
    pub fn width(self) -> f64 {
        self.upper - self.lower
    }

    /// `q` of a value.
    #[must_use]
    pub fn free(self, value: f64) -> f64 {
        self.free_of_share((value - self.lower) / self.width())
    }

    /// `q` at a share of the width, from 0 at the smallest value to 1.
    pub(super) fn free_of_share(self, share: f64) -> f64 {
        (2.0 * share - 1.0).clamp(-1.0, 1.0).asin()
    }

    /// The value at `q`.
    #[must_use]
    pub fn value(self, free: f64) -> f64 {
        let value = self.lower + self.width() * 0.5 * (1.0 + free.sin());
        value.clamp(self.lower, self.upper)
    }

    /// Derivative of the value by `q`, 0 at a bound.
    #[must_use]
    pub fn slope(self, free: f64) -> f64 {
        let cos = free.cos();
        let rounded = if cos.abs() < 1e-12 { 0.0 } else { cos };
        0.5 * self.width() * rounded
    }
}
