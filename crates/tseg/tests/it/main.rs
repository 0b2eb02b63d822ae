#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stderr,
    missing_docs
)]

mod dynamic;
mod laws;
mod reference;
mod reference_merging;
mod regression;
mod rivals;
mod streaming;
