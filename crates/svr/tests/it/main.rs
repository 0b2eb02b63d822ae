//! Integration tests of support vector regression.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stderr,
    clippy::print_stdout,
    missing_docs
)]

mod degenerate;
mod equivalence;
mod least_squares;
mod model_file;
mod optimality;
mod problem;
mod reference;
mod refusals;
mod search;
#[path = "../../../../fixtures/shared.rs"]
mod shared;
