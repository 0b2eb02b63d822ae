//! One control step of a robot on a path of one's own.
//!
//! `cargo run -p unicycle-cbf --example minimal_step`

#![allow(clippy::print_stdout)]

use std::error::Error;

use unicycle_cbf::path::Path;
use unicycle_cbf::{Controller, ControllerSettings, Leader, Preset, State, Testbed};

fn main() -> Result<(), Box<dyn Error>> {
    let oval: Vec<[f64; 2]> = (0..64)
        .map(|i| std::f64::consts::TAU * f64::from(i) / 64.0)
        .map(|angle| [1.2 * angle.cos(), 0.8 * angle.sin()])
        .collect();
    let path = Path::closed(&oval)?;
    let body = Testbed::Khepera.body();
    let hold_s = 0.02;
    let settings = ControllerSettings::from(Preset::Hardened);
    let controller = Controller::new(path, body, settings, hold_s)?;

    let own = State {
        x_m: 1.2,
        y_m: 0.0,
        speed_mps: 0.1,
        heading_rad: std::f64::consts::FRAC_PI_2,
        turn_rate_rad_s: 0.0,
    };
    let objectives = controller.objectives(0.15);
    let alone = controller.decide(&own, None, &objectives, 0.0);
    let ahead = Leader::known(State { y_m: 0.3, ..own });
    let behind = controller.decide(&own, Some(&ahead), &objectives, 0.0);
    for (what, decision) in [("alone", alone), ("behind another robot", behind)] {
        let (speeds, outcome) = (decision.speeds, decision.outcome.name());
        println!(
            "{what}: {outcome}, {:.3} m/s, {:.3} rad/s",
            speeds.speed_mps, speeds.turn_rate_rad_s
        );
    }
    Ok(())
}
