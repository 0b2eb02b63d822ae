//! Paths from files: points by the names and units of their columns.

use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};

use crate::error::Error;

/// The way from the last point to the first is a gap, and the path open, if it is longer than the longest step by this factor.
const GAP: f64 = 1.5;
const COLUMNS: &str = "name the columns of the points `x_m` and `y_m` (or mm, cm, km), a point per line, in the order of travel";

/// The points of a path and what was taken for granted of them.
#[derive(Debug, Clone, PartialEq)]
pub struct PathFile {
    /// `[x, y]` in m, in the order of travel
    pub points_m: Vec<[f64; 2]>,
    /// For who gave the file
    pub notes: Vec<String>,
}

impl PathFile {
    /// Reads CSV whose header names x and y with their units, among any other columns; or two columns of numbers without a header,
    /// which are x and y in m.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, columns that are no places in a plane, or the first line that is no point.
    pub fn read(file: &Path) -> Result<Self, Error> {
        let bytes = crate::log_file::file_bytes(file)?;
        let text = str::from_utf8(&bytes).map_err(|_| Flaw::of_file("it is no text".to_owned()));
        text.and_then(Self::parse).map_err(|flaw| Error::Content {
            path: file.to_owned(),
            place: flaw
                .line
                .map_or(String::new(), |line| format!(", line {line}")),
            found: flaw.found,
            help: flaw.help.to_owned(),
        })
    }

    fn parse(text: &str) -> Result<Self, Flaw> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .comment(Some(b'#'))
            .delimiter(delimiter(text))
            .trim(Trim::All)
            .from_reader(text.as_bytes());
        let mut records = reader.records().peekable();
        let first = match records.peek() {
            Some(Ok(first)) => first.clone(),
            Some(Err(error)) => return Err(Flaw::of_file(error.to_string())),
            None => return Err(Flaw::of_file("no line with a point".to_owned())),
        };
        let (columns, notes) = Columns::of(&first)?;
        if columns.has_header {
            records.next();
        }
        let points_m = records.map(|record| {
            let record = record.map_err(|error| Flaw::of_file(error.to_string()))?;
            columns.point_m(&record)
        });
        Ok(Self {
            points_m: points_m.collect::<Result<_, _>>()?,
            notes,
        })
    }

    /// How far apart the ends of an open path are, in m; none of a path around which the points lead.
    #[must_use]
    pub fn gap_m(&self) -> Option<f64> {
        let distance_m = |[ax, ay]: [f64; 2], [bx, by]: [f64; 2]| (bx - ax).hypot(by - ay);
        let steps_m = self
            .points_m
            .windows(2)
            .map(|pair| distance_m(pair[0], pair[1]));
        let longest_m = steps_m.fold(0.0, f64::max);
        let gap_m = distance_m(*self.points_m.last()?, *self.points_m.first()?);
        (gap_m > GAP * longest_m).then_some(gap_m)
    }
}

/// What is wrong, and where.
struct Flaw {
    line: Option<u64>,
    found: String,
    help: &'static str,
}

impl Flaw {
    fn of_file(found: String) -> Self {
        Self {
            line: None,
            found,
            help: COLUMNS,
        }
    }

    fn at(record: &StringRecord, found: String, help: &'static str) -> Self {
        Self {
            line: record.position().map(csv::Position::line),
            found,
            help,
        }
    }
}

fn delimiter(text: &str) -> u8 {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let first = lines.next().unwrap_or_default();
    let found = [b';', b'\t', b','].into_iter();
    let mut found = found.filter(|delimiter| first.as_bytes().contains(delimiter));
    found.next().unwrap_or(b',')
}

/// Where x and y stand in a line, and how long their unit is, in m.
struct Columns {
    has_header: bool,
    x: (usize, f64),
    y: (usize, f64),
}

impl Columns {
    /// By the first line of a file.
    fn of(first: &StringRecord) -> Result<(Self, Vec<String>), Flaw> {
        let is_number = |text: &str| text.parse::<f64>().is_ok();
        if !first.iter().all(is_number) {
            return Self::named(first);
        }
        if first.len() != 2 {
            let found = format!("{} columns without a header", first.len());
            return Err(Flaw::at(first, found, COLUMNS));
        }
        let note = "the path has no header: its columns are taken for x and y in m".to_owned();
        let columns = Self {
            has_header: false,
            x: (0, 1.0),
            y: (1, 1.0),
        };
        Ok((columns, vec![note]))
    }

