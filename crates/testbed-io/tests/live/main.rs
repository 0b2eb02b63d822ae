//! Sessions over loopback, with simulated robots that speak what the real ones speak.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stderr,
    clippy::print_stdout,
    missing_docs,
    unreachable_pub
)]

mod doubt;
mod elsewhere;
mod faulty;
mod gone;
mod json;
mod khepera;
mod khepera_faults;
mod khepera_peer;
mod leaps;
mod mosquitto;
mod mqtt;
mod mqtt_faults;
mod mqtt_login;
mod natnet_client;
mod natnet_faults;
mod natnet_filler;
mod natnet_server;
mod natnet_synthetic;
mod proxy;
#[path = "../../../../fixtures/python.rs"]
mod python;
mod robotarium;
mod robotarium_peer;
mod testbed;
mod world;
