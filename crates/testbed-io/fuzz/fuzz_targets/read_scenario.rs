//! Any text as a scenario file, and some steps of what can be run. Nothing may panic, no command may be without a number.
#![no_main]

use libfuzzer_sys::fuzz_target;
use testbed_io::RunFile;

fuzz_target!(|text: &str| {
    let Ok(mut spec) = toml::from_str::<RunFile>(text) else {
        return;
    };
    spec.scenario.duration_s = 5.0 / spec.scenario.rate_hz;
    let Ok((run, _)) = spec.simulate() else {
        return;
    };
    for tick in &run.ticks {
        let wheels = tick.decision.wheels;
        assert!(wheels.left_mps.is_finite() && wheels.right_mps.is_finite());
    }
});
