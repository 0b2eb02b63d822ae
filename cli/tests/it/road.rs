//! Roads out of logs, tracks and maps.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use driver_model::road::RoadFile;
use serde_json::Value;
use tempfile::TempDir;

use crate::program::{Run, drivekit_in, fixture};

fn road_of(folder: &Path, arguments: &str) -> Run {
    let arguments: Vec<&str> = arguments.split(' ').collect();
    drivekit_in(folder, &[&["road"][..], &arguments].concat())
}

#[test]
fn a_drive_of_the_fixtures_becomes_a_road_that_reads_back() {
    let folder = TempDir::new().unwrap();
    let drive = fixture("drives/drive-01.csv");
    for name in ["road.toml", "road.json"] {
        let run = road_of(folder.path(), &format!("{drive} -o {name} --format json")).ok();
        assert!(
            run.stderr.contains(&format!("road written to {name}")),
            "{}",
            run.stderr
        );
        let document = run.json();
        assert_eq!(document["schema"], "drivekit/road/1");
        assert_eq!(document["inputs"][0]["path"], drive);
        let road = RoadFile::read(&folder.path().join(name)).unwrap();
        assert_eq!(serde_json::to_value(&road).unwrap(), document["road"]);
        assert!(!road.limits.is_empty() && !road.elevation.is_empty());
        assert_eq!(road.limits[0].position_m, 0.0);
    }
}

/// At 10 Hz to 54 km/h, standing once, and back to rest after about `length_m`.
fn drive(dwell_s: usize, length_m: f64, limit_from_m: f64) -> String {
    let mut text = String::from("time_s,speed_mps,speed_limit_kmh,elevation_m\n");
    let (mut place_m, mut speed_mps, mut stood) = (0.0, 0.0_f64, 0);
    let mut k = 0;
    while place_m < length_m - 0.5 || speed_mps > 0.0 {
        let limit = if place_m < limit_from_m { 50 } else { 70 };
        let _ = writeln!(
            text,
            "{:.1},{speed_mps:.4},{limit},{:.2}",
            0.1 * f64::from(k),
            300.0 + 0.02 * place_m
        );
        let is_waiting = place_m >= 499.0 && stood < 10 * dwell_s;
        let next_m = if is_waiting || place_m < 499.0 {
            500.0
        } else {
            length_m
        };
        let allowed_mps = (2.0 * (next_m - place_m).max(0.0)).sqrt();
        let wanted_mps = if next_m - place_m < 0.5 {
            0.0
        } else {
            allowed_mps
        };
        stood += usize::from(is_waiting && speed_mps <= 0.0);
        let next_mps = wanted_mps.min(15.0).min(speed_mps + 0.15).max(0.0);
        place_m += 0.05 * (speed_mps + next_mps);
        speed_mps = next_mps;
        k += 1;
    }
    text
}

#[test]
fn drives_of_one_road_share_limits_stops_and_elevation() {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("a.csv", &drive(10, 1000.0, 200.0));
    write("b.csv", &drive(20, 1000.0, 220.0));
    write("c.csv", &drive(30, 1001.0, 210.0));
    let run = road_of(
        folder.path(),
        "a.csv b.csv c.csv -o road.toml --format json",
    )
    .ok();
    let document = run.json();
    let road = &document["road"];
    let number = |value: &Value| value.as_f64().unwrap();
    assert!((number(&road["length_m"]) - 1000.0).abs() < 3.0, "{road}");
    assert_eq!(road["limits"].as_array().unwrap().len(), 2);
    assert!(
        (number(&road["limits"][1]["position_m"]) - 210.0).abs() < 3.0,
        "{road}"
    );
    assert_eq!(road["stops"].as_array().unwrap().len(), 1);
    assert!(
        (number(&road["stops"][0]["dwell_s"]) - 20.0).abs() < 2.0,
        "{road}"
    );
    let finding = document["findings"][0].as_str().unwrap();
    assert!(
        finding.contains("disagree about the limit over 2"),
        "{finding}"
    );
    let heights = road["elevation"].as_array().unwrap();
    let (first, last) = (
        &heights[0]["elevation_m"],
        &heights[heights.len() - 1]["elevation_m"],
    );
    assert!(
        (number(last) - number(first) - 20.0).abs() < 1.0,
        "{first} {last}"
    );

    let said = road_of(folder.path(), "a.csv b.csv -o road.toml")
        .ok()
        .stdout;
    for part in ["limit 70.0 km/h", "stop of 15.", "start at 0.0 km/h"] {
        assert!(said.contains(part), "no `{part}` in: {said}");
    }
    write("long.csv", &drive(20, 1200.0, 220.0));
    let run = road_of(folder.path(), "a.csv b.csv c.csv long.csv -o road.toml");
    run.refused(&["long (1.20 km)", "5 %", "leave these out"]);
    let run = road_of(
        folder.path(),
        "a.csv -o road.toml --require road.length_m>=2000",
    );
    assert_eq!(run.code, 1, "{}", run.stderr);
}

