//! Several drives in one file: the columns that say which rows belong to which.

use std::collections::{BTreeMap, HashMap};

use crate::header::normalised;
use crate::note::Note;
use crate::number::is_missing;
use crate::{Action, FindingKind};

/// Headers that name a trip, a vehicle or a driver, without marks between their words.
const NAMES: [&str; 29] = [
    "trip",
    "tripid",
    "tripno",
    "tripnumber",
    "driveid",
    "vehicle",
    "vehicleid",
    "vehicleno",
    "vehiclenumber",
    "vehiclename",
    "vehid",
    "vin",
    "car",
    "carid",
    "carno",
    "carname",
    "deviceid",
    "licenseplate",
    "licenceplate",
    "driver",
    "driverid",
    "drivername",
    "journey",
    "journeyid",
    "session",
    "sessionid",
    "ride",
    "rideid",
    "tripname",
];

/// From this many rows on, a column with another value in most of them names nothing.
const ROWS_TO_JUDGE: usize = 20;

/// The columns whose headers name a trip, a vehicle or a driver.
pub(crate) fn columns(headers: &[String]) -> Vec<usize> {
    let is_name = |header: &String| {
        let words = normalised(header).replace(['_', '-', '.'], "");
        NAMES.contains(&words.as_str())
    };
    (0..headers.len())
        .filter(|column| is_name(&headers[*column]))
        .collect()
}

/// The values of a column without repetition, and which of them each row has.
#[derive(Debug, Default)]
pub(crate) struct Kinds {
    values: Vec<String>,
    codes: HashMap<String, u32>,
    /// `None` where there is no value.
    rows: Vec<Option<u32>>,
}

impl Kinds {
    pub(crate) fn push(&mut self, text: &str) {
        let text = whole(text);
        if is_missing(text) {
            self.rows.push(None);
            return;
        }
        let code = self.codes.get(text).copied().or_else(|| {
            let code = u32::try_from(self.values.len()).ok()?;
            self.values.push(text.to_owned());
            self.codes.insert(text.to_owned(), code);
            Some(code)
        });
        self.rows.push(code);
    }

    /// The only value in some rows, all if `None`.
    pub(crate) fn only(&self, rows: Option<&[usize]>) -> Option<&str> {
        let mut codes: Vec<u32> = match rows {
            None => self.rows.iter().flatten().copied().collect(),
            Some(rows) => rows.iter().filter_map(|row| self.rows[*row]).collect(),
        };
        codes.dedup();
        match codes.as_slice() {
            [code] => self.values.get(*code as usize).map(String::as_str),
            _ => None,
        }
    }

    /// Measured values, a trip meter say: with decimals, or another in most of the rows.
    fn is_measured(&self) -> bool {
        let decimal = |value: &String| value.parse::<f64>().is_ok_and(|v| v.fract() != 0.0);
        let rows = self.rows.len();
        self.values.iter().any(decimal) || (rows >= ROWS_TO_JUDGE && 2 * self.values.len() > rows)
    }
}

/// A whole number without its decimals: `3.0` and `3` name the same trip.
fn whole(text: &str) -> &str {
    match text.split_once('.') {
        Some((whole, decimals))
            if !whole.is_empty()
                && whole.bytes().all(|b| b.is_ascii_digit())
                && decimals.bytes().all(|b| b == b'0') =>
        {
            whole
        }
        _ => text,
    }
}

/// One drive of a file.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct DriveRows {
    /// What follows `#` in its name, where there are several: `trip=3,vehid=8`.
    pub(crate) part: Option<String>,
    /// The values of the columns, by header.
    pub(crate) origin: BTreeMap<String, String>,
    /// Its rows in the file, all if `None`.
    pub(crate) rows: Option<Vec<usize>>,
}

/// Divides a file by its columns of trips and vehicles, given with their headers. What a layout
/// names divides whatever it holds (`declared`).
pub(crate) fn divided(
    mut columns: Vec<(String, Kinds)>,
    declared: bool,
) -> (Vec<DriveRows>, Vec<Note>) {
    let mut notes = Vec::new();
    if !declared {
        columns.retain(|(header, kinds)| {
            let measured = kinds.is_measured();
            if measured {
                notes.push(undivided(header, kinds.values.len()));
            }
            !measured
        });
    }
    let mut common = BTreeMap::new();
    columns.retain(|(header, kinds)| {
        if let [value] = kinds.values.as_slice() {
            common.insert(header.clone(), value.clone());
        }
        kinds.values.len() > 1
    });
    if columns.is_empty() {
        let all = DriveRows {
            origin: common,
            ..DriveRows::default()
        };
        return (vec![all], notes);
    }
    let (groups, nameless) = groups(&columns);
    notes.extend(left_out(&nameless));
    let drives = groups
        .into_iter()
        .map(|rows| drive(&columns, &common, rows));
    (drives.collect(), notes)
}

