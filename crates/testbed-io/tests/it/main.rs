//! Integration tests of simulated testbeds, logs and recordings.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stderr,
    clippy::print_stdout,
    missing_docs
)]

mod json_lines;
mod log_file;
mod natnet;
mod natnet_axes;
mod natnet_messages;
mod path_files;
mod recorded;
mod replay;
mod robotarium;
mod shadow;
#[path = "../../../../fixtures/shared.rs"]
mod shared;
