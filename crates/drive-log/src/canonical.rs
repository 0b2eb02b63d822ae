//! The canonical layout: the header is the channel and its unit.

use std::path::Path;

use crate::header::{list, speed_without_unit};
use crate::plan::{ChannelColumn, LogPlan, Plan, TimeColumns};
use crate::unit::{Quantity, Unit};
use crate::{Channel, Error};

/// Headers of a time whose unit they do not say: dates or clocks as text, or numbers that tell it;
/// the first that a file has is taken.
const OPEN_TIMES: [&str; 11] = [
    "timestamp",
    "time_stamp",
    "datetime",
    "date_time",
    "date time",
    "time_utc",
    "utc_time",
    "gps_time",
    "utc",
    "time",
    "date",
];

/// What a way is called before its unit. Another word after it, `distance_to_lead`, is no unit, and the column something else.
const DISTANCES: [&str; 8] = [
    "distance",
    "total_distance",
    "trip_distance",
    "travelled_distance",
    "distance_travelled",
    "odometer",
    "odo",
    "mileage",
];

/// Headers of what `drivekit energy --trace` writes beside the speed.
const TRACE: [&str; 3] = ["wheel_force_n", "rolling_n", "terminal_power_w"];

/// What a canonical header says.
#[derive(Clone, Copy)]
enum Meaning {
    Time(Unit),
    Channel(Channel, Unit),
    /// `v` or `a`, where no longer header says the same.
    Short(Channel, Unit),
    /// `V` or `A` where the file has both: volts and amps, where no longer header says the same.
    Electric(Channel, Unit),
    /// A way with its unit. The first that a file has is taken.
    Distance(Unit),
    /// A channel (or time, `None`) in a unit that is not known.
    UnknownUnit(Option<Channel>),
    Other,
}

fn meaning(header: &str) -> Meaning {
    let written = header.trim();
    let header = written.to_ascii_lowercase();
    match written {
        "t" => return Meaning::Time(Unit::SECOND),
        "v" => return Meaning::Short(Channel::Speed, Unit::METRE_PER_SECOND),
        "a" => return Meaning::Short(Channel::Accel, Unit::METRE_PER_SECOND_SQUARED),
        "V" => return Meaning::Electric(Channel::BatteryVoltage, Unit::VOLT),
        "A" => return Meaning::Electric(Channel::BatteryCurrent, Unit::AMPERE),
        _ => {}
    }
    if OPEN_TIMES.contains(&header.as_str()) {
        return Meaning::Other;
    }
    let suffix_after = |key: &str| {
        header
            .strip_prefix(key)?
            .strip_prefix('_')
            .map(str::to_owned)
    };
    if let Some(suffix) = suffix_after("time") {
        return Unit::parse(Quantity::Time, &suffix)
            .map_or(Meaning::UnknownUnit(None), Meaning::Time);
    }
    let way = |key: &&str| Unit::parse(Quantity::Length, &suffix_after(key)?);
    if let Some(unit) = DISTANCES.iter().find_map(way) {
        return Meaning::Distance(unit);
    }
    // `speed_limit_kmh` starts with `speed_` too: the longest channel wins
    let longest = Channel::ALL
        .into_iter()
        .filter(|channel| *channel != Channel::Distance)
        .filter_map(|channel| suffix_after(channel.key()).map(|suffix| (channel, suffix)))
        .max_by_key(|(channel, _)| channel.key().len());
    match longest {
        None => Meaning::Other,
        Some((channel, suffix)) => match Unit::parse(channel.quantity(), &suffix) {
            Some(unit) => Meaning::Channel(channel, unit),
            // Receivers name theirs `latitude_gps` and `longitude_e7`, and most readers need none.
            None if channel.quantity() == Quantity::Position => Meaning::Other,
            None => Meaning::UnknownUnit(Some(channel)),
        },
    }
}

