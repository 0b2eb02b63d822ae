mod noise;
mod profile;

use crate::GRAVITY_MPS2;
use crate::error::Error;
use noise::{widened_m, without_outliers};
use profile::Profile;

/// Bandwidth that suits elevations from satellite navigation and from terrain models, m.
pub const DEFAULT_SLOPE_BANDWIDTH_M: f64 = 100.0;

/// Distances beyond this lose the metres to rounding.
const DISTANCE_LIMIT_M: f64 = 1e9;

/// Elevations beyond this are no elevations.
const ELEVATION_LIMIT_M: f64 = 1e5;

/// The accelerometer gives the slope over distances shorter than this many bandwidths, the elevation over longer ones.
const TREND_BANDWIDTHS: f64 = 30.0;

/// What an accelerometer feels beyond this is a bump or a failure, as a share of gravity.
const SPECIFIC_FORCE_LIMIT: f64 = 0.5;

/// A step of at most so many of the smallest steps comes from rounding; a larger one after a hold from a receiver without a fix.
const ROUNDING_STEPS: f64 = 1.5;

/// Slope angle in rad, positive uphill, from elevation along the road.
///
/// The elevation is taken as piecewise linear over distance, `h(s)`. The slope at `s` is `atan` of
/// the gradient of the straight line that fits `h` best, in the least-squares sense over distance,
/// in the window `[s − b, s + b]` cut to the recording:
///
/// ```text
/// gradient(s) = 12/L³ ∫ (x − c) h(x) dx        window of length L around its centre c
/// ```
///
/// For a full window this is the derivative of Lanczos, which averages the true gradient with
/// Epanechnikov weights. Because the fit is over distance and not over samples, a stop adds nothing
/// to it however long it lasts.
///
/// Elevations in steps are read as what they are: where a rounded value changes to the next, the road is halfway between the
/// two; where a value was held and then jumps, only the first sample of the hold was measured. Outliers, more than 5 m and
/// five standard deviations off a first fit, are left out of a second one. Where elevations scatter so that the slope would be
/// off by more than 0.005 (standard deviation), the window is widened, to at most 10 `b`.
///
/// - `distance_m`: place along the road, distance from the start, within ±10⁹ m. It decreases where the car goes back, over the
///   same road.
/// - `elevation_m`: elevation at the same samples. Values that are not finite or beyond ±10⁵ m
///   count as missing and are bridged by straight lines over distance.
/// - `bandwidth_m`: `b`, 1 to 10⁵ m; [`DEFAULT_SLOPE_BANDWIDTH_M`] unless there is a reason.
///
/// Returns one slope per sample. Where the elevation covers no distance the slope is 0. The time is
/// linear in the number of samples of a car that does not go back.
///
/// # Errors
/// [`Error::Length`], [`Error::Argument`] for the bandwidth, [`Error::Sample`] for a distance that
/// is out of range.
pub fn slope_from_elevation(
    distance_m: &[f64],
    elevation_m: &[f64],
    bandwidth_m: f64,
) -> Result<Vec<f64>, Error> {
    check_length("elevation_m", elevation_m, distance_m.len())?;
    check_bandwidth(bandwidth_m)?;
    check_distance(distance_m)?;
    let recorded = distance_m.iter().copied().zip(elevation_m.iter().copied());
    let valid: Vec<(f64, f64)> = recorded
        .filter(|(_, elevation_m)| elevation_m.abs() <= ELEVATION_LIMIT_M)
        .collect();
    let points = without_outliers(along_road(unstepped(&valid)), bandwidth_m);
    let bandwidth_m = widened_m(&points, bandwidth_m);
    let places = Places::of(distance_m);
    let profile = Profile::new(points.into_iter());
    let gradients = profile.gradients(&places.sorted_m, bandwidth_m);
    Ok(places.in_order_of_time(gradients.map(f64::atan)))
}

/// Slope angle in rad, positive uphill, from an accelerometer along the car, and elevation.
///
/// On a slope an accelerometer feels more than the change of speed: `a_x = dv/dt + g sin θ`. Elevation from satellites errs by
/// metres and misses bridges and ramps; an accelerometer sees each, but its offset grows into a hill. So the difference, summed
/// over the distance to an elevation `z(s)` of its own, gives the gradient over short distances, and the recorded elevation the
/// trend of what is left:
///
/// ```text
/// slope = atan( gradient of z over b + gradient of (h − z) over 30 b )
/// ```
///
/// with the gradients of [`slope_from_elevation`]. Without elevation the road is level over 30 `b`.
///
/// - `step_s`: time between two samples, over 0.
/// - `speed_mps`: speed, finite; below 0 the car goes back over the same road.
/// - `accelerometer_mps2`: as many values; missing ones count as no slope.
/// - `elevation_m`: as many values; missing ones are bridged.
/// - `bandwidth_m`: `b`, 1 to 10⁵ m; [`DEFAULT_SLOPE_BANDWIDTH_M`] unless there is a reason.
///
/// # Errors
/// As [`slope_from_elevation`], and [`Error::Argument`] for the step.
pub fn slope_from_accelerometer(
    step_s: f64,
    speed_mps: &[f64],
    accelerometer_mps2: &[f64],
    elevation_m: Option<&[f64]>,
    bandwidth_m: f64,
) -> Result<Vec<f64>, Error> {
    check_length("accelerometer_mps2", accelerometer_mps2, speed_mps.len())?;
    if let Some(elevation_m) = elevation_m {
        check_length("elevation_m", elevation_m, speed_mps.len())?;
    }
    check_bandwidth(bandwidth_m)?;
    if !(1e-3..=1e6).contains(&step_s) {
        return Err(Error::Argument {
            name: "step_s",
            value: step_s,
            min: 1e-3,
            max: 1e6,
        });
    }
    let felt = felt_elevation(step_s, speed_mps, accelerometer_mps2);
    let distance_m: Vec<f64> = felt.iter().map(|(distance_m, _)| *distance_m).collect();
    check_distance(&distance_m)?;
    let trend_m = TREND_BANDWIDTHS * bandwidth_m;
    let rest = felt.iter().enumerate().map(|(i, &(distance_m, felt_m))| {
        let recorded_m = elevation_m.map_or(0.0, |elevation_m| elevation_m[i]);
        (distance_m, recorded_m - felt_m)
    });
    let rest = rest.filter(|(_, elevation)| elevation.abs() <= ELEVATION_LIMIT_M);
    let long = Profile::new(along_road(rest.collect()).into_iter());
    let short = Profile::new(along_road(felt).into_iter());
    let places = Places::of(&distance_m);
    let short = short.gradients(&places.sorted_m, bandwidth_m);
    let long = long.gradients(&places.sorted_m, trend_m);
    let slopes = short.zip(long).map(|(short, long)| (short + long).atan());
    Ok(places.in_order_of_time(slopes))
}

