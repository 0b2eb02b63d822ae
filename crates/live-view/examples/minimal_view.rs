//! A page of simulated robots, as fast as they would drive, for ten seconds or until somebody presses its button.
//!
//! `cargo run -p live-view --example minimal_view`

#![allow(clippy::print_stdout)]

use std::error::Error;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::Duration;

use live_view::{NewestPlaces, Snapshot, View};
use testbed_sim::{Disturbances, RunSpec};
use unicycle_cbf::{Preset, Scenario, Testbed};

fn main() -> Result<(), Box<dyn Error>> {
    let mut spec = Testbed::Robotarium.scenario("track", Preset::Hardened)?;
    spec.duration_s = 10.0;
    let scenario = Scenario::new(spec.clone())?;
    let stopped = Arc::new(AtomicBool::new(false));
    let switch = Arc::clone(&stopped);
    let stop = Box::new(move || switch.store(true, Ordering::SeqCst));
    let view = View::start("127.0.0.1:0".parse()?, &scenario, stop)?;
    println!("{}", view.control_url());

    let period = Duration::from_secs_f64(scenario.controller().hold_s());
    let run = RunSpec {
        seed: 1,
        scenario: spec,
        disturbances: Disturbances::HARD,
    };
    let (run, _) = run.simulate()?;
    let mut newest = NewestPlaces::new(&scenario);
    for ticks in run.ticks.chunk_by(|a, b| a.tick == b.tick) {
        if stopped.load(Ordering::SeqCst) {
            break;
        }
        view.show(Snapshot {
            time_s: ticks[0].time_s,
            duration_s: 10.0,
            robots: newest.robots(ticks, &[0.0, 0.0], &[1, 2]),
            ..Snapshot::default()
        });
        sleep(period);
    }
    view.ended("finished");
    Ok(())
}