fn undivided(header: &str, values: usize) -> Note {
    let detail = format!(
        "the column {header:?} has {values} values, as a measured quantity has: the file was not \
         divided by it"
    );
    Note::of_file(FindingKind::NoDivision, Action::Kept, detail)
}

/// The rows of each combination of values, in the order in which they come, and the rows without
/// one.
fn groups(columns: &[(String, Kinds)]) -> (Vec<Vec<usize>>, Vec<usize>) {
    let rows = columns.first().map_or(0, |(_, kinds)| kinds.rows.len());
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut known: HashMap<Vec<u32>, usize> = HashMap::new();
    let mut nameless = Vec::new();
    let mut key = Vec::with_capacity(columns.len());
    for row in 0..rows {
        key.clear();
        key.extend(columns.iter().filter_map(|(_, kinds)| kinds.rows[row]));
        if key.len() < columns.len() {
            nameless.push(row);
            continue;
        }
        let group = match known.get(&key) {
            Some(group) => *group,
            None => {
                known.insert(key.clone(), groups.len());
                groups.push(Vec::new());
                groups.len() - 1
            }
        };
        groups[group].push(row);
    }
    (groups, nameless)
}

fn left_out(nameless: &[usize]) -> Option<Note> {
    let first = nameless.first()? + 1;
    let detail = format!(
        "{} without a value in the columns that divide the file, first row {first}",
        counted(nameless.len(), "row", "rows")
    );
    Some(Note::of_file(
        FindingKind::NoSample,
        Action::Dropped,
        detail,
    ))
}

fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

fn drive(
    columns: &[(String, Kinds)],
    common: &BTreeMap<String, String>,
    rows: Vec<usize>,
) -> DriveRows {
    let mut origin = common.clone();
    let mut part: Vec<String> = Vec::new();
    let first = rows.first().copied().unwrap_or_default();
    for (header, kinds) in columns {
        let code = kinds.rows[first].unwrap_or_default();
        let value = &kinds.values[code as usize];
        let name = value.replace(['/', '\\'], "_");
        part.push(format!("{}={name}", normalised(header)));
        origin.insert(header.clone(), value.clone());
    }
    DriveRows {
        part: Some(part.join(",")),
        origin,
        rows: Some(rows),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn kinds(values: &[&str]) -> Kinds {
        let mut kinds = Kinds::default();
        values.iter().for_each(|value| kinds.push(value));
        kinds
    }

    #[test]
    fn names_in_any_dress() {
        let headers: Vec<String> = [
            "Trip",
            "time_s",
            "[VehId]",
            "Vehicle ID",
            "trip_km",
            "Driver_ID",
        ]
        .map(str::to_owned)
        .into();
        assert_eq!(columns(&headers), [0, 2, 3, 5]);
    }

    #[test]
    fn rows_of_one_trip_need_not_be_adjacent() {
        let columns = vec![
            ("Trip".to_owned(), kinds(&["3", "3.0", "4", "3", "", "4"])),
            ("Car".to_owned(), kinds(&["x", "x", "x", "y", "x", "x"])),
            ("Driver".to_owned(), kinds(&["a", "", "a", "a", "a", "a"])),
        ];
        let (drives, notes) = divided(columns, false);
        let rows: Vec<_> = drives.iter().map(|d| d.rows.clone().unwrap()).collect();
        assert_eq!(rows, [vec![0, 1], vec![2, 5], vec![3]]);
        assert_eq!(drives[2].part.as_deref(), Some("trip=3,car=y"));
        assert_eq!(drives[2].origin["Driver"], "a");
        assert_eq!((drives[2].origin.len(), notes.len()), (3, 1));
    }

    #[test]
    fn a_trip_meter_divides_nothing() {
        let (drives, notes) = divided(vec![("trip".to_owned(), kinds(&["0.1", "0.2"]))], false);
        assert_eq!((drives.len(), notes.len()), (1, 1));
        assert!(drives[0].rows.is_none() && drives[0].origin.is_empty());
        let (drives, _) = divided(vec![("trip".to_owned(), kinds(&["0.1", "0.2"]))], true);
        assert_eq!(drives.len(), 2);
    }
}
