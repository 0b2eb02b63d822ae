use serde::{Deserialize, Serialize};

use crate::{AccelPoint, DriveBehaviour, PhaseCurve, PhaseKind};

/// What models are fitted to: phases by the heuristic route, points of acceleration over speed by the statistical route.
#[derive(Debug, Clone, Default)]
pub struct TrainingSet<'a> {
    /// Phases without a leader, of one kind.
    pub phases: Vec<TrainingPhase<'a>>,
    /// Of segments without a leader, of the same kind.
    pub points: Vec<AccelPoint>,
    points_of: PointsOf,
}

/// Points of acceleration over speed that functions are fitted to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PointsOf {
    /// One per segment, by its means.
    #[default]
    Means,
    /// All samples of the segments.
    Samples,
}

/// A phase to learn from.
#[derive(Debug, Clone, Copy)]
pub struct TrainingPhase<'a> {
    /// The measured phase.
    pub curve: &'a PhaseCurve,
    /// Number of the trip that it is from; phases of one trip are held out together.
    pub trip: usize,
    /// Above 0; 1 for the driver's own.
    pub weight: f64,
}

impl<'a> TrainingSet<'a> {
    /// Joins what trips have to offer of one kind of phase.
    #[must_use]
    pub fn from_trips(
        kind: PhaseKind,
        trips: impl IntoIterator<Item = &'a DriveBehaviour>,
    ) -> Self {
        Self::with_points(PointsOf::Means, kind, trips)
    }

    /// The same with a choice of points.
    #[must_use]
    pub fn with_points(
        points_of: PointsOf,
        kind: PhaseKind,
        trips: impl IntoIterator<Item = &'a DriveBehaviour>,
    ) -> Self {
        let mut training = Self {
            points_of,
            ..Self::default()
        };
        training.extend(kind, trips, 1.0);
        training
    }

    /// Adds trips of other drivers, each phase and segment with this weight beside 1 for the own; 0 adds nothing.
    #[must_use]
    pub fn with_prior(
        mut self,
        kind: PhaseKind,
        trips: impl IntoIterator<Item = &'a DriveBehaviour>,
        weight: f64,
    ) -> Self {
        if weight > 0.0 {
            self.extend(kind, trips, weight);
        }
        self
    }

    fn extend(
        &mut self,
        kind: PhaseKind,
        trips: impl IntoIterator<Item = &'a DriveBehaviour>,
        weight: f64,
    ) {
        let points_of = self.points_of;
        let parts = |trip: &'a DriveBehaviour| {
            let points = trip.points_of(kind, points_of);
            (trip.phases_of(kind), points)
        };
        self.add(trips.into_iter().map(parts), weight);
    }

    /// Adds the phases and points of trips, which are numbered on from the last that has a phase.
    pub(crate) fn add<P, A>(&mut self, trips: impl Iterator<Item = (P, A)>, weight: f64)
    where
        P: Iterator<Item = &'a PhaseCurve>,
        A: Iterator<Item = &'a AccelPoint>,
    {
        let first = self.phases.last().map_or(0, |p| p.trip + 1);
        for (trip, (curves, points)) in (first..).zip(trips) {
            let phase = |curve| TrainingPhase {
                curve,
                trip,
                weight,
            };
            self.phases.extend(curves.map(phase));
            let weighted = |point: &AccelPoint| AccelPoint { weight, ..*point };
            self.points.extend(points.map(weighted));
        }
    }

    /// The weighted mean over phases, `None` without one.
    pub(crate) fn mean(&self, figure: impl Fn(&PhaseCurve) -> f64) -> Option<f64> {
        let (sum, weight) = self.phases.iter().fold((0.0, 0.0), |(sum, weight), p| {
            (sum + p.weight * figure(p.curve), weight + p.weight)
        });
        (weight > 0.0).then(|| sum / weight)
    }
}
