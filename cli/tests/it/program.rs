//! Running the program.

use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

pub(crate) use crate::shared::shared;

pub(crate) struct Run {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

pub(crate) fn drivekit(args: &[&str]) -> Run {
    run(Command::new(env!("CARGO_BIN_EXE_drivekit"))
        .args(args)
        .stdin(Stdio::null())
        .output())
}

pub(crate) fn drivekit_in(folder: &Path, args: &[&str]) -> Run {
    run(Command::new(env!("CARGO_BIN_EXE_drivekit"))
        .args(args)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output())
}

pub(crate) fn run(output: std::io::Result<Output>) -> Run {
    let output = output.unwrap();
    Run {
        code: output.status.code().expect("not killed by a signal"),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

impl Run {
    pub(crate) fn ok(self) -> Self {
        assert_eq!(self.code, 0, "{}", self.stderr);
        self
    }

    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).unwrap()
    }

    /// An error as it should be: exit code 2, no panic, and each of the words in its message.
    pub(crate) fn refused(&self, words: &[&str]) {
        assert_eq!(
            self.code, 2,
            "stdout {} stderr {}",
            self.stdout, self.stderr
        );
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        assert!(self.stdout.is_empty(), "{}", self.stdout);
        for word in words {
            assert!(
                self.stderr.contains(word),
                "no `{word}` in: {}",
                self.stderr
            );
        }
    }
}

pub(crate) fn fixture(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../fixtures")
        .join(name);
    path.to_str().unwrap().to_owned()
}

/// Whether the program under test inherits that a signal is ignored, as under `nohup`; known on Linux only.
pub(crate) fn is_ignored(signal: u32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Sends a signal, `-INT` say.
pub(crate) fn signal(child: &std::process::Child, signal: &str) {
    let pid = child.id().to_string();
    let sent = Command::new("kill").args([signal, &pid]).status();
    assert!(sent.unwrap().success());
}

/// Poses of one robot on a part of a circle, `poses.csv` in the folder.
pub(crate) fn write_poses(folder: &Path) {
    let mut poses = "time_s,robot,x_m,y_m,heading_rad\n".to_owned();
    for k in 0..200 {
        let (t, angle) = (0.05 * f64::from(k), 0.01 * f64::from(k));
        let heading = angle + std::f64::consts::FRAC_PI_2;
        poses += &format!("{t},0,{},{},{heading}\n", angle.cos(), angle.sin());
    }
    std::fs::write(folder.join("poses.csv"), poses).unwrap();
}
