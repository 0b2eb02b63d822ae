//! Fit, write, read, predict.

use std::fs;

use tempfile::TempDir;

use crate::program::{drivekit, fixture};

#[test]
fn every_model_is_fitted_written_read_and_predicts() {
    let folder = TempDir::new().unwrap();
    let drives = fixture("drives");
    let test = fixture("drives/drive-12.csv");
    for kind in [
        "inverse",
        "exponential",
        "exponential-amplitude",
        "rise-time",
        "rise-time-exact",
        "transition-point",
        "profile",
        "profile-conditioned",
        "profile-onset",
        "constant",
        "straight",
        "smoothstep",
    ] {
        let file = folder.path().join(format!("{kind}.json"));
        let file = file.to_str().unwrap();
        drivekit(&["fit", &drives, "--model", kind, "-o", file]).ok();
        let document = drivekit(&["predict", &test, "--model", file, "--format", "json"])
            .ok()
            .json();
        let phases = document["logs"][0]["phases"].as_array().unwrap();
        assert!(!phases.is_empty(), "{kind}");
        for phase in phases {
            assert_eq!(
                phase["speed_mps"].as_array().unwrap().len() as u64,
                phase["samples"].as_u64().unwrap()
            );
            assert!(phase["in_band_pct"].as_f64().unwrap() >= 0.0);
        }
    }
}

#[test]
fn a_model_file_says_where_it_comes_from() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("model.json");
    let drive = fixture("drives/drive-01.csv");
    drivekit(&[
        "fit",
        &drive,
        "--model",
        "profile",
        "-o",
        file.to_str().unwrap(),
    ])
    .ok();
    let model: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap();
    assert_eq!(model["schema"], "drivekit/model/3");
    assert_eq!(model["behaviour"], "acceleration");
    assert_eq!(model["training"]["inputs"][0]["path"], drive);
    assert_eq!(model["config"]["min_gain"], 10.0);
}

#[test]
fn braking_has_its_own_models() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("braking.json");
    let file = file.to_str().unwrap();
    let drives = fixture("drives");
    drivekit(&[
        "fit",
        &drives,
        "--model",
        "profile-onset",
        "--phase",
        "braking",
        "-o",
        file,
    ])
    .ok();
    let test = fixture("drives/drive-12.csv");
    let document = drivekit(&["predict", &test, "--model", file, "--format", "json"])
        .ok()
        .json();
    let phases = document["logs"][0]["phases"].as_array().unwrap();
    assert!(!phases.is_empty());
    for phase in phases {
        assert!(phase["end_speed_mps"].as_f64() < phase["start_speed_mps"].as_f64());
        assert_eq!(phase["bands"].as_array().unwrap().len(), 4);
    }
}

#[test]
fn a_model_of_whole_phases_is_applied_to_whole_phases_and_says_so() {
    let folder = TempDir::new().unwrap();
    let (drives, test) = (fixture("drives"), fixture("drives/drive-12.csv"));
    let predicted = |extent: &str| {
        let file = folder.path().join(format!("{extent}.json"));
        let file = file.to_str().unwrap();
        let arguments = ["fit", &drives, "--model", "profile-onset", "--extent"];
        let fitted = drivekit(&[&arguments[..], &[extent, "-o", file]].concat()).ok();
        let shown = drivekit(&["model", "show", file]).ok();
        let run = drivekit(&["predict", &test, "--model", file, "--format", "json"]).ok();
        let said = run.stderr.contains("phases from begin to end");
        (
            fitted.stdout + &shown.stdout,
            said,
            run.json()["logs"][0]["phases"].clone(),
        )
    };
    let (cut_words, cut_said, cut) = predicted("threshold");
    let (whole_words, whole_said, whole) = predicted("whole");
    assert_eq!(cut_words.matches("phases cut at the threshold").count(), 2);
    assert_eq!(whole_words.matches("phases from begin to end").count(), 2);
    assert!(whole_said && !cut_said);
    let length_s = |phases: &serde_json::Value| {
        let phases = phases.as_array().unwrap().iter();
        let lengths = phases.map(|p| p["end_s"].as_f64().unwrap() - p["start_s"].as_f64().unwrap());
        lengths.sum::<f64>()
    };
    assert!(length_s(&whole) > length_s(&cut));
}

