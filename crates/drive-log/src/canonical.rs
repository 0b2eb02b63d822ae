//! The canonical layout: the header is the channel and its unit.

use std::path::Path;

use crate::layout::{ChannelColumn, LogPlan, Plan, TimeColumns, list};
use crate::unit::{Quantity, Unit};
use crate::{Channel, Error};

/// What a canonical header says.
enum Meaning {
    Time(Unit),
    Channel(Channel, Unit),
    /// A channel (or time, `None`) in a unit that is not known.
    UnknownUnit(Option<Channel>),
    Other,
}

fn meaning(header: &str) -> Meaning {
    let header = header.trim().to_ascii_lowercase();
    match header.as_str() {
        "t" => return Meaning::Time(Unit::SECOND),
        "v" => return Meaning::Channel(Channel::Speed, Unit::METRE_PER_SECOND),
        "a" => return Meaning::Channel(Channel::Accel, Unit::METRE_PER_SECOND_SQUARED),
        _ => {}
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
    // `speed_limit_kmh` starts with `speed_` too: the longest channel wins
    let longest = Channel::ALL
        .into_iter()
        .filter_map(|channel| suffix_after(channel.key()).map(|suffix| (channel, suffix)))
        .max_by_key(|(channel, _)| channel.key().len());
    match longest {
        None => Meaning::Other,
        Some((channel, suffix)) => Unit::parse(channel.quantity(), &suffix)
            .map_or(Meaning::UnknownUnit(Some(channel)), |unit| {
                Meaning::Channel(channel, unit)
            }),
    }
}

/// Whether the file speaks of time or speed in canonical words.
pub(crate) fn claims(headers: &[String]) -> bool {
    headers.iter().any(|h| {
        matches!(
            meaning(h),
            Meaning::Time(_)
                | Meaning::Channel(Channel::Speed, _)
                | Meaning::UnknownUnit(None | Some(Channel::Speed))
        )
    })
}

pub(crate) fn plan(path: &Path, headers: &[String]) -> Result<Plan, Error> {
    let mut time: Option<(usize, Unit)> = None;
    let mut columns: Vec<ChannelColumn> = Vec::new();
    let twice = |channel, first: usize, second: usize| Error::DuplicateColumn {
        path: path.to_owned(),
        channel,
        first: headers[first].clone(),
        second: headers[second].clone(),
    };
    for (column, header) in headers.iter().enumerate() {
        match meaning(header) {
            Meaning::Other => {}
            Meaning::Time(unit) => match time {
                Some((first, _)) => return Err(twice("time", first, column)),
                None => time = Some((column, unit)),
            },
            Meaning::Channel(channel, unit) => {
                match columns.iter().find(|c| c.channel == channel) {
                    Some(first) => return Err(twice(channel.name(), first.column, column)),
                    None => columns.push(ChannelColumn::new(channel, column, unit)),
                }
            }
            Meaning::UnknownUnit(channel) => {
                return Err(Error::UnknownUnit {
                    path: path.to_owned(),
                    header: header.clone(),
                    channel: channel.map_or("time", Channel::key),
                    known: Unit::suffixes(channel.map_or(Quantity::Time, Channel::quantity)),
                });
            }
        }
    }
    let missing = |channel, wanted: &str| Error::MissingColumn {
        path: path.to_owned(),
        channel,
        wanted: wanted.to_owned(),
        found: list(headers),
    };
    if !columns.iter().any(|c| c.channel == Channel::Speed) {
        return Err(missing(
            Channel::Speed.name(),
            "speed_mps, speed_kmh, speed_mph or v",
        ));
    }
    let Some((column, unit)) = time else {
        return Err(missing("time", "time_s, time_ms or t"));
    };
    Ok(Plan {
        time: TimeColumns::Number { column, unit },
        logs: vec![LogPlan {
            part: None,
            columns,
        }],
    })
}
