//! Rows that are no samples, cells that are no plain numbers, headers without a unit.

use std::path::Path;

use drive_log::{Channel, Finding, FindingKind, Layout, LayoutChoice, RawLog, read_bytes};

use crate::{log, read};

const ROWS: [&str; 4] = ["0,36.5", "1,37.5", "2,38.5", "3,39.5"];

/// A file of these lines.
fn lines(lines: &[&str]) -> String {
    lines.iter().map(|line| format!("{line}\n")).collect()
}

fn is_the_drive(log: &RawLog, case: &str) {
    assert_eq!(log.time_s(), [0.0, 1.0, 2.0, 3.0], "{case}");
    let speed = log.channel(Channel::Speed).unwrap();
    assert!((speed[0] - 36.5 / 3.6).abs() < 1e-12 && (speed[3] - 39.5 / 3.6).abs() < 1e-12);
}

fn no_samples(log: RawLog) -> Vec<Finding> {
    let findings = drive_log::check(log).findings.into_iter();
    findings
        .filter(|f| f.kind == FindingKind::NoSample)
        .collect()
}

#[test]
fn rows_that_are_no_samples_are_left_out_and_named() {
    let [a, b, c, d] = ROWS;
    let h = "time_s,speed_kmh";
    for (text, word) in [
        (
            lines(&["# logger 1.2", "# 2026-08-05", h, a, b, c, d]),
            "2 comments above",
        ),
        (lines(&[h, a, b, "# marker", c, "// lap, 2", d]), "line 4"),
        (lines(&[h, "s,km/h", a, b, c, d]), "describes the columns"),
        (lines(&[h, "[s],[km/h]", "-,gps", a, b, c, d]), "line 2"),
        (lines(&[h, a, b, h, c, d]), "1 repeated header"),
        (
            lines(&[h, a, b, "time_s, speed_kmh,", c, d]),
            "1 repeated header",
        ),
        (
            lines(&[
                "time_s speed_kmh",
                "0 36.5",
                "# mark",
                "1 37.5",
                "2 38.5",
                "3 39.5",
            ]),
            "1 comment",
        ),
        (lines(&[h, a, b, c, d, "Total,4"]), "\"Total,4\" in line 6"),
        (
            lines(&[h, a, b, c, d, "", "Average,38", "End of log"]),
            "2 rows of a footer",
        ),
    ] {
        let log = log(&text);
        is_the_drive(&log, &text);
        let findings = no_samples(log);
        assert_eq!(findings.len(), 1, "{text}");
        assert!(findings[0].detail.contains(word), "{findings:?}");
    }
}

/// Two files one behind the other, each with its header and units.
#[test]
fn units_under_a_repeated_header() {
    let [a, b, c, d] = ROWS;
    let (h, units) = ("time_s,speed_kmh", "s,km/h");
    let log = log(lines(&[h, units, a, b, "# second", h, units, c, d]));
    is_the_drive(&log, "joined");
    let counts: Vec<char> = no_samples(log)
        .iter()
        .filter_map(|f| f.detail.chars().next())
        .collect();
    assert_eq!(counts, ['2', '1', '1'], "descriptions, a comment, a header");
}

#[test]
fn forms_of_text_that_need_no_word() {
    let [a, b, c, d] = ROWS;
    let h = "time_s,speed_kmh";
    for text in [
        lines(&["sep=,", h, a, b, c, d]),
        lines(&[h, a, b, c, d]).replace('\n', "\r"),
        lines(&["\u{feff}\"sep=;\"", h, a, b, c, d]).replace(',', ";"),
        lines(&["#time_s,speed_kmh", a, b, c, d]),
        lines(&["% time_s speed_kmh", a, b, c, d]).replace(',', " "),
        lines(&[h, "0,36.5 km/h", "1,37.5km/h", "2 s,38.5", "3,39.5 kph"]),
        lines(&[
            "\"time_s\",\"speed_kmh\"",
            "0,\"36,5\"",
            "1,\"37,5\"",
            "2,\"38,5\"",
            "3,\"39,5\"",
        ]),
    ] {
        let log = log(&text);
        is_the_drive(&log, &text);
        assert!(no_samples(log).is_empty(), "{text}");
    }
}

