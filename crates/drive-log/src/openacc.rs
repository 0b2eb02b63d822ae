//! Platoons of the OpenACC campaigns (Makridis et al., *OpenACC. An open database of car-following
//! experiments*, 2021).
//!
//! Five lines precede the header: `Date`, `Vehicle_order`, `Number_of_vehicles`, `ACC`,
//! `Distance_setting`. The columns of car `k` are `Speedk` (m/s), `Altk` (m) and positions; `IVSk`
//! (m) is the gap, bumper to bumper, between car `k` and the car behind it, `k + 1`. The distance
//! of the two positions minus `IVSk` is constant (the length of a car), and car `k` drives ahead of
//! `k + 1`. So the car ahead of car `k` is `k − 1`, at the gap `IVS(k−1)`; where its columns are
//! missing, so are gap and speed of the lead.

use std::path::Path;

use crate::header::Head;
use crate::plan::{ChannelColumn, LogPlan, Plan, TimeColumns};
use crate::unit::Unit;
use crate::{Channel, Error};

pub(crate) const LINES_BEFORE_HEADER: usize = 5;

pub(crate) fn claims(head: &Head) -> bool {
    head.preamble
        .get(1)
        .is_some_and(|line| line.starts_with("Vehicle_order"))
}

pub(crate) fn plan(path: &Path, head: &Head) -> Result<Plan, Error> {
    let find = |name: &str| head.headers.iter().position(|h| h.trim() == name);
    let missing = |channel, wanted: &str| Error::MissingColumn {
        path: path.to_owned(),
        channel,
        wanted: wanted.to_owned(),
        found: head.listed(),
    };
    let time = find("Time").ok_or_else(|| missing("time", "\"Time\""))?;
    let mut logs: Vec<LogPlan> = Vec::new();
    for (column, header) in head.headers.iter().enumerate() {
        let Some(car) = header
            .trim()
            .strip_prefix("Speed")
            .and_then(|k| k.parse::<usize>().ok())
        else {
            continue;
        };
        let mut columns = vec![ChannelColumn::new(
            Channel::Speed,
            column,
            Unit::METRE_PER_SECOND,
        )];
        let mut add = |channel, name: String, unit| {
            columns.extend(find(&name).map(|column| ChannelColumn::new(channel, column, unit)));
        };
        add(Channel::Elevation, format!("Alt{car}"), Unit::METRE);
        if let Some(ahead) = car.checked_sub(1) {
            add(Channel::LeadGap, format!("IVS{ahead}"), Unit::METRE);
            add(
                Channel::LeadSpeed,
                format!("Speed{ahead}"),
                Unit::METRE_PER_SECOND,
            );
        }
        let mut part = car_name(&head.preamble, car);
        if logs.iter().any(|log| log.part.as_ref() == Some(&part)) {
            part = format!("{part}-{car}");
        }
        logs.push(LogPlan {
            part: Some(part),
            columns,
        });
    }
    if logs.is_empty() {
        return Err(missing(Channel::Speed.name(), "\"Speed1\", \"Speed2\", …"));
    }
    let time = TimeColumns::Number {
        column: time,
        unit: Unit::SECOND,
    };
    Ok(Plan::new(time, logs))
}

/// The name of car `k`, counted from 1, in the line `Vehicle_order`.
fn car_name(preamble: &[String], car: usize) -> String {
    let name = preamble
        .get(1)
        .and_then(|line| line.split(',').nth(car))
        .map_or("", str::trim);
    if name.is_empty() || car == 0 {
        format!("car{car}")
    } else {
        name.to_owned()
    }
}
