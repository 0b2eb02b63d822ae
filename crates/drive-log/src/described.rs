//! Layouts that a TOML file describes.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use crate::header::{Form, Head, normalised};
use crate::plan::{ChannelColumn, LogPlan, Plan, TimeColumns};
use crate::stamp::DateOrder;
use crate::unit::{Quantity, Unit};
use crate::{Channel, Error};

/// A layout file, word for word.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    delimiter: Option<String>,
    decimal: Option<String>,
    #[serde(default)]
    skip_lines: usize,
    #[serde(default)]
    no_header: bool,
    #[serde(default)]
    missing: Vec<String>,
    split_by: Option<Vec<String>>,
    date_order: Option<String>,
    time: TimeEntry,
    channels: BTreeMap<String, Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TimeEntry {
    header: Option<String>,
    column: Option<usize>,
    unit: Option<String>,
    date: Option<String>,
    clock: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    header: Option<String>,
    column: Option<usize>,
    unit: String,
    sign: Option<i8>,
}

/// A checked layout.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Described {
    pub(crate) form: Form,
    time: Time,
    channels: Vec<Source>,
    split_by: Option<Vec<Place>>,
    missing: Vec<String>,
    date_order: Option<DateOrder>,
    /// Whether every channel must be there, or only speed.
    strict: bool,
}

#[derive(Debug, Clone, PartialEq)]
enum Time {
    Number(Place, Unit),
    Open(Place),
    DateAndClock(Place, Place),
}

#[derive(Debug, Clone, PartialEq)]
struct Source {
    channel: Channel,
    place: Place,
    unit: Unit,
    sign: f64,
}

/// Where a column is: by its header, or by its number from 0.
#[derive(Debug, Clone, PartialEq)]
enum Place {
    Header(String),
    Column(usize),
}

impl Place {
    fn wanted(&self) -> String {
        match self {
            Place::Header(header) => format!("{header:?}"),
            Place::Column(column) => format!("column {}", column + 1),
        }
    }

    fn find(
        &self,
        path: &Path,
        channel: &'static str,
        head: &Head,
    ) -> Result<Option<usize>, Error> {
        match self {
            Place::Column(column) => Ok((*column < head.headers.len()).then_some(*column)),
            Place::Header(header) => {
                let wanted = normalised(header);
                let mut found =
                    (0..head.headers.len()).filter(|&c| normalised(&head.headers[c]) == wanted);
                match (found.next(), found.next()) {
                    (Some(first), Some(second)) => Err(Error::DuplicateColumn {
                        path: path.to_owned(),
                        channel,
                        first: head.headers[first].clone(),
                        second: head.headers[second].clone(),
                        columns: (first + 1, second + 1),
                    }),
                    (first, _) => Ok(first),
                }
            }
        }
    }

    fn require(&self, path: &Path, channel: &'static str, head: &Head) -> Result<usize, Error> {
        self.find(path, channel, head)?
            .ok_or_else(|| Error::MissingColumn {
                path: path.to_owned(),
                channel,
                wanted: self.wanted(),
                found: head.listed(),
            })
    }
}

impl Described {
    pub(crate) fn from_toml_str(name: &str, text: &str, strict: bool) -> Result<Described, Error> {
        let wrong = |problem: String| Error::Layout {
            name: name.to_owned(),
            problem,
        };
        let file: File = toml::from_str(text).map_err(|e| wrong(e.to_string()))?;
        let form = form(&file).map_err(wrong)?;
        let time = time(&file).map_err(wrong)?;
        let mut channels = Vec::new();
        for (key, entry) in &file.channels {
            channels.push(source(key, entry, file.no_header).map_err(wrong)?);
        }
        if !channels.iter().any(|s| s.channel == Channel::Speed) {
            return Err(wrong(
                "no speed under [channels]; add speed = { header = \"…\", unit = \"km/h\" }"
                    .to_owned(),
            ));
        }
        let headers = |names: Vec<String>| names.into_iter().map(Place::Header).collect();
        Ok(Described {
            form,
            time,
            channels,
            split_by: file.split_by.map(headers),
            missing: file.missing,
            date_order: date_order(file.date_order.as_deref()).map_err(wrong)?,
            strict,
        })
    }

    /// Whether time and speed are there; without a header, whether it looks like this layout's
    /// table.
    pub(crate) fn claims(&self, head: &Head) -> bool {
        let path = Path::new("");
        let there = |place: &Place| {
            place
                .find(path, "", head)
                .is_ok_and(|column| column.is_some())
        };
        if head.has_header == self.form.no_header {
            return false;
        }
        if self.form.no_header {
            return head.headers.len() == self.channels.len() + 1;
        }
        let time = match &self.time {
            Time::Number(place, _) | Time::Open(place) => there(place),
            Time::DateAndClock(date, clock) => there(date) && there(clock),
        };
        time && self
            .channels
            .iter()
            .any(|s| s.channel == Channel::Speed && there(&s.place))
    }

