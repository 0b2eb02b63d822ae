//! The same drive again: it would be learned from and held out at once.

use std::collections::BTreeMap;
use std::fmt;

use drive_log::{DriveIndex, Kinship};
use serde::Serialize;

use super::{Input, Inputs, notes};
use crate::flags::Context;

/// A file or drive that is left out, since another is the same or holds it.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Twice {
    path: String,
    /// The drive, where it is not the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    same_as: String,
    why: Why,
}

#[derive(Debug, Clone, Copy, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Why {
    /// One file by two paths.
    SameFile,
    /// Byte for byte.
    SameBytes,
    /// Second by second.
    SameSpeed,
    /// Of a longer drive.
    PartOf,
}

impl fmt::Display for Twice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (path, other) = (&self.path, &self.same_as);
        match self.why {
            _ if path == other => write!(f, "`{path}` is named again, counted once"),
            Why::SameFile => write!(f, "`{path}` is the file `{other}`, counted once"),
            Why::SameBytes => write!(f, "`{path}` is a copy of `{other}`, counted once"),
            Why::SameSpeed => write!(
                f,
                "`{path}` is the same drive as `{other}`, second by second, counted once"
            ),
            Why::PartOf => write!(f, "`{path}` is a part of the drive `{other}`, counted once"),
        }
    }
}

impl Twice {
    pub(super) fn file(path: String, same_as: String) -> Self {
        Self {
            path,
            name: None,
            same_as,
            why: Why::SameFile,
        }
    }

    fn drive(input: &Input, of: &Input, why: Why) -> Self {
        Self {
            path: input.place(),
            name: Some(input.drive.name.clone()),
            same_as: of.place(),
            why,
        }
    }
}

impl From<Kinship> for Why {
    fn from(kinship: Kinship) -> Self {
        match kinship {
            Kinship::Same => Self::SameSpeed,
            Kinship::PartOf | Kinship::Holds => Self::PartOf,
        }
    }
}

/// Leaves out what is a copy, the same second by second, or a part of a drive. The longer of two stays, of equal ones the
/// one with more channels, then the first.
pub(super) fn each_once(inputs: Inputs, context: &Context) -> Inputs {
    let found = found_among(&inputs);
    let twice = found.iter().enumerate().map(|(number, found)| {
        let (of, why) = (*found)?;
        Some(Twice::drive(&inputs[number], &inputs[of], why))
    });
    let twice = twice.collect();
    without_those(inputs, twice, context)
}

/// Leaves out what is among other drives, whichever of the two is longer.
pub(super) fn without(inputs: Inputs, own: &[Input], context: &Context) -> Inputs {
    let mut index = DriveIndex::default();
    for (number, input) in own.iter().enumerate() {
        index.insert(number, &input.drive);
    }
    let twice = inputs.iter().map(|input| {
        let copy = own.iter().find(|own| own.sha256 == input.sha256);
        copy.map(|own| Twice::drive(input, own, Why::SameBytes))
            .or_else(|| {
                let (number, kinship) = *index.kin(&input.drive).first()?;
                Some(Twice::drive(input, &own[number], kinship.into()))
            })
    });
    let twice = twice.collect();
    without_those(inputs, twice, context)
}

/// Which drive each one is again, and why.
fn found_among(inputs: &[Input]) -> Vec<Option<(usize, Why)>> {
    let mut found: Vec<Option<(usize, Why)>> = vec![None; inputs.len()];
    let mut copies = BTreeMap::new();
    let mut index = DriveIndex::default();
    for (number, input) in inputs.iter().enumerate() {
        let before = inputs[..number].iter().rev();
        let of_file = before.take_while(|other| other.path == input.path).count();
        let first = *copies.entry((&input.sha256, of_file)).or_insert(number);
        if first != number {
            found[number] = Some((first, Why::SameBytes));
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
fn says_more(input: &Input, other: &Input, kinship: Kinship) -> bool {
    let channels = |input: &Input| {
        let first = input.drive.pieces.first();
        first.map_or(0, |piece| piece.channels().count())
    };
    match kinship {
        Kinship::Same => channels(input) > channels(other),
        Kinship::PartOf => false,
        Kinship::Holds => true,
    }
}

/// Takes out the drives that are there twice, and says so.
fn without_those(mut inputs: Inputs, twice: Vec<Option<Twice>>, context: &Context) -> Inputs {
    let mut twice = twice.into_iter();
    let mut named = Vec::new();
    inputs.drives.retain(|_| {
        let found = twice.next().flatten();
        let is_new = found.is_none();
        named.extend(found);
        is_new
    });
    notes::twice(&named, context);
    inputs.beside.twice.extend(named);
    inputs
}
