//! A robot whose poses come a tenth of a second late and then no more: the pilot predicts, and stops it when they are too old.
//!
//! `cargo run -p unicycle-cbf --example late_poses`

#![allow(clippy::print_stdout)]

use std::error::Error;

use unicycle_cbf::path::Path;
use unicycle_cbf::{
    Controller, ControllerSettings, Pilot, Pose, Preset, Speeds, StampedPose, Testbed, pilot::Ahead,
};

const HOLD_S: f64 = 0.02;
const LATE_STEPS: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let path = Path::straight(0.0, 0.0, 0.0)?;
    let settings = ControllerSettings::from(Preset::Hardened);
    let controller = Controller::new(path, Testbed::Khepera.body(), settings, HOLD_S)?;
    let objectives = controller.objectives(0.15);
    let mut pilot = Pilot::new(0.0, Speeds::ZERO);
    let mut poses = vec![Pose {
        x_m: 0.0,
        y_m: 0.02,
        heading_rad: 0.0,
    }];
    for step in 0..200_usize {
        let now_s = HOLD_S * step as f64;
        let seen = step.saturating_sub(LATE_STEPS);
        if now_s < 2.0 {
            let stamp_s = HOLD_S * seen as f64;
            let pose = poses[seen];
            pilot.observe(&controller, StampedPose { stamp_s, pose });
        }
        let decision = pilot.decide(&controller, now_s, Ahead::Nobody, &objectives);
        pilot.sent(now_s, decision.speeds);
        poses.push(poses[step].advanced(decision.speeds, HOLD_S));
        if step % 20 == 0 {
            let (speed_mps, outcome) = (decision.speeds.speed_mps, decision.outcome);
            println!("{now_s:.2} s: {speed_mps:.3} m/s, {outcome:?}");
        }
    }
    Ok(())
}
