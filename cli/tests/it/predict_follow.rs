//! Predictions of a drive that is still going on.

use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Child, Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{Run, drivekit, fixture, run};

fn following(models: &[&str], more: &[&str]) -> Child {
    let models = models.iter().flat_map(|model| ["--model", model]);
    Command::new(env!("CARGO_BIN_EXE_drivekit"))
        .args(["predict", "-", "--follow"])
        .args(models)
        .args(more)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn follow(text: &str, models: &[&str], more: &[&str]) -> Run {
    let mut child = following(models, more);
    let mut stdin = child.stdin.take().unwrap();
    let text = text.to_owned();
    // A program that refuses the input stops reading.
    let writer = std::thread::spawn(move || drop(stdin.write_all(text.as_bytes())));
    let run = run(child.wait_with_output());
    writer.join().unwrap();
    run
}

/// Models of the speed ahead, of acceleration and of braking.
fn models(folder: &TempDir) -> [String; 3] {
    let fitted = |name: &str, more: &[&str]| {
        let file = folder.path().join(name).display().to_string();
        let drives = fixture("drives/drive-0[1-4].csv");
        drivekit(&[&["fit", &drives, "-o", &file], more].concat()).ok();
        file
    };
    [
        fitted("ahead.json", &["--model", "ridge", "--horizons", "1,5"]),
        fitted("acceleration.json", &["--model", "profile-onset"]),
        fitted(
            "braking.json",
            &["--model", "profile", "--phase", "braking"],
        ),
    ]
}

fn lines(text: &str) -> Vec<Value> {
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

fn of<'a>(lines: &'a [Value], event: &str) -> Vec<&'a Value> {
    lines.iter().filter(|line| line["event"] == event).collect()
}

#[test]
fn a_drive_is_predicted_while_it_goes_on() {
    let folder = TempDir::new().unwrap();
    let [ahead, acceleration, braking] = &models(&folder);
    let drive = fixture("drives/drive-12.csv");
    let text = fs::read_to_string(&drive).unwrap();
    let all = [ahead.as_str(), acceleration, braking];
    let run = follow(&text, &all, &["--format", "json"]).ok();
    assert!(
        run.stderr.contains("road ahead is not known"),
        "{}",
        run.stderr
    );
    let lines = lines(&run.stdout);
    assert_eq!(of(&lines, "ahead").len(), 595);
    for line in of(&lines, "ahead") {
        let horizons = line["horizons"].as_array().unwrap();
        assert_eq!(horizons.len(), 2);
        for horizon in horizons {
            let at = |key: &str| horizon[key].as_f64().unwrap();
            assert!(at("low_mps") <= at("speed_mps") && at("speed_mps") <= at("high_mps"));
        }
    }
    // The phases that count are those that `predict` finds in the whole.
    for (model, phase) in [(acceleration, "acceleration"), (braking, "braking")] {
        let whole = drivekit(&["predict", &drive, "--model", model, "--format", "json"])
            .ok()
            .json();
        let whole: Vec<f64> = whole["logs"][0]["phases"]
            .as_array()
            .unwrap()
            .iter()
            .map(|phase| phase["start_s"].as_f64().unwrap())
            .collect();
        let ends = of(&lines, "phase-ends");
        let counting = ends
            .iter()
            .filter(|e| e["phase"] == phase && e["counts"] == true);
        let followed: Vec<f64> = counting.map(|e| e["begin_s"].as_f64().unwrap()).collect();
        assert_eq!(followed.len(), whole.len(), "{phase}");
        for (followed, whole) in followed.iter().zip(&whole) {
            assert!((followed - whole).abs() < 1e-6);
        }
        let begins = of(&lines, "phase-begins");
        assert!(begins.iter().filter(|e| e["phase"] == phase).count() >= whole.len());
    }

    let one = follow(
        &text,
        &all[..1],
        &["--format", "json", "--horizon", "5", "-q"],
    )
    .ok();
    let horizons = self::lines(&one.stdout)[0]["horizons"].clone();
    assert_eq!(horizons.as_array().unwrap().len(), 1);
    assert_eq!(
        (horizons[0]["horizon_s"].as_f64(), one.stderr.as_str()),
        (Some(5.0), "")
    );

    let said = follow(&text, &all, &[]).ok().stdout;
    let heads = ["at s", "ahead", "began at", "ended after"];
    assert!(heads.iter().all(|words| said.contains(words)), "{said}");
}

