//! Controllers and states for tests.

use proptest::prelude::*;
use unicycle_cbf::path::Path;
use unicycle_cbf::{Controller, ControllerSettings, Preset, State, Testbed};

/// The controller of a built-in scenario with its settings changed.
pub(crate) fn controller(
    testbed: Testbed,
    name: &str,
    preset: Preset,
    change: impl FnOnce(&mut ControllerSettings),
) -> Controller {
    let mut spec = testbed.scenario(name, preset).unwrap();
    change(&mut spec.controller);
    unicycle_cbf::Scenario::new(spec)
        .unwrap()
        .controller()
        .clone()
}

pub(crate) fn ellipse() -> Path {
    let points: Vec<[f64; 2]> = (0..60)
        .map(|i| f64::from(i) * std::f64::consts::TAU / 60.0)
        .map(|angle| [1.2 * angle.cos(), 0.8 * angle.sin()])
        .collect();
    Path::closed(&points).unwrap()
}

/// States near paths of about a metre.
pub(crate) fn state() -> impl Strategy<Value = State> {
    (0.6..1.2, -3.1..3.1, -0.3..0.3, -3.0..3.0, -2.0..2.0).prop_map(
        |(r, phi, speed_mps, heading_rad, turn_rate_rad_s): (f64, f64, f64, f64, f64)| State {
            x_m: r * phi.cos(),
            y_m: r * phi.sin(),
            speed_mps,
            heading_rad,
            turn_rate_rad_s,
        },
    )
}
