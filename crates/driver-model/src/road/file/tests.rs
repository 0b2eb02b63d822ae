use proptest::prelude::*;

use super::*;
use crate::road::Road;

const ROAD: &str = r#"
length_m = 1000
end_speed_kmh = 30
limits = [{position_m = 0, limit_kmh = 50}, {position_m = 400, limit_mps = 20}]
stops = [{position_m = 700, dwell_s = 12}]
slow_points = [{position_m = 200, speed_kmh = 18}]
curves = [{from_m = 500, to_m = 520, radius_m = 32}]
elevation = [{position_m = 0, elevation_m = 100}, {position_m = 500, elevation_m = 110}]
signals = [
    {position_m = 300, green_s = [[0, 20], [60, 80]]},
    {position_m = 900, cycle_s = 60, green_from_s = 15, green_s = 30},
]
leader = [{time_s = 0, position_m = 30}, {time_s = 10, position_m = 120.5}]
"#;

#[test]
fn a_road_by_hand_is_read_in_si() {
    let road = RoadFile::from_toml(ROAD, "road.toml").unwrap();
    assert_eq!((road.length_m, road.start_speed_mps), (1000.0, 0.0));
    assert_eq!(road.end_speed_mps, 30.0 / 3.6);
    assert_eq!(road.limits[0].limit_mps, 50.0 / 3.6);
    assert_eq!(road.limits[1].limit_mps, 20.0);
    assert_eq!(road.slow_points.as_ref().unwrap()[0].speed_mps, 5.0);
    let cycle = Green::Cycle {
        cycle_s: 60.0,
        green_from_s: 15.0,
        green_s: 30.0,
    };
    assert_eq!(road.signals[1].green, cycle);
    assert_eq!(road.leader[1].position_m, 120.5);
    let json = r#"{"length_m": 5, "slope": [{"position_m": 0, "grade_pct": 100}]}"#;
    let road = RoadFile::from_json(json, "road.json").unwrap();
    assert_eq!(road.slope[0].slope_rad, std::f64::consts::FRAC_PI_4);
    assert_eq!((road.slow_points, road.limits.len()), (None, 0));
}

#[test]
fn a_road_is_written_as_one_writes_it() {
    let road = RoadFile::from_toml(ROAD, "road.toml").unwrap();
    let written = road.to_toml().unwrap();
    let lines = [
        "    { position_m = 0.0, limit_kmh = 50.0 },\n",
        "    { position_m = 400.0, limit_kmh = 72.0 },\n",
        "    { position_m = 700.0, dwell_s = 12.0 },\n",
        "    { position_m = 300.0, green_s = [[0.0, 20.0], [60.0, 80.0]] },\n",
    ];
    for line in lines {
        assert!(written.contains(line), "{written}");
    }
}

#[test]
fn elevation_becomes_the_mean_slope_of_each_piece() {
    let road = RoadFile::from_toml(ROAD, "road.toml").unwrap();
    let slope_rad = 0.02_f64.atan();
    let at = |position_m| SlopeAt {
        position_m,
        slope_rad,
    };
    assert_eq!(road.slope(), [at(0.0), at(500.0)]);
}

#[test]
fn a_trip_drivers_road_has_curves_as_slow_points_and_needs_limits() {
    let road = RoadFile::from_toml(ROAD, "road.toml").unwrap();
    let map = road.to_map("road.toml").unwrap();
    let slow = map.slow_points.as_ref().unwrap();
    assert_eq!(
        (slow.len(), slow[0].speed_mps, slow[1].speed_mps),
        (22, 5.0, 8.0)
    );
    let of_map = Road::new(map).unwrap();
    assert_eq!((of_map.cap_mps()[510], of_map.cap_mps()[700]), (8.0, 0.0));
    assert_eq!(of_map.limit_mps()[399], 13.89);
    let bare = RoadFile::from_toml("length_m = 10", "bare.toml").unwrap();
    let error = bare.to_map("bare.toml").unwrap_err().to_string();
    assert!(
        error.starts_with("bare.toml: no limit at the start"),
        "{error}"
    );
}

