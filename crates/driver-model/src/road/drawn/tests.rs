use std::f64::consts::PI;

use drive_log::Channel;
use proptest::prelude::*;

use super::*;
use crate::Motion;
use crate::road::RoadStop;

/// Metres eastwards on the equator in degrees.
fn deg(m: f64) -> f64 {
    m / (6_371_008.8 * PI / 180.0)
}

fn gpx_points(tag: &str, points: &[(f64, f64)]) -> String {
    let points = points.iter().map(|(east_m, up_m)| {
        format!(
            "<{tag} lat='0' lon='{:.9}'><ele>{up_m}</ele></{tag}>",
            deg(*east_m)
        )
    });
    points.collect()
}

fn hill(length_m: usize) -> Vec<(f64, f64)> {
    (0..=length_m / 20)
        .map(|k| 20.0 * k as f64)
        .map(|s| (s, 200.0 + 0.03 * s))
        .collect()
}

fn track(segments: &[&[(f64, f64)]]) -> String {
    let segments = segments
        .iter()
        .map(|points| format!("<trkseg>{}</trkseg>", gpx_points("trkpt", points)));
    format!(
        "<?xml version='1.0'?><gpx><trk>{}</trk></gpx>",
        segments.collect::<String>()
    )
}

#[test]
fn a_gpx_track_has_length_and_smoothed_elevation() {
    let drawn = DrawnRoad::of_gpx(&track(&[&hill(2000)]), "a.gpx").unwrap();
    let road = &drawn.road;
    assert_eq!(road.length_m, 2000.0);
    for at in &road.elevation {
        assert!(
            (at.elevation_m - 200.0 - 0.03 * at.position_m).abs() < 0.02,
            "{at:?}"
        );
    }
    assert_eq!(drawn.findings, ["no limits: GPX has none"]);
}

#[test]
fn a_receiver_that_stands_adds_no_length_and_segments_join_over_short_gaps() {
    let mut wandering = hill(1000);
    wandering.extend((0..200).map(|k| (1000.0 + f64::from(k % 2) * 3.0, 230.0)));
    let second: Vec<_> = hill(2000).split_off(60);
    let drawn = DrawnRoad::of_gpx(&track(&[&wandering, &second]), "a.gpx").unwrap();
    assert_eq!(drawn.road.length_m, 2000.0);
    assert!(
        drawn.findings[0].starts_with("2 segments joined by straight lines of 19"),
        "{:?}",
        drawn.findings
    );
}

#[test]
fn a_route_counts_where_there_is_no_track() {
    let points = gpx_points("rtept", &[(0.0, 1.0), (300.0, 1.0)]);
    let route = format!("<gpx xmlns='x'><rte>{points}</rte></gpx>");
    assert_eq!(
        DrawnRoad::of_gpx(&route, "a.gpx").unwrap().road.length_m,
        300.0
    );
}

#[test]
fn heights_that_are_none_are_bridged() {
    let mut points = hill(2000);
    points[40].1 = 1e300;
    points[41].1 = f64::NAN;
    let road = DrawnRoad::of_gpx(&track(&[&points]), "a.gpx").unwrap().road;
    let highest_m = road
        .elevation
        .iter()
        .map(|at| at.elevation_m)
        .fold(0.0, f64::max);
    assert!((highest_m - 260.0).abs() < 0.1, "{highest_m}");
}

#[test]
fn what_is_no_track_is_refused_with_place_and_cure() {
    let far = [(5000.0, 0.0), (5100.0, 0.0)];
    let one = hill(100);
    let two = track(&[&one]).replace("</gpx>", "").replace("<gpx>", "") + "";
    let two = two.replace("<?xml version='1.0'?>", "");
    for (text, parts) in [
        (String::new(), &["no GPX"][..]),
        ("<kml></kml>".to_owned(), &["no <gpx>"]),
        ("<gpx></gpx>".to_owned(), &["no track and no route"]),
        ("<gpx><trk>\n</gpx>".to_owned(), &["line 2", "trk"]),
        (
            track(&[&one]).replace("</gpx>", ""),
            &["cut off within <gpx>"],
        ),
        (
            track(&[&one, &far]),
            &["a gap of 4900 m", "0.000899° east", "fill it"],
        ),
        (format!("<gpx>{two}{two}</gpx>"), &["2 tracks", "keep one"]),
        (
            track(&[&one]).replace("lat='0'", "lat='north'"),
            &["lat is `north`", "-90 to 90"],
        ),
        (track(&[&one]).replace("lat='0'", ""), &["without lat"]),
        (
            track(&[&one]).replace("<ele>200<", "<ele>high<"),
            &["<ele> is `high`"],
        ),
        (
            track(&[&[(0.0, 1.0), (0.2, 1.0)]]),
            &["length_m = 0.2", "1 m to 1000 km"],
        ),
    ] {
        let error = DrawnRoad::of_gpx(&text, "a.gpx").unwrap_err().to_string();
        assert!(error.starts_with("a.gpx: "), "{error}");
        for part in parts {
            assert!(error.contains(part), "no `{part}` in: {error}");
        }
    }
}