    fn named(header: &StringRecord) -> Result<(Self, Vec<String>), Flaw> {
        if let Some(name) = header.iter().find(|name| is_on_globe(name)) {
            let help = "project the places onto a plane, to x and y in m";
            let found = format!("column `{name}` is in degrees on the globe");
            return Err(Flaw::at(header, found, help));
        }
        let mut notes = Vec::new();
        let mut find = |axis: &str| {
            let (index, unit) = only(header, axis)?;
            let name = header.get(index).unwrap_or_default();
            if unit.is_empty() {
                notes.push(format!(
                    "column `{name}` of the path names no unit: it is taken for m"
                ));
            }
            let unit_m = metres(&unit).ok_or_else(|| {
                let found =
                    format!("column `{name}` is in `{unit}`, which is no length known here");
                Flaw::at(header, found, COLUMNS)
            })?;
            Ok((index, unit_m))
        };
        let (x, y) = (find("x")?, find("y")?);
        let columns = Self {
            has_header: true,
            x,
            y,
        };
        Ok((columns, notes))
    }

    fn point_m(&self, record: &StringRecord) -> Result<[f64; 2], Flaw> {
        let coordinate_m = |(column, unit_m): (usize, f64)| {
            let value: f64 = record.get(column)?.parse().ok()?;
            value.is_finite().then_some(value * unit_m)
        };
        match (coordinate_m(self.x), coordinate_m(self.y)) {
            (Some(x_m), Some(y_m)) => Ok([x_m, y_m]),
            _ => {
                let found = format!(
                    "`{}` is no point",
                    record.iter().collect::<Vec<_>>().join(",")
                );
                Err(Flaw::at(record, found, help(record)))
            }
        }
    }
}

/// What to do about a line that is no point.
fn help(record: &StringRecord) -> &'static str {
    let is_number = |text: String| text.parse::<f64>().is_ok_and(f64::is_finite);
    let mut fields = record.iter();
    if fields.any(|text| text.contains(',') && is_number(text.replacen(',', ".", 1))) {
        "write decimals with a point, 1.2 and not 1,2"
    } else {
        "complete or delete the line"
    }
}

/// The one column of an axis and its unit; of several the one whose unit is a length.
fn only(header: &StringRecord, axis: &str) -> Result<(usize, String), Flaw> {
    let named = header.iter().enumerate();
    let named = named.filter_map(|(index, name)| Some((index, unit(name, axis)?)));
    let named: Vec<(usize, String)> = named.collect();
    let lengths = named.iter().filter(|(_, unit)| metres(unit).is_some());
    let lengths: Vec<_> = lengths.cloned().collect();
    let refuse = |what: &str| {
        let names = header.iter().collect::<Vec<_>>().join(", ");
        Flaw::at(header, format!("{what} `{axis}` among: {names}"), COLUMNS)
    };
    match (lengths.as_slice(), named.as_slice()) {
        ([only], _) | ([], [only, ..]) => Ok(only.clone()),
        ([], []) => Err(refuse("no column")),
        _ => Err(refuse("more than one column")),
    }
}

fn is_on_globe(name: &str) -> bool {
    let name = name.to_lowercase();
    let mut words = name.split(|letter: char| !letter.is_alphabetic());
    words.any(|word| {
        matches!(
            word,
            "lat" | "latitude" | "lon" | "lng" | "long" | "longitude"
        )
    })
}

/// The unit of a column of this axis, as in `x_mm`, `x [mm]`, `x (mm)`, `x/mm`; empty without one, none of another column.
fn unit(name: &str, axis: &str) -> Option<String> {
    let name = name.to_lowercase();
    let rest = name.strip_prefix(axis)?;
    let marks = |letter: char| letter.is_whitespace() || "_[]()/".contains(letter);
    let is_apart = rest.is_empty() || rest.starts_with(marks);
    is_apart.then(|| rest.trim_matches(marks).to_owned())
}

fn metres(unit: &str) -> Option<f64> {
    match unit {
        "" | "m" | "metre" | "metres" | "meter" | "meters" => Some(1.0),
        "cm" => Some(1e-2),
        "mm" => Some(1e-3),
        "km" => Some(1e3),
        _ => None,
    }
}
