//! `drivekit ctrl check`, and what `ctrl run` says that it does otherwise than its scenario asks.

use std::path::Path;

use serde_json::Value;

use crate::program::{Run, drivekit, drivekit_in};

/// The built-in straight scenario of a testbed, hardened, as a file with some of its lines changed or left out.
fn write(folder: &Path, testbed: &str, scenario: &str, change: impl Fn(&str) -> Option<String>) {
    let args = ["ctrl", "run", "--show-config", "--preset", "hardened"];
    let which = ["--testbed", testbed, "--scenario", scenario];
    let shown = drivekit(&[&args[..], &which].concat()).ok().stdout;
    let lines: Vec<String> = shown.lines().filter_map(change).collect();
    std::fs::write(folder.join("mine.toml"), lines.join("\n")).unwrap();
}

/// As it is, but for a key with another value.
fn with(key: &'static str, value: &'static str) -> impl Fn(&str) -> Option<String> {
    move |line| {
        let is_key = line.split(" = ").next() == Some(key);
        Some(if is_key {
            format!("{key} = {value}")
        } else {
            line.to_owned()
        })
    }
}

fn narrow(folder: &Path, half_width_m: &'static str) {
    let half_width = with("half_width_m", half_width_m);
    let margin = with("margin_m", "0.001");
    write(folder, "khepera", "straight", |line| {
        half_width(line).and_then(|line| margin(&line))
    });
}

fn check(folder: &Path, flags: &[&str]) -> Run {
    drivekit_in(
        folder,
        &[&["ctrl", "check", "--scenario", "mine.toml"], flags].concat(),
    )
}

fn document(folder: &Path) -> Value {
    check(folder, &["--format", "json"]).ok().json()
}

fn run(folder: &Path) -> Run {
    drivekit_in(
        folder,
        &["ctrl", "run", "--scenario", "mine.toml", "--duration", "5"],
    )
    .ok()
}

#[test]
fn built_in_scenarios_fit_as_asked_but_for_the_narrow_ones() {
    for (testbed, scenario, words) in [
        ("khepera", "on-off", "fits as asked"),
        ("khepera", "straight", "fits as asked"),
        ("robotarium", "track", "fits as asked"),
    ] {
        let run = drivekit(&[
            "ctrl",
            "check",
            "--testbed",
            testbed,
            "--scenario",
            scenario,
        ])
        .ok();
        assert!(
            run.stdout.ends_with(&format!("{words}\n")),
            "{}",
            run.stdout
        );
        for row in [
            "margin of the lane as driven",
            "way to a stand",
            "between the middles of two axles",
        ] {
            assert!(run.stdout.contains(row), "no `{row}` in {}", run.stdout);
        }
    }
}

#[test]
fn a_document_has_what_is_asked_and_what_there_is() {
    let args = [
        "ctrl",
        "check",
        "--testbed",
        "khepera",
        "--scenario",
        "on-off",
        "--format",
        "json",
    ];
    let document = drivekit(&args).ok().json();
    assert_eq!(document["schema"], "drivekit/ctrl-check/1");
    assert_eq!(
        (&document["scenario"], &document["slowed"]),
        (&"on-off".into(), &false.into())
    );
    assert_eq!(document["half_width_m"], 0.15);
    assert_eq!(document["least_distance_m"], 0.14);
    assert_eq!(document["driven_standstill_m"], 0.14);
    assert_eq!(document["standstill_m"], 0.0);
    assert_eq!(document["crossings"], 0);
    assert!(document["margin_m"].as_f64().unwrap() < 0.15);
}

#[test]
fn a_narrow_lane_is_said_to_be_driven_slowly_with_both_margins() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    narrow(folder, "0.03");
    let document = document(folder);
    assert_eq!(document["slowed"], true);
    let mm = |key: &str| format!("{:.1} mm", 1e3 * document[key].as_f64().unwrap());
    let (asked, driven) = (mm("margin_at_full_speed_m"), mm("margin_m"));
    assert_ne!(asked, driven);
    let text = check(folder, &[]).ok().stdout;
    assert!(
        text.ends_with("fits at a lower speed than asked for\n"),
        "{text}"
    );
    for (told, where_from) in [(text, "check"), (run(folder).stderr, "run")] {
        for words in [&asked, &driven, "half width of 30.0 mm", "not at 0.315 m/s"] {
            assert!(
                told.contains(words),
                "no `{words}` from {where_from}: {told}"
            );
        }
    }
}