#[test]
fn what_is_no_comment_is_refused_with_its_line() {
    let [a, b, c, d] = ROWS;
    let h = "time_s,speed_kmh";
    for (text, words) in [
        (
            lines(&[h, a, b, "lap 2", c, d]),
            &["line 4", "1 field ", "begin it with #"][..],
        ),
        (
            lines(&[h, "s,m/s", a, b, c, d]),
            &["line 2", "speed_kmh", "\"m/s\"", "km/h"],
        ),
        (
            lines(&[h, a, "1,37.5 mph", c, d]),
            &["line 3", "\"mph\"", "km/h"],
        ),
        (
            lines(&[h, a, "1,ND", c, d]),
            &["line 3", "\"ND\"", "missing = [\"ND\"]"],
        ),
        (
            lines(&[h, a, "1,1'037", c, d]),
            &["line 3", "\"1'037\"", "thousands"],
        ),
        (
            lines(&["time_s;speed_kmh", a, b, c, d]),
            &["line 2", "2 with ','"],
        ),
        (
            lines(&["sats,time_s,speed_kmh", a, b, c, d]),
            &[
                "line 2",
                "2 fields",
                "3",
                "no_header = true, skip_lines = 1",
            ],
        ),
    ] {
        let error = read(&text).unwrap_err().to_string();
        for word in words {
            assert!(error.contains(word), "{error:?} does not say {word:?}");
        }
    }
}

#[test]
fn words_and_ranges_are_no_value_where_there_may_be_none() {
    let log = log("t,v,speed_limit_kmh\n0,1,NPI\n1,1,48-40\n2,1,50\n3,1,NPI\n");
    let limit = log.channel(Channel::SpeedLimit).unwrap().to_vec();
    assert_eq!(
        limit.iter().map(|v| v.is_nan()).collect::<Vec<_>>(),
        [true, true, false, true]
    );
    let findings = drive_log::check(log).findings;
    let words = findings
        .iter()
        .find(|f| f.kind == FindingKind::NoNumber)
        .unwrap();
    assert!(
        words.detail.starts_with("3 cells") && words.detail.contains("\"48-40\""),
        "{words:?}"
    );
}

#[test]
fn a_layout_declares_words_and_chooses_between_equal_headers() {
    let layout = "skip_lines = 1\nmissing = [\"ND\"]\ntime = { header = \"t\", unit = \"s\" }\n\
                  [channels]\nspeed = { column = 3, unit = \"m/s\" }\n";
    let layout = Layout::from_toml_str("mine", layout).unwrap();
    let read = |text: &str, layout: Layout| {
        let choice = LayoutChoice::Described(layout);
        read_bytes(Path::new("log.csv"), text.as_bytes(), &choice)
    };
    let text = "made by a logger\nt,speed,speed\nunix time,gps,calc\n0,1,2\n1,1,ND\n";
    let file = read(text, layout).unwrap();
    let speed = file.logs[0].channel(Channel::Speed).unwrap();
    assert!(speed[0] == 2.0 && speed[1].is_nan());
    let coded = "missing = [\"-99\"]\ntime = { header = \"t\", unit = \"s\" }\n[channels]\n\
                 speed = { header = \"v\", unit = \"m/s\" }\nelevation = { header = \"h\", unit = \"m\" }\n";
    let file = read(
        "t,v,h\n-99,1,-99\n-98,2,-98.5\n",
        Layout::from_toml_str("mine", coded).unwrap(),
    );
    let log = &file.unwrap().logs[0];
    let elevation = log.channel(Channel::Elevation).unwrap();
    assert!(elevation[0].is_nan() && elevation[1] == -98.5 && log.time_s()[0] == -99.0);
    let by_name = "skip_lines = 1\ntime = { header = \"t\", unit = \"s\" }\n\
                   [channels]\nspeed = { header = \"speed\", unit = \"m/s\" }\n";
    let error = read(text, Layout::from_toml_str("mine", by_name).unwrap()).unwrap_err();
    assert!(error.to_string().contains("column = 2 or 3"), "{error}");
}

