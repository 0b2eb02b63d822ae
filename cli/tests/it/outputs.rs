//! Where results are written: never over an input, a device or each other, and whole or not at all.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::{FileTypeExt as _, PermissionsExt as _, symlink};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::program::{drivekit, drivekit_in, fixture};

/// Two drives and a vehicle file.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::create_dir(folder.path().join("logs")).unwrap();
    for name in ["drive-01.csv", "drive-02.csv"] {
        let from = fixture(&format!("drives/{name}"));
        fs::copy(from, folder.path().join("logs").join(name)).unwrap();
    }
    let vehicle = drivekit(&["vehicle", "show", "b250e"]).ok().stdout;
    fs::write(folder.path().join("car.toml"), vehicle).unwrap();
    folder
}

/// Everything in a folder, to its bottom.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(contents(&path));
        } else {
            found.push((path.display().to_string(), fs::read(&path).unwrap()));
        }
    }
    found.sort();
    found
}

#[test]
fn an_output_that_is_an_input_is_refused() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    symlink("logs/drive-01.csv", at("link.csv")).unwrap();
    fs::hard_link(at("logs/drive-02.csv"), at("hard.csv")).unwrap();
    symlink("car.toml", at("other.toml")).unwrap();
    fs::write(at("settings.toml"), "step = 0.1\n").unwrap();
    let trained = ["fit", "logs", "--model", "profile", "-o", "model.json"];
    drivekit_in(folder.path(), &trained).ok();
    symlink("model.json", at("model.svg")).unwrap();
    fs::copy(at("logs/drive-01.csv"), at("logs/drive-03.csv")).unwrap();
    let before = contents(folder.path());
    let energy = ["energy", "--vehicle", "b250e", "--trace"];
    for args in [
        &["logs/drive-01.csv", "logs/drive-01.csv"][..],
        &["link.csv", "logs/drive-01.csv"],
        &["hard.csv", "logs/drive-02.csv"],
        &["logs/../logs/drive-01.csv", "./logs/drive-01.csv"],
        // A folder or a pattern stands for its logs.
        &["logs/drive-03.csv", "logs"],
        &["logs/drive-03.csv", "logs/*.csv"],
        // As a shell expands `--trace logs/*.csv`.
        &[
            "logs/drive-01.csv",
            "logs/drive-02.csv",
            "logs/drive-03.csv",
            "logs/drive-01.csv",
        ],
    ] {
        let run = drivekit_in(folder.path(), &[&energy[..], args].concat());
        run.refused(&["--trace", args[0], "input"]);
    }
    let logs = "logs/drive-01.csv";
    for args in [
        &["calibrate", logs, "--vehicle", "car.toml", "-o", "car.toml"][..],
        &[
            "calibrate",
            logs,
            "--vehicle",
            "other.toml",
            "-o",
            "car.toml",
        ],
        &[
            "calibrate",
            logs,
            "--vehicle",
            "b250e",
            "-o",
            "settings.toml",
            "--config",
            "settings.toml",
        ],
        &["model", "show", "model.json", "--plot", "model.svg"],
    ] {
        drivekit_in(folder.path(), args).refused(&["overwrite an input"]);
    }
    assert!(contents(folder.path()) == before, "something was written");
}

#[test]
fn stdin_is_an_input_too() {
    let folder = folder();
    let log = folder.path().join("logs/drive-01.csv");
    let output = Command::new(env!("CARGO_BIN_EXE_drivekit"))
        .args([
            "energy",
            "-",
            "--vehicle",
            "b250e",
            "--trace",
            "logs/drive-01.csv",
        ])
        .current_dir(folder.path())
        .stdin(fs::File::open(&log).unwrap())
        .output();
    crate::program::run(output).refused(&["overwrite an input"]);
    assert_eq!(
        fs::read(log).unwrap(),
        fs::read(fixture("drives/drive-01.csv")).unwrap()
    );
}