#[test]
fn functions_of_speed_can_be_fitted_to_all_samples() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("model.json");
    let file = file.to_str().unwrap();
    let drives = fixture("drives");
    let fit = |model: &str, to: &str| {
        drivekit(&[
            "fit", &drives, "--model", model, "--to", to, "-o", file, "--format", "json",
        ])
    };
    let points = |run: crate::program::Run| run.ok().json()["training_points"].as_u64().unwrap();
    assert!(points(fit("inverse", "samples")) > 10 * points(fit("inverse", "means")));
    fit("profile", "samples").refused(&["--to samples", "profile"]);
}

#[test]
fn a_prior_is_recorded_with_its_weight_and_changes_the_fit() {
    let folder = TempDir::new().unwrap();
    let own = fixture("drives/drive-01.csv");
    let prior = fixture("drives/drive-02.csv");
    let fit = |weight: &str| {
        let file = folder.path().join(format!("{weight}.json"));
        let arguments = [
            "fit",
            &own,
            "--prior",
            &prior,
            "--prior-weight",
            weight,
            "--model",
            "constant",
        ];
        drivekit(&[&arguments[..], &["-o", file.to_str().unwrap()]].concat()).ok();
        let text = fs::read_to_string(file).unwrap();
        serde_json::from_str::<serde_json::Value>(&text).unwrap()
    };
    let (alone, joint) = (fit("0"), fit("1"));
    assert_eq!(joint["training"]["prior_weight"], 1.0);
    assert_eq!(joint["training"]["prior_inputs"][0]["path"], prior);
    assert!(joint["training"]["phases"].as_u64() > alone["training"]["phases"].as_u64());
    assert_ne!(alone["model"]["accel_mps2"], joint["model"]["accel_mps2"]);
}

#[test]
fn a_model_is_shown_in_words_and_as_pictures() {
    let folder = TempDir::new().unwrap();
    let drives = fixture("drives");
    for model in [
        "inverse",
        "exponential",
        "rise-time",
        "transition-point",
        "profile",
        "profile-onset",
        "straight",
    ] {
        let file = folder.path().join("model.json");
        let file = file.to_str().unwrap();
        drivekit(&["fit", &drives, "--model", model, "-o", file]).ok();
        let plot = folder.path().join("model.svg");
        let text = drivekit(&["model", "show", file, "--plot", plot.to_str().unwrap()])
            .ok()
            .stdout;
        assert!(
            text.contains(model) && text.contains("0 → 50 km/h") && text.contains('●'),
            "{text}"
        );
        assert!(fs::read_to_string(plot).unwrap().contains("</svg>"));
    }
    let document = drivekit(&[
        "model",
        "show",
        folder.path().join("model.json").to_str().unwrap(),
        "--format",
        "json",
    ]);
    assert_eq!(
        document.ok().json()["examples"].as_array().unwrap().len(),
        3
    );
}

