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
mod conditioned;
mod cruise;
mod energy;
mod evaluation;
mod fitting;
mod following;
mod free_run;
mod model_file;
mod phases;
mod reference_vectors;
mod step_response;
mod support;
mod weights;