/// What the headers say. One that is spelled otherwise, `Battery Voltage [V]`, counts where none says the
/// same in canonical words.
fn meanings(headers: &[String]) -> Vec<Meaning> {
    let exact: Vec<Meaning> = headers.iter().map(|header| meaning(header)).collect();
    let has_time = exact.iter().any(|m| matches!(m, Meaning::Time(_)))
        || OPEN_TIMES
            .iter()
            .any(|name| position(headers, name).is_some());
    let is_new = |said: &Meaning| match said {
        Meaning::Time(_) => !has_time,
        Meaning::Channel(channel, _) => !exact
            .iter()
            .any(|m| matches!(m, Meaning::Channel(c, _) | Meaning::Short(c, _) if c == channel)),
        Meaning::Distance(_) => !exact.iter().any(|m| matches!(m, Meaning::Distance(_))),
        _ => false,
    };
    let meaning_of = |(header, exact): (&String, &Meaning)| match exact {
        Meaning::Other => Some(spelled(header)).filter(is_new).unwrap_or(*exact),
        _ => *exact,
    };
    headers.iter().zip(&exact).map(meaning_of).collect()
}

/// What a header says whose words are divided by blanks, dashes or brackets. A number at its end counts columns, and is
/// no unit.
fn spelled(header: &str) -> Meaning {
    let divides = |c: char| c.is_whitespace() || "_-[](){}".contains(c);
    let words: Vec<&str> = header
        .split(divides)
        .filter(|word| !word.is_empty())
        .collect();
    match words.last() {
        Some(unit) if unit.parse::<f64>().is_err() => {
            let first = match words[0].to_ascii_lowercase().as_str() {
                "altitude" => Channel::Elevation.key(),
                _ => words[0],
            };
            meaning(&[&[first], &words[1..]].concat().join("_"))
        }
        _ => Meaning::Other,
    }
}

fn position(headers: &[String], name: &str) -> Option<usize> {
    headers
        .iter()
        .position(|header| header.trim().eq_ignore_ascii_case(name))
}

/// Whether the file has a time and a speed with its unit, however they are spelled.
pub(crate) fn claims_spelled(headers: &[String]) -> bool {
    let meanings = meanings(headers);
    let has_speed = meanings
        .iter()
        .any(|m| matches!(m, Meaning::Channel(Channel::Speed, _)));
    has_speed && time(Path::new(""), headers, &meanings).is_ok()
}

/// Whether the file speaks of time or speed in canonical words.
pub(crate) fn claims(headers: &[String]) -> bool {
    headers.iter().any(|h| {
        matches!(
            meaning(h),
            Meaning::Time(_)
                | Meaning::Channel(Channel::Speed, _)
                | Meaning::Short(Channel::Speed, _)
                | Meaning::UnknownUnit(None | Some(Channel::Speed))
        )
    })
}

pub(crate) fn plan(path: &Path, headers: &[String]) -> Result<Plan, Error> {
    if TRACE.iter().all(|name| position(headers, name).is_some()) {
        return Err(Error::NotALog {
            path: path.to_owned(),
            found: "a trace of `drivekit energy`",
        });
    }
    let meanings = meanings(headers);
    let columns = channels(path, headers, &meanings)?;
    if !columns.iter().any(|c| c.channel == Channel::Speed) {
        return Err(speed_without_unit(path, headers).unwrap_or_else(|| {
            let wanted = "speed_mps, speed_kmh, speed_mph or v";
            missing(path, headers, Channel::Speed.name(), wanted)
        }));
    }
    let time = time(path, headers, &meanings)?;
    let log = LogPlan {
        part: None,
        columns,
    };
    Ok(Plan::new(time, vec![log]))
}

fn channels(
    path: &Path,
    headers: &[String],
    meanings: &[Meaning],
) -> Result<Vec<ChannelColumn>, Error> {
    let mut columns: Vec<ChannelColumn> = Vec::new();
    for (column, meaning) in meanings.iter().enumerate() {
        match meaning {
            Meaning::Channel(channel, unit) => {
                if let Some(first) = columns.iter().find(|c| c.channel == *channel) {
                    return Err(twice(path, headers, channel.name(), (first.column, column)));
                }
                columns.push(ChannelColumn::new(*channel, column, *unit));
            }
            Meaning::UnknownUnit(channel) => {
                return Err(Error::UnknownUnit {
                    path: path.to_owned(),
                    header: headers[column].clone(),
                    channel: channel.map_or("time", Channel::key),
                    known: Unit::suffixes(channel.map_or(Quantity::Time, Channel::quantity)),
                });
            }
            _ => {}
        }
    }
    short_channels(path, headers, meanings, &mut columns)?;
    columns.extend(electric_channels(meanings, &columns));
    let ways = meanings.iter().enumerate();
    let mut ways = ways.filter_map(|(column, m)| match m {
        Meaning::Distance(unit) => Some(ChannelColumn::new(Channel::Distance, column, *unit)),
        _ => None,
    });
    columns.extend(ways.next());
    Ok(columns)
}

