//! Integration tests of simulated testbeds, logs and recordings.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stdout,
    missing_docs
)]

mod campaign;
mod literal;
mod log_file;
mod recorded;
mod replay;
mod runs;
mod shadow;