#[test]
fn tracks_and_maps_are_roads_and_findings_say_what_is_missing() {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let points: String = (0..=50)
        .map(|k| {
            format!(
                "<trkpt lat=\"48\" lon=\"{:.6}\"><ele>{}</ele></trkpt>\n",
                11.0 + 4e-4 * f64::from(k),
                500 + k
            )
        })
        .collect();
    write(
        "track.gpx",
        &format!("<gpx><trk><trkseg>\n{points}</trkseg></trk></gpx>"),
    );
    let run = road_of(folder.path(), "track.gpx -o road.toml").ok();
    assert!(run.stdout.contains("1.488 km, between"), "{}", run.stdout);
    assert!(
        run.stdout.contains("no limits: GPX has none"),
        "{}",
        run.stdout
    );
    write(
        "ways.geojson",
        r#"{"type":"FeatureCollection","features":[
        {"type":"Feature","properties":{"@id":"way/2","maxspeed":"30"},"geometry":{"type":"LineString","coordinates":[[11.02,48],[11.01,48]]}},
        {"type":"Feature","properties":{"@id":"way/1","maxspeed":"50"},"geometry":{"type":"LineString","coordinates":[[11,48],[11.005,48],[11.01,48]]}},
        {"type":"Feature","properties":{"highway":"traffic_signals"},"geometry":{"type":"Point","coordinates":[11.01,48]}},
        {"type":"Feature","properties":{"highway":"stop"},"geometry":{"type":"Point","coordinates":[11.005,48]}}]}"#,
    );
    let document = road_of(folder.path(), "ways.geojson -o ways.toml --format json")
        .ok()
        .json();
    let road = RoadFile::read(&folder.path().join("ways.toml")).unwrap();
    let limits: Vec<f64> = road
        .limits
        .iter()
        .map(|limit| (3.6 * limit.limit_mps).round())
        .collect();
    assert_eq!((limits, road.stops[0].dwell_s), (vec![30.0, 50.0], 2.0));
    let findings = document["findings"].to_string();
    assert!(
        findings.contains("1 traffic signal at 744 m without times left out"),
        "{findings}"
    );
    assert_eq!(document["inputs"][0]["path"], "ways.geojson");
}

#[test]
fn what_is_no_road_is_refused_and_nothing_is_written() {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("cut.gpx", "<gpx><trk><trkseg>");
    write("bad.geojson", "{}");
    write("a.csv", &drive(10, 800.0, 200.0));
    for (arguments, words) in [
        (
            "cut.gpx -o road.toml",
            &["cut.gpx", "cut off within <trkseg>"][..],
        ),
        (
            "bad.geojson -o road.toml",
            &["bad.geojson: not GeoJSON", "give GeoJSON with a line"],
        ),
        ("none.gpx -o road.toml", &["cannot read `none.gpx`"]),
        (
            "cut.gpx a.csv -o road.toml",
            &["`cut.gpx` and 1 other files", "name one kind"],
        ),
        (
            "cut.gpx --limit-map bad.geojson -o road.toml",
            &["--limit-map is for logs"],
        ),
        ("cut.gpx -o cut.gpx", &["--output writes .toml, .json"]),
        ("bad.json -o bad.json", &["bad.json"]),
    ] {
        road_of(folder.path(), arguments).refused(words);
    }
    road_of(folder.path(), "-o road.toml").refused(&["no logs given"]);
    assert!(!folder.path().join("road.toml").exists());
}

#[test]
fn the_road_in_the_guide_is_one() {
    let guide = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/guides/roads.md");
    let guide = fs::read_to_string(guide).unwrap();
    let (_, after) = guide.split_once("```toml\n").unwrap();
    let (road, _) = after.split_once("```").unwrap();
    let road = RoadFile::from_toml(road, "guide").unwrap();
    assert_eq!(
        (road.signals.len(), road.curves.len(), road.leader.len()),
        (2, 1, 2)
    );
}