/// `V` and `A`: one of each, and no volts or amps of a longer name.
fn electric_channels(meanings: &[Meaning], columns: &[ChannelColumn]) -> Vec<ChannelColumn> {
    let short = meanings
        .iter()
        .enumerate()
        .filter_map(|(column, m)| match m {
            Meaning::Electric(channel, unit) => Some(ChannelColumn::new(*channel, column, *unit)),
            _ => None,
        });
    let short: Vec<ChannelColumn> = short.collect();
    let taken = |c: &ChannelColumn| columns.iter().any(|known| known.channel == c.channel);
    match short.as_slice() {
        [one, other] if one.channel != other.channel && !short.iter().any(taken) => short,
        _ => Vec::new(),
    }
}

/// Adds `v` and `a`. Beside a speed of a longer name, `v` is something else, and `a` with it.
fn short_channels(
    path: &Path,
    headers: &[String],
    meanings: &[Meaning],
    columns: &mut Vec<ChannelColumn>,
) -> Result<(), Error> {
    let short = |wanted: Channel| {
        meanings
            .iter()
            .enumerate()
            .filter_map(move |(column, m)| match m {
                Meaning::Short(channel, unit) if *channel == wanted => {
                    Some(ChannelColumn::new(wanted, column, *unit))
                }
                _ => None,
            })
    };
    let has = |columns: &[ChannelColumn], channel| columns.iter().any(|c| c.channel == channel);
    let long_speed = has(columns, Channel::Speed);
    if long_speed && short(Channel::Speed).next().is_some() {
        return Ok(());
    }
    for channel in [Channel::Speed, Channel::Accel] {
        let mut found = short(channel);
        if let (Some(first), second, false) = (found.next(), found.next(), has(columns, channel)) {
            if let Some(second) = second {
                let both = (first.column, second.column);
                return Err(twice(path, headers, channel.name(), both));
            }
            columns.push(first);
        }
    }
    Ok(())
}

/// The column of time with its unit, else a date and a clock, else one that may be either.
fn time(path: &Path, headers: &[String], meanings: &[Meaning]) -> Result<TimeColumns, Error> {
    let mut times = meanings
        .iter()
        .enumerate()
        .filter_map(|(column, m)| match m {
            Meaning::Time(unit) => Some((column, *unit)),
            _ => None,
        });
    match (times.next(), times.next()) {
        (Some((first, _)), Some((second, _))) => {
            return Err(twice(path, headers, "time", (first, second)));
        }
        (Some((column, unit)), None) => return Ok(TimeColumns::Number { column, unit }),
        (None, _) => {}
    }
    let named = |name: &str| position(headers, name);
    if let (Some(date), Some(clock)) = (named("date"), named("time").or_else(|| named("clock"))) {
        return Ok(TimeColumns::DateAndClock { date, clock });
    }
    let open = OPEN_TIMES.iter().find_map(|name| named(name));
    open.map(|column| TimeColumns::Open { column })
        .ok_or_else(|| missing(path, headers, "time", "time_s, time_ms or t"))
}

fn twice(
    path: &Path,
    headers: &[String],
    channel: &'static str,
    (first, second): (usize, usize),
) -> Error {
    Error::DuplicateColumn {
        path: path.to_owned(),
        channel,
        first: headers[first].clone(),
        second: headers[second].clone(),
        columns: (first + 1, second + 1),
    }
}

fn missing(path: &Path, headers: &[String], channel: &'static str, wanted: &str) -> Error {
    Error::MissingColumn {
        path: path.to_owned(),
        channel,
        wanted: wanted.to_owned(),
        found: list(headers),
    }
}
