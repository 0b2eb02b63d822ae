//! Messages of the Robotarium.

use std::collections::BTreeMap;

use proptest::prelude::*;
use testbed_io::live::robotarium::{
    LARGEST_MESSAGE, NotFinite, RobotariumSpec, TrackedPose, decode_command, decode_poses,
    encode_command, encode_poses,
};
use unicycle_cbf::{Pose, Speeds};

fn finite() -> impl Strategy<Value = f64> {
    any::<f64>().prop_filter("finite", |number| number.is_finite())
}

fn poses() -> impl Strategy<Value = Vec<TrackedPose>> {
    let of_one = (finite(), finite(), finite());
    let of_all = prop::collection::btree_map(any::<u32>(), of_one, 0..30);
    of_all.prop_map(|by_id: BTreeMap<_, _>| by_id.into_iter().map(tracked).collect())
}

fn tracked((id, (x_m, y_m, heading_rad)): (u32, (f64, f64, f64))) -> TrackedPose {
    let pose = Pose {
        x_m,
        y_m,
        heading_rad,
    };
    TrackedPose { id, pose }
}

proptest! {
    #[test]
    fn poses_come_back(poses in poses()) {
        let message = encode_poses(&poses);
        prop_assert_eq!(decode_poses(message.as_bytes()).unwrap(), poses);
    }

    #[test]
    fn cut_poses_are_malformed(poses in poses(), share in 0.0..1.0_f64) {
        let message = encode_poses(&poses);
        let kept = (message.len() as f64 * share) as usize;
        prop_assert!(decode_poses(&message.as_bytes()[..kept]).is_err());
    }

    #[test]
    fn commands_come_back(speed_mps in finite(), turn_rate_rad_s in finite()) {
        let speeds = Speeds { speed_mps, turn_rate_rad_s };
        let message = encode_command(speeds).unwrap();
        prop_assert_eq!(decode_command(message.as_bytes()).unwrap(), speeds);
    }

    #[test]
    fn any_bytes_are_taken(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = decode_poses(&bytes);
        let _ = decode_command(&bytes);
    }
}

#[test]
fn both_trackers_are_understood() {
    let newer =
        br#"{"5": {"x": 1, "y": -0.5, "theta": 3e-1, "batt_volt": 3.9, "charge_status": true}}"#;
    let older = br#" {"5":{"charging":0,"powerData":3.9,"theta":0.3,"y":-0.5,"x":1.0}}  "#;
    let one = [tracked((5, (1.0, -0.5, 0.3)))];
    assert_eq!(decode_poses(newer).unwrap(), one);
    assert_eq!(decode_poses(older).unwrap(), one);
}

#[test]
fn the_battery_does_not_matter() {
    for battery in [
        "",
        r#", "batt_volt": null"#,
        r#", "powerData": {"busVolt": []}"#,
    ] {
        let message = format!(r#"{{"5": {{"x": 1, "y": 0, "theta": 0{battery}}}}}"#);
        let poses = decode_poses(message.as_bytes()).unwrap();
        assert_eq!(poses, [tracked((5, (1.0, 0.0, 0.0)))]);
    }
}

#[test]
fn wrong_poses_are_malformed() {
    let good = r#"{"x": 0, "y": 0, "theta": 0}"#;
    for id in [
        "",
        "a",
        "-1",
        "+1",
        "01",
        "1.0",
        "1e0",
        " 1",
        "1 ",
        "4294967296",
    ] {
        malformed(&format!(r#"{{"{id}": {good}}}"#));
    }
    for entry in [
        r#"{"x": 0, "y": 0}"#,
        r#"{"x": NaN, "y": 0, "theta": 0}"#,
        r#"{"x": -Infinity, "y": 0, "theta": 0}"#,
        r#"{"x": 1e999, "y": 0, "theta": 0}"#,
        r#"{"x": null, "y": 0, "theta": 0}"#,
        r#"{"x": "0", "y": 0, "theta": 0}"#,
        r#"{"x": 0, "x": 1, "y": 0, "theta": 0}"#,
        "0",
        "null",
    ] {
        malformed(&format!(r#"{{"1": {entry}}}"#));
    }
    malformed(&format!(r#"{{"1": {good}, "1": {good}}}"#));
    malformed(&format!(r#"{{"1": {good}}} {{}}"#));
    malformed(&"[".repeat(50_000));
    malformed("");
    malformed("[]");
}

fn malformed(message: &str) {
    let decoded = decode_poses(message.as_bytes());
    assert!(decoded.is_err(), "{message}: {decoded:?}");
}

#[test]
fn long_messages_are_malformed() {
    let robots = |count| (0..count).map(|id| tracked((id, (0.0, 0.0, 0.0))));
    let most = encode_poses(&robots(1000).collect::<Vec<_>>());
    assert_eq!(decode_poses(most.as_bytes()).unwrap().len(), 1000);
    malformed(&encode_poses(&robots(1001).collect::<Vec<_>>()));
    let padded = format!("{{}}{}", " ".repeat(LARGEST_MESSAGE - 2));
    assert_eq!(decode_poses(padded.as_bytes()).unwrap(), []);
    malformed(&format!("{padded} "));
}

#[test]
fn commands_are_finite() {
    for wrong in [f64::NAN, f64::INFINITY] {
        let speeds = Speeds {
            speed_mps: 0.1,
            turn_rate_rad_s: wrong,
        };
        assert_eq!(encode_command(speeds), Err(NotFinite));
        let pose = tracked((1, (wrong, 0.0, 0.0)));
        malformed(&encode_poses(&[pose]));
    }
    let stop = encode_command(Speeds::ZERO).unwrap();
    assert_eq!(stop, r#"{"v":0.0,"w":0.0}"#);
}

#[test]
fn lights_do_not_matter() {
    let message = br#"{"v": 0.1, "w": -2, "left_led": [255, 0, 0]}"#;
    let speeds = Speeds {
        speed_mps: 0.1,
        turn_rate_rad_s: -2.0,
    };
    assert_eq!(decode_command(message).unwrap(), speeds);
}

#[test]
fn settings_come_back() {
    let spec = RobotariumSpec {
        port: 1883,
        ..RobotariumSpec::default()
    };
    let text = serde_json::to_string(&spec).unwrap();
    assert_eq!(serde_json::from_str::<RobotariumSpec>(&text).unwrap(), spec);
    let short: RobotariumSpec = serde_json::from_str(r#"{"port": 1883}"#).unwrap();
    assert_eq!(short, spec);
    assert!(serde_json::from_str::<RobotariumSpec>(r#"{"host": "a"}"#).is_err());
}
