//! Copies of one drive in other units, orders, clocks and dresses have its distance, energies and phases.

mod dress;
mod sampled;
mod table;

use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{drivekit, drivekit_in, fixture, shared};
use dress::{Copy, Digits, copies};
use table::Table;

/// What a drive comes to.
struct Outcome {
    distance_m: f64,
    energy_j: f64,
    /// 0 where it is not measured.
    measured_j: f64,
    boundaries: Value,
    segments: Vec<Value>,
    /// Kinds and channels, without those that the dress of a log makes.
    findings: Vec<[String; 2]>,
}

impl Outcome {
    fn phases(&self) -> Vec<&Value> {
        self.segments
            .iter()
            .map(|segment| &segment["phase"])
            .collect()
    }

    /// Accelerations of at least 3 s.
    fn accelerations(&self) -> usize {
        let is_one = |segment: &&Value| {
            let samples = segment["end"].as_u64().unwrap() - segment["start"].as_u64().unwrap();
            segment["phase"] == "acceleration" && samples >= 30
        };
        self.segments.iter().filter(is_one).count()
    }
}

/// Findings that say how a file is written, and nothing of the drive.
const OF_DRESS: [&str; 4] = ["backward_time", "no_sample", "repeated_time", "time_format"];

fn findings(input: &Value) -> Vec<[String; 2]> {
    let all = input["findings"].as_array().unwrap().iter();
    all.map(|f| [&f["kind"], &f["channel"]].map(|text| text.as_str().unwrap().to_owned()))
        .filter(|[kind, _]| !OF_DRESS.contains(&kind.as_str()))
        .collect()
}

/// The outcomes of logs, in their order.
fn outcomes(logs: &[&str], vehicle: &str) -> Vec<Outcome> {
    let document = |subcommand: &[&str]| {
        let args = [subcommand, logs, &["--format", "json"]].concat();
        drivekit(&args).ok().json()
    };
    let energy = document(&["energy", "--vehicle", vehicle]);
    let segments = document(&["segment", "--method", "heuristic"]);
    let outcome = |k: usize| {
        let log = &energy["logs"][k];
        let number = |key: &str| log[key].as_f64().unwrap_or(0.0);
        let cuts = &segments["logs"][k];
        Outcome {
            distance_m: number("distance_m"),
            energy_j: number("battery_energy_j"),
            measured_j: number("measured_terminal_energy_j"),
            boundaries: cuts["boundaries"].clone(),
            segments: cuts["segments"].as_array().unwrap().clone(),
            findings: findings(&energy["inputs"][k]),
        }
    };
    (0..logs.len()).map(outcome).collect()
}

fn assert_near(name: &str, what: &str, found: f64, expected: f64, tolerance: f64) {
    let off = (found - expected).abs();
    assert!(off <= tolerance, "{name}: {what} {found} for {expected}");
}

/// Where all digits are kept, figures agree to six digits and boundaries are equal. Steps of 0.01 in km/h or mph and of
/// 0.1 ms in times move single samples over a threshold, and the last of them off the grid: 0.1 s of the drive.
fn assert_same(copy: &Copy, found: &Outcome, expected: &Outcome) {
    let name = copy.name;
    assert_eq!(found.findings, expected.findings, "{name}");
    let (share, distance_m) = match copy.digits {
        Digits::All => (1e-6, 1e-6 * expected.distance_m),
        Digits::Few => (2e-4, 3.0),
    };
    for (what, of) in [
        ("energy", [found, expected].map(|o| o.energy_j)),
        ("measured energy", [found, expected].map(|o| o.measured_j)),
    ] {
        assert_near(name, what, of[0], of[1], share * of[1]);
    }
    assert_near(
        name,
        "distance",
        found.distance_m,
        expected.distance_m,
        distance_m,
    );
    let [found_len, len] = [found, expected].map(|o| o.segments.len());
    match copy.digits {
        Digits::All => {
            assert_eq!(found.boundaries, expected.boundaries, "{name}");
            assert_eq!(found.phases(), expected.phases(), "{name}");
        }
        Digits::Few => assert!(
            found_len.abs_diff(len) <= len / 25,
            "{name}: {found_len} for {len}"
        ),
    }
}

