//! Integration tests of simulated robots.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stderr,
    clippy::print_stdout,
    missing_docs
)]

mod campaign;
mod figures;
mod literal;
mod random;
mod runs;
mod safety;
#[path = "../../../../fixtures/shared.rs"]
mod shared;