    pub(crate) fn plan(&self, path: &Path, head: &Head) -> Result<Plan, Error> {
        let time = match &self.time {
            Time::Number(place, unit) => TimeColumns::Number {
                column: place.require(path, "time", head)?,
                unit: *unit,
            },
            Time::Open(place) => TimeColumns::Open {
                column: place.require(path, "time", head)?,
            },
            Time::DateAndClock(date, clock) => TimeColumns::DateAndClock {
                date: date.require(path, "time", head)?,
                clock: clock.require(path, "time", head)?,
            },
        };
        let mut columns = Vec::new();
        for source in &self.channels {
            let name = source.channel.name();
            let column = if self.strict || source.channel == Channel::Speed {
                Some(source.place.require(path, name, head)?)
            } else {
                source.place.find(path, name, head)?
            };
            columns.extend(column.map(|column| ChannelColumn {
                channel: source.channel,
                column,
                unit: source.unit,
                sign: source.sign,
            }));
        }
        let split_by = self.split_by.as_ref().map(|places| {
            let column = |place: &Place| place.require(path, "split_by", head);
            places.iter().map(column).collect()
        });
        let log = LogPlan {
            part: None,
            columns,
        };
        Ok(Plan {
            split_by: split_by.transpose()?,
            missing: self.missing.clone(),
            date_order: self.date_order,
            ..Plan::new(time, vec![log])
        })
    }
}

fn form(file: &File) -> Result<Form, String> {
    let delimiter = match file.delimiter.as_deref() {
        None => None,
        Some(",") => Some(b','),
        Some(";") => Some(b';'),
        Some("\t" | "tab") => Some(b'\t'),
        Some(" " | "space") => Some(b' '),
        Some(other) => {
            return Err(format!(
                "delimiter {other:?}: give \",\", \";\", \"tab\" or \"space\""
            ));
        }
    };
    let decimal_comma = match file.decimal.as_deref() {
        None => None,
        Some(".") => Some(false),
        Some(",") => Some(true),
        Some(other) => return Err(format!("decimal {other:?}: give \".\" or \",\"")),
    };
    if delimiter == Some(b',') && decimal_comma == Some(true) {
        return Err(
            "a comma is both the delimiter and the decimal mark; give one of them another value"
                .to_owned(),
        );
    }
    Ok(Form {
        delimiter,
        decimal_comma,
        skip_lines: file.skip_lines,
        no_header: file.no_header,
    })
}

fn time(file: &File) -> Result<Time, String> {
    let header = |text: &String| Place::Header(text.clone());
    match &file.time {
        TimeEntry {
            date: Some(date),
            clock: Some(clock),
            header: None,
            column: None,
            unit: None,
        } if !file.no_header => Ok(Time::DateAndClock(header(date), header(clock))),
        TimeEntry {
            date: None,
            clock: None,
            header,
            column,
            unit,
        } => {
            let place = place("time", header.as_deref(), *column, file.no_header)?;
            match unit {
                None => Ok(Time::Open(place)),
                Some(unit) => known_unit("time", Quantity::Time, unit)
                    .map(|unit| Time::Number(place, unit)),
            }
        }
        _ => Err(
            "time: give a header, with a unit where it holds numbers, or the headers of a date and a clock"
                .to_owned(),
        ),
    }
}

fn date_order(text: Option<&str>) -> Result<Option<DateOrder>, String> {
    match text {
        None => Ok(None),
        Some("dmy") => Ok(Some(DateOrder::DayMonthYear)),
        Some("mdy") => Ok(Some(DateOrder::MonthDayYear)),
        Some(other) => Err(format!("date_order {other:?}: give \"dmy\" or \"mdy\"")),
    }
}

fn source(key: &str, entry: &Entry, no_header: bool) -> Result<Source, String> {
    let Some(channel) = Channel::from_key(key) else {
        let known: Vec<&str> = Channel::ALL.into_iter().map(Channel::key).collect();
        return Err(format!(
            "{key:?} is not a channel; known channels: {}",
            known.join(", ")
        ));
    };
    let sign = match entry.sign {
        None | Some(1) => 1.0,
        Some(-1) => -1.0,
        Some(other) => return Err(format!("{key}: sign {other}: give 1 or -1")),
    };
    let place = place(key, entry.header.as_deref(), entry.column, no_header)?;
    Ok(Source {
        channel,
        place,
        unit: known_unit(key, channel.quantity(), &entry.unit)?,
        sign,
    })
}

fn place(
    key: &str,
    header: Option<&str>,
    column: Option<usize>,
    no_header: bool,
) -> Result<Place, String> {
    match (header, column, no_header) {
        (Some(header), None, false) => Ok(Place::Header(header.to_owned())),
        (None, Some(column), _) if column > 0 => Ok(Place::Column(column - 1)),
        (_, _, false) => Err(format!(
            "{key}: give the header of its column, or the number of its column, from 1"
        )),
        (_, _, true) => Err(format!(
            "{key}: without a header, give the number of its column, from 1"
        )),
    }
}

fn known_unit(key: &str, quantity: Quantity, text: &str) -> Result<Unit, String> {
    Unit::parse(quantity, text).ok_or_else(|| {
        format!(
            "{key}: unit {text:?} is not known; known units: {}",
            Unit::symbols(quantity)
        )
    })
}
