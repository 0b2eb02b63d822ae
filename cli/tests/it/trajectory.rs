//! The speed ahead and whole trips, as users run them.

use tempfile::TempDir;

use crate::program::{drivekit, fixture};

/// Few samples and horizons, so that it takes seconds.
const QUICK: [&str; 8] = [
    "--task",
    "trajectory",
    "--horizons",
    "1,5",
    "--max-samples",
    "800",
    "--models",
    "blend,svr-rbf",
];

#[test]
fn models_beat_persistence_and_trips_are_predicted_from_the_road() {
    let mut arguments = vec!["evaluate", "--format", "json"];
    arguments.extend(QUICK);
    arguments.extend(["--require", "blend.skill_pct.5>=40"]);
    let document = drivekit(&arguments).ok().json();

    assert_eq!(document["task"], "trajectory");
    let rmse = |model: &str, horizon: &str| {
        document["horizons"][horizon][model]["rmse_mps"]
            .as_f64()
            .unwrap()
    };
    for baseline in [
        "persistence",
        "constant-acceleration",
        "decaying-acceleration",
        "ridge",
        "boosted-trees",
    ] {
        assert!(rmse("blend", "5") < rmse(baseline, "5"), "{baseline}");
        assert!(document["baselines"][baseline].is_object());
    }
    let coverage = document["horizons"]["5"]["blend"]["interval"]["coverage_pct"]
        .as_f64()
        .unwrap();
    assert!((80.0..=98.0).contains(&coverage), "{coverage}");
    let trials = document["trials"].as_array().unwrap();
    assert_eq!(trials.len(), 5);
    for trial in trials {
        assert_eq!(trial["by_trip"].as_array().unwrap().len(), 12);
        assert_eq!(trial["fits"][0]["status"], "optimal");
    }
    let known = &document["free_run"]["known"];
    assert!(known["distance"]["mean_abs_pct"].as_f64().unwrap() < 3.0);
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let run = |threads: &str| {
        let mut arguments = vec!["--threads", threads, "evaluate", "--format", "json"];
        arguments.extend(QUICK);
        let document = drivekit(&arguments).ok().json();
        document["horizons"].clone()
    };
    assert_eq!(run("1"), run("2"));
}

#[test]
fn a_missed_requirement_is_an_honest_negative() {
    let mut arguments = vec!["evaluate", "--require", "blend.skill_pct.1>=99.9"];
    arguments.extend(QUICK);
    assert_eq!(drivekit(&arguments).code, 1);
}

#[test]
fn models_of_the_speed_ahead_are_fitted_kept_and_used() {
    let folder = TempDir::new().unwrap();
    let (drives, test) = (fixture("drives"), fixture("drives/drive-12.csv"));
    for (kind, rmse_mps) in [
        ("svr-linear", 1.94),
        ("svr-quadratic", 1.68),
        ("svr-rbf", 1.59),
        ("least-squares", 1.53),
        ("blend", 1.31),
        ("ridge", 1.91),
        ("boosted-trees", 1.19),
    ] {
        let file = folder.path().join(format!("{kind}.json"));
        let file = file.to_str().unwrap();
        drivekit(&[
            "fit",
            &drives,
            "--model",
            kind,
            "--horizons",
            "2,5",
            "-o",
            file,
        ])
        .ok();
        let document = drivekit(&[
            "predict",
            &test,
            "--model",
            file,
            "--horizon",
            "5",
            "--format",
            "json",
        ])
        .ok()
        .json();
        let horizons = document["logs"][0]["horizons"].as_array().unwrap();
        assert_eq!(horizons.len(), 1, "{kind}");
        let found = horizons[0]["rmse_mps"].as_f64().unwrap();
        assert!((found / rmse_mps - 1.0).abs() < 0.05, "{kind}: {found}");
        let shown = drivekit(&["model", "show", file]).ok();
        assert!(shown.stdout.contains("speed-ahead"), "{}", shown.stdout);
        let refused = drivekit(&["predict", &test, "--model", file, "--horizon", "7"]);
        assert_eq!(refused.code, 2);
        assert!(
            refused.stderr.contains("--horizons 7"),
            "{}",
            refused.stderr
        );
    }
}

