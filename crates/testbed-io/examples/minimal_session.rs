//! A session without robots: the poses of a run log as if they came now, as fast as they can.
//!
//! `cargo run -p testbed-io --example minimal_session -- run.csv`, with a log of `drivekit ctrl run --preset hardened -o run.csv`

#![allow(clippy::print_stdout)]

use std::error::Error;

use testbed_io::live::poses::{Pace, RecordingSpec};
use testbed_io::live::{CommandsSpec, LinkSpec, PosesSpec, Session, StopSwitch, Update};
use unicycle_cbf::{Preset, Scenario, Testbed};

fn main() -> Result<(), Box<dyn Error>> {
    let Some(file) = std::env::args().nth(1) else {
        println!("which run log?");
        return Ok(());
    };
    let spec = Testbed::Khepera.scenario("on-off", Preset::Hardened)?;
    let link = LinkSpec {
        robots: (1..).take(spec.robots.len()).collect(),
        lost_after_s: 5.0,
        arena: None,
        poses: PosesSpec::Recording(RecordingSpec {
            file: file.into(),
            pace: Pace::Fast,
        }),
        commands: CommandsSpec::None,
    };
    let scenario = Scenario::new(spec)?;
    let session = Session {
        scenario: &scenario,
        link: &link,
    };
    let (summary, report) = session.run(&StopSwitch::default(), |update| {
        if let Update::Note(note) = update {
            println!("{note}");
        }
    })?;
    println!("{:?}, {:?}", report.ending, summary.verdict);
    Ok(())
}
