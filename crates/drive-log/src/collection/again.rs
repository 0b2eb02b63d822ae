//! The same drive again: it would be learned from and held out at once.

use std::collections::BTreeMap;

use super::Collection;
use super::repeated::{Repeated, SameBy};
use super::sourced_drive::SourcedDrive;
use crate::{DriveIndex, Kinship};

impl Collection {
    /// Leaves out what is a copy, the same second by second, or a part of a drive, and lists it in [`Beside::twice`](super::Beside). The
    /// longer of two stays, of equal ones the one with more channels, then the first.
    #[must_use]
    pub fn each_once(self) -> Self {
        let found = found_among(&self);
        let twice = found.iter().enumerate().map(|(number, found)| {
            let (of, why) = (*found)?;
            Some(Repeated::drive(&self[number], &self[of], why))
        });
        let twice = twice.collect();
        self.without_those(twice)
    }

    /// Leaves out what is among other drives, whichever of the two is longer.
    #[must_use]
    pub fn without(self, own: &[SourcedDrive]) -> Self {
        let mut index = DriveIndex::default();
        for (number, other) in own.iter().enumerate() {
            index.insert(number, &other.drive);
        }
        let twice = self.iter().map(|drive| {
            let copy = own.iter().find(|own| own.sha256 == drive.sha256);
            copy.map(|own| Repeated::drive(drive, own, SameBy::SameBytes))
                .or_else(|| {
                    let (number, kinship) = *index.kin(&drive.drive).first()?;
                    Some(Repeated::drive(drive, &own[number], kinship.into()))
                })
        });
        let twice = twice.collect();
        self.without_those(twice)
    }

    /// Leaves out the drives of files that `model`, by its name, has learnt from already, told by their SHA-256, and lists them in
    /// [`Beside::twice`](super::Beside).
    #[must_use]
    pub fn without_learnt(self, model: &str, is_known: impl Fn(&str) -> bool) -> Self {
        let learnt = self
            .iter()
            .map(|drive| is_known(&drive.sha256).then(|| Repeated::learnt(drive, model)));
        let learnt = learnt.collect();
        self.without_those(learnt)
    }

    fn without_those(mut self, twice: Vec<Option<Repeated>>) -> Self {
        let mut twice = twice.into_iter();
        let beside = &mut self.beside.twice;
        self.drives.retain(|_| {
            let found = twice.next().flatten();
            let is_new = found.is_none();
            beside.extend(found);
            is_new
        });
        self
    }
}

/// Which drive each one is again, and why.
fn found_among(inputs: &[SourcedDrive]) -> Vec<Option<(usize, SameBy)>> {
    let mut found: Vec<Option<(usize, SameBy)>> = vec![None; inputs.len()];
    let mut copies = BTreeMap::new();
    let mut index = DriveIndex::default();
    for (number, input) in inputs.iter().enumerate() {
        let before = inputs[..number].iter().rev();
        let of_file = before.take_while(|other| other.path == input.path).count();
        let first = *copies.entry((&input.sha256, of_file)).or_insert(number);
        if first != number {
            found[number] = Some((first, SameBy::SameBytes));
            continue;
        }
        let kin = index.kin(&input.drive);
        let (known, held): (Vec<_>, Vec<_>) = kin
            .into_iter()
            .partition(|(other, kinship)| !says_more(input, &inputs[*other], *kinship));
        match known.first() {
            Some(&(other, kinship)) => found[number] = Some((other, kinship.into())),
            None => {
                for (other, kinship) in held {
                    found[other] = Some((number, kinship.into()));
                }
            }
        }
        index.insert(number, &input.drive);
    }
    found
}

/// Whether a drive is the longer of two, or has more channels than the same drive before it.
fn says_more(input: &SourcedDrive, other: &SourcedDrive, kinship: Kinship) -> bool {
    let channels = |input: &SourcedDrive| {
        let first = input.drive.pieces.first();
        first.map_or(0, |piece| piece.channels().count())
    };
    match kinship {
        Kinship::Same => channels(input) > channels(other),
        Kinship::PartOf => false,
        Kinship::Holds => true,
    }
}