#[test]
fn a_pattern_after_the_flag_loses_no_log() {
    let folder = folder();
    let before = contents(folder.path());
    let args = [
        "fit",
        "--model",
        "profile",
        "-o",
        "logs/drive-01.csv",
        "logs/drive-02.csv",
    ];
    drivekit_in(folder.path(), &args).refused(&["--output", ".json", "logs/drive-01.csv"]);
    assert!(contents(folder.path()) == before);
}

#[test]
fn two_outputs_in_one_file_are_refused() {
    let folder = folder();
    fs::write(folder.path().join("there.html"), "old").unwrap();
    symlink("there.html", folder.path().join("link.csv")).unwrap();
    symlink("new.html", folder.path().join("new.csv")).unwrap();
    let energy = ["energy", "logs", "--vehicle", "b250e"];
    for (trace, report) in [("link.csv", "there.html"), ("new.csv", "./new.html")] {
        let more = ["--trace", trace, "--report", report];
        let run = drivekit_in(folder.path(), &[&energy[..], &more].concat());
        run.refused(&["--trace", "--report", "one file"]);
    }
    assert_eq!(
        fs::read_to_string(folder.path().join("there.html")).unwrap(),
        "old"
    );
}

#[test]
fn stdout_is_an_output_too() {
    let folder = folder();
    let text = folder.path().join("text.json");
    let output = Command::new(env!("CARGO_BIN_EXE_drivekit"))
        .args(["fit", "logs", "--model", "profile", "-o", "text.json"])
        .current_dir(folder.path())
        .stdout(fs::File::create(&text).unwrap())
        .output();
    crate::program::run(output).refused(&["--output and stdout are one file"]);
}

#[test]
fn the_name_of_a_file_decides_its_format_or_is_refused() {
    let folder = folder();
    let before = contents(folder.path());
    let log = "logs/drive-01.csv";
    for (args, words) in [
        (
            &["segment", log, "--plot", "x.png"][..],
            &["--plot", ".svg", "x.png"][..],
        ),
        (&["evaluate", "--report", "x.pdf"], &["--report", ".html"]),
        (
            &["energy", log, "--vehicle", "b250e", "--trace", "x.parquet"],
            &["--trace", ".csv"],
        ),
        (
            &["fit", log, "--model", "profile", "-o", "x.toml"],
            &["--output", ".json"],
        ),
        (
            &["fit", log, "--model", "profile", "-o", "x"],
            &["--output", ".json"],
        ),
        (
            &["calibrate", log, "--vehicle", "b250e", "-o", "x.json"],
            &["--output", ".toml"],
        ),
        (
            &["road", log, "-o", "x.csv"],
            &["--output", ".toml", ".json"],
        ),
        (
            &["ctrl", "run", "-o", "x.txt"],
            &["--output", ".parquet", ".csv", ".mcap"],
        ),
        (
            &["ctrl", "run", "--report", "x.svg"],
            &["--report", ".html"],
        ),
        (
            &["ctrl", "campaign", "--report", "-"],
            &["--report", ".html"],
        ),
    ] {
        drivekit_in(folder.path(), args).refused(words);
    }
    assert!(contents(folder.path()) == before);
    drivekit_in(folder.path(), &["segment", log, "--plot", "X.SVG"]).ok();
}

#[test]
fn a_device_or_a_pipe_is_written_to_and_stays() {
    let folder = folder();
    let fit = |output: &str| {
        let args = ["-q", "fit", "logs", "--model", "profile", "-o", output];
        drivekit_in(folder.path(), &args)
    };
    let printed = fit("/dev/stdout").ok().stdout;
    assert!(
        printed.starts_with('{') && printed.contains("written to"),
        "{printed}"
    );

    let pipe = folder.path().join("pipe");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read_to_string(pipe).unwrap()
    });
    fit("pipe").ok();
    assert!(reader.join().unwrap().starts_with('{'));
    assert!(fs::metadata(&pipe).unwrap().file_type().is_fifo());

    let null = folder.path().join("null");
    let made = Command::new("mknod")
        .arg(&null)
        .args(["c", "1", "3"])
        .status();
    if made.is_ok_and(|status| status.success()) {
        fit("null").ok();
        assert!(fs::metadata(&null).unwrap().file_type().is_char_device());
    }
}