fn line(points_m: &[(f64, f64)], properties: &str) -> String {
    let points = points_m
        .iter()
        .map(|(x, y)| format!("[{:.9},{:.9}]", deg(*x), deg(*y)));
    let points: Vec<String> = points.collect();
    format!(
        r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{{"type":"LineString","coordinates":[{}]}}}}"#,
        points.join(",")
    )
}

fn point(east_m: f64, properties: &str) -> String {
    format!(
        r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{{"type":"Point","coordinates":[{:.9},0]}}}}"#,
        deg(east_m)
    )
}

fn collection(features: &[String]) -> String {
    format!(
        r#"{{"type":"FeatureCollection","features":[{}]}}"#,
        features.join(",")
    )
}

#[test]
fn ways_in_any_order_and_direction_are_one_road_with_limits_and_stop_signs() {
    let map = collection(&[
        line(&[(200.0, 0.0), (500.0, 0.0)], r#""maxspeed":"50 km/h""#),
        line(
            &[(900.0, 0.0), (500.0, 0.0)],
            r#""tags":{"maxspeed:backward":"30 mph"}"#,
        ),
        line(
            &[(0.0, 0.0), (100.0, 0.0), (200.0, 0.0)],
            r#""maxspeed":"DE:urban""#,
        ),
        line(&[(900.0, 0.0), (1000.0, 0.0)], ""),
        point(100.0, r#""highway":"stop""#),
        point(500.0, r#""highway":"traffic_signals""#),
        point(200.0, r#""tags":{"highway":"traffic_signals"}"#),
        point(900.0, r#""highway":"give_way""#),
        point(555.0, r#""highway":"stop""#),
        point(100.0, r#""highway":"stop","direction":"backward""#),
    ]);
    let drawn = DrawnRoad::of_geojson(&map, "map.geojson").unwrap();
    let limits: Vec<(f64, f64)> = drawn
        .road
        .limits
        .iter()
        .map(|l| (l.position_m, (l.limit_mps * 36.0).round() / 10.0))
        .collect();
    assert_eq!(limits, [(0.0, 50.0), (500.0, 48.3)]);
    let stop = RoadStop {
        position_m: 100.0,
        dwell_s: 2.0,
    };
    assert_eq!(
        (drawn.road.length_m, &drawn.road.stops[..]),
        (1000.0, &[stop][..])
    );
    let findings = drawn.findings.join("\n");
    for part in [
        "no elevations: a level road",
        "were not used: 1",
        "300 m have no limit",
        "1 stop sign at 100 m taken as 2 s of standing",
        "2 traffic signals at 200, 500 m without times left out; add them as `signals`",
        "1 give-way sign at 900 m left out",
        "2 points left out",
    ] {
        assert!(findings.contains(part), "no `{part}` in: {findings}");
    }
}

#[test]
fn a_line_with_heights_is_a_track_and_one_way_streets_turn_the_road() {
    let coordinates: Vec<String> = (0..=50)
        .map(|k| {
            format!(
                "[{:.9},0,{}]",
                deg(20.0 * f64::from(k)),
                300.0 - f64::from(k)
            )
        })
        .collect();
    let text = format!(
        r#"{{"type":"LineString","coordinates":[{}]}}"#,
        coordinates.join(",")
    );
    let road = DrawnRoad::of_geojson(&text, "line.geojson").unwrap().road;
    assert_eq!((road.length_m, road.limits.len()), (1000.0, 0));
    let (first, last) = (
        road.elevation[0].elevation_m,
        road.elevation.last().unwrap().elevation_m,
    );
    assert!(
        (first - 300.0).abs() < 0.1 && (last - 250.0).abs() < 0.1,
        "{first} {last}"
    );

    let map = collection(&[
        line(&[(0.0, 0.0), (400.0, 0.0)], r#""maxspeed":30"#),
        line(
            &[(900.0, 0.0), (400.0, 0.0)],
            r#""maxspeed":70,"oneway":"yes""#,
        ),
    ]);
    let drawn = DrawnRoad::of_geojson(&map, "map.geojson").unwrap();
    let limits: Vec<f64> = drawn
        .road
        .limits
        .iter()
        .map(|limit| (limit.limit_mps * 3.6).round())
        .collect();
    assert_eq!(
        (limits, drawn.road.limits[1].position_m),
        (vec![70.0, 30.0], 500.0)
    );
    assert!(
        drawn.findings[0].contains("against the first line"),
        "{:?}",
        drawn.findings
    );
}

#[test]
fn lines_that_are_no_road_are_refused_with_place_and_cure() {
    let along = |from: f64, to: f64| line(&[(from, 0.0), (0.5 * (from + to), 0.0), (to, 0.0)], "");
    let one_way = |from: f64, to: f64| line(&[(from, 0.0), (to, 0.0)], r#""oneway":"yes""#);
    for (features, parts) in [
        (
            vec![along(0.0, 100.0), along(112.0, 200.0)],
            &[
                "do not join: 12.0 m from 0.000899° east",
                "to 0.001007° east",
                "add the line",
            ][..],
        ),
        (
            vec![
                along(0.0, 100.0),
                along(100.0, 200.0),
                line(&[(100.0, 0.0), (100.0, 90.0)], ""),
            ],
            &[
                "3 ends of lines meet at 0.000899° east",
                "keep the lines of one way",
            ],
        ),
        (
            vec![along(0.0, 100.0), line(&[(50.0, 0.0), (50.0, 90.0)], "")],
            &["branches off within another at 0.000450° east", "split"],
        ),
        (
            vec![
                along(0.0, 100.0),
                line(&[(100.0, 0.0), (50.0, 90.0), (0.0, 0.0)], ""),
            ],
            &["the lines close", "take out one"],
        ),
        (
            vec![
                along(0.0, 100.0),
                line(&[(300.0, 0.0), (350.0, 90.0), (300.0, 0.0)], ""),
            ],
            &["some lines close", "take them out"],
        ),
        (
            vec![one_way(0.0, 100.0), one_way(200.0, 100.0)],
            &["opposite directions", "keep those of one direction"],
        ),
        (
            vec![point(0.0, "")],
            &["no line", "give GeoJSON with a line"],
        ),
        (
            vec![line(&[(0.0, 0.0), (0.5, 0.0)], "")],
            &["length_m = 0.5"],
        ),
    ] {
        let error = DrawnRoad::of_geojson(&collection(&features), "map.geojson")
            .unwrap_err()
            .to_string();
        assert!(error.starts_with("map.geojson: "), "{error}");
        for part in parts {
            assert!(error.contains(part), "no `{part}` in: {error}");
        }
    }
}

/// At 1 Hz: from rest to 10 m/s, slow at a turn, standing `dwell_s`, and to the end; the limit changes `late` samples later.
fn drive(name: &str, dwell_s: usize, late: usize, channels: &[(Channel, f64)]) -> Motion {
    let ramp = |from: f64, to: f64, seconds: usize| {
        (0..seconds).map(move |k| from + (to - from) * k as f64 / seconds as f64)
    };
    let mut speed: Vec<f64> = vec![0.0; 5];
    speed.extend(ramp(0.0, 10.0, 10).chain(ramp(10.0, 10.0, 40)));
    speed.extend(
        ramp(10.0, 4.0, 5)
            .chain(ramp(4.0, 10.0, 5))
            .chain(ramp(10.0, 10.0, 30)),
    );
    speed.extend(
        ramp(10.0, 0.0, 8)
            .chain(ramp(0.0, 0.0, dwell_s))
            .chain(ramp(0.0, 10.0, 10)),
    );
    speed.extend(
        ramp(10.0, 10.0, 20)
            .chain(ramp(10.0, 0.0, 8))
            .chain([0.0; 4]),
    );
    let limit = (0..speed.len()).map(|k| {
        if k < 30 + late {
            50.0 / 3.6
        } else {
            70.0 / 3.6
        }
    });
    let constant = channels
        .iter()
        .map(|(channel, value)| (*channel, vec![*value; speed.len()]));
    let all = constant.chain([
        (Channel::SpeedLimit, limit.collect()),
        (Channel::Speed, speed.clone()),
    ]);
    Motion::of_channels(name, 1.0, all)
}

#[test]
fn several_drives_share_their_road() {
    let slope = [(Channel::Slope, 0.02), (Channel::Elevation, 100.0)];
    let drives = [
        drive("a", 10, 0, &slope),
        drive("b", 20, 2, &slope),
        drive("c", 14, 4, &slope),
    ];
    let drawn = DrawnRoad::of_drives(&drives).unwrap();
    let road = &drawn.road;
    assert_eq!((road.start_speed_mps, road.end_speed_mps), (0.0, 0.0));
    assert_eq!(road.length_m, 1150.0);
    let limits: Vec<(f64, f64)> = road
        .limits
        .iter()
        .map(|l| (l.position_m, (3.6 * l.limit_mps).round()))
        .collect();
    // Sample 32 of the middle drive: 50 m while speeding up, and 17 s at 10 m/s.
    assert_eq!(limits, [(0.0, 50.0), (220.0, 70.0)]);
    assert_eq!(road.stops.len(), 1);
    assert!(
        (road.stops[0].dwell_s - 14.0).abs() < 1.0
            && (road.stops[0].position_m - 860.0).abs() < 5.0,
        "{:?}",
        road.stops
    );
    let slow = road.slow_points.as_ref().unwrap();
    assert!(
        slow.len() == 1 && (slow[0].speed_mps - 4.0).abs() < 0.1,
        "{slow:?}"
    );
    let (first, last) = (
        road.elevation[0].elevation_m,
        road.elevation.last().unwrap().elevation_m,
    );
    assert!((last - first - 23.0).abs() < 0.1, "{first} {last}");
    assert!(
        drawn.findings[0].contains("disagree about the limit over 40 of 1150 m"),
        "{:?}",
        drawn.findings
    );
}

#[test]
fn one_drive_is_its_road_and_what_it_lacks_is_said() {
    let motion = drive("a", 10, 0, &[]);
    let drawn = DrawnRoad::of_drives(&[motion.without_limits()]).unwrap();
    assert!(drawn.road.limits.is_empty() && drawn.road.elevation.is_empty());
    assert_eq!(drawn.road.slow_points.unwrap().len(), 1);
    assert!(
        drawn.findings[0].starts_with("no limits"),
        "{:?}",
        drawn.findings
    );
    assert!(
        drawn.findings[1].contains("level road"),
        "{:?}",
        drawn.findings
    );
}

#[test]
fn drives_of_other_lengths_and_in_pieces_are_refused_by_name() {
    let other = Motion::of_channels("other", 1.0, [(Channel::Speed, vec![10.0; 150])]);
    let drives = [
        drive("a", 10, 0, &[]),
        drive("b", 10, 0, &[]),
        other.clone(),
    ];
    let error = DrawnRoad::of_drives(&drives).unwrap_err().to_string();
    assert!(
        error.contains("most are 1.15 km long") && error.contains("other (1.49 km)"),
        "{error}"
    );
    let pieces = [other.clone(), other];
    let error = DrawnRoad::of_drives(&pieces).unwrap_err().to_string();
    assert!(error.contains("2 drives; give them one by one"), "{error}");
    let error = DrawnRoad::of_drives(&[]).unwrap_err().to_string();
    assert!(error.contains("give logs"), "{error}");
    let standing = Motion::of_channels("standing", 1.0, [(Channel::Speed, vec![0.0; 9])]);
    let error = DrawnRoad::of_drives(&[standing]).unwrap_err().to_string();
    assert!(error.contains("standing: length_m = 0"), "{error}");
}

#[test]
fn a_drive_that_starts_rolling_keeps_its_speed() {
    let rolling = Motion::of_channels("a", 1.0, [(Channel::Speed, vec![10.0; 50])]);
    let road = DrawnRoad::of_drives(&[rolling]).unwrap().road;
    assert_eq!((road.start_speed_mps, road.end_speed_mps), (10.0, 10.0));
}

proptest! {
    #[test]
    fn any_drives_make_a_road_that_reads_back(
        speeds in prop::collection::vec(prop::collection::vec(0.0..40.0_f64, 30..60), 1..4),
        limit_kmh in 5.0..200.0_f64,
    ) {
        let motions: Vec<Motion> = speeds.into_iter().enumerate().map(|(number, speed)| {
            let limits = speed.iter().map(|v| limit_kmh + (v * 4.0).round()).map(|kmh| kmh / 3.6).collect();
            Motion::of_channels(&number.to_string(), 1.0, [(Channel::Speed, speed), (Channel::SpeedLimit, limits)])
        }).collect();
        if let Ok(drawn) = DrawnRoad::of_drives(&motions) {
            let toml = drawn.road.to_toml().unwrap();
            prop_assert_eq!(RoadFile::from_toml(&toml, "road.toml").unwrap(), drawn.road);
        }
    }

    #[test]
    fn any_track_is_a_road_or_an_error(
        points in prop::collection::vec((-3e3..3e3_f64, -3e3..9e3_f64), 0..40),
        cut in 0..4000_usize,
    ) {
        let text = track(&[&points]);
        if let Ok(drawn) = DrawnRoad::of_gpx(&text, "any.gpx") {
            prop_assert!(drawn.road.length_m >= 1.0);
        }
        let cut = text.get(..cut).unwrap_or(&text);
        let _ = DrawnRoad::of_gpx(cut, "any.gpx");
        let map = collection(&[line(&points, "")]);
        let _ = DrawnRoad::of_geojson(&map, "any.geojson");
    }
}
