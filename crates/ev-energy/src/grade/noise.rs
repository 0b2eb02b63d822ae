//! Noise of elevations: outliers, and how wide a window must be.

use super::profile::Profile;

/// An elevation is an outlier if it is off the smoothed road by this many standard deviations of the others, and by so many
/// metres.
const OUTLIER_DEVIATIONS: f64 = 5.0;
const OUTLIER_M: f64 = 5.0;

/// Noise of the elevation may add this much to the slope, standard deviation; where it would add more, the window is widened, to at
/// most so many bandwidths.
const SLOPE_DEVIATION: f64 = 0.005;
const WIDEST_BANDWIDTHS: f64 = 10.0;

/// Noise is told from means over this share of the bandwidth: elevations between two fixes lie on a line and scatter less than the
/// fixes.
const NOISE_BLOCK: f64 = 1.0 / 3.0;

/// Standard deviation of a normal distribution over the median of its magnitude.
const DEVIATION_PER_MEDIAN: f64 = 1.4826;

/// The points that are not far off the smoothed road.
pub(super) fn without_outliers(mut points: Vec<(f64, f64)>, bandwidth_m: f64) -> Vec<(f64, f64)> {
    let profile = Profile::new(points.iter().copied());
    let distance_m: Vec<f64> = points.iter().map(|(distance_m, _)| *distance_m).collect();
    let off_m: Vec<f64> = profile
        .smoothed(&distance_m, bandwidth_m)
        .zip(&points)
        .map(|(smooth_m, (_, elevation_m))| smooth_m.map_or(0.0, |h| (elevation_m - h).abs()))
        .collect();
    let median_m = median(off_m.clone());
    let limit_m = (OUTLIER_DEVIATIONS * DEVIATION_PER_MEDIAN * median_m).max(OUTLIER_M);
    let mut off_m = off_m.into_iter();
    points.retain(|_| off_m.next().is_some_and(|off_m| off_m <= limit_m));
    points
}

/// The bandwidth at which noise of the points leaves the slope to [`SLOPE_DEVIATION`]. A straight line through points of spacing
/// `d` and deviation `σ` over a length `L` has a gradient of deviation `σ √(12 d/L³)`.
pub(super) fn widened_m(points: &[(f64, f64)], bandwidth_m: f64) -> f64 {
    let points = block_means(points, NOISE_BLOCK * bandwidth_m);
    // farther apart, a hill looks like noise
    let close = |three: &&[(f64, f64)]| three[2].0 - three[0].0 <= bandwidth_m;
    let off_m: Vec<f64> = points
        .windows(3)
        .filter(close)
        .filter_map(off_neighbours_m)
        .collect();
    let spacing_m = match (points.first(), points.last()) {
        (Some(first), Some(last)) => (last.0 - first.0) / points.len() as f64,
        _ => return bandwidth_m,
    };
    let deviation_m = DEVIATION_PER_MEDIAN * median(off_m);
    let length_m = (12.0 * spacing_m * (deviation_m / SLOPE_DEVIATION).powi(2)).cbrt();
    (0.5 * length_m).clamp(bandwidth_m, WIDEST_BANDWIDTHS * bandwidth_m)
}

/// The mean point of each block of this length in which there are points.
fn block_means(points: &[(f64, f64)], length_m: f64) -> Vec<(f64, f64)> {
    let number = |point: &(f64, f64)| (point.0 / length_m).floor() as i64;
    let mean = |block: &[(f64, f64)]| {
        let sum = |sum: (f64, f64), point: &(f64, f64)| (sum.0 + point.0, sum.1 + point.1);
        let (distance_m, elevation_m) = block.iter().fold((0.0, 0.0), sum);
        (
            distance_m / block.len() as f64,
            elevation_m / block.len() as f64,
        )
    };
    points
        .chunk_by(|a, b| number(a) == number(b))
        .map(mean)
        .collect()
}

/// How far the middle one of three points lies off the line through the others, for noise of the same deviation, m; `None` where
/// they do not follow each other.
fn off_neighbours_m(points: &[(f64, f64)]) -> Option<f64> {
    let [(from_m, before), (at_m, here), (to_m, after)] = points else {
        return None;
    };
    let share = (at_m - from_m) / (to_m - from_m);
    let off_m = here - (before + share * (after - before));
    let scale = (1.0 + share * share + (1.0 - share) * (1.0 - share)).sqrt();
    (at_m > from_m && to_m > at_m).then(|| (off_m / scale).abs())
}

/// The upper one of the two for an even number; 0 of nothing.
fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
