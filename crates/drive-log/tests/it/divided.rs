//! Several trips or vehicles in one file.

use std::path::Path;

use drive_log::{Channel, FindingKind, Layout, LayoutChoice, LogFile, RawLog, read_bytes};

use crate::{log, read};

fn described(layout: &str, text: &str) -> LogFile {
    let layout = Layout::from_toml_str("mine", layout).unwrap();
    let choice = LayoutChoice::Described(layout);
    read_bytes(Path::new("log.csv"), text.as_bytes(), &choice).unwrap()
}

fn names(file: &LogFile) -> Vec<&str> {
    file.logs.iter().map(RawLog::name).collect()
}

#[test]
fn interleaved_vehicles_are_a_log_each() {
    let row = |i: u32| {
        let t = f64::from(i / 2) * 0.1;
        let vehicle = ["a", "b"][i as usize % 2];
        format!("{vehicle},{t:.1},{}\n", 10 + i % 2)
    };
    let text: String = (0..100).map(row).collect();
    let file = read(format!("Vehicle,time_s,speed_mps\n{text}")).unwrap();
    assert_eq!(names(&file), ["log#vehicle=a", "log#vehicle=b"]);
    for (log, (vehicle, speed)) in file.logs.iter().zip([("a", 10.0), ("b", 11.0)]) {
        assert_eq!(log.origin()["Vehicle"], vehicle);
        assert_eq!(log.len(), 50);
        assert!(
            log.channel(Channel::Speed)
                .unwrap()
                .iter()
                .all(|v| *v == speed)
        );
        assert!(log.time_s().is_sorted());
    }
}

#[test]
fn a_trip_of_a_vehicle_need_not_be_in_one_place() {
    let file = read(
        "VehId,Trip,Driver,time_s,speed_mps\n8,1,x,0,1\n8,2.0,x,0,2\n9,1,x,0,3\n8,1,x,1,1\n8,2,x,1,2\n9,1,x,1,3\n",
    )
    .unwrap();
    assert_eq!(
        names(&file),
        [
            "log#vehid=8,trip=1",
            "log#vehid=8,trip=2",
            "log#vehid=9,trip=1"
        ]
    );
    for log in &file.logs {
        assert_eq!(log.time_s(), [0.0, 1.0]);
        assert_eq!(log.origin()["Driver"], "x");
        assert_eq!(log.origin().len(), 3);
    }
}

#[test]
fn each_drive_has_a_clock_and_findings_of_its_own() {
    let file = read(
        "trip,timestamp,speed_mps,elevation_m\n1,2026-03-04T23:59:59,1,10\n1,2026-03-05T00:00:00,1,?!\n\
         2,2026-03-09T08:00:00,2,ND\n2,2026-03-09T08:00:00.5,2,20\n",
    )
    .unwrap();
    assert_eq!(file.logs[0].time_s(), [0.0, 1.0]);
    assert_eq!(file.logs[1].time_s(), [0.0, 0.5]);
    let found = |log: RawLog| {
        let findings = drive_log::check(log).findings.into_iter();
        findings.filter(|f| f.kind == FindingKind::NoNumber).count()
    };
    let counts: Vec<usize> = file.logs.into_iter().map(found).collect();
    assert_eq!(counts, [0, 1], "only the second has a word");
}

#[test]
fn one_value_is_origin_and_no_part_of_the_name() {
    let log = log("DRIVER,time_s,speed_mps\nA,0,1\nA,0.1,2\n");
    assert_eq!((log.name(), log.len()), ("log", 2));
    assert_eq!(log.origin()["DRIVER"], "A");
}

#[test]
fn a_trip_meter_does_not_divide() {
    let rows: String = (0..50)
        .map(|i| format!("{:.1},{i},10\n", f64::from(i) / 100.0))
        .collect();
    let log = log(format!("trip,time_s,speed_mps\n{rows}"));
    assert_eq!(log.len(), 50);
    let findings = drive_log::check(log).findings;
    assert_eq!(findings[0].kind, FindingKind::NoDivision);
}