#[test]
fn a_prediction_is_printed_while_the_drive_goes_on() {
    let folder = TempDir::new().unwrap();
    let [ahead, ..] = &models(&folder);
    let text = fs::read_to_string(fixture("drives/drive-12.csv")).unwrap();
    let mut child = following(&[ahead], &["--format", "json"]);
    let mut stdin = child.stdin.take().unwrap();
    let rows: Vec<&str> = text.split_inclusive('\n').take(80).collect();
    stdin.write_all(rows.concat().as_bytes()).unwrap();
    stdin.flush().unwrap();
    // Without a line, the test waits; the stream is still open.
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap())
        .read_line(&mut line)
        .unwrap();
    assert_eq!(serde_json::from_str::<Value>(&line).unwrap()["time_s"], 5.0);
    // The reader is gone: the next line ends the program.
    let rest: String = text.split_inclusive('\n').skip(80).take(40).collect();
    let _ = stdin.write_all(rest.as_bytes());
    drop(stdin);
    assert!(child.wait().unwrap().success());
}

#[test]
fn gaps_start_anew_and_bad_rows_are_left_out() {
    let folder = TempDir::new().unwrap();
    let [ahead, acceleration, _] = &models(&folder);
    let row = |k: usize, offset_s: f64| {
        let (time_s, speed) = (0.1 * k as f64 + offset_s, (0.15 * k as f64).min(15.0));
        match k {
            30 => "fast,,\n".to_owned(),
            40 => format!("{time_s},1e9,13.9\n"),
            50 => format!("{time_s},{speed},wide\n"),
            _ => format!("{time_s},{speed},13.9\n"),
        }
    };
    let piece = |offset_s| (0..150).map(move |k| row(k, offset_s)).collect::<String>();
    let text = format!(
        "time_s,speed_mps,speed_limit_mps\n{}{}",
        piece(0.0),
        piece(100.0)
    );
    let run = follow(&text, &[ahead, acceleration], &["--format", "json"]).ok();
    for words in ["a new piece starts", "left out", "counted as missing"] {
        assert!(run.stderr.contains(words), "{words}: {}", run.stderr);
    }
    let lines = lines(&run.stdout);
    let times: Vec<f64> = of(&lines, "ahead")
        .iter()
        .map(|e| e["time_s"].as_f64().unwrap())
        .collect();
    assert!(
        times.contains(&5.0) && !times.contains(&100.0) && times.contains(&105.0),
        "{times:?}"
    );
    let begins: Vec<f64> = of(&lines, "phase-begins")
        .iter()
        .map(|e| e["begin_s"].as_f64().unwrap())
        .collect();
    assert_eq!(begins.len(), 2, "{begins:?}");
    assert_eq!(of(&lines, "phase-ends").len(), 2);
}

#[test]
fn what_cannot_be_followed_is_refused_with_what_to_do() {
    let folder = TempDir::new().unwrap();
    let [ahead, acceleration, braking] = &models(&folder);
    let drive = fixture("drives/drive-12.csv");
    let text = fs::read_to_string(&drive).unwrap();
    drivekit(&["predict", &drive, "--model", ahead, "--model", braking]).refused(&["--follow"]);
    drivekit(&["predict", &drive, "--model", ahead, "--follow"]).refused(&["stdin"]);
    follow(&text, &[ahead, ahead], &[]).refused(&["two models"]);
    follow(&text, &[ahead], &["--step", "1"]).refused(&["every 1 s"]);
    follow(&text, &[ahead], &["--horizon", "3"]).refused(&["--horizon 3"]);
    follow(&text, &[acceleration], &["--horizon", "3"]).refused(&["--horizon"]);
    follow(&text, &[ahead], &["--min-gain", "5"]).refused(&["--follow"]);
    follow("time_s,speed_mps\n0,1\n0.1,1\n", &[ahead], &[]).refused(&["limit"]);
    // A file of before has no phases.
    let mut file: Value = serde_json::from_str(&fs::read_to_string(acceleration).unwrap()).unwrap();
    file.as_object_mut().unwrap().remove("memory");
    let old = folder.path().join("old.json").display().to_string();
    fs::write(&old, file.to_string()).unwrap();
    follow(&text, &[&old], &[]).refused(&["fit it anew"]);
    drivekit(&["fit", &drive, "--update", &old, "-o", &old]).refused(&["--update", "fit it anew"]);
    drivekit(&["fit", &drive, "--update", ahead, "-o", &old]).refused(&["ridge", "profile-onset"]);
}
