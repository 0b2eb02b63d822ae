#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stderr,
    clippy::single_range_in_vec_init,
    missing_docs
)]

mod dynamic;
mod laws;
mod reference;
mod reference_merging;
mod regression;
mod rivals;
#[path = "../../../../fixtures/shared.rs"]
mod shared;
mod streaming;
