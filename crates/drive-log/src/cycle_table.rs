//! The European cycles in one table: time in s, then a column per cycle in km/h, each ending with
//! its last value.

use std::path::Path;

use crate::header::list;
use crate::plan::{ChannelColumn, LogPlan, Plan, TimeColumns};
use crate::unit::Unit;
use crate::{Channel, Error};

/// Families of cycles that such a table may hold.
const FAMILIES: [&str; 6] = ["WLTC", "CADC", "NEDC", "SORT", "ARTEMIS", "UDDS"];

fn is_cycle(header: &str) -> bool {
    let header = header.trim().to_ascii_uppercase();
    FAMILIES.iter().any(|family| header.starts_with(family))
}

pub(crate) fn claims(headers: &[String]) -> bool {
    headers
        .first()
        .is_some_and(|h| h.trim().eq_ignore_ascii_case("time (s)"))
        && headers.len() > 1
        && headers[1..].iter().all(|h| is_cycle(h))
}

pub(crate) fn plan(path: &Path, headers: &[String]) -> Result<Plan, Error> {
    if !claims(headers) {
        return Err(Error::MissingColumn {
            path: path.to_owned(),
            channel: "time",
            wanted: "\"Time (s)\" and a column per cycle, or cycSecs, cycMps and cycGrade"
                .to_owned(),
            found: list(headers),
        });
    }
    let logs = headers
        .iter()
        .enumerate()
        .skip(1)
        .map(|(column, header)| LogPlan {
            part: Some(header.trim().to_owned()),
            columns: vec![ChannelColumn::new(
                Channel::Speed,
                column,
                Unit::KILOMETRE_PER_HOUR,
            )],
        })
        .collect();
    let time = TimeColumns::Number {
        column: 0,
        unit: Unit::SECOND,
    };
    Ok(Plan::new(time, logs))
}