/// A key of a road of 1000 m, and what the error says of it besides the file.
const BAD: [(&str, &[&str]); 50] = [
    ("length_m = 0.5", &["length_m = 0.5", "1 m to 1000 km"]),
    ("length_m = 2e6", &["length_m = 2000000", "split"]),
    ("length_m = nan", &["length_m = NaN"]),
    ("length_m = inf", &["length_m = inf"]),
    ("length_m = \"1 km\"", &["line 1, column 12", "f64"]),
    ("stops = []", &["length_m"]),
    (
        "speed = 3",
        &[
            "line 2, column 1",
            "unknown field `speed`",
            "`start_speed_kmh`",
        ],
    ),
    ("start_speed_kmh = -1", &["start_speed_kmh = -1", "from 0"]),
    ("end_speed_mps = inf", &["end_speed_kmh = inf", "from 0"]),
    (
        "start_speed_kmh = 36\nstart_speed_mps = 10",
        &["start_speed_kmh = 36", "start_speed_mps = 10", "give one"],
    ),
    (
        "limits = [{position_m = 0, limit_kmh = 0}]",
        &["limits[0].limit_kmh = 0", "1.8 to 400 km/h"],
    ),
    (
        "limits = [{position_m = 0, limit_kmh = 900}]",
        &["limits[0].limit_kmh = 900"],
    ),
    (
        "limits = [{position_m = 0, limit_kmh = nan}]",
        &["limits[0].limit_kmh = NaN"],
    ),
    (
        "limits = [{position_m = 0}]",
        &["limits[0]", "limit_kmh or limit_mps"],
    ),
    (
        "limits = [{position_m = 0, limit_kmh = 5, limit_mps = 6}]",
        &["limits[0]: limit_kmh = 5 and limit_mps = 6", "give one"],
    ),
    (
        "limits = [{position_m = 0, limit = 5}]",
        &["unknown field `limit`", "limit_kmh"],
    ),
    (
        "limits = [{position_m = 9, limit_kmh = 5}, {position_m = 8, limit_kmh = 5}]",
        &["limits[1].position_m = 8", "before is at 9", "ascending"],
    ),
    (
        "limits = [{position_m = 9, limit_kmh = 5}, {position_m = 9, limit_kmh = 6}]",
        &["limits[1].position_m = 9", "each position once"],
    ),
    (
        "limits = [{position_m = -1, limit_kmh = 5}]",
        &["limits[0].position_m = -1", "0 to length_m = 1000"],
    ),
    (
        "stops = [{position_m = 1000.5, dwell_s = 3}]",
        &["stops[0].position_m = 1000.5", "lengthen the road"],
    ),
    (
        "stops = [{position_m = nan, dwell_s = 3}]",
        &["stops[0].position_m = NaN"],
    ),
    (
        "stops = [{position_m = 5, dwell_s = -3}]",
        &["stops[0].dwell_s = -3", "from 0"],
    ),
    (
        "stops = [{position_m = 5, dwell_s = 1e7}]",
        &["stops[0].dwell_s = 10000000", "to 1000000"],
    ),
    ("stops = [{position_m = 5}]", &["missing field `dwell_s`"]),
    (
        "slow_points = [{position_m = 5, speed_kmh = 0}]",
        &["slow_points[0].speed_kmh = 0", "is a stop"],
    ),
    (
        "slow_points = [{position_m = 5}]",
        &["slow_points[0]", "speed_kmh or speed_mps"],
    ),
    (
        "curves = [{from_m = 5, to_m = 9, radius_m = 0}]",
        &["curves[0].radius_m = 0", "over 0"],
    ),
    (
        "curves = [{from_m = 5, to_m = 5, radius_m = 9}]",
        &["curves[0].to_m = 5", "beyond from_m = 5"],
    ),
    (
        "curves = [{from_m = 5, to_m = 9e9, radius_m = 9}]",
        &["curves[0].to_m", "length_m = 1000"],
    ),
    (
        "curves = [{from_m = 5, to_m = 9, radius_m = 9}, {from_m = 8, to_m = 12, radius_m = 9}]",
        &["curves[1].from_m = 8", "from 9"],
    ),
    (
        "elevation = [{position_m = 0, elevation_m = inf}]",
        &["elevation[0].elevation_m = inf"],
    ),
    (
        "slope = [{position_m = 0, slope_rad = 1.6}]",
        &["slope[0].slope_rad = 1.6", "π/2"],
    ),
    (
        "slope = [{position_m = 0, slope_rad = 0.1, grade_pct = 3}]",
        &["slope[0]", "give one"],
    ),
    (
        "slope = [{position_m = 0, slope_rad = 0.1}]\nelevation = [{position_m = 0, elevation_m = 1}]",
        &["elevation and slope", "give one"],
    ),
    (
        "signals = [{position_m = 5, green_s = [[0, 9], [8, 20]]}]",
        &["signals[0].green_s[1][0] = 8", "ends at 9", "overlap"],
    ),
    (
        "signals = [{position_m = 5, green_s = [[9, 9]]}]",
        &["signals[0].green_s[0][1] = 9", "after it"],
    ),
    (
        "signals = [{position_m = 5, green_s = []}]",
        &["signals[0].green_s is empty", "give a window"],
    ),
    (
        "signals = [{position_m = 5, green_s = [[nan, 9]]}]",
        &["signals[0].green_s[0][0] = NaN"],
    ),
    (
        "signals = [{position_m = 5, green_s = \"red\"}]",
        &["windows [[from, to], …]"],
    ),
    (
        "signals = [{position_m = 5, green_s = 20}]",
        &["signals[0]", "green_s = 20", "cycle_s"],
    ),
    (
        "signals = [{position_m = 5, green_s = [[0, 9]], cycle_s = 60}]",
        &["signals[0]", "either windows"],
    ),
    (
        "signals = [{position_m = 5, green_s = 70, cycle_s = 60, green_from_s = 0}]",
        &["signals[0].green_s = 70", "cycle_s = 60"],
    ),
    (
        "signals = [{position_m = 5, green_s = 7, cycle_s = 0, green_from_s = 0}]",
        &["signals[0].cycle_s = 0", "1 s to a day"],
    ),
    (
        "signals = [{position_m = 5, green_s = 1e-6, cycle_s = 1e-6, green_from_s = 0}]",
        &["signals[0].cycle_s = 0.000001", "1 s to a day"],
    ),
    (
        "signals = [{position_m = 5, green_s = 10, cycle_s = 1e9, green_from_s = 0}]",
        &["signals[0].cycle_s = 1000000000", "1 s to a day"],
    ),
    (
        "signals = [{position_m = 5, green_s = 7, cycle_s = 9, green_from_s = inf}]",
        &["signals[0].green_from_s = inf"],
    ),
    (
        "leader = [{time_s = 0, position_m = 9}, {time_s = 1, position_m = 8}]",
        &["leader[1].position_m = 8", "backwards"],
    ),
    (
        "leader = [{time_s = 1, position_m = 9}, {time_s = 1, position_m = 9}]",
        &["leader[1].time_s = 1", "ascending"],
    ),
    (
        "leader = [{time_s = 1, position_m = 9}]",
        &["leader has one entry", "two times"],
    ),
    (
        "leader = [{time_s = 1, position_m = nan}, {time_s = 2, position_m = 9}]",
        &["leader[0].position_m = NaN"],
    ),
];