/// Place along the road and the elevation that an accelerometer felt there, per sample, m.
fn felt_elevation(step_s: f64, speed_mps: &[f64], accelerometer_mps2: &[f64]) -> Vec<(f64, f64)> {
    let mut felt = Vec::with_capacity(speed_mps.len());
    felt.extend(speed_mps.first().map(|_| (0.0, 0.0)));
    let (mut distance_m, mut elevation_m) = (0.0, 0.0);
    for (v, a) in speed_mps.windows(2).zip(accelerometer_mps2.windows(2)) {
        let specific_mps2 = 0.5 * (a[0] + a[1]) - (v[1] - v[0]) / step_s;
        let sine =
            (specific_mps2 / GRAVITY_MPS2).clamp(-SPECIFIC_FORCE_LIMIT, SPECIFIC_FORCE_LIMIT);
        let travelled_m = 0.5 * (v[0] + v[1]) * step_s;
        // In reverse the car climbs what it would descend.
        elevation_m += if sine.is_finite() {
            travelled_m * sine
        } else {
            0.0
        };
        distance_m += travelled_m;
        felt.push((distance_m, elevation_m));
    }
    felt
}

fn check_length(channel: &'static str, values: &[f64], expected: usize) -> Result<(), Error> {
    if values.len() == expected {
        return Ok(());
    }
    Err(Error::Length {
        channel,
        found: values.len(),
        expected,
    })
}

fn check_bandwidth(bandwidth_m: f64) -> Result<(), Error> {
    if (1.0..=1e5).contains(&bandwidth_m) {
        return Ok(());
    }
    Err(Error::Argument {
        name: "bandwidth_m",
        value: bandwidth_m,
        min: 1.0,
        max: 1e5,
    })
}

fn check_distance(distance_m: &[f64]) -> Result<(), Error> {
    let allowed = -DISTANCE_LIMIT_M..=DISTANCE_LIMIT_M;
    match distance_m.iter().position(|value| !allowed.contains(value)) {
        None => Ok(()),
        Some(index) => Err(Error::Sample {
            channel: "distance_m",
            index,
            value: distance_m[index],
            min: -DISTANCE_LIMIT_M,
            max: DISTANCE_LIMIT_M,
        }),
    }
}

/// Points in the order of the road: those of a car that went back come where they were.
fn along_road(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

/// Where the samples were, in the order of the road.
struct Places {
    sorted_m: Vec<f64>,
    /// The sample that is at each place.
    sample: Vec<usize>,
}

impl Places {
    fn of(distance_m: &[f64]) -> Self {
        let mut sample: Vec<usize> = (0..distance_m.len()).collect();
        sample.sort_by(|&a, &b| distance_m[a].total_cmp(&distance_m[b]));
        let sorted_m = sample.iter().map(|&k| distance_m[k]).collect();
        Self { sorted_m, sample }
    }

    /// Values of the places, one per sample.
    fn in_order_of_time(&self, of_places: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut values = vec![0.0; self.sample.len()];
        for (&k, value) in self.sample.iter().zip(of_places) {
            values[k] = value;
        }
        values
    }
}

/// The points that say where the road is, see [`slope_from_elevation`].
#[allow(clippy::float_cmp)] // a held value is the same to the last bit
fn unstepped(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let step_m = points
        .windows(2)
        .map(|pair| (pair[1].1 - pair[0].1).abs())
        .filter(|step| *step > 0.0)
        .fold(f64::INFINITY, f64::min);
    let mut kept = Vec::with_capacity(points.len());
    let mut before: Option<(f64, f64)> = None;
    for run in points.chunk_by(|a, b| a.1 == b.1) {
        let start = run[0];
        let rounded = |before: &(f64, f64)| {
            run.len() > 1 && (start.1 - before.1).abs() <= ROUNDING_STEPS * step_m
        };
        kept.push(match before.filter(rounded) {
            Some(before) => (0.5 * (before.0 + start.0), 0.5 * (before.1 + start.1)),
            None => start,
        });
        before = run.last().copied();
    }
    kept.extend(before);
    kept
}
