//! A value over speed and acceleration with its first and second derivatives.

use std::ops::{Add, Mul, Sub};

#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Jet {
    pub(crate) value: f64,
    pub(crate) w: f64,
    pub(crate) a: f64,
    pub(crate) ww: f64,
    pub(crate) wa: f64,
    pub(crate) aa: f64,
}

impl Jet {
    pub(crate) fn constant(value: f64) -> Self {
        Self {
            value,
            ..Self::default()
        }
    }

    /// A function of the value, which gives itself and two derivatives.
    #[inline(always)]
    pub(crate) fn map(self, function: impl Fn(f64) -> [f64; 3]) -> Self {
        let [value, first, second] = function(self.value);
        Self {
            value,
            w: first * self.w,
            a: first * self.a,
            ww: first * self.ww + second * self.w * self.w,
            wa: first * self.wa + second * self.w * self.a,
            aa: first * self.aa + second * self.a * self.a,
        }
    }

    /// [`positive_part`] of the value.
    #[inline(always)]
    pub(crate) fn positive_part(self, width: f64) -> Self {
        self.map(|x| positive_part(x, width))
    }

    /// `max(x, 0)` beyond a width, and between a polynomial with two continuous derivatives.
    #[inline(always)]
    pub(crate) fn rounded_part(self, width: f64) -> Self {
        self.map(|x| {
            if x >= width {
                return [x, 1.0, 0.0];
            }
            if x <= -width {
                return [0.0; 3];
            }
            let (t, rest) = (1.0 + x / width, 1.0 - x / width);
            [
                width * t * t * t * (2.0 + rest) / 16.0,
                t * t * (1.0 + rest) / 4.0,
                0.75 * t * rest / width,
            ]
        })
    }

    #[inline(always)]
    pub(crate) fn squared(self) -> Self {
        self.map(|x| [x * x, 2.0 * x, 2.0])
    }

    /// Times the speed itself.
    #[inline(always)]
    pub(crate) fn times_speed(self, w: f64) -> Self {
        Self {
            value: self.value * w,
            w: self.w * w + self.value,
            a: self.a * w,
            ww: self.ww * w + 2.0 * self.w,
            wa: self.wa * w + self.a,
            aa: self.aa * w,
        }
    }

    #[inline(always)]
    pub(crate) fn times(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            w: self.w * other.value + self.value * other.w,
            a: self.a * other.value + self.value * other.a,
            ww: self.ww * other.value + 2.0 * self.w * other.w + self.value * other.ww,
            wa: self.wa * other.value + self.w * other.a + self.a * other.w + self.value * other.wa,
            aa: self.aa * other.value + 2.0 * self.a * other.a + self.value * other.aa,
        }
    }
}

/// `½(x + √(x² + width²))` with its first and second derivative.
#[inline(always)]
pub(crate) fn positive_part(x: f64, width: f64) -> [f64; 3] {
    let square = width * width;
    let root = (x * x + square).sqrt();
    let by_root = 1.0 / root;
    // Without cancellation for negative x.
    let larger = root + x.abs();
    let value = if x > 0.0 {
        0.5 * larger
    } else {
        0.5 * square / larger
    };
    [
        value,
        value * by_root,
        0.5 * square * by_root * by_root * by_root,
    ]
}

impl Add for Jet {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            w: self.w + other.w,
            a: self.a + other.a,
            ww: self.ww + other.ww,
            wa: self.wa + other.wa,
            aa: self.aa + other.aa,
        }
    }
}

impl Sub for Jet {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}

impl Mul<f64> for Jet {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            w: self.w * factor,
            a: self.a * factor,
            ww: self.ww * factor,
            wa: self.wa * factor,
            aa: self.aa * factor,
        }
    }
}
