use crate::{CruiseGroup, Error, FollowingGroup, PhaseKind, Trip};

/// The trips of an evaluation, in units that are held out together.
#[derive(Debug, Clone)]
pub struct EvaluationData<'a> {
    pub(super) trips: &'a [Trip],
    /// Trips of other drivers, never held out.
    pub(super) prior: &'a [Trip],
    pub(super) units: Vec<String>,
    pub(super) unit_of: Vec<usize>,
}

impl<'a> EvaluationData<'a> {
    /// Every trip is a unit of its own.
    #[must_use]
    pub fn by_trip(trips: &'a [Trip]) -> Self {
        Self {
            units: trips.iter().map(|t| t.name.clone()).collect(),
            unit_of: (0..trips.len()).collect(),
            prior: &[],
            trips,
        }
    }

    /// Trips with the same name of unit (a file, a driver) are held out together; `unit_names` has one for every trip.
    #[must_use]
    pub fn by_unit(trips: &'a [Trip], unit_names: &[String]) -> Self {
        let (units, unit_of) = numbered(unit_names);
        Self {
            units,
            unit_of,
            prior: &[],
            trips,
        }
    }

    /// Adds trips of other drivers, from which every model learns as well.
    #[must_use]
    pub fn with_prior(mut self, prior: &'a [Trip]) -> Self {
        self.prior = prior;
        self
    }

    /// Stretches behind a leader, by unit.
    #[must_use]
    pub fn following_groups(&self) -> Vec<FollowingGroup> {
        let units = self
            .units
            .iter()
            .zip(self.stretches(|trip| &trip.following));
        units
            .map(|(name, stretches)| FollowingGroup {
                name: name.clone(),
                stretches,
            })
            .collect()
    }

    /// Stretches of cruising, by unit.
    #[must_use]
    pub fn cruise_groups(&self) -> Vec<CruiseGroup> {
        let units = self.units.iter().zip(self.stretches(|trip| &trip.cruise));
        units
            .map(|(name, stretches)| CruiseGroup {
                name: name.clone(),
                stretches,
            })
            .collect()
    }

    fn stretches<T: Clone>(&self, of: fn(&Trip) -> &[T]) -> Vec<Vec<T>> {
        let mut units = vec![Vec::new(); self.units.len()];
        for (trip, &unit) in self.trips.iter().zip(&self.unit_of) {
            units[unit].extend_from_slice(of(trip));
        }
        units
    }

    pub(super) fn trips_where(
        &self,
        counts: impl Fn(usize) -> bool,
    ) -> impl Iterator<Item = &'a Trip> {
        let trips = self.trips.iter().zip(&self.unit_of);
        trips.filter_map(move |(trip, &unit)| counts(unit).then_some(trip))
    }

    pub(super) fn check(&self, kind: PhaseKind) -> Result<(), Error> {
        if self.units.len() < 2 {
            return Err(Error::TooFewTrips {
                found: self.units.len(),
                needed: 2,
            });
        }
        if self
            .trips
            .iter()
            .all(|t| t.phases_of(kind).next().is_none())
        {
            return Err(Error::TooFewPhases {
                model: "any model",
                found: 0,
                needed: 1,
                unit: match kind {
                    PhaseKind::Braking => "braking phases without a leader",
                    _ => "acceleration phases without a leader",
                },
            });
        }
        Ok(())
    }
}

/// The different names in order of their first mention, and which of them each is.
pub(crate) fn numbered(names: &[String]) -> (Vec<String>, Vec<usize>) {
    let mut different: Vec<String> = Vec::new();
    let number_of = |name: &String| {
        different
            .iter()
            .position(|known| known == name)
            .unwrap_or_else(|| {
                different.push(name.clone());
                different.len() - 1
            })
    };
    let numbers = names.iter().map(number_of).collect();
    (different, numbers)
}
