//! Any text as a layout description, applied to logs. Nothing may panic.
#![no_main]

use std::path::Path;

use drive_log::{Layout, LayoutChoice, check, read_bytes};
use libfuzzer_sys::fuzz_target;

const LOGS: [&[u8]; 2] = [
    b"Zeit;Tempo [km/h];Strom (A)\n0,0;1,5;-3\n0,1;1,6;-4\n0,2;1,7;-4\n0,3;1,6;-2\n",
    b"# made\nTrip;Run;Date;Clock;Zeit;Tempo [km/h];Tempo [km/h];Limit\n;;;;s;km/h;km/h;\n1;a;3/4/2026;23:59:59;095959;1,5;2;ND\n\
      1;b;4/4/2026;0:00:00;100000;1,6;2;48-40\n2;a;;0:00:01;1.000;--;1.234,5;-99\nEnd\n",
];

fuzz_target!(|text: &str| {
    let (description, log) = text.split_once("\u{1e}").unwrap_or((text, ""));
    let Ok(layout) = Layout::from_toml_str("fuzz.toml", description) else {
        return;
    };
    let logs = if log.is_empty() { &LOGS[..] } else { &[log.as_bytes()] };
    for log in logs {
        let choice = LayoutChoice::Described(layout.clone());
        if let Ok(file) = read_bytes(Path::new("fuzz.csv"), log, &choice) {
            file.logs.into_iter().take(4).for_each(|log| drop(check(log)));
        }
    }
});
