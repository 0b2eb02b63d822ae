//! Simulated drives: same seed, same bytes.

use std::fs;

use tempfile::TempDir;

use crate::program::{drivekit, fixture};

#[test]
fn the_shipped_drives_are_what_synth_writes() {
    let folder = TempDir::new().unwrap();
    drivekit(&["synth", "--noise", "-o", folder.path().to_str().unwrap()]).ok();
    for name in ["drive-01.csv", "drive-12.csv", "truth.json"] {
        let made = fs::read(folder.path().join(name)).unwrap();
        let shipped = fs::read(fixture(&format!("drives/{name}"))).unwrap();
        assert!(
            made == shipped,
            "{name} differs; `just fixtures` makes them anew"
        );
    }
}

#[test]
fn the_shipped_drives_are_small() {
    let total: u64 = fs::read_dir(fixture("drives"))
        .unwrap()
        .map(|e| e.unwrap().metadata().unwrap().len())
        .sum();
    assert!(total < 5_000_000, "{total} bytes");
}

#[test]
fn the_seed_decides() {
    let make = |seed: &str| {
        let folder = TempDir::new().unwrap();
        drivekit(&[
            "synth",
            "-o",
            folder.path().to_str().unwrap(),
            "--drives",
            "1",
            "--duration",
            "120",
            "--seed",
            seed,
        ])
        .ok();
        fs::read(folder.path().join("drive-01.csv")).unwrap()
    };
    assert_eq!(make("7"), make("7"));
    assert_ne!(make("7"), make("8"));
}
