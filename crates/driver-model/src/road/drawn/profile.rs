//! Elevation over distance out of recorded elevations or slopes.

use ev_energy::{DEFAULT_SLOPE_BANDWIDTH_M, slope_from_elevation};

use crate::Error;
use crate::road::{ElevationAt, HIGHEST_M};
use crate::statistics::mean;

/// Distance of elevations, m: a tenth of what they are smoothed over.
const SPACING_M: f64 = DEFAULT_SLOPE_BANDWIDTH_M / 10.0;

/// Evenly spaced places from 0 to the end.
pub(super) fn grid_m(length_m: f64) -> Vec<f64> {
    let steps = (length_m / SPACING_M).ceil().max(1.0);
    (0..=steps as usize)
        .map(|k| k as f64 / steps * length_m)
        .collect()
}

/// Elevations along a track, smoothed as those of logs are: by the slope that [`slope_from_elevation`] gives, from which the track's own
/// differ by nothing on average. Empty with fewer than two.
pub(super) fn of_track(
    length_m: f64,
    place_m: &[f64],
    elevation_m: &[f64],
) -> Result<Vec<ElevationAt>, Error> {
    let known = |m: &f64| if m.abs() <= HIGHEST_M { *m } else { f64::NAN };
    let elevation_m: Vec<f64> = elevation_m.iter().map(known).collect();
    if elevation_m.iter().filter(|m| m.is_finite()).count() < 2 {
        return Ok(Vec::new());
    }
    let grid_m = grid_m(length_m);
    let places: Vec<f64> = place_m.iter().chain(&grid_m).copied().collect();
    // Places without an elevation are those where the slope is asked for.
    let unknown = std::iter::repeat_n(f64::NAN, grid_m.len());
    let elevations: Vec<f64> = elevation_m.iter().copied().chain(unknown).collect();
    let slope_rad = slope_from_elevation(&places, &elevations, DEFAULT_SLOPE_BANDWIDTH_M)?;
    let climbed_m = climbed(&grid_m, &slope_rad[place_m.len()..]);
    let above = place_m.iter().zip(&elevation_m);
    let above = above.map(|(place_m, elevation_m)| elevation_m - at(&grid_m, &climbed_m, *place_m));
    let start_m = mean(above.filter(|m| m.is_finite())).unwrap_or(0.0);
    Ok(elevations_of(&grid_m, &climbed_m, start_m))
}

pub(super) fn elevations_of(grid_m: &[f64], climbed_m: &[f64], start_m: f64) -> Vec<ElevationAt> {
    let climbed = grid_m.iter().zip(climbed_m);
    climbed
        .map(|(&position_m, climbed_m)| ElevationAt {
            position_m,
            elevation_m: start_m + climbed_m,
        })
        .collect()
}

/// Height above the first place, by the slope between two places.
pub(super) fn climbed(place_m: &[f64], slope_rad: &[f64]) -> Vec<f64> {
    let mut climbed_m = vec![0.0; place_m.len()];
    for k in 1..place_m.len() {
        let gradient = 0.5 * (slope_rad[k - 1].tan() + slope_rad[k].tan());
        climbed_m[k] = climbed_m[k - 1] + gradient * (place_m[k] - place_m[k - 1]);
    }
    climbed_m
}

/// Linear between places in ascending order, constant beyond; there is at least one.
pub(super) fn at(place_m: &[f64], values: &[f64], wanted_m: f64) -> f64 {
    let next = place_m.partition_point(|place_m| *place_m <= wanted_m);
    if next == 0 || next == place_m.len() {
        return values[next.min(place_m.len() - 1)];
    }
    let share = (wanted_m - place_m[next - 1]) / (place_m[next] - place_m[next - 1]);
    values[next - 1] + share * (values[next] - values[next - 1])
}
