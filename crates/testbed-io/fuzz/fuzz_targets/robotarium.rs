//! Any bytes as a message of the Robotarium. Nothing may panic, and what is taken comes back.
#![no_main]

use libfuzzer_sys::fuzz_target;
use testbed_io::live::robotarium::{
    LARGEST_MESSAGE, decode_command, decode_poses, encode_command, encode_poses,
};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(poses) = decode_poses(bytes) {
        let message = encode_poses(&poses);
        // It may be longer than what is taken, if it was short with many robots.
        if let Ok(again) = decode_poses(message.as_bytes()) {
            assert_eq!(again, poses);
        } else {
            assert!(message.len() > LARGEST_MESSAGE);
        }
    }
    if let Ok(speeds) = decode_command(bytes) {
        let message = encode_command(speeds).expect("JSON has finite numbers only");
        assert_eq!(decode_command(message.as_bytes()), Ok(speeds));
    }
});
