//! Copies of a drive in other units and on other clocks are cut at the same samples.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{drivekit, fixture, shared};

const METHODS: [&[&str]; 6] = [
    &["heuristic"],
    &["swab"],
    &["bottom-up"],
    &["sliding-window"],
    &["dynamic", "--segments", "40"],
    &["swab", "--merge", "mean"],
];

fn boundaries(log: &Path, method: &[&str]) -> Value {
    let log = log.to_str().unwrap();
    let args = ["segment", log, "--format", "json", "--method"];
    let document = drivekit(&[&args[..], method].concat()).ok().json();
    document["logs"][0]["segments"]
        .as_array()
        .unwrap()
        .iter()
        .map(|segment| {
            serde_json::json!([
                segment["start"],
                segment["end"],
                segment["phase"],
                segment["lead_influenced"]
            ])
        })
        .collect()
}

/// A drive of 1 cm/s resolution with its speed in another unit, and its time from another start.
fn copy(unit: &str, per_mps: f64, decimals: usize, t0_s: f64) -> String {
    let text = fs::read_to_string(fixture("drives/drive-02.csv")).unwrap();
    let mut rows = text.lines();
    let header: Vec<&str> = rows.next().unwrap().split(',').collect();
    assert_eq!(header[..2], ["time_s", "speed_mps"]);
    let mut copy = format!("time_s,speed_{unit},{}\n", header[2..].join(","));
    for row in rows {
        let cells: Vec<&str> = row.split(',').collect();
        let [time_s, speed_mps] = [cells[0], cells[1]].map(|cell| cell.parse::<f64>().unwrap());
        let _ = writeln!(
            copy,
            "{},{:.decimals$},{}",
            time_s + t0_s,
            speed_mps * per_mps,
            cells[2..].join(",")
        );
    }
    copy
}

#[test]
fn copies_in_other_units_are_cut_at_the_same_samples() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("copy.csv");
    let original = fixture("drives/drive-02.csv");
    for method in METHODS {
        let expected = boundaries(Path::new(&original), method);
        for (unit, per_mps, decimals) in [("kmh", 3.6, 17), ("mph", 1.0 / 0.44704, 17)] {
            fs::write(&path, copy(unit, per_mps, decimals, 0.0)).unwrap();
            assert!(boundaries(&path, method) == expected, "{unit}, {method:?}");
        }
    }
}

/// The heuristic rule looks at single samples and so has a tie at every tenth of them.
#[test]
fn the_rounding_of_a_copy_decides_no_tie() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("copy.csv");
    let original = fixture("drives/drive-02.csv");
    let expected = boundaries(Path::new(&original), &["heuristic"]);
    for (unit, per_mps, decimals, t0_s) in [
        ("mph", 1.0 / 0.44704, 6, 0.0),
        ("kmh", 3.6, 5, 0.0),
        ("mps", 1.0, 2, 1_600_000_000.0),
    ] {
        fs::write(&path, copy(unit, per_mps, decimals, t0_s)).unwrap();
        assert!(
            boundaries(&path, &["heuristic"]) == expected,
            "{unit} {decimals} {t0_s}"
        );
    }
}

#[test]
fn the_shared_copies_are_cut_at_the_same_samples() {
    let Some(folder) = shared("cases/cars/37-mph-copy") else {
        return;
    };
    for method in METHODS {
        let expected = boundaries(&folder.join("f1-base.csv"), method);
        for copy in ["f1-mph.csv", "f1-kmh.csv"] {
            assert!(
                boundaries(&folder.join(copy), method) == expected,
                "{copy}, {method:?}"
            );
        }
    }
}
