//! Seeded runs of every built-in scenario in parallel, and which of them were unsafe.
//!
//! `cargo run -p testbed-sim --example minimal_campaign`

#![allow(clippy::print_stdout)]

use testbed_sim::{Campaign, Disturbances, Error, Group, NamedScenario};
use unicycle_cbf::{Preset, Testbed};

fn main() -> Result<(), Error> {
    let mut scenarios = NamedScenario::built_in(Testbed::ALL, &[], Preset::Thesis)?;
    scenarios.extend(NamedScenario::built_in(
        Testbed::ALL,
        &[],
        Preset::Hardened,
    )?);
    for scenario in &mut scenarios {
        scenario.spec.duration_s = 10.0;
    }
    let campaign = Campaign {
        scenarios,
        groups: vec![Group::None, Group::All],
        runs: 26,
        seed: 1,
        disturbances: Disturbances::HARD,
    };
    let report = campaign.run(&|| {})?;
    for total in &report.totals {
        println!(
            "{} under {}: {} of {} runs unsafe",
            total.preset.name(),
            total.disturbance.name(),
            total.tally.violations,
            total.tally.runs
        );
    }
    Ok(())
}
