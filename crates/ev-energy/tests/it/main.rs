#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stderr,
    missing_docs
)]

mod calibration;
mod laws;
mod limits;
#[path = "../../../../fixtures/shared.rs"]
mod shared;
mod slope;
mod steps;
mod vectors;
mod vehicles;