#[test]
fn marks_between_thousands() {
    let elevation = |text: &str| log(text).channel(Channel::Elevation).unwrap().to_vec();
    assert_eq!(
        elevation("t;v;elevation_m\n0;0,5;1.235,5\n1;0,6;999,5\n"),
        [1235.5, 999.5]
    );
    assert_eq!(
        elevation("t,v,elevation_m\n0,0.5,\"1,235.5\"\n1,0.6,999.5\n"),
        [1235.5, 999.5]
    );
    assert_eq!(
        elevation("t;v;elevation_m\n0;0,5;1.235\n1;0,6;999\n"),
        [1235.0, 999.0]
    );
    assert_eq!(
        elevation("t,v,elevation_m\n0,0.5,\"1,235\"\n1,0.6,999\n"),
        [1235.0, 999.0]
    );
    // a number with both marks tells the others of its column
    assert_eq!(
        elevation("t,v,elevation_m\n0,0.5,\"1,235\"\n1,0.6,\"1,234.5\"\n2,0.6,999.5\n"),
        [1235.0, 1234.5, 999.5]
    );
    assert!(read("t,v,elevation_m\n0,0.5,\"1,235\"\n1,0.6,999.5\n").is_err());
    for text in [
        "t;v;elevation_m\n0;5;1.235\n1;6;999\n",
        "t\tv\televation_m\n0\t5\t1,235\n1\t6\t999\n",
        "time_ms;v\n0;1\n1.000;2\n2.000;2\n",
    ] {
        let error = read(text).unwrap_err().to_string();
        assert!(
            error.contains("a thousand times") && error.contains("decimal ="),
            "{error}"
        );
    }
    // three decimals that a number with a leading zero, or with two, tells
    assert_eq!(
        elevation("t;v;elevation_m\n0;0.125;1.235\n1;0.5;1.236\n"),
        [1.235, 1.236]
    );
    assert_eq!(
        elevation("t,v,elevation_m\n0,1,1.235\n1,2,1.236\n"),
        [1.235, 1.236]
    );
}

#[test]
fn a_unit_is_never_guessed() {
    for (text, words) in [
        (
            "Date,Time,Latitude,Speed\n2026-03-04,09:55:30,40.1,0.67\n",
            &["\"Speed\"", "speed_kmh", "unit"][..],
        ),
        ("time_s,speed\n0,1\n1,2\n", &["\"speed\"", "speed_mps"]),
        ("t,V,A\n0,52.4,1.6\n1,52.5,2.1\n", &["speed_mps", "\"V\""]),
    ] {
        let error = read(text).unwrap_err().to_string();
        for word in words {
            assert!(error.contains(word), "{error:?} does not say {word:?}");
        }
    }
    let volts = log("time_s,speed_kmh,V,A,T\n0,36,314.5,1.6,25\n1,36,314.9,2.1,25\n");
    assert_eq!(
        volts.channels().count(),
        3,
        "volts and amps beside a speed are read, a temperature is left alone"
    );
    let volts = log("time_s,speed_kmh,v,a\n0,36,314.5,1.6\n1,36,314.9,2.1\n");
    assert_eq!(volts.channels().count(), 1);
}

/// Volts and amps in small letters: the second does not follow the first.
#[test]
fn v_and_a_that_are_no_speed_and_its_acceleration() {
    let amps = |i: u32| 40.0 * (f64::from(i) / 15.0).sin();
    let row = |i: u32| {
        format!(
            "{},{:.2},{:.1}\n",
            f64::from(i) / 10.0,
            52.0 - amps(i) / 100.0,
            amps(i)
        )
    };
    let rows: String = (0..300).map(row).collect();
    let error = read(format!("t,v,a\n{rows}")).unwrap_err().to_string();
    assert!(error.contains("headers with units"), "{error}");
    let row = |i: u32| {
        let phase = f64::from(i) / 30.0;
        format!(
            "{},{:.3},{:.3}\n",
            f64::from(i) / 10.0,
            10.0 - 3.0 * phase.cos(),
            phase.sin()
        )
    };
    let rows: String = (0..300).map(row).collect();
    assert_eq!(log(format!("t,v,a\n{rows}")).channels().count(), 2);
}

#[test]
fn a_first_line_without_end_is_refused_at_once() {
    let error = read("x".repeat(3 << 20)).unwrap_err().to_string();
    assert!(error.contains("line 1") && error.len() < 200, "{error}");
    let error = read(format!("time_s,speed_kmh\n{}", "1".repeat(3 << 20))).unwrap_err();
    assert!(error.to_string().contains("line 2"), "{error}");
}

#[test]
fn the_words_of_the_system_are_said_once() {
    let path = Path::new("no/such/file.csv");
    let error = drive_log::read_file(path, &LayoutChoice::Auto).unwrap_err();
    assert!(
        std::error::Error::source(&error).is_none(),
        "said in the message"
    );
    assert_eq!(
        error.to_string().matches("No such file").count(),
        1,
        "{error}"
    );
}
