//! Any bytes as a run log in CSV or MCAP: read, taken for a run, replayed. Nothing may panic.
//!
//! Parquet is left out: its decoder panics on damaged files, which the reader catches and the fuzzer would not.
#![no_main]

use libfuzzer_sys::fuzz_target;
use testbed_io::log_file::{LogFormat, read_bytes};

fuzz_target!(|bytes: &[u8]| {
    let format = if bytes.starts_with(b"\x89MCAP") {
        LogFormat::Mcap
    } else {
        LogFormat::Csv
    };
    let Ok(table) = read_bytes(bytes, format) else {
        return;
    };
    if let Ok(log) = table.run_log() {
        let _ = log.replay();
    }
});