#[test]
fn a_file_that_is_no_model_is_refused_with_its_reason() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("model.json");
    for (text, words) in [
        ("{}", "no key `schema`"),
        ("[1,2", "not JSON"),
        (r#"{"schema":"drivekit/model/1"}"#, "fit the model anew"),
        (r#"{"schema":"other/thing/1"}"#, "is no model"),
    ] {
        fs::write(&file, text).unwrap();
        drivekit(&["model", "show", file.to_str().unwrap()]).refused(&["model.json", words]);
    }
    drivekit(&["model", "show", "absent.json"]).refused(&["absent.json"]);
}

#[test]
fn cruising_and_following_are_fitted_written_read_predicted_and_shown() {
    let folder = TempDir::new().unwrap();
    let drives = fixture("drives");
    for (model, figure, words) in [
        ("cruise", "hold_rmse_mps", "cruises at the limit"),
        ("idm", "gap_rmse_m", "would drive"),
        ("constant-time-gap", "gap_rmse_m", "to close a wrong gap"),
    ] {
        let file = folder.path().join(format!("{model}.json"));
        let file = file.to_str().unwrap();
        drivekit(&["fit", &drives, "--model", model, "-o", file]).ok();
        let shown = drivekit(&["model", "show", file]).ok().stdout;
        assert!(shown.contains(words), "{shown}");
        let document = drivekit(&["predict", &drives, "--model", file, "--format", "json"])
            .ok()
            .json();
        let logs = document["logs"].as_array().unwrap();
        let mut stretches = logs
            .iter()
            .flat_map(|log| log["phases"].as_array().unwrap());
        assert!(stretches.next().unwrap()[figure].is_number(), "{model}");
        drivekit(&["predict", &drives, "--model", file]).ok();
    }
    let file = folder.path().join("prior.json");
    let arguments = [
        "fit",
        &drives,
        "--model",
        "idm",
        "--prior",
        &drives,
        "-o",
        file.to_str().unwrap(),
    ];
    drivekit(&arguments).refused(&["--prior"]);
    drivekit(&["fit", &drives, "--model", "x", "-o", "x.json"]).refused(&["profile-onset", "idm"]);
}

#[test]
fn drives_are_added_to_a_model_as_if_they_had_been_there() {
    let folder = TempDir::new().unwrap();
    let file = |name: &str| folder.path().join(name).display().to_string();
    let read = |path: &str| -> serde_json::Value {
        serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
    };
    let (old, new) = (
        fixture("drives/drive-0[1-4].csv"),
        fixture("drives/drive-0[5-7].csv"),
    );
    let prior = fixture("drives/drive-12.csv");
    let (once, steps) = (file("once.json"), file("steps.json"));
    let braking = [
        "--model",
        "profile-onset",
        "--phase",
        "braking",
        "--min-gain",
        "8",
    ];
    let with_prior = [&braking[..], &["--prior", &prior, "-o"]].concat();
    drivekit(&[&["fit", &old, &new][..], &with_prior, &[&once]].concat()).ok();
    drivekit(&[&["fit", &old][..], &with_prior, &[&steps]].concat()).ok();
    // One log of before among the new ones, and the file itself is replaced.
    let known = fixture("drives/drive-04.csv");
    let update = |more: &[&str]| {
        drivekit(
            &[
                &["fit", &new, &known, "--update", &steps, "-o", &steps],
                more,
            ]
            .concat(),
        )
    };
    update(&["--min-gain", "5"]).refused(&["--min-gain 5", "--min-gain 8"]);
    update(&["--model", "profile"]).refused(&["--update", "--model"]);
    update(&["--phase", "braking"]).refused(&["--update", "--phase"]);
    for (name, given) in [("step", "0.2"), ("max-gap", "5"), ("slope-bandwidth", "30")] {
        let flag = format!("--{name}");
        update(&[&flag, given]).refused(&[&format!("{flag} {given}"), "leave it out"]);
    }
    let config = file("config.toml");
    for (text, words) in [
        ("max-gap = 5", "--max-gap 5"),
        ("[fit]\nraw = true", "without --raw"),
        ("phase = \"acceleration\"", "--phase braking"),
        ("[fit]\nprior = [\"x.csv\"]", "--prior"),
    ] {
        fs::write(&config, text).unwrap();
        update(&["--config", &config]).refused(&[words, "leave it out"]);
    }
    fs::write(&config, "min-gain = 8\n[evaluate]\nstep = 0.2").unwrap();
    let run = update(&["--min-gain", "8", "--config", &config]).ok();
    assert!(
        run.stderr.contains("has learnt from it already"),
        "{}",
        run.stderr
    );
    assert!(
        run.stdout.contains("were remembered") && run.stdout.contains("3 drives are new"),
        "{}",
        run.stdout
    );
    let (once, updated) = (read(&once), read(&steps));
    for key in ["model", "memory", "behaviour", "training"] {
        assert_eq!(once[key], updated[key], "{key}");
    }
    for key in ["model", "phase", "min_gain"] {
        assert_eq!(once["config"][key], updated["config"][key], "{key}");
    }
    update(&[]).refused(&["has learnt from all of these already"]);
    let newer = fixture("drives/drive-11.csv");
    let later = folder.path().join("later.json").display().to_string();
    let more = ["fit", &newer, &known, "--update", &steps, "-o", &later];
    let document = drivekit(&[&more[..], &["--format", "json"]].concat()).ok();
    assert_eq!(document.json()["files"]["twice"][0]["why"], "learnt");
    drivekit(&["fit", &prior, "--update", &steps, "-o", &steps])
        .refused(&["other drivers", "fit it anew"]);

    let shown = drivekit(&["model", "show", &steps]).ok().stdout;
    assert!(shown.contains("--update` can add drives"), "{shown}");
    let shown = drivekit(&["model", "show", &steps, "--format", "json"])
        .ok()
        .json();
    assert_eq!(shown["remembered"]["own_drives"], 7);
    assert_eq!(shown["remembered"]["other_drives"], 1);
    assert!(shown["file"].get("memory").is_none());
}
