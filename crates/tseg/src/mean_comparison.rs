use crate::series::on_grid;

/// Whether two segments of these means are alike: thesis Algorithm 5.
///
/// They have the same sign (that of 0 is 0), both magnitudes lie at or below, or both at or above, their threshold, and
/// the means differ by `difference` at most; all of them compare on the grid.
pub(crate) fn means_alike(means: [f64; 2], magnitudes: [f64; 2], difference: f64) -> bool {
    let [x, y] = means.map(on_grid);
    let [x_limit, y_limit] = magnitudes.map(on_grid);
    let sign = |mean: f64| (mean > 0.0, mean < 0.0);
    let both_low = x.abs() <= x_limit && y.abs() <= y_limit;
    let both_high = x.abs() >= x_limit && y.abs() >= y_limit;
    sign(x) == sign(y) && (both_low || both_high) && (x - y).abs() <= on_grid(difference)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sign_magnitude_and_difference_decide() {
        let alike = |x, y| means_alike([x, y], [0.4, 0.4], 0.55);
        assert!(alike(0.1, 0.4) && alike(0.4, 0.9) && alike(-1.0, -1.5) && alike(0.0, -0.0));
        assert!(!alike(0.1, -0.1), "signs");
        assert!(!alike(0.0, 0.1), "0 has a sign of its own");
        assert!(!alike(0.3, 0.5), "magnitudes");
        assert!(!alike(1.0, 1.6), "difference");
    }

    #[test]
    fn the_literal_form_has_a_threshold_for_each() {
        assert!(means_alike([0.3, 0.5], [0.4, 0.55], 0.55));
        assert!(!means_alike([0.5, 0.3], [0.4, 0.55], 0.55));
    }
}
