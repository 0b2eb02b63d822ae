//! A run of two simulated robots under disturbances, and what it comes to.
//!
//! `cargo run -p testbed-sim --example minimal_run`

#![allow(clippy::print_stdout)]

use testbed_sim::{Disturbances, Error, Group, RunSpec};
use unicycle_cbf::{Preset, Testbed};

fn main() -> Result<(), Error> {
    for preset in [Preset::Thesis, Preset::Hardened] {
        let spec = RunSpec {
            seed: 7,
            scenario: Testbed::Khepera.scenario("on-off", preset)?,
            disturbances: Disturbances::HARD.only(Group::Latency),
        };
        let (run, summary) = spec.simulate()?;
        println!(
            "{}: {} ticks, {:?}, {:.1} mm to the edge of the lane at least",
            preset.name(),
            run.ticks.len(),
            summary.verdict,
            1e3 * summary.lane_clearance_m
        );
    }
    Ok(())
}
