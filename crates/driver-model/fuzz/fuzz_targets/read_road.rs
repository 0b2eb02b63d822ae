//! Road files, GPX and GeoJSON from any bytes: an error, or a road that reads back and that trip drivers can be asked about.
#![no_main]

use driver_model::road::{DrawnRoad, Road, RoadFile};
use libfuzzer_sys::fuzz_target;

/// Longer roads are left alone: their nodes take the time.
const LONGEST_M: f64 = 20_000.0;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let files = [RoadFile::from_toml(text, "road.toml"), RoadFile::from_json(text, "road.json")];
    let drawn = [DrawnRoad::of_gpx(text, "track.gpx"), DrawnRoad::of_geojson(text, "ways.geojson")];
    let drawn = drawn.into_iter().flatten().map(|drawn| drawn.road);
    for road in files.into_iter().flatten().chain(drawn) {
        read_back(&road);
    }
});

fn read_back(road: &RoadFile) {
    let toml = road.to_toml().expect("TOML");
    assert_eq!(RoadFile::from_toml(&toml, "again.toml").expect("a road"), *road);
    let json = road.to_json().expect("JSON");
    assert_eq!(RoadFile::from_json(&json, "again.json").expect("a road"), *road);
    if road.length_m > LONGEST_M {
        return;
    }
    if let Ok(map) = road.to_map("road") {
        let nodes = Road::new(map).expect("a road").nodes();
        assert!(nodes >= 2);
    }
}
