//! JSON lines: parse, write, parse.

use proptest::prelude::*;
use testbed_io::live::json_lines::{CommandLine, PoseLine};

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-10.0..10.0, prop::num::f64::NORMAL | prop::num::f64::ZERO]
}

proptest! {
    #[test]
    fn poses_are_read_as_written(
        robot: u32, x in number(), y in number(), theta in number(), t in prop::option::of(number()),
    ) {
        let pose = PoseLine { robot, x, y, theta, t };
        let text = serde_json::to_vec(&pose).unwrap();
        prop_assert_eq!(PoseLine::parse(&text), Some(pose));
    }

    #[test]
    fn commands_are_read_as_written(
        robot: u32, v in number(), w in number(), left in number(), right in number(),
    ) {
        let command = CommandLine { robot, v, w, left, right };
        let text = serde_json::to_vec(&command).unwrap();
        prop_assert_eq!(CommandLine::parse(&text), Some(command));
    }

    #[test]
    fn anything_else_is_refused_without_a_panic(bytes: Vec<u8>) {
        let _ = PoseLine::parse(&bytes);
        let _ = CommandLine::parse(&bytes);
    }
}

#[test]
fn lines_that_are_none_are_refused() {
    for line in [
        "",
        "{}",
        r#"{"robot": 1, "x": NaN, "y": 0, "theta": 0}"#,
        r#"{"robot": -1, "x": 0, "y": 0, "theta": 0}"#,
        r#"{"robot": 1, "x": 1e999, "y": 0, "theta": 0}"#,
        r#"{"robot": 1, "x": 0, "y": 0}"#,
        r#"{"robot": 1, "x": 0, "y": 0, "theta": 0"#,
    ] {
        assert_eq!(PoseLine::parse(line.as_bytes()), None, "{line}");
    }
    let long = format!(
        "{{\"robot\": 1, \"x\": 0, \"y\": 0, \"theta\": 0{}}}",
        " ".repeat(5000)
    );
    assert_eq!(PoseLine::parse(long.as_bytes()), None);
}