#[test]
fn what_no_road_has_is_refused_with_place_value_and_cure() {
    for (text, parts) in BAD {
        let is_whole = text.starts_with("length_m") || text == "stops = []";
        let text = match is_whole {
            true => text.to_owned(),
            false => format!("length_m = 1000\n{text}"),
        };
        let error = RoadFile::from_toml(&text, "road.toml")
            .unwrap_err()
            .to_string();
        assert!(error.starts_with("road.toml: "), "{error}");
        for part in parts {
            assert!(error.contains(part), "no `{part}` for {text} in: {error}");
        }
    }
}

#[test]
fn signals_are_a_list_of_their_own() {
    let road = RoadFile {
        length_m: 1000.0,
        ..RoadFile::default()
    };
    let read = |text| road.clone().with_signals_of_json(text, "lights.json");
    let signal = r#"[{"position_m": 500, "green_s": [[0, 9]]}]"#;
    assert_eq!(read(signal).unwrap().signals.len(), 1);
    for (text, part) in [
        ("[], \"limits\": []", "line 1 column 3"),
        ("{}", "a list of signals"),
        ("[{\n\"position_m\": x}]", "line 2 column 15"),
        (
            r#"[{"position_m": 1500, "green_s": [[0, 9]]}]"#,
            "signals[0].position_m = 1500",
        ),
    ] {
        let error = read(text).unwrap_err().to_string();
        assert!(
            error.starts_with("lights.json: ") && error.contains(part),
            "{error}"
        );
    }
}

#[test]
fn more_than_a_million_entries_are_refused() {
    let entry = LeaderAt {
        time_s: 0.0,
        position_m: 0.0,
    };
    let road = RoadFile {
        length_m: 10.0,
        leader: vec![entry; 1_000_001],
        ..RoadFile::default()
    };
    let error = road.checked("road.toml").unwrap_err().to_string();
    assert!(error.contains("leader has 1000001 entries"), "{error}");
}

