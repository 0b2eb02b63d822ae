use crate::error::Error;

/// Accelerations that are allowed, over speed: linear between the points, constant before the first and after the last.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    points: Vec<EnvelopePoint>,
}

/// Accelerations that are allowed at a speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvelopePoint {
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Strongest braking, m/s²; below 0.
    pub min_mps2: f64,
    /// Strongest acceleration, m/s²; above 0.
    pub max_mps2: f64,
}

/// An acceleration limit at a speed, and how it changes with the speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Limit {
    pub(crate) accel_mps2: f64,
    pub(crate) per_s: f64,
}

/// −2.0 and +1.5 m/s² at every speed.
impl Default for Envelope {
    fn default() -> Self {
        Self::points_unchecked(-2.0, 1.5)
    }
}

impl Envelope {
    /// The same limits at every speed, m/s².
    ///
    /// # Errors
    /// [`Error::Envelope`] for a limit on the wrong side of 0, beyond 20 m/s² or not finite.
    pub fn constant(min_mps2: f64, max_mps2: f64) -> Result<Self, Error> {
        Self::new(Self::points_unchecked(min_mps2, max_mps2).points)
    }

    fn points_unchecked(min_mps2: f64, max_mps2: f64) -> Self {
        Self {
            points: vec![EnvelopePoint {
                speed_mps: 0.0,
                min_mps2,
                max_mps2,
            }],
        }
    }

    /// Limits over speed, at increasing speeds.
    ///
    /// # Errors
    /// [`Error::Envelope`] for no point, speeds out of order, a limit on the wrong side of 0, beyond 20 m/s² or not finite.
    pub fn new(points: Vec<EnvelopePoint>) -> Result<Self, Error> {
        let fail = |index: usize, problem: &'static str| Err(Error::Envelope { index, problem });
        if points.is_empty() {
            return fail(0, "there is no point");
        }
        for (index, point) in points.iter().enumerate() {
            if !(0.0..=1e3).contains(&point.speed_mps) {
                return fail(index, "the speed is not within 0 and 1000 m/s");
            }
            if !(-20.0..=-0.01).contains(&point.min_mps2) {
                return fail(
                    index,
                    "the strongest braking is not within -20 and -0.01 m/s²",
                );
            }
            if !(0.01..=20.0).contains(&point.max_mps2) {
                return fail(
                    index,
                    "the strongest acceleration is not within 0.01 and 20 m/s²",
                );
            }
            if index > 0 && point.speed_mps <= points[index - 1].speed_mps {
                return fail(index, "the speed does not increase from point to point");
            }
        }
        Ok(Self { points })
    }

    /// The points.
    #[must_use]
    pub fn points(&self) -> &[EnvelopePoint] {
        &self.points
    }

    /// Whether the limits are the same at every speed.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.points.len() == 1
    }

    pub(crate) fn max_at(&self, speed_mps: f64) -> Limit {
        self.at(speed_mps, |point| point.max_mps2)
    }

    pub(crate) fn min_at(&self, speed_mps: f64) -> Limit {
        self.at(speed_mps, |point| point.min_mps2)
    }

    /// Smallest and largest acceleration at any of a range of speeds.
    pub(crate) fn range(&self, from_mps: f64, to_mps: f64) -> (f64, f64) {
        if let [point] = self.points.as_slice() {
            return (point.min_mps2, point.max_mps2);
        }
        let between = self
            .points
            .iter()
            .filter(|point| from_mps < point.speed_mps && point.speed_mps < to_mps);
        let (first, last) = (from_mps, to_mps);
        let mut min = self
            .min_at(first)
            .accel_mps2
            .min(self.min_at(last).accel_mps2);
        let mut max = self
            .max_at(first)
            .accel_mps2
            .max(self.max_at(last).accel_mps2);
        for point in between {
            min = min.min(point.min_mps2);
            max = max.max(point.max_mps2);
        }
        (min, max)
    }

    /// Largest change of a limit per change of the speed, 1/s.
    pub(crate) fn steepest_per_s(&self) -> f64 {
        let steepness = |pair: &[EnvelopePoint]| {
            let change = (pair[1].min_mps2 - pair[0].min_mps2)
                .abs()
                .max((pair[1].max_mps2 - pair[0].max_mps2).abs());
            change / (pair[1].speed_mps - pair[0].speed_mps)
        };
        self.points.windows(2).map(steepness).fold(0.0, f64::max)
    }

    fn at(&self, speed_mps: f64, limit: impl Fn(&EnvelopePoint) -> f64) -> Limit {
        let end = self
            .points
            .partition_point(|point| point.speed_mps <= speed_mps);
        let constant = |point: &EnvelopePoint| Limit {
            accel_mps2: limit(point),
            per_s: 0.0,
        };
        match (
            end.checked_sub(1).map(|k| &self.points[k]),
            self.points.get(end),
        ) {
            (Some(from), Some(to)) => {
                let per_s = (limit(to) - limit(from)) / (to.speed_mps - from.speed_mps);
                Limit {
                    accel_mps2: limit(from) + per_s * (speed_mps - from.speed_mps),
                    per_s,
                }
            }
            (Some(point), None) | (None, Some(point)) => constant(point),
            (None, None) => Limit {
                accel_mps2: 0.0,
                per_s: 0.0,
            },
        }
    }
}