#[test]
fn a_link_is_followed_and_permissions_are_kept() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("models")).unwrap();
    fs::write(at("models/mine.json"), "old").unwrap();
    fs::set_permissions(at("models/mine.json"), fs::Permissions::from_mode(0o640)).unwrap();
    symlink("models/mine.json", at("first.json")).unwrap();
    symlink("first.json", at("link.json")).unwrap();
    symlink("models/new.json", at("dangling.json")).unwrap();
    for name in ["link.json", "dangling.json"] {
        let args = ["fit", "logs", "--model", "profile", "-o", name];
        drivekit_in(folder.path(), &args).ok();
        assert!(at(name).is_symlink());
    }
    assert!(at("first.json").is_symlink());
    let mine = fs::read_to_string(at("models/mine.json")).unwrap();
    assert!(mine.starts_with('{'));
    let mode = fs::metadata(at("models/mine.json"))
        .unwrap()
        .permissions()
        .mode();
    assert_eq!(mode & 0o777, 0o640);
    assert_eq!(fs::read_to_string(at("models/new.json")).unwrap(), mine);
    symlink("round.json", at("round.json")).unwrap();
    let args = ["fit", "logs", "--model", "profile", "-o", "round.json"];
    drivekit_in(folder.path(), &args).refused(&["round.json", "links"]);
}

#[test]
fn synth_asks_before_it_writes_among_drives() {
    let folder = folder();
    let before = contents(folder.path());
    let synth = ["synth", "-o", "logs", "--drives", "1", "--duration", "60"];
    drivekit_in(folder.path(), &synth).refused(&["logs", "drive-01.csv", "--force"]);
    assert!(contents(folder.path()) == before);
    let run = drivekit_in(folder.path(), &[&synth[..], &["--force"]].concat()).ok();
    assert!(run.stderr.contains("drive-02.csv"), "{}", run.stderr);
    let there = fs::read(folder.path().join("logs/drive-02.csv")).unwrap();
    assert_eq!(there, fs::read(fixture("drives/drive-02.csv")).unwrap());
}

/// Of names in a folder, those of files that are being written.
fn unfinished(folder: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names
        .filter(|name| name.starts_with(".drivekit-"))
        .collect()
}

#[test]
fn a_signal_leaves_no_unfinished_file() {
    for (signal, number) in [("-INT", 2), ("-TERM", 15), ("-HUP", 1)] {
        if crate::program::is_ignored(number) {
            continue;
        }
        let folder = TempDir::new().unwrap();
        let drives = folder.path().join("s");
        let mut child = Command::new(env!("CARGO_BIN_EXE_drivekit"))
            .args([
                "-q",
                "synth",
                "-o",
                "s",
                "--drives",
                "20",
                "--duration",
                "20000",
            ])
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let start = Instant::now();
        while unfinished(&drives).is_empty() {
            assert!(start.elapsed() < Duration::from_secs(120), "never wrote");
            assert!(
                child.try_wait().unwrap().is_none(),
                "too fast to be stopped"
            );
        }
        crate::program::signal(&child, signal);
        let status = child.wait().unwrap();
        assert_eq!(
            std::os::unix::process::ExitStatusExt::signal(&status),
            i32::try_from(number).ok()
        );
        assert_eq!(unfinished(&drives), Vec::<String>::new());
    }
}

#[test]
fn what_was_started_to_ignore_hangups_ignores_them() {
    let folder = TempDir::new().unwrap();
    let script = "trap '' HUP; \"$0\" -q synth -o s --drives 3 --duration 20000 & child=$!; \
        while ! ls s/.drivekit-* >/dev/null 2>&1; do kill -0 $child || exit 3; done; kill -HUP $child; wait $child";
    let status = Command::new("bash")
        .args(["-c", script, env!("CARGO_BIN_EXE_drivekit")])
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .unwrap();
    assert_eq!(status.code(), Some(0));
}