#[test]
fn a_lane_that_fits_at_no_speed_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    narrow(folder, "0.005");
    let words = ["too narrow", "half width of 5.0 mm", "mm off"];
    let run = drivekit_in(folder, &["ctrl", "run", "--scenario", "mine.toml"]);
    let text = [&check(folder, &[]), &check(folder, &["--format", "json"])]
        .map(|ran| (ran.code, ran.stdout.clone()));
    for (code, text) in text.into_iter().chain([(run.code, run.stderr)]) {
        assert_eq!(code, 1, "{text}");
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    }
}

#[test]
fn what_a_file_leaves_out_is_said_with_what_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "khepera", "straight", |line| {
        let newer = ["radius_m", "max_wheel_acceleration_mps2", "every_robot"];
        let left_out = newer.iter().any(|key| line.starts_with(key));
        (!left_out).then(|| line.to_owned())
    });
    let stderr = run(folder).stderr;
    for words in [
        "radius is not given; 0.065 m",
        "`radius_m` under [scenario.body]",
        "5.0 m/s² is taken",
        "standstill gap is 140.0 mm, and not 0.0 mm",
    ] {
        assert!(stderr.contains(words), "no `{words}` in {stderr}");
    }
    let quiet = [
        "ctrl",
        "run",
        "--scenario",
        "mine.toml",
        "--duration",
        "1",
        "--quiet",
    ];
    assert_eq!(drivekit_in(folder, &quiet).ok().stderr, "");
}

#[test]
fn a_guard_that_a_file_leaves_out_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "khepera", "on-off", |line| {
        (!line.starts_with("max_course_angle_rad")).then(|| line.to_owned())
    });
    let text = check(folder, &[]).ok().stdout;
    assert!(text.contains("no limit on the angle to the path"), "{text}");
    assert!(
        text.ends_with("fits as asked; these settings lack guards\n"),
        "{text}"
    );
}

#[test]
fn a_path_that_meets_itself_is_said_to() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let point = |at: usize| {
        let turn = std::f64::consts::TAU * at as f64 / 64.0;
        format!("{},{}\n", 1.2 * turn.sin(), 0.6 * (2.0 * turn).sin())
    };
    let points: String = (0..64).map(point).collect();
    std::fs::write(folder.join("eight.csv"), format!("x_m,y_m\n{points}")).unwrap();
    let which = [
        "--scenario",
        "on-off",
        "--preset",
        "hardened",
        "--path",
        "eight.csv",
    ];
    let run = drivekit_in(folder, &[&["ctrl", "run"], &which[..]].concat()).ok();
    let check = drivekit_in(folder, &[&["ctrl", "check"], &which[..]].concat()).ok();
    for told in [run.stderr, check.stdout] {
        for words in [
            "meets itself at 1 place(s)",
            "along the path, and not as a chord",
        ] {
            assert!(told.contains(words), "no `{words}` in {told}");
        }
    }
}

#[test]
fn robots_that_start_on_each_other_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "khepera", "straight", with("start", "0.0"));
    check(folder, &[]).refused(&["robot 1"]);
    write(folder, "khepera", "straight", |line| {
        Some(line.replace("start = 0.6", "start = 0.1"))
    });
    check(folder, &[]).refused(&["starts 0.100 m from robot 0", "0.149 m are needed"]);
}

/// By bodies: the headway of the thesis holds, the robots touch.
#[test]
fn the_thesis_scenarios_in_which_robots_touch_end_with_exit_code_1() {
    for scenario in ["stop", "brake"] {
        let args = [
            "ctrl",
            "run",
            "--testbed",
            "robotarium",
            "--scenario",
            scenario,
        ];
        let run = drivekit(&args);
        assert_eq!(run.code, 1, "{}", run.stderr);
        assert!(
            run.stdout.contains("least distance between bodies"),
            "{}",
            run.stdout
        );
        assert!(run.stdout.contains("UNSAFE from"), "{}", run.stdout);
    }
}

#[test]
fn robots_that_start_on_each_other_are_an_error_with_every_preset() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "khepera", "straight", |line| {
        let is_start = line.starts_with("start = ");
        Some(if is_start { "start = 0.05" } else { line }.to_owned())
            .filter(|line| !line.starts_with("start_deviation_m"))
    });
    let text = std::fs::read_to_string(folder.path().join("mine.toml")).unwrap();
    let text = text.replacen("start = 0.05", "start = 0.06", 1);
    std::fs::write(folder.path().join("mine.toml"), text).unwrap();
    for preset in ["thesis", "hardened"] {
        let out = check(folder.path(), &["--preset", preset]);
        out.refused(&["robot 1 starts 0.010 m from robot 0"]);
    }
}

