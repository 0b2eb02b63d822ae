//! Logs that go wrong elsewhere, where they are at hand: each opens with its right values, or is
//! refused with the cure.

use drive_log::{Drive, Layout, LayoutChoice, Preparation, prepare, read_file};

use crate::shared::shared;

fn drives(path: &str, layout: Option<&str>) -> Result<Vec<Drive>, String> {
    let Some(file) = shared(&format!("cases/cars/{path}")) else {
        return Err(String::new());
    };
    let layout = layout.map_or(LayoutChoice::Auto, |name| {
        let layout = shared(&format!("cases/cars/{name}")).unwrap();
        let text = std::fs::read_to_string(layout).unwrap();
        LayoutChoice::Described(Layout::from_toml_str(name, &text).unwrap())
    });
    let logs = read_file(&file, &layout).map_err(|e| e.to_string())?.logs;
    let drives = logs
        .into_iter()
        .map(|log| prepare(log, &Preparation::default()));
    drives.collect::<Result<_, _>>().map_err(|e| e.to_string())
}

/// Distances in km, one per drive.
fn distances(path: &str, layout: Option<&str>, expected_km: &[f64]) {
    if shared(&format!("cases/cars/{path}")).is_none() {
        return;
    }
    let drives = drives(path, layout).unwrap();
    let found: Vec<f64> = drives.iter().map(|d| d.distance_m() / 1e3).collect();
    assert_eq!(found.len(), expected_km.len(), "{path}: {found:?}");
    for (found, expected) in found.iter().zip(expected_km) {
        assert!(
            (found - expected).abs() < 0.005 * expected,
            "{path}: {found} for {expected}"
        );
    }
}

fn refused(path: &str, layout: Option<&str>, words: &[&str]) {
    if shared(&format!("cases/cars/{path}")).is_none() {
        return;
    }
    let error = drives(path, layout).expect_err(path);
    for word in words {
        assert!(
            error.contains(word),
            "{path}: {error:?} does not say {word:?}"
        );
    }
}

#[test]
fn logs_that_open_with_their_right_values() {
    for (path, layout, km) in [
        (
            "01-torque-tracklog/trackLog.csv",
            Some("01-torque-tracklog/layout.toml"),
            3.856,
        ),
        (
            "01-torque-tracklog/norepeat.csv",
            Some("01-torque-tracklog/layout.toml"),
            3.856,
        ),
        ("04-packed-hhmmss/log.csv", None, 3.856),
        ("04-packed-hhmmss/straight.csv", None, 3.856),
        ("07-header-again/log.csv", None, 3.856),
        ("08-unit-in-cells/log.csv", None, 3.856),
        ("08-unit-in-cells/unitsrow.csv", None, 3.856),
        ("13-v-is-volts/amps.csv", None, 1.717),
        ("13-v-is-volts/volts.csv", None, 1.717),
        ("13-v-is-volts/full.csv", None, 1.717),
        ("03-header-ms-values-s/log.csv", None, 3.856),
        ("14-thousands-point/both.csv", None, 3.856),
        ("14-thousands-point/time_quoted.csv", None, 3.856),
        ("14-thousands-point/time_thousands.csv", None, 3.856),
        ("17-iso-time/clock_only.csv", None, 3.856),
        ("17-iso-time/excel_serial.csv", None, 3.856),
        ("17-iso-time/iso_time_s.csv", None, 3.856),
        ("17-iso-time/iso_z_ms.csv", None, 3.856),
        ("17-iso-time/iso_zone.csv", None, 3.856),
        ("31-knots/log.csv", None, 6.771),
    ] {
        distances(path, layout, &[km]);
    }
    let names = [
        "comment_middle",
        "comments",
        "cr_only",
        "footer",
        "footer_total",
        "nan_words",
    ];
    let more = ["sep_line", "trailing", "trailing_rows_only"];
    let words = (0..15).map(|i| format!("word_{i:02}"));
    for name in names
        .into_iter()
        .chain(more)
        .map(str::to_owned)
        .chain(words)
    {
        distances(&format!("32-comments-footer/{name}.csv"), None, &[6.771]);
    }
}

#[test]
fn logs_that_are_refused_with_the_cure() {
    for (path, layout, words) in [
        (
            "02-racechrono-v3/session.csv",
            Some("02-racechrono-v3/layout.toml"),
            &["\"speed\"", "column = 7 or 8"][..],
        ),
        (
            "05-column-shift/log.txt",
            Some("05-column-shift/layout.toml"),
            &["line 2", "6 fields", "7", "no_header"],
        ),
        (
            "05-column-shift/shifted.csv",
            None,
            &["\"time_s\"", "header"],
        ),
        (
            "11-speed-without-unit/gps_mps.csv",
            None,
            &["\"Speed\"", "unit"],
        ),
        (
            "11-speed-without-unit/gps_kmh.csv",
            None,
            &["\"Speed\"", "unit"],
        ),
        ("13-v-is-volts/log.csv", None, &["speed_mps", "\"V\""]),
        (
            "14-thousands-point/point_only.csv",
            None,
            &["line 2", "\"1.234\"", "decimal"],
        ),
        (
            "14-thousands-point/time_thousands_int.csv",
            None,
            &["line 3", "\"1.000\""],
        ),
        (
            "32-comments-footer/mixed_delims.csv",
            None,
            &["line 2", "','"],
        ),
    ] {
        refused(path, layout, words);
    }
}

#[test]
fn one_drive_per_trip_and_car() {
    distances("49-trip-column/day.csv", None, &[6.771, 9.330, 7.082]);
    distances(
        "16-two-vehicles-interleaved/same_times.csv",
        None,
        &[3.868, 3.762],
    );
    distances(
        "16-two-vehicles-interleaved/offset_times.csv",
        None,
        &[3.868, 3.762],
    );
    distances(
        "16-two-vehicles-interleaved/offset_1hz.csv",
        None,
        &[3.856, 3.743],
    );
    for file in ["week.csv", "sorted_by_time.csv"] {
        for layout in ["layout.toml", "layout_limit.toml"] {
            distances(
                &format!("15-ved-many-trips/{file}"),
                Some(&format!("15-ved-many-trips/{layout}")),
                &[3.859, 3.642, 3.761, 3.116],
            );
        }
    }
}

#[test]
fn the_trips_of_the_naturalistic_driving_study() {
    for (driver, trips) in [("A", ["5", "12", "18"]), ("B", ["8", "13", "18"])] {
        let path = format!("../../data/nds-br/driver_{driver}.csv.gz");
        if shared(&format!("cases/cars/{path}")).is_none() {
            return;
        }
        let drives = drives(&path, Some("nds-limit.toml")).unwrap();
        let found: Vec<&str> = drives.iter().map(|d| d.origin["TRIP"].as_str()).collect();
        assert_eq!(found, trips);
        assert!(drives.iter().all(|d| d.origin["DRIVER"] == driver));
    }
}
