//! Which items are held out together.

use driver_model::{Motion, motion};
use rayon::prelude::*;

use crate::Error;

/// Items such as trips or stretches in units, such as files or drivers, that are held out together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HoldOut {
    units: Vec<String>,
    unit_of: Vec<usize>,
    folds: usize,
}

impl HoldOut {
    /// Items with the same name of unit are held out together, one unit at a time; `unit_names` has one for every item.
    #[must_use]
    pub fn by_unit<S: AsRef<str>>(unit_names: &[S]) -> Self {
        let mut units: Vec<String> = Vec::new();
        let number_of = |name: &S| {
            let name = name.as_ref();
            units
                .iter()
                .position(|known| known == name)
                .unwrap_or_else(|| {
                    units.push(name.to_owned());
                    units.len() - 1
                })
        };
        let unit_of = unit_names.iter().map(number_of).collect();
        let folds = units.len();
        Self {
            units,
            unit_of,
            folds,
        }
    }

    /// Pieces of drives, by units of drives; `unit_names` has one for every drive.
    #[must_use]
    pub fn of_motions(motions: &[Motion], unit_names: &[String]) -> Self {
        let drives = motion::drives(motions).zip(unit_names);
        let names = drives.flat_map(|(pieces, name)| std::iter::repeat_n(name, pieces.len()));
        Self::by_unit(&names.collect::<Vec<_>>())
    }

    /// Every item is a unit of its own.
    #[must_use]
    pub fn one_by_one(names: impl IntoIterator<Item = String>) -> Self {
        let units: Vec<String> = names.into_iter().collect();
        Self {
            unit_of: (0..units.len()).collect(),
            folds: units.len(),
            units,
        }
    }

    /// The same units for other items, given by the index of the unit of each in ascending order. Units without items are none.
    #[must_use]
    pub fn of_items(&self, unit_of: &[usize]) -> Self {
        let mut known = unit_of.to_vec();
        known.dedup();
        let number_of = |unit: &usize| known.partition_point(|known| known < unit);
        Self {
            units: known.iter().map(|&unit| self.units[unit].clone()).collect(),
            unit_of: unit_of.iter().map(number_of).collect(),
            folds: known.len(),
        }
    }

    /// Unit `u` is held out in fold `u mod folds`; at most as many folds as units.
    #[must_use]
    pub fn in_folds(self, folds: usize) -> Self {
        let folds = folds.min(self.units.len());
        Self { folds, ..self }
    }

    /// Names of the units, in the order of their first mention.
    #[must_use]
    pub fn units(&self) -> &[String] {
        &self.units
    }

    /// Index of the unit of every item.
    #[must_use]
    pub fn unit_of(&self) -> &[usize] {
        &self.unit_of
    }

    /// # Errors
    /// [`Error::TooFewUnits`] below so many.
    pub fn at_least(&self, needed: usize) -> Result<(), Error> {
        let found = self.units.len();
        if found < needed {
            return Err(Error::TooFewUnits { found, needed });
        }
        Ok(())
    }

    /// Runs every fold on the current rayon pool and calls `progress` after each, from any thread. Outcomes are in the order of
    /// folds, on any number of threads.
    ///
    /// # Errors
    /// That of the first fold that fails.
    pub fn run<T: Send>(
        &self,
        progress: &(dyn Fn() + Sync),
        fold: impl Fn(Split<'_>) -> Result<T, Error> + Sync,
    ) -> Result<Vec<T>, Error> {
        let run = |number| {
            let outcome = fold(self.split(number));
            progress();
            outcome
        };
        (0..self.folds).into_par_iter().map(run).collect()
    }

    pub(crate) fn split(&self, fold: usize) -> Split<'_> {
        Split { of: self, fold }
    }
}

/// One fold.
#[derive(Debug, Clone, Copy)]
pub struct Split<'a> {
    of: &'a HoldOut,
    fold: usize,
}

impl<'a> Split<'a> {
    /// Its number; where units are held out alone, that of the unit.
    #[must_use]
    pub fn fold(self) -> usize {
        self.fold
    }

    /// The units that are held out.
    pub fn units(self) -> impl Iterator<Item = usize> + 'a {
        (self.fold..self.of.units.len()).step_by(self.of.folds)
    }

    /// Items of held-out units.
    pub fn held_out(self) -> impl Iterator<Item = usize> + 'a {
        self.items(true)
    }

    /// Items of all other units.
    pub fn rest(self) -> impl Iterator<Item = usize> + 'a {
        self.items(false)
    }

    fn items(self, held_out: bool) -> impl Iterator<Item = usize> + 'a {
        let items = self.of.unit_of.iter().enumerate();
        let of_fold = move |unit: usize| (unit % self.of.folds == self.fold) == held_out;
        items
            .filter(move |(_, unit)| of_fold(**unit))
            .map(|(item, _)| item)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_held_out_once_with_its_unit() {
        let units = HoldOut::by_unit(&["b", "a", "b", "c", "a"]);
        assert_eq!(units.units(), ["b", "a", "c"]);
        let held_out = |units: &HoldOut| {
            let fold = |split: Split<'_>| {
                let (held_out, rest): (Vec<_>, Vec<_>) =
                    (split.held_out().collect(), split.rest().collect());
                assert_eq!(held_out.len() + rest.len(), 5);
                Ok(held_out)
            };
            units.run(&|| {}, fold).unwrap()
        };
        assert_eq!(held_out(&units), [vec![0, 2], vec![1, 4], vec![3]]);
        assert_eq!(
            held_out(&units.clone().in_folds(2)),
            [vec![0, 2, 3], vec![1, 4]]
        );
        assert_eq!(held_out(&units.clone().in_folds(9)).len(), 3);
        let of_others = units.of_items(&[0, 0, 2]);
        assert_eq!(of_others.units(), ["b", "c"]);
        assert_eq!(of_others.unit_of(), [0, 0, 1]);
        assert!(HoldOut::by_unit(&["a", "a"]).at_least(2).is_err());
    }
}
