//! `ctrl`, which is `drivekit ctrl`

fn main() -> std::process::ExitCode {
    drivekit::ctrl()
}
