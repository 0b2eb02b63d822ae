use proptest::prelude::*;

use super::*;
use crate::{Channel, DriveLog, RawLog};

/// About this many metres north of the equator's meridian, in degrees.
fn deg(m: f64) -> f64 {
    m / (EARTH_RADIUS_M * PI / 180.0)
}

fn line(points_m: &[[f64; 2]], properties: &str) -> String {
    let points: Vec<String> = points_m
        .iter()
        .map(|[x, y]| format!("[{:.9},{:.9}]", deg(*x), deg(*y)))
        .collect();
    format!(
        r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{{"type":"LineString","coordinates":[{}]}}}}"#,
        points.join(",")
    )
}

fn map(features: &[String]) -> LimitMap {
    let all = features.join(",");
    let text = format!(r#"{{"type":"FeatureCollection","features":[{all}]}}"#);
    LimitMap::from_geojson("map", &text).unwrap()
}

fn drive(points_m: &[[f64; 2]], limits_mps: Option<Vec<f64>>) -> DriveLog {
    let of = |axis: usize| points_m.iter().map(|p| deg(p[axis])).collect();
    let mut channels = BTreeMap::from([
        (Channel::Speed, vec![10.0; points_m.len()]),
        (Channel::Longitude, of(0)),
        (Channel::Latitude, of(1)),
    ]);
    channels.extend(limits_mps.map(|limits| (Channel::SpeedLimit, limits)));
    DriveLog::new("drive", 0.0, 1.0, channels).unwrap()
}

fn kmh(limits_mps: &[f64]) -> Vec<f64> {
    limits_mps.iter().map(|v| (3.6 * v).round()).collect()
}

/// East along `y`, 10 m per sample, with an error to either side that repeats.
fn eastwards(from_m: f64, to_m: f64, y_m: f64, noise_m: f64) -> Vec<[f64; 2]> {
    let steps = ((to_m - from_m) / 10.0) as usize;
    (0..=steps)
        .map(|k| {
            [
                from_m + 10.0 * k as f64,
                y_m + noise_m * (k as f64 * 2.4).sin(),
            ]
        })
        .collect()
}

#[test]
fn limits_change_where_ways_do_and_crossings_do_not_count() {
    let map = map(&[
        line(&[[0.0, 0.0], [500.0, 0.0]], r#""maxspeed":"50""#),
        line(&[[500.0, 0.0], [1000.0, 0.0]], r#""maxspeed":30"#),
        line(&[[250.0, -300.0], [250.0, 300.0]], r#""maxspeed":"100""#),
        line(&[[0.0, 30.0], [1000.0, 30.0]], r#""maxspeed":"80""#),
    ]);
    let (limits_mps, known) = map.limits_along(&drive(&eastwards(10.0, 1000.0, 0.0, 9.0), None));
    let limits_kmh = kmh(&limits_mps);
    assert!(
        limits_kmh[..48].iter().all(|v| *v == 50.0),
        "{limits_kmh:?}"
    );
    assert!(
        limits_kmh[51..].iter().all(|v| *v == 30.0),
        "{limits_kmh:?}"
    );
    assert_eq!(
        (known.with_limit_s, known.off_map_s, known.compared_s),
        (100.0, 0.0, 0.0)
    );
}

#[test]
fn directions_have_their_own_limits_and_one_way_streets_only_one() {
    let both = r#""maxspeed":"50","maxspeed:forward":"40","tags":{"maxspeed:backward":"30 mph"}"#;
    let map_of = map(&[line(&[[0.0, 0.0], [500.0, 0.0]], both)]);
    let mut there = eastwards(20.0, 480.0, 2.0, 1.0);
    assert!(
        kmh(&map_of.limits_along(&drive(&there, None)).0)
            .iter()
            .all(|v| *v == 40.0)
    );
    there.reverse();
    assert!(
        kmh(&map_of.limits_along(&drive(&there, None)).0)
            .iter()
            .all(|v| *v == 48.0)
    );
    let one_way = map(&[
        line(
            &[[0.0, 0.0], [500.0, 0.0]],
            r#""maxspeed":"50","oneway":"yes""#,
        ),
        line(
            &[[500.0, 12.0], [0.0, 12.0]],
            r#""maxspeed":"60","oneway":"yes""#,
        ),
    ]);
    assert!(
        kmh(&one_way.limits_along(&drive(&there, None)).0)
            .iter()
            .all(|v| *v == 60.0)
    );
}

#[test]
fn what_the_map_does_not_know_is_what_was_recorded() {
    let map = map(&[
        line(&[[0.0, 0.0], [200.0, 0.0]], r#""maxspeed":"50""#),
        line(&[[200.0, 0.0], [400.0, 0.0]], r#""maxspeed":"DE:urban""#),
    ]);
    assert_eq!((map.ways(), map.not_understood()), (2, 1));
    let mut points = eastwards(0.0, 400.0, 0.0, 0.0);
    points.extend(eastwards(400.0, 600.0, 500.0, 0.0));
    points[0] = [0.0, 0.0];
    points[5] = [f64::NAN, 0.0];
    let recorded = vec![50.0 / 3.6; points.len()];
    let mut recorded_mps = recorded.clone();
    recorded_mps[1] = 20.0;
    recorded_mps[2] = f64::NAN;
    let (limits_mps, known) = map.limits_along(&drive(&points, Some(recorded_mps)));
    assert_eq!(kmh(&limits_mps), kmh(&recorded));
    // The first has the position of a receiver without a fix.
    assert_eq!((known.no_position_s, known.off_map_s), (2.0, 21.0));
    assert_eq!(
        (known.compared_s - known.agreeing_s, known.duration_s()),
        (1.0, 62.0)
    );
    let nowhere = DriveLog::new("no", 0.0, 1.0, [(Channel::Speed, vec![1.0; 3])].into()).unwrap();
    assert_eq!(map.limits_along(&nowhere).1.no_position_s, 3.0);
}

/// One line across, and one that is cut there into two, as RFC 7946 asks for.
#[test]
fn maps_and_drives_cross_the_meridian_of_180_degrees() {
    let feature = |kind: &str, coordinates: &str| {
        format!(
            r#"{{"type":"Feature","properties":{{"maxspeed":"50"}},"geometry":{{"type":"{kind}","coordinates":{coordinates}}}}}"#
        )
    };
    let time_s: Vec<f64> = (0..61).map(f64::from).collect();
    let east: Vec<f64> = time_s
        .iter()
        .map(|t| turned_deg(179.997 + 1e-4 * t, 0.0))
        .collect();
    let channels = BTreeMap::from([
        (Channel::Speed, vec![10.0; 61]),
        (Channel::Longitude, east),
        (Channel::Latitude, vec![-17.0; 61]),
    ]);
    let raw = RawLog::new("drive", time_s, channels).unwrap();
    let drive = crate::prepare(raw, &crate::Preparation::default()).unwrap();
    for map in [
        map(&[feature("LineString", "[[179.99,-17],[-179.99,-17]]")]),
        map(&[feature(
            "MultiLineString",
            "[[[179.99,-17],[180,-17]],[[-180,-17],[-179.99,-17]]]",
        )]),
    ] {
        let (limits_mps, known) = map.limits_along(&drive.pieces[0]);
        assert_eq!(limits_mps.len(), 601);
        assert!(kmh(&limits_mps).iter().all(|v| *v == 50.0), "{known:?}");
        assert!(map.ways() == 1 || map.meeting[0] == [1]);
    }
}

#[test]
fn what_is_no_map_is_refused() {
    for (text, part) in [
        ("", "not GeoJSON"),
        ("[1,2]", "not GeoJSON"),
        (
            r#"{"type":"Point","coordinates":[1,2]}"#,
            "without properties",
        ),
        (r#"{"type":"FeatureCollection","features":[]}"#, "no line"),
        (
            r#"{"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[1,2],[500,2]]}}"#,
            "no position",
        ),
    ] {
        let error = LimitMap::from_geojson("map", text).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}

proptest! {
    #[test]
    fn every_drive_over_every_map_has_a_limit_or_none(
        ways in prop::collection::vec(prop::collection::vec([-900.0..900.0, -900.0..900.0], 2..6), 1..8),
        points in prop::collection::vec([-900.0..900.0, -900.0..900.0], 1..40),
    ) {
        let tags = [r#""maxspeed":"50""#, r#""oneway":"-1","maxspeed":"30""#, ""];
        let features = ways.iter().enumerate().map(|(k, way)| line(way, tags[k % 3]));
        let map = map(&features.collect::<Vec<_>>());
        let (limits_mps, known) = map.limits_along(&drive(&points, None));
        prop_assert!(limits_mps.iter().all(|v| v.is_nan() || kmh(&[*v])[0] == 50.0 || kmh(&[*v])[0] == 30.0));
        prop_assert!((known.duration_s() - points.len() as f64).abs() < 1e-9);
    }
}
