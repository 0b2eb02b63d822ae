//! What commands print, word by word, and what their documents hold, key by key. `cargo insta review` shows what a change does to them.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde_json::Value;

use crate::program::{drivekit_in, fixture};

/// Run beside the fixtures, without what differs between runs and versions.
fn printed(arguments: &str) -> String {
    let arguments: Vec<&str> = arguments.split(' ').chain(["--no-times", "-q"]).collect();
    let text = drivekit_in(fixture("").as_ref(), &arguments).stdout;
    text.replace(env!("CARGO_PKG_VERSION"), "VERSION")
}

/// Every key of a document by its path, with the types found there; entries of lists count as one.
fn shape(arguments: &str) -> String {
    let document: Value =
        serde_json::from_str(&printed(&format!("{arguments} --format json"))).unwrap();
    let mut types = BTreeMap::new();
    gather(&document, String::new(), &mut types);
    types
        .into_iter()
        .fold(String::new(), |mut text, (path, types)| {
            let _ = writeln!(text, "{path}: {}", types.join(" or "));
            text
        })
}

fn gather(value: &Value, path: String, types: &mut BTreeMap<String, Vec<&'static str>>) {
    let kind = match value {
        Value::Null => "null",
        Value::Bool(_) => "bool",
        Value::Number(_) => "number",
        Value::String(_) => "string",
        Value::Array(entries) => {
            return entries
                .iter()
                .for_each(|entry| gather(entry, format!("{path}[]"), types));
        }
        Value::Object(keys) => {
            let below = |key: &String| {
                if path.is_empty() {
                    key.clone()
                } else {
                    format!("{path}.{key}")
                }
            };
            return keys
                .iter()
                .for_each(|(key, value)| gather(value, below(key), types));
        }
    };
    let known = types.entry(path).or_default();
    if !known.contains(&kind) {
        known.push(kind);
        known.sort_unstable();
    }
}

#[test]
fn texts() {
    for (name, arguments) in [
        ("inspect", "inspect drives/drive-01.csv"),
        ("segment", "segment drives/drive-01.csv drives/drive-02.csv"),
        (
            "evaluate",
            "evaluate drives --models profile,profile-onset,svr-linear",
        ),
        (
            "evaluate-trajectory",
            "evaluate drives/drive-01.csv drives/drive-02.csv --task trajectory --models ridge --horizons 2",
        ),
        ("portrait", "portrait drives"),
        ("road", "road drives/drive-01.csv -o /dev/null"),
        ("plan", "plan roads/town-and-country.toml --arrive 300"),
        (
            "plan-potential",
            "plan drives/drive-01.csv drives/drive-02.csv --potential",
        ),
        (
            "energy",
            "energy drives/drive-01.csv drives/drive-02.csv --vehicle b250e",
        ),
        (
            "vehicle-point",
            "vehicle point b250e --speed 13.9 --accel 0.5 --grade 0.02",
        ),
        (
            "ctrl-check",
            "ctrl check --testbed khepera --scenario chain",
        ),
        (
            "ctrl-run",
            "ctrl run --testbed khepera --scenario stop --preset hardened --disturb all",
        ),
    ] {
        insta::assert_snapshot!(name, printed(arguments));
    }
}

#[test]
fn documents() {
    for (name, arguments) in [
        ("inspect-document", "inspect drives/drive-01.csv"),
        ("segment-document", "segment drives/drive-01.csv"),
        (
            "evaluate-document",
            "evaluate drives --models profile,constant",
        ),
        (
            "evaluate-trajectory-document",
            "evaluate drives/drive-01.csv drives/drive-02.csv --task trajectory --models ridge --horizons 2",
        ),
        ("portrait-document", "portrait drives"),
        ("road-document", "road drives/drive-01.csv -o /dev/null"),
        (
            "plan-document",
            "plan roads/town-and-country.toml --arrive 300",
        ),
        (
            "plan-potential-document",
            "plan drives/drive-01.csv drives/drive-02.csv --potential",
        ),
        (
            "energy-document",
            "energy drives/drive-01.csv --vehicle b250e",
        ),
        ("vehicle-point-document", "vehicle point b250e --speed 13.9"),
        (
            "ctrl-check-document",
            "ctrl check --testbed khepera --scenario chain",
        ),
        (
            "ctrl-run-document",
            "ctrl run --testbed khepera --scenario stop --preset hardened",
        ),
    ] {
        insta::assert_snapshot!(name, shape(arguments));
    }
}
