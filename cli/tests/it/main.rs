//! The program as its users run it, a module per theme.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stderr
)]

mod architecture;
mod bad_input;
mod browser;
mod calibrate;
mod copies;
mod ctrl;
mod ctrl_check;
mod ctrl_links;
mod ctrl_live;
mod ctrl_logs;
mod ctrl_scenarios;
mod documents;
mod energy;
mod evaluate;
mod examples;
mod fit_predict;
mod flags;
mod follow;
mod inspect;
mod limit_map;
mod little_data;
mod many_logs;
mod outputs;
mod plan;
mod portrait;
mod predict_follow;
mod program;
#[path = "../../../fixtures/python.rs"]
mod python;
mod require;
mod road;
mod segment;
#[path = "../../../fixtures/shared.rs"]
mod shared;
mod snapshots;
mod synth;
mod ties;
mod times;
mod trajectory;
mod twice;
