//! A simulated run into a run log, and every decision of the log once more.
//!
//! `cargo run -p testbed-io --example minimal_replay`

#![allow(clippy::print_stdout)]

use std::error::Error;

use testbed_io::RunFile;
use testbed_io::log_file::{LogFormat, read_bytes, write};
use testbed_sim::Disturbances;
use unicycle_cbf::{Preset, Testbed};

fn main() -> Result<(), Box<dyn Error>> {
    let spec = RunFile {
        seed: 1,
        scenario: Testbed::Robotarium.scenario("track", Preset::Hardened)?,
        disturbances: Disturbances::HARD,
        link: None,
    };
    let (run, _) = spec.simulate()?;
    let table = run.to_table()?;
    for format in [LogFormat::Csv, LogFormat::Parquet, LogFormat::Mcap] {
        let mut bytes = Vec::new();
        write(&table, format, &mut bytes)?;
        let replay = read_bytes(&bytes, format)?.run_log()?.replay()?;
        println!(
            "{format:?}: {} bytes, {} decisions, {} differ, {:?}",
            bytes.len(),
            replay.decisions,
            replay.different,
            replay.verdict
        );
    }
    Ok(())
}
