//! The car ahead: a CSV file with the columns `time_s` and `position_m`.

use std::path::Path;

use anyhow::{Context as _, bail};
use csv::{ReaderBuilder, StringRecord, Trim};
use driver_model::road::LeaderAt;

use super::source::text_of;

const COLUMNS: &str = "give the columns `time_s` and `position_m`";

pub(super) fn read(path: &Path) -> anyhow::Result<Vec<LeaderAt>> {
    parse(&text_of(path)?).with_context(|| path.display().to_string())
}

fn parse(text: &str) -> anyhow::Result<Vec<LeaderAt>> {
    // Some editors begin with a byte order mark.
    let text = text.trim_start_matches('\u{feff}');
    let mut reader = ReaderBuilder::new()
        .trim(Trim::All)
        .from_reader(text.as_bytes());
    let header = reader.headers()?;
    let column = |name| header.iter().position(|column| column == name);
    let (Some(time), Some(position), 2) = (column("time_s"), column("position_m"), header.len())
    else {
        let found: Vec<&str> = header.iter().collect();
        bail!("line 1 is `{}`; {COLUMNS}", found.join(","));
    };
    let rows = reader.records().map(|record| {
        let record = record?;
        Ok(LeaderAt {
            time_s: number(&record, time)?,
            position_m: number(&record, position)?,
        })
    });
    let rows = rows.collect::<anyhow::Result<Vec<_>>>()?;
    if rows.len() < 2 {
        bail!(
            "{}; a leader takes two or more: where it is at two times",
            crate::words::plural(rows.len(), "row")
        );
    }
    Ok(rows)
}

fn number(record: &StringRecord, column: usize) -> anyhow::Result<f64> {
    let text = record.get(column).unwrap_or_default();
    text.parse().with_context(|| {
        let line = record.position().map_or(0, csv::Position::line);
        format!("line {line}: expected a number, found `{text}`")
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn what_is_harmless_is_read() {
        let plain = parse("time_s,position_m\n0,30\n10,100\n").unwrap();
        for text in [
            "\u{feff}time_s,position_m\r\n0,30\r\n10,100\r\n",
            "\"time_s\",\"position_m\"\n0,30\n10,100",
            "position_m, time_s\n30, 0\n\n100 ,10\n",
        ] {
            assert_eq!(parse(text).unwrap(), plain, "{text}");
        }
    }

    #[test]
    fn what_is_no_leader_is_named() {
        for (text, part) in [
            ("", "line 1"),
            ("time_s,position_m\n", "0 rows"),
            ("time_s,position_m\n0,30\n", "1 row"),
            ("t,x\n0,3\n", "`t,x`"),
            (
                "time_s,position_m,speed\n0,3,3\n",
                "time_s,position_m,speed",
            ),
            (
                "time_s,position_m\n0,30\n1,a\n",
                "line 3: expected a number, found `a`",
            ),
            ("time_s,position_m\n0,30\n1\n", "line: 3"),
        ] {
            let error = format!("{:#}", parse(text).unwrap_err());
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
