//! Comparisons that compile to one instruction: `f64::min` and `max` spend two more on NaN, which no value of this crate is.

/// The smaller of two numbers; the second where the first is NaN.
#[inline(always)]
pub(crate) fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger of two numbers; the second where the first is NaN.
#[inline(always)]
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Sine and cosine of a slope angle, to the last bits. Roads stay within ±0.5 rad, where the Taylor series end after seven
/// terms (the next ones are under 3e-17 of the result) and compile to arithmetic that runs in parallel.
#[inline(always)]
pub(crate) fn sin_cos(angle_rad: f64) -> (f64, f64) {
    if angle_rad.abs() > 0.5 {
        return angle_rad.sin_cos();
    }
    let z = angle_rad * angle_rad;
    let sine = [
        1.0 / 6_227_020_800.0,
        -1.0 / 39_916_800.0,
        1.0 / 362_880.0,
        -1.0 / 5_040.0,
        1.0 / 120.0,
        -1.0 / 6.0,
        1.0,
    ];
    let cosine = [
        -1.0 / 87_178_291_200.0,
        1.0 / 479_001_600.0,
        -1.0 / 3_628_800.0,
        1.0 / 40_320.0,
        -1.0 / 720.0,
        1.0 / 24.0,
        -0.5,
        1.0,
    ];
    let horner = |sum: f64, coefficient: &f64| sum * z + coefficient;
    (
        angle_rad * sine.iter().fold(0.0, horner),
        cosine.iter().fold(0.0, horner),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_agree_with_the_library() {
        for k in -1600..=1600 {
            let angle_rad = f64::from(k) / 1000.0;
            let (sine, cosine) = sin_cos(angle_rad);
            assert!((sine - angle_rad.sin()).abs() <= 2.3e-16, "{angle_rad}");
            assert!((cosine - angle_rad.cos()).abs() <= 2.3e-16, "{angle_rad}");
        }
    }
}