#[test]
fn a_trip_driver_drives_the_road_of_a_log() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("trips.json");
    let file = file.to_str().unwrap();
    drivekit(&[
        "fit",
        &fixture("drives"),
        "--model",
        "trip-driver",
        "-o",
        file,
    ])
    .ok();
    let document = drivekit(&[
        "predict",
        &fixture("drives/drive-03.csv"),
        "--model",
        file,
        "--format",
        "json",
    ])
    .ok()
    .json();
    let trip = &document["logs"][0];
    let ratio =
        trip["duration_s"].as_f64().unwrap() / trip["measured_duration_s"].as_f64().unwrap();
    assert!((0.9..1.1).contains(&ratio), "{ratio}");
    let speeds = trip["speed_mps"].as_array().unwrap();
    assert!(speeds.iter().all(|v| v.as_f64().unwrap() >= 0.0));
}

#[test]
fn what_does_not_fit_together_is_refused() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("model.json");
    let file = file.to_str().unwrap();
    let cycle = fixture("cycles/udds.csv");
    for (arguments, words) in [
        (
            vec!["fit", &cycle, "--model", "trip-driver", "-o", file],
            "limit",
        ),
        (
            vec![
                "fit",
                &cycle,
                "--model",
                "svr-rbf",
                "--horizons",
                "0",
                "-o",
                file,
            ],
            "horizon",
        ),
        (
            vec!["evaluate", "--task", "trajectory", "--models", "profile"],
            "phases",
        ),
        (
            vec!["evaluate", "--task", "trajectory", "--folds", "1"],
            "folds",
        ),
    ] {
        let run = drivekit(&arguments);
        assert_eq!(run.code, 2, "{arguments:?}");
        assert!(run.stderr.contains(words), "{}", run.stderr);
    }
}

/// A drive whose speed goes to where the pedal points, which is moved every 4 s.
fn pedalled(seed: u32, has_pedal: bool) -> String {
    let level = |block: u32| {
        let mixed = (block + 1000 * seed + 1).wrapping_mul(2_654_435_761);
        f64::from(mixed >> 8) / f64::from(1_u32 << 24)
    };
    let header = if has_pedal {
        "time_s,speed_mps,accelerator_pedal_pct"
    } else {
        "time_s,speed_mps"
    };
    let mut text = format!("{header}\n");
    let mut speed = 10.0;
    for i in 0..1500 {
        let pedal = 100.0 * level(i / 20);
        speed += 0.2 * (0.3 * pedal - speed) / 5.0;
        text += &format!("{:.1},{speed:.4}", 0.2 * f64::from(i));
        text += &if has_pedal {
            format!(",{pedal:.2}\n")
        } else {
            "\n".to_owned()
        };
    }
    text
}

#[test]
fn what_the_driver_does_is_told_and_said() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let logs: Vec<String> = (0..6).map(|seed| at(&format!("{seed}.csv"))).collect();
    for (seed, path) in logs.iter().enumerate() {
        std::fs::write(path, pedalled(seed as u32, true)).unwrap();
    }
    let drives = || logs.iter().map(String::as_str);
    let report = at("ahead.html");
    let mut arguments = vec!["evaluate", "--step", "0.2", "--report", &report];
    arguments.extend(&QUICK[..6]);
    arguments.extend(["--models", "least-squares"]);
    arguments.extend(drives());
    let text = drivekit(&arguments).ok().stdout;
    for said in [
        "ridge+channels",
        "+channels: told of accelerator_pedal_pct as well.",
        "Intervals of 90 %",
    ] {
        assert!(text.contains(said), "{said}: {text}");
    }
    let against = |line: &&str| line.starts_with("5 s") && line.matches("+channels").count() == 2;
    assert_eq!(text.lines().filter(against).count(), 1, "{text}");

    let (model, untold) = (at("ahead.json"), at("untold.csv"));
    std::fs::write(&untold, pedalled(9, false)).unwrap();
    let mut arguments = vec!["fit", "--model", "ridge", "--step", "0.2", "-o", &model];
    arguments.extend(["--horizons", "1,5"]);
    arguments.extend(drives());
    drivekit(&arguments).ok();
    let shown = drivekit(&["model", "show", &model]).ok().stdout;
    assert!(
        shown.contains("told accelerator_pedal_pct, which 6 of 6 drives had"),
        "{shown}"
    );
    let predicted = drivekit(&["predict", &untold, "--step", "0.2", "--model", &model]).ok();
    let note = "1 of 1 drive predicted without what the driver does";
    assert!(predicted.stderr.contains(note), "{}", predicted.stderr);
}
