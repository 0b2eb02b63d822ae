//! Acceleration from speed.

/// Forward difference `a_k = (v_{k+1} − v_k)/step` (thesis eq. 3.21), m/s².
///
/// The last sample repeats the one before it; a single sample has acceleration 0. As many values as
/// `speed_mps`.
#[must_use]
pub fn forward_difference(speed_mps: &[f64], step_s: f64) -> Vec<f64> {
    let mut accel_mps2: Vec<f64> = speed_mps
        .windows(2)
        .map(|pair| (pair[1] - pair[0]) / step_s)
        .collect();
    if !speed_mps.is_empty() {
        accel_mps2.push(accel_mps2.last().copied().unwrap_or(0.0));
    }
    accel_mps2
}

#[cfg(test)]
#[allow(clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn the_last_value_is_repeated() {
        assert_eq!(forward_difference(&[0.0, 1.0, 3.0], 0.5), [2.0, 4.0, 4.0]);
        assert_eq!(forward_difference(&[7.0], 0.5), [0.0]);
        assert!(forward_difference(&[], 0.5).is_empty());
    }
}
