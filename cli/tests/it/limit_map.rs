//! Speed limits of a map along drives with positions.

use std::fmt::Write as _;

use crate::program::drivekit;

/// A kilometre eastwards on the equator at 10 m/s, without a limit in the log, or with 60 km/h.
fn drive(limit: bool) -> String {
    let mut text = String::from("time_s,speed_mps,latitude_deg,longitude_deg");
    text += if limit { ",speed_limit_kmh\n" } else { "\n" };
    for second in 0..400 {
        let degrees = 1e-3 + f64::from(second) * 10.0 / 111_195.0;
        let _ = write!(text, "{second},10,0,{degrees:.7}");
        text += if limit { ",60\n" } else { "\n" };
    }
    text
}

const MAP: &str = r#"{"type":"FeatureCollection","features":[
{"type":"Feature","properties":{"maxspeed":"50"},"geometry":{"type":"LineString","coordinates":[[0,0],[0.02,0]]}},
{"type":"Feature","properties":{"maxspeed":"30"},"geometry":{"type":"LineString","coordinates":[[0.02,0],[0.03,0]]}},
{"type":"Feature","properties":{"maxspeed":"none"},"geometry":{"type":"LineString","coordinates":[[0.03,0],[0.1,0]]}},
{"type":"Feature","properties":{"name":"a place"},"geometry":{"type":"Point","coordinates":[0,0]}}]}"#;

#[test]
fn drives_get_the_limits_of_a_map() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("map.geojson"), MAP).unwrap();
    let logs = folder.path().join("logs");
    std::fs::create_dir(&logs).unwrap();
    for name in ["a.csv", "b.csv"] {
        let mut text = drive(false);
        let _ = writeln!(text, "# {name}");
        std::fs::write(logs.join(name), text).unwrap();
    }
    let flags = [
        "--limit-map",
        &path("map.geojson"),
        "--step",
        "1",
        "--format",
        "json",
    ];
    let run = |logs: &str| drivekit(&[&["inspect", logs][..], &flags].concat()).ok();
    let document = run(logs.to_str().unwrap()).json();
    let map = &document["files"]["limit_map"];
    assert_eq!(
        (&map["ways"], &map["not_understood"]),
        (&3.into(), &1.into())
    );
    assert_eq!(map["sha256"].as_str().unwrap().len(), 64);
    let seconds = |key: &str| map[key].as_f64().unwrap();
    let ends = 2.0 * (0.029 * 111_195.0 / 10.0);
    assert!((seconds("with_limit_s") - ends).abs() < 5.0, "{map}");
    assert!(
        (seconds("without_limit_s") - (800.0 - ends)).abs() < 5.0,
        "{map}"
    );
    assert_eq!(seconds("compared_s"), 0.0);

    std::fs::write(path("known.csv"), drive(true)).unwrap();
    let said = run(&path("known.csv")).stderr;
    assert!(said.contains("map and log agree in 0.0 %"), "{said}");
    assert!(
        said.contains("no speed of a road and were not used: 1"),
        "{said}"
    );
}

#[test]
fn what_is_no_map_is_refused_with_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("drive.csv"), drive(false)).unwrap();
    std::fs::write(path("map.geojson"), "{}").unwrap();
    for (map, part) in [
        ("map.geojson", "no map with speed limits"),
        ("none", "No such file"),
    ] {
        let run = drivekit(&["inspect", &path("drive.csv"), "--limit-map", &path(map)]);
        run.refused(&[map, part]);
    }
}
