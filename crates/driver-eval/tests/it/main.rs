//! Integration tests, a module per theme.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stderr
)]

mod begun;
mod calibration;
mod conditioned;
mod cruise;
mod evaluation;
mod following;
mod following_fits;
mod free_run;
mod referee;
#[path = "../../../../fixtures/shared.rs"]
mod shared;
#[allow(dead_code, reason = "for the tests of models too")]
#[path = "../../../driver-model/tests/it/support.rs"]
mod support;
mod whole_phases;