#[test]
fn files_of_other_kinds_and_damaged_ones_are_refused() {
    let folder = std::env::temp_dir().join(format!("road-file-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = |name: &str| folder.join(name);
    std::fs::write(path("road.toml"), ROAD).unwrap();
    assert_eq!(RoadFile::read(&path("road.toml")).unwrap().stops.len(), 1);
    std::fs::write(path("road.json"), "{\"length_m\": 5,}").unwrap();
    for (name, part) in [
        ("road.yaml", "name a road `.toml` or `.json`"),
        ("none.toml", "cannot read it"),
        ("road.json", "line 1 column 16"),
    ] {
        let error = RoadFile::read(&path(name)).unwrap_err().to_string();
        assert!(error.contains(part) && error.contains(name), "{error}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// Ascending positions up to a length, in shares of it.
fn positions(most: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::btree_set(0_u32..1_000_000, 0..most).prop_map(|shares| {
        shares
            .into_iter()
            .map(|share| f64::from(share) / 1e6)
            .collect()
    })
}

fn signal(position_m: f64, times: [f64; 3]) -> Signal {
    let [a, b, c] = times;
    let green = match a < 50.0 {
        true => Green::Windows {
            green_s: vec![[a, a + b], [a + b, a + b + c]],
        },
        false => Green::Cycle {
            cycle_s: 1.0 + b + c,
            green_from_s: a,
            green_s: b,
        },
    };
    Signal { position_m, green }
}

prop_compose! {
    fn any_road()(
        length_m in 1.0..1e6_f64,
        ends_mps in [0.0..50.0_f64, 0.0..50.0],
        shares in prop::collection::vec(positions(6), 6),
        values in [0.5..100.0_f64, 0.3..100.0, 1e-3..1e3],
        times in [0.0..100.0_f64, 1e-3..100.0, 1e-3..100.0],
        known in any::<bool>(),
    ) -> RoadFile {
        let at = |list: usize| shares[list].iter().map(move |share| share * length_m);
        let slow_points = at(2).map(|position_m| SlowPoint { position_m, speed_mps: values[1] });
        let curve = |pair: &[f64]| Curve { from_m: pair[0], to_m: pair[1], radius_m: values[2] };
        let heights = at(4).map(|position_m| ElevationAt { position_m, elevation_m: values[2] - values[0] });
        let slopes = at(4).map(|position_m| SlopeAt { position_m, slope_rad: values[0] / 100.0 });
        RoadFile {
            length_m,
            start_speed_mps: ends_mps[0],
            end_speed_mps: ends_mps[1],
            limits: at(0).map(|position_m| LimitFrom { position_m, limit_mps: values[0] }).collect(),
            stops: at(1).map(|position_m| RoadStop { position_m, dwell_s: values[2] }).collect(),
            slow_points: known.then(|| slow_points.collect()),
            curves: at(3).collect::<Vec<_>>().chunks_exact(2).map(curve).collect(),
            elevation: if known { heights.collect() } else { Vec::new() },
            slope: if known { Vec::new() } else { slopes.collect() },
            signals: at(5).map(|position_m| signal(position_m, times)).collect(),
            leader: at(5).take(shares[5].len() & !1).enumerate().map(|(k, position_m)| LeaderAt { time_s: k as f64, position_m }).collect(),
        }
    }
}

proptest! {
    #[test]
    fn any_road_with_limits_is_one_for_trip_drivers(road in any_road()) {
        let mut road = RoadFile { length_m: road.length_m.min(2e4), ..road };
        road.limits.insert(0, LimitFrom { position_m: 0.0, limit_mps: 9.0 });
        road.limits.dedup_by(|next, kept| next.position_m <= kept.position_m);
        if let Ok(road) = road.checked("any") {
            Road::new(road.to_map("any").unwrap()).unwrap();
        }
    }

    #[test]
    fn what_is_written_reads_back_unchanged(road in any_road()) {
        let road = road.checked("any").unwrap();
        let toml = road.to_toml().unwrap();
        prop_assert_eq!(&RoadFile::from_toml(&toml, "road.toml").unwrap(), &road, "{}", toml);
        let json = road.to_json().unwrap();
        prop_assert_eq!(&RoadFile::from_json(&json, "road.json").unwrap(), &road, "{}", json);
    }

    #[test]
    fn kilometres_per_hour_stay_what_they_are(kmh in 1_u32..4000) {
        let kmh = f64::from(kmh) / 10.0;
        let text = format!("length_m = 9\nend_speed_kmh = {kmh}");
        let road = RoadFile::from_toml(&text, "road.toml").unwrap();
        let line = format!("end_speed_kmh = {kmh:?}\n");
        prop_assert!(road.to_toml().unwrap().contains(&line));
    }

    #[test]
    fn any_text_is_a_road_or_an_error(text in "\\PC*", value in any::<f64>()) {
        let _ = RoadFile::from_toml(&text, "any");
        let _ = RoadFile::from_json(&text, "any");
        let _ = RoadFile::from_toml(&format!("length_m = 10\nlimits = [{{position_m = {value:?}, limit_kmh = {value:?}}}]"), "any");
    }
}