#[test]
fn rows_without_a_trip_are_left_out_and_that_is_said() {
    let file = read("trip,time_s,speed_mps\n1,0,1\n,1,1\n2,2,1\n2,3,1\n").unwrap();
    assert_eq!(names(&file), ["log#trip=1", "log#trip=2"]);
    let findings = drive_log::check(file.logs[1].clone()).findings;
    assert_eq!(findings[0].kind, FindingKind::NoSample);
    assert!(findings[0].detail.contains("1 row without"), "{findings:?}");
}

#[test]
fn a_drive_without_speed_is_named() {
    let file = read("trip,time_s,speed_mps\n1,0,1\n1,1,1\n2,0,\n2,1,\n").unwrap();
    assert_eq!(names(&file), ["log#trip=1"]);
    let findings = drive_log::check(file.logs[0].clone()).findings;
    assert!(findings[0].detail.contains("log#trip=2"), "{findings:?}");
}

#[test]
fn a_layout_says_what_divides() {
    let layout = "time = { header = \"t\", unit = \"s\" }\n[channels]\nspeed = { header = \"v\", unit = \"m/s\" }\n";
    let text = "t,v,Trip,run\n0,1,7,a\n1,1,8,a\n0,1,7,b\n1,1,8,b\n";
    assert_eq!(
        names(&described(layout, text)),
        ["log#trip=7", "log#trip=8"]
    );
    let by_run = format!("split_by = [\"Run\"]\n{layout}");
    assert_eq!(names(&described(&by_run, text)), ["log#run=a", "log#run=b"]);
    let whole = format!("split_by = []\n{layout}");
    assert_eq!(names(&described(&whole, text)), ["log"]);
    let absent = Layout::from_toml_str("mine", &format!("split_by = [\"lap\"]\n{layout}")).unwrap();
    let error = read_bytes(
        Path::new("log.csv"),
        text.as_bytes(),
        &LayoutChoice::Described(absent),
    );
    assert!(error.unwrap_err().to_string().contains("\"lap\""));
}

/// Two cars at 10 Hz, half a row apart.
fn two_cars() -> Vec<(f64, f64)> {
    let car = |car: usize| {
        (0..3000).map(move |i| {
            let t_s = 0.1 * i as f64;
            let speed = [
                12.0 + 6.0 * (0.05 * t_s).sin(),
                20.0 + 8.0 * (0.07 * t_s).cos(),
            ];
            (t_s + 0.05 * car as f64, speed[car])
        })
    };
    let mut rows: Vec<(f64, f64)> = car(0).chain(car(1)).collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    rows
}

#[test]
fn interleaved_vehicles_without_a_name_are_refused() {
    for every in [1, 10] {
        let rows = two_cars();
        let kept = rows.iter().enumerate().filter(|(i, _)| i / 2 % every == 0);
        let (time_s, speed): (Vec<f64>, Vec<f64>) = kept.map(|(_, row)| *row).unzip();
        let log = crate::raw(time_s, [(Channel::Speed, speed)]);
        let error = drive_log::prepare(log, &drive_log::Preparation::default()).unwrap_err();
        assert!(error.to_string().contains("split_by"), "{error}");
    }
}

#[test]
fn vehicles_have_many_names() {
    for header in [
        "VIN",
        "car",
        "device_id",
        "Vehicle No",
        "Vehicle Number",
        "licence plate",
    ] {
        let mut text = format!("{header},time_s,speed_mps\n");
        for (i, (t_s, speed)) in two_cars().iter().enumerate() {
            text += &format!("{},{t_s:.2},{speed:.3}\n", ["WAUZ1", "WBA2"][i % 2]);
        }
        let file = read(text).unwrap();
        assert_eq!(file.logs.len(), 2, "{header}");
        for log in file.logs {
            assert_eq!(drive_log::check(log).findings, [], "{header}");
        }
    }
}

#[test]
fn any_column_may_name_the_driver() {
    let text = "time_s,speed_mps,Driver Name,gear\n0,1,Anna,1\n1,2,Anna,2\n2,3,Anna,2\n";
    let folder = std::env::temp_dir().join(format!("drive-log-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("trip.csv");
    std::fs::write(&path, text).unwrap();
    let of = |header| drive_log::constants_of_column(&path, &LayoutChoice::Auto, header).unwrap();
    assert_eq!(of("driver name")["trip"], "Anna");
    assert!(of("gear").is_empty() && of("Pilot").is_empty());
    std::fs::remove_dir_all(&folder).unwrap();
}