#[test]
fn disturbances_beyond_what_controllers_expect_are_noted_with_both_numbers() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "khepera", "straight", |line| {
        Some(match line {
            "position_noise_m = 0.0" => "position_noise_m = 0.012".to_owned(),
            "wheel_error = 0.0" => "wheel_error = 0.3".to_owned(),
            line => line.to_owned(),
        })
    });
    let note = "disturbances are larger than the controllers expect";
    for text in [run(folder.path()).stderr, check(folder.path(), &[]).stdout] {
        for words in [note, "12.0 mm and not 3.0 mm", "30.0 % and not 10.0 %"] {
            assert!(text.contains(words), "no `{words}` in {text}");
        }
    }
    write(folder.path(), "khepera", "straight", |line| {
        Some(line.to_owned())
    });
    assert!(!run(folder.path()).stderr.contains(note));
}

#[test]
fn numbers_in_another_unit_are_refused_and_the_message_says_which() {
    let folder = tempfile::tempdir().unwrap();
    for (key, value, words) in [
        ("half_width_m", "150.0", "mm or cm"),
        ("wheel_base_m", "88.5", "mm or cm"),
        ("heading_rad", "90.0", "degrees"),
        ("radius_m", "0.02", "the wheels stand out of it"),
    ] {
        write(folder.path(), "khepera", "straight", with(key, value));
        for command in ["check", "run"] {
            let run = drivekit_in(folder.path(), &["ctrl", command, "--scenario", "mine.toml"]);
            assert_eq!(run.code, 2, "{key}: {}", run.stderr);
            assert!(run.stderr.contains(words), "{key}: {}", run.stderr);
        }
    }
}

#[test]
fn documents_list_the_files_that_were_read() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "khepera", "straight", |line| {
        Some(line.to_owned())
    });
    let (json, short) = (["--format", "json"], ["--duration", "1"]);
    for args in [
        &["check", "--scenario", "mine.toml"][..],
        &["run", "--scenario", "mine.toml", "--duration", "1"],
        &[
            "campaign",
            "--scenario",
            "mine.toml",
            "--runs",
            "2",
            "--duration",
            "1",
        ],
    ] {
        let run = drivekit_in(folder.path(), &[&["ctrl"], args, &json].concat());
        let inputs = &run.ok().json()["inputs"];
        assert_eq!(inputs.as_array().unwrap().len(), 1, "{args:?}");
        assert_eq!(inputs[0]["path"], "mine.toml");
        assert_eq!(inputs[0]["sha256"].as_str().unwrap().len(), 64);
    }
    let log = ["ctrl", "run", "-o", "run.csv"];
    let built_in = drivekit_in(folder.path(), &[&log[..], &short, &json].concat());
    assert_eq!(built_in.ok().json()["inputs"].as_array().unwrap().len(), 0);
    let replay = drivekit_in(
        folder.path(),
        &[&["ctrl", "replay", "run.csv"][..], &json].concat(),
    );
    assert_eq!(replay.ok().json()["inputs"][0]["path"], "run.csv");
}

/// Poses that a link plays, also where the journal of the session would be.
#[test]
fn a_recording_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    for (recording, output) in [("run.csv", "run.csv"), ("run.partial.csv", "run.csv")] {
        let made = [
            "ctrl",
            "run",
            "--preset",
            "hardened",
            "--duration",
            "2",
            "-o",
        ];
        drivekit_in(folder.path(), &[&made[..], &[recording]].concat()).ok();
        let link = format!(
            "robots = [1, 2]\nlost_after_s = 5.0\n[poses]\nkind = \"recording\"\nfile = \"{recording}\"\npace = \"fast\"\n[commands]\nkind = \"none\"\n"
        );
        std::fs::write(folder.path().join("lab.toml"), link).unwrap();
        let before = std::fs::read(folder.path().join(recording)).unwrap();
        let args = [
            "ctrl",
            "run",
            "--live",
            "lab.toml",
            "--duration",
            "2",
            "-o",
            output,
        ];
        let run = drivekit_in(folder.path(), &args);
        assert_eq!(run.code, 2, "{}", run.stderr);
        assert!(
            run.stderr.contains("an input; name another file"),
            "{}",
            run.stderr
        );
        assert_eq!(
            std::fs::read(folder.path().join(recording)).unwrap(),
            before
        );
        std::fs::remove_file(folder.path().join(recording)).unwrap();
    }
}
