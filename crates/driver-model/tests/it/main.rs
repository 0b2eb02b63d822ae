//! Integration tests, a module per theme.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stderr
)]

mod braking;
mod closed_forms;
mod energy;
mod fitting;
mod live;
mod memory;
mod model_file;
mod pedal;
mod phases;
mod reference_vectors;
#[path = "../../../../fixtures/shared.rs"]
mod shared;
mod step_response;
mod support;
mod weights;
mod whole_phases;
mod wish;
