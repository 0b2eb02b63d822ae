//! `drivekit`

fn main() -> std::process::ExitCode {
    drivekit::drivekit()
}