/// Writes the copies of a table and compares each with the original.
fn assert_copies_agree(original: &str, table: &Table, vehicle: &str) {
    let folder = TempDir::new().unwrap();
    let copies = copies(table);
    assert!(copies.len() >= 38, "{} copies", copies.len());
    let written = copies.iter().enumerate().map(|(k, copy)| {
        let path = folder.path().join(format!("{k}.csv"));
        fs::write(&path, &copy.content).unwrap();
        path.to_str().unwrap().to_owned()
    });
    let paths: Vec<String> = written.collect();
    let mut logs = vec![original];
    logs.extend(paths.iter().map(String::as_str));
    let outcomes = outcomes(&logs, vehicle);
    for (copy, found) in copies.iter().zip(&outcomes[1..]) {
        assert_same(copy, found, &outcomes[0]);
    }
}

#[test]
fn copies_of_a_simulated_drive_come_to_the_same() {
    let original = fixture("drives/drive-02.csv");
    let table = Table::read(&fs::read_to_string(&original).unwrap(), ',');
    assert_copies_agree(&original, &table, "b250e");
}

/// The recorded drive in the words of the canonical layout.
fn recorded(path: &Path) -> Table {
    const HEADERS: [(&str, &str); 13] = [
        ("Time [s]", "time_s"),
        ("Velocity [km/h]", "speed_kmh"),
        ("Longitudinal Acceleration [m/s^2]", "accelerometer_mps2"),
        ("Elevation [m]", "elevation_m"),
        ("Battery Voltage [V]", "battery_voltage_v"),
        ("Battery Current [A]", "battery_current_a"),
        ("SoC [%]", "soc_pct"),
        ("Motor Torque [Nm]", "motor_torque_nm"),
        ("AirCon Power [kW]", "aux_power_kw"),
        ("Heating Power CAN [kW]", "heating_power_kw"),
        ("Requested Heating Power [W]", "heating_request_w"),
        ("Ambient Temperature [°C]", "ambient_temperature_degc"),
        ("Battery Temperature [°C]", "battery_temperature_degc"),
    ];
    let latin_1: String = fs::read(path)
        .unwrap()
        .iter()
        .map(|b| char::from(*b))
        .collect();
    let table = Table::read(&latin_1, ';').renamed(&HEADERS);
    table.with("battery_current_a", "battery_current_a", |a| -a)
}

#[test]
fn copies_of_a_recorded_drive_come_to_the_same() {
    let Some(original) = shared("data/bmw-i3/TripA03.csv") else {
        return;
    };
    let table = recorded(&original);
    assert_copies_agree(original.to_str().unwrap(), &table, "bmw-i3-60ah");
}

#[test]
fn headers_of_another_kind_are_named_in_a_layout() {
    let original = fixture("drives/drive-02.csv");
    let table = Table::read(&fs::read_to_string(&original).unwrap(), ',');
    let folder = TempDir::new().unwrap();
    let names = [
        ("time_s", "Zeit"),
        ("speed_mps", "Geschwindigkeit"),
        ("grade_rad", "Steigung"),
        ("battery_voltage_v", "U"),
        ("battery_current_a", "I"),
    ];
    let layout = "time = { header = \"Zeit\", unit = \"ms\" }\n[channels]\n\
        speed = { header = \"Geschwindigkeit\", unit = \"km/h\" }\n\
        grade = { header = \"Steigung\", unit = \"%\" }\n\
        battery_voltage = { header = \"U\", unit = \"V\" }\n\
        battery_current = { header = \"I\", unit = \"mA\", sign = -1 }\n";
    let table = table
        .with("speed_mps", "speed_mps", |v| v * 3.6)
        .with("time_s", "time_s", |t| t * 1e3)
        .with("grade_rad", "grade_rad", |angle| 100.0 * angle.tan())
        .with("battery_current_a", "battery_current_a", |a| -1e3 * a);
    let mut table = table.renamed(&names);
    (table.delimiter, table.decimal_comma) = (";", true);
    fs::write(folder.path().join("copy.csv"), table.text()).unwrap();
    fs::write(folder.path().join("layout.toml"), layout).unwrap();
    let args = [
        "energy",
        "copy.csv",
        "--layout",
        "layout.toml",
        "--vehicle",
        "b250e",
        "--format",
        "json",
    ];
    let found = drivekit_in(folder.path(), &args).ok().json();
    let expected = &outcomes(&[&original], "b250e")[0];
    for (key, expected) in [
        ("distance_m", expected.distance_m),
        ("battery_energy_j", expected.energy_j),
        ("measured_terminal_energy_j", expected.measured_j),
    ] {
        let found = found["logs"][0][key].as_f64().unwrap();
        assert_near("layout", key, found, expected, 1e-6 * expected);
    }
}
