//! Elevation over distance, and the straight lines that fit it.

/// Windows shorter than this share of the bandwidth carry no slope: noise would be divided by next
/// to nothing.
const SHORTEST_WINDOW: f64 = 0.01;

/// Piecewise linear elevation over distance; both count from the first valid sample, against
/// cancellation.
pub(super) struct Profile {
    origin_m: f64,
    datum_m: f64,
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
    /// Through points of distance and elevation, in their order.
    pub(super) fn new(points: impl Iterator<Item = (f64, f64)>) -> Self {
        let mut points = points.peekable();
        let (origin_m, datum_m) = points.peek().copied().unwrap_or_default();
        let start = Knot {
            distance_m: 0.0,
            elevation_m: 0.0,
            area: 0.0,
            moment: 0.0,
        };
        let knots = points
            .scan(start, |last, (distance, elevation)| {
                *last = last.extended(distance - origin_m, elevation - datum_m);
                Some(*last)
            })
            .collect();
        Self {
            origin_m,
            datum_m,
            knots,
        }
    }

    /// The windows of half a width around distances that never decrease, by their ends; `None` where the profile covers next to
    /// nothing of one.
    fn windows<'a>(
        &'a self,
        distance_m: &'a [f64],
        bandwidth_m: f64,
    ) -> impl Iterator<Item = (f64, Option<(Knot, Knot)>)> + use<'a> {
        let (mut left_hint, mut right_hint) = (0, 0);
        distance_m.iter().map(move |&distance_m| {
            let left = self.at(distance_m - bandwidth_m, &mut left_hint);
            let right = self.at(distance_m + bandwidth_m, &mut right_hint);
            let covered = |(left, right): &(Knot, Knot)| {
                right.distance_m - left.distance_m >= SHORTEST_WINDOW * bandwidth_m
            };
            (distance_m, left.zip(right).filter(covered))
        })
    }

    /// Gradient at distances that never decrease, 0 where the profile says nothing.
    pub(super) fn gradients<'a>(
        &'a self,
        distance_m: &'a [f64],
        bandwidth_m: f64,
    ) -> impl Iterator<Item = f64> + use<'a> {
        self.windows(distance_m, bandwidth_m)
            .map(|(_, window)| window.map_or(0.0, |(left, right)| Self::gradient(&left, &right)))
    }

    /// Elevation of the best straight lines at distances that never decrease; `None` where the profile says nothing.
    pub(super) fn smoothed<'a>(
        &'a self,
        distance_m: &'a [f64],
        bandwidth_m: f64,
    ) -> impl Iterator<Item = Option<f64>> + use<'a> {
        self.windows(distance_m, bandwidth_m)
            .map(|(distance_m, window)| {
                let (left, right) = window?;
                let length = right.distance_m - left.distance_m;
                let centre = 0.5 * (left.distance_m + right.distance_m);
                let from_centre = distance_m - self.origin_m - centre;
                let mean_m = (right.area - left.area) / length;
                let gradient = Self::gradient(&left, &right);
                Some(self.datum_m + mean_m + gradient * from_centre)
            })
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
