//! Run logs that were damaged or cut off, as users meet them.

use std::fs;
use std::path::Path;

use crate::program::drivekit_in;

fn logged(folder: &Path, name: &str) -> Vec<u8> {
    let args = ["ctrl", "run", "--duration", "1", "-o", name, "--quiet"];
    drivekit_in(folder, &args).ok();
    fs::read(folder.join(name)).unwrap()
}

#[test]
fn a_damaged_run_log_is_an_error_and_one_cut_off_a_note() {
    let folder = tempfile::tempdir().unwrap();
    for (name, place) in [
        ("run.csv", ", line "),
        ("run.mcap", ", after the record of tick "),
    ] {
        let whole = logged(folder.path(), name);
        let replay = |bytes: &[u8]| {
            fs::write(folder.path().join(name), bytes).unwrap();
            drivekit_in(folder.path(), &["ctrl", "replay", name])
        };
        let mut damaged = whole.clone();
        damaged[whole.len() * 3 / 4] ^= 1;
        let out = replay(&damaged);
        assert_eq!(out.code, 2, "{}", out.stdout);
        let error = &out.stderr;
        assert!(error.contains(name) && error.contains("damaged"), "{error}");
        assert!(error.contains(place), "{error}");
        if name == "run.csv" {
            let out = replay(&whole[..whole.len() - 20]).ok();
            assert!(out.stderr.contains("run.csv is cut off"), "{}", out.stderr);
            assert!(
                out.stdout.contains("98 decisions, every one the same"),
                "{}",
                out.stdout
            );
        }
    }
}

#[test]
fn csv_logs_have_a_row_per_decision() {
    let folder = tempfile::tempdir().unwrap();
    let text = String::from_utf8(logged(folder.path(), "run.csv")).unwrap();
    let (names, rows) = text.split_once('\n').unwrap();
    assert!(
        names.starts_with("tick,robot,time_s,outcome,")
            && names.ends_with(",lane_clearance_m,about")
    );
    assert_eq!(rows.lines().count(), 100);
}
