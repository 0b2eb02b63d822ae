//! Any bytes as a log: read, check, resample, and write what came of it. Nothing may panic.
//!
//! Parquet is left out: its decoder panics on damaged files, which the reader catches and the fuzzer would not.
#![no_main]

use std::path::Path;

use drive_log::{LayoutChoice, Preparation, prepare, read_bytes, write_csv};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if bytes.starts_with(b"PAR1") {
        return;
    }
    let Ok(file) = read_bytes(Path::new("fuzz.csv"), bytes, &LayoutChoice::Auto) else {
        return;
    };
    // a file may be a log per row
    for log in file.logs.into_iter().take(8) {
        // A grid of a second keeps long times from becoming long logs.
        let options = Preparation {
            step_s: 1.0,
            ..Preparation::default()
        };
        let Ok(drive) = prepare(log, &options) else {
            continue;
        };
        for piece in drive.pieces.iter().take(4) {
            let mut text = Vec::new();
            write_csv(piece, &mut text).expect("writing to memory does not fail");
        }
    }
});
