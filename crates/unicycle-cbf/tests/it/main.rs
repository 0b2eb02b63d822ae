//! Integration tests of the controller.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stderr,
    clippy::print_stdout,
    missing_docs
)]

mod derivatives;
mod guards;
mod ladder;
mod path;
mod qp;
mod reference;
mod scenarios;
#[path = "../../../../fixtures/shared.rs"]
mod shared;
mod states;
mod tracks;
mod units;
