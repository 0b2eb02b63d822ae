use driver_model::{DriveBehaviour, PhaseKind};

use crate::{Error, HoldOut};

/// The trips of an evaluation, in units that are held out together.
#[derive(Debug, Clone)]
pub struct EvaluationData<'a> {
    pub(super) trips: &'a [DriveBehaviour],
    /// Trips of other drivers, never held out.
    pub(super) prior: &'a [DriveBehaviour],
    pub(super) hold_out: HoldOut,
}

impl<'a> EvaluationData<'a> {
    /// Every trip is a unit of its own.
    #[must_use]
    pub fn by_trip(trips: &'a [DriveBehaviour]) -> Self {
        Self {
            hold_out: HoldOut::one_by_one(trips.iter().map(|trip| trip.name.clone())),
            prior: &[],
            trips,
        }
    }

    /// Trips with the same name of unit (a file, a driver) are held out together; `unit_names` has one for every trip.
    #[must_use]
    pub fn by_unit(trips: &'a [DriveBehaviour], unit_names: &[String]) -> Self {
        Self {
            hold_out: HoldOut::by_unit(unit_names),
            prior: &[],
            trips,
        }
    }

    /// Adds trips of other drivers, from which every model learns as well.
    #[must_use]
    pub fn with_prior(mut self, prior: &'a [DriveBehaviour]) -> Self {
        self.prior = prior;
        self
    }

    /// The trips that are held out.
    #[must_use]
    pub fn trips(&self) -> &'a [DriveBehaviour] {
        self.trips
    }

    /// The trips of other drivers.
    #[must_use]
    pub fn prior(&self) -> &'a [DriveBehaviour] {
        self.prior
    }

    /// The same units with something else of the same trips.
    pub(crate) fn with_trips<'b>(
        &self,
        trips: &'b [DriveBehaviour],
        prior: &'b [DriveBehaviour],
    ) -> EvaluationData<'b> {
        EvaluationData {
            trips,
            prior,
            hold_out: self.hold_out.clone(),
        }
    }

    /// Stretches of all trips, those of a unit together, and how they are held out.
    #[must_use]
    pub fn stretches<T: Clone>(&self, of: fn(&DriveBehaviour) -> &[T]) -> (Vec<T>, HoldOut) {
        let mut by_unit: Vec<(usize, &T)> = Vec::new();
        for (trip, &unit) in self.trips.iter().zip(self.hold_out.unit_of()) {
            by_unit.extend(of(trip).iter().map(|stretch| (unit, stretch)));
        }
        by_unit.sort_by_key(|(unit, _)| *unit);
        let units: Vec<usize> = by_unit.iter().map(|(unit, _)| *unit).collect();
        let stretches = by_unit.into_iter().map(|(_, stretch)| stretch.clone());
        (stretches.collect(), self.hold_out.of_items(&units))
    }

    pub(super) fn trips_where(
        &self,
        counts: impl Fn(usize) -> bool,
    ) -> impl Iterator<Item = &'a DriveBehaviour> {
        let trips = self.trips.iter().zip(self.hold_out.unit_of());
        trips.filter_map(move |(trip, &unit)| counts(unit).then_some(trip))
    }

    pub(super) fn check(&self, kind: PhaseKind) -> Result<(), Error> {
        self.hold_out.at_least(2)?;
        if self
            .trips
            .iter()
            .all(|t| t.phases_of(kind).next().is_none())
        {
            let error = driver_model::Error::TooFewPhases {
                model: "any model",
                found: 0,
                needed: 1,
                unit: match kind {
                    PhaseKind::Braking => "braking phases without a leader",
                    _ => "acceleration phases without a leader",
                },
            };
            return Err(error.into());
        }
        Ok(())
    }
}
