//! Any text as a layout description, applied to a log. Nothing may panic.
#![no_main]

use std::path::Path;

use drive_log::{Layout, LayoutChoice, read_bytes};
use libfuzzer_sys::fuzz_target;

const LOG: &[u8] = b"Zeit;Tempo [km/h];Strom (A)\n0,0;1,5;-3\n0,1;1,6;-4\n0,2;1,7;-4\n0,3;1,6;-2\n";

fuzz_target!(|text: &str| {
    let (description, log) = text.split_once("\u{1e}").unwrap_or((text, ""));
    if let Ok(layout) = Layout::from_toml_str("fuzz.toml", description) {
        let log = if log.is_empty() { LOG } else { log.as_bytes() };
        let _ = read_bytes(Path::new("fuzz.csv"), log, &LayoutChoice::Described(layout));
    }
});
