use crate::error::Error;

/// Bandwidth that suits elevations from satellite navigation and from terrain models, m.
pub const DEFAULT_SLOPE_BANDWIDTH_M: f64 = 100.0;

/// Windows shorter than this share of the bandwidth carry no slope: noise would be divided by next
/// to nothing.
const SHORTEST_WINDOW: f64 = 0.01;

/// Distances beyond this lose the metres to rounding.
const DISTANCE_LIMIT_M: f64 = 1e9;

/// Elevations beyond this are no elevations.
const ELEVATION_LIMIT_M: f64 = 1e5;

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
/// - `distance_m`: distance since the start, within ±10⁹ m, never decreasing.
/// - `elevation_m`: elevation at the same samples. Values that are not finite or beyond ±10⁵ m
///   count as missing and are bridged by straight lines over distance.
/// - `bandwidth_m`: `b`, 1 to 10⁵ m; [`DEFAULT_SLOPE_BANDWIDTH_M`] unless there is a reason.
///
/// Returns one slope per sample. Where the elevation covers no distance the slope is 0. The time is
/// linear in the number of samples.
///
/// # Errors
/// [`Error::Length`], [`Error::Argument`] for the bandwidth, [`Error::Sample`] for a distance that
/// is out of range or smaller than its predecessor.
pub fn slope_from_elevation(
    distance_m: &[f64],
    elevation_m: &[f64],
    bandwidth_m: f64,
) -> Result<Vec<f64>, Error> {
    if elevation_m.len() != distance_m.len() {
        return Err(Error::Length {
            channel: "elevation_m",
            found: elevation_m.len(),
            expected: distance_m.len(),
        });
    }
    if !(1.0..=1e5).contains(&bandwidth_m) {
        return Err(Error::Argument {
            name: "bandwidth_m",
            value: bandwidth_m,
            min: 1.0,
            max: 1e5,
        });
    }
    let mut min = -DISTANCE_LIMIT_M;
    for (index, &value) in distance_m.iter().enumerate() {
        if !(min..=DISTANCE_LIMIT_M).contains(&value) {
            return Err(Error::Sample {
                channel: "distance_m",
                index,
                value,
                min,
                max: DISTANCE_LIMIT_M,
            });
        }
        min = value;
    }

    let profile = Profile::new(distance_m, elevation_m);
    let (mut left_hint, mut right_hint) = (0, 0);
    let slope_rad = |&distance_m: &f64| {
        let left = profile.at(distance_m - bandwidth_m, &mut left_hint)?;
        let right = profile.at(distance_m + bandwidth_m, &mut right_hint)?;
        let covered = right.distance_m - left.distance_m >= SHORTEST_WINDOW * bandwidth_m;
        covered.then(|| Profile::gradient(&left, &right).atan())
    };
    Ok(distance_m
        .iter()
        .map(slope_rad)
        .map(Option::unwrap_or_default)
        .collect())
}

/// Piecewise linear elevation over distance; both count from the first valid sample, against
/// cancellation.
struct Profile {
    origin_m: f64,
    knots: Vec<Knot>,
}

/// A point of the profile with `area = ∫ h ds` and `moment = ∫ s h ds` from the first knot up to
/// it.
#[derive(Clone, Copy)]
struct Knot {
    distance_m: f64,
    elevation_m: f64,
    area: f64,
    moment: f64,
}

impl Profile {
    fn new(distance_m: &[f64], elevation_m: &[f64]) -> Self {
        let mut valid = distance_m
            .iter()
            .zip(elevation_m)
            .filter(|(_, elevation)| elevation.abs() <= ELEVATION_LIMIT_M)
            .peekable();
        let (origin_m, datum_m) = valid
            .peek()
            .map_or((0.0, 0.0), |&(&distance, &elevation)| (distance, elevation));
        let start = Knot {
            distance_m: 0.0,
            elevation_m: 0.0,
            area: 0.0,
            moment: 0.0,
        };
        let knots = valid
            .scan(start, |last, (&distance, &elevation)| {
                *last = last.extended(distance - origin_m, elevation - datum_m);
                Some(*last)
            })
            .collect();
        Self { origin_m, knots }
    }

    /// The point at a distance, cut to the profile. `hint` is the knot to search from, and moves
    /// forward only.
    fn at(&self, distance_m: f64, hint: &mut usize) -> Option<Knot> {
        let (first, last) = (self.knots.first()?, self.knots.last()?);
        let distance_m = (distance_m - self.origin_m)
            .max(first.distance_m)
            .min(last.distance_m);
        while self
            .knots
            .get(*hint + 1)
            .is_some_and(|next| next.distance_m <= distance_m)
        {
            *hint += 1;
        }
        let from = self.knots.get(*hint)?;
        Some(match self.knots.get(*hint + 1) {
            None => *from,
            Some(to) => {
                let share = (distance_m - from.distance_m) / (to.distance_m - from.distance_m);
                from.extended(
                    distance_m,
                    from.elevation_m + share * (to.elevation_m - from.elevation_m),
                )
            }
        })
    }

    /// Gradient of the best straight line between two points of the profile.
    fn gradient(left: &Knot, right: &Knot) -> f64 {
        let length = right.distance_m - left.distance_m;
        let centre = 0.5 * (left.distance_m + right.distance_m);
        let moment = (right.moment - left.moment) - centre * (right.area - left.area);
        12.0 * moment / (length * length * length)
    }
}

impl Knot {
    /// The point at the end of a straight line from here; the integrals of the line are exact.
    fn extended(&self, distance_m: f64, elevation_m: f64) -> Self {
        let length = distance_m - self.distance_m;
        let mean_distance_m = 0.5 * (self.distance_m + distance_m);
        let mean_elevation_m = 0.5 * (self.elevation_m + elevation_m);
        let rise_m = elevation_m - self.elevation_m;
        Self {
            distance_m,
            elevation_m,
            area: self.area + length * mean_elevation_m,
            moment: self.moment
                + length * (mean_distance_m * mean_elevation_m + length * rise_m / 12.0),
        }
    }
}
