//! JSON lines and answers of Khepera robots: what can be read is written and read the same.
#![no_main]

use libfuzzer_sys::fuzz_target;
use testbed_io::live::commands::KheperaReply;
use testbed_io::live::json_lines::{CommandLine, PoseLine};

fuzz_target!(|line: &[u8]| {
    if let Some(pose) = PoseLine::parse(line) {
        let text = serde_json::to_vec(&pose).expect("numbers");
        assert_eq!(PoseLine::parse(&text), Some(pose));
    }
    if let Some(command) = CommandLine::parse(line) {
        let text = serde_json::to_vec(&command).expect("numbers");
        assert_eq!(CommandLine::parse(&text), Some(command));
    }
    let _ = KheperaReply::parse(line);
});
