//! Findings in recorded logs: what is wrong is found, and nothing is made up.

use std::process::{Command, Stdio};

use serde_json::Value;

use crate::program::{drivekit, fixture, shared};

fn findings(document: &Value) -> Vec<(String, String, f64, f64)> {
    document["inputs"][0]["findings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|f| {
            let text = |key: &str| f[key].as_str().unwrap().to_owned();
            (
                text("channel"),
                text("kind"),
                f["from_s"].as_f64().unwrap(),
                f["to_s"].as_f64().unwrap(),
            )
        })
        .collect()
}

fn inspect_i3(trip: &str) -> Option<Vec<(String, String, f64, f64)>> {
    let log = shared("data/bmw-i3")?.join(format!("Trip{trip}.csv"));
    let document = drivekit(&["inspect", log.to_str().unwrap(), "--format", "json"])
        .ok()
        .json();
    Some(findings(&document))
}

#[test]
fn frozen_elevation_in_a04() {
    let Some(found) = inspect_i3("A04") else {
        return;
    };
    assert!(
        found
            .iter()
            .any(|(channel, kind, from, to)| channel == "elevation_m"
                && kind.contains("frozen")
                && to - from > 370.0),
        "{found:?}"
    );
}

#[test]
fn pinned_heating_in_a05_a13_and_a18() {
    for trip in ["A05", "A13", "A18"] {
        let Some(found) = inspect_i3(trip) else {
            return;
        };
        assert!(
            found
                .iter()
                .any(|(channel, kind, ..)| channel == "heating_power_w" && kind.contains("pinned")),
            "{trip}: {found:?}"
        );
    }
}

#[test]
fn spurious_heating_pulses() {
    for trip in ["A01", "A07", "A16"] {
        let Some(found) = inspect_i3(trip) else {
            return;
        };
        assert!(
            found.iter().any(
                |(channel, kind, ..)| channel == "heating_power_w" && kind.contains("sentinel")
            ),
            "{trip}: {found:?}"
        );
    }
}

#[test]
fn six_frozen_channels_in_b34() {
    let Some(found) = inspect_i3("B34") else {
        return;
    };
    let frozen: Vec<_> = found
        .iter()
        .filter(|(_, kind, from, to)| {
            kind.contains("frozen") && (290.0..296.0).contains(from) && *to > 730.0
        })
        .map(|(channel, ..)| channel.as_str())
        .collect();
    for channel in [
        "speed_mps",
        "battery_voltage_v",
        "battery_current_a",
        "motor_torque_nm",
    ] {
        assert!(frozen.contains(&channel), "{channel} in {found:?}");
    }
}

#[test]
fn missing_state_of_charge_at_the_end() {
    for trip in ["B05", "B11", "B34"] {
        let Some(found) = inspect_i3(trip) else {
            return;
        };
        assert!(
            found.iter().any(|(channel, ..)| channel == "soc_pct"),
            "{trip}: {found:?}"
        );
    }
}

#[test]
fn nothing_is_made_up_where_nothing_is_wrong() {
    for trip in ["A01", "A07", "A16"] {
        let Some(found) = inspect_i3(trip) else {
            return;
        };
        for (channel, kind, ..) in found {
            let of_these = [
                "time",
                "speed_mps",
                "battery_voltage_v",
                "battery_current_a",
                "soc_pct",
            ];
            assert!(
                !of_these.contains(&channel.as_str()),
                "{trip}: {channel} {kind}"
            );
        }
    }
}

#[test]
fn a_log_from_stdin() {
    let log = std::fs::File::open(fixture("drives/drive-01.csv")).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_drivekit"))
        .args(["inspect", "-", "--format", "json"])
        .stdin(Stdio::from(log))
        .output()
        .unwrap();
    assert!(output.status.success());
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["inputs"][0]["path"], "stdin");
}

#[test]
fn standard_cycles_have_no_findings() {
    for name in ["udds", "hwfet", "us06", "wltc-3b", "nedc"] {
        let log = fixture(&format!("cycles/{name}.csv"));
        let document = drivekit(&["inspect", &log, "--format", "json"]).ok().json();
        assert!(
            findings(&document).is_empty(),
            "{name}: {:?}",
            findings(&document)
        );
    }
}
