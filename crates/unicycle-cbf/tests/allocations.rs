//! A step allocates nothing: counted by the allocator of this binary.
#![allow(clippy::unwrap_used, clippy::panic, missing_docs)]

use std::alloc::System;

use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use unicycle_cbf::path::Path;
use unicycle_cbf::{
    Controller, Pilot, Pose, Preset, Scenario, Speeds, StampedPose, Testbed, pilot::Ahead,
};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn steps(controller: &Controller) {
    let objectives = controller.objectives(0.2);
    let mut ahead = Pilot::new(0.0, Speeds::ZERO);
    let mut behind = Pilot::new(0.0, Speeds::ZERO);
    for step in 0..300 {
        let now_s = f64::from(step) * controller.hold_s();
        // Also outside the lane, so that the ladder is climbed, and with gaps, so that the watchdog bites.
        let angle = 0.02 * f64::from(step);
        let place = |radius: f64, angle: f64| Pose {
            x_m: radius * angle.cos(),
            y_m: radius * angle.sin(),
            heading_rad: angle + 1.5,
        };
        if step % 50 < 25 {
            let stamp_s = now_s - 0.03;
            let pose = place(0.9 + 0.002 * f64::from(step), angle);
            behind.observe(controller, StampedPose { stamp_s, pose });
            let pose = place(0.9, angle + 0.5);
            ahead.observe(controller, StampedPose { stamp_s, pose });
        }
        let seen = ahead.sighting(controller, now_s);
        let decision = behind.decide(controller, now_s, seen.into(), &objectives);
        behind.sent(now_s, decision.speeds);
        let decision = ahead.decide(controller, now_s, Ahead::Nobody, &objectives);
        ahead.sent(now_s, decision.speeds);
    }
}

#[test]
fn a_step_allocates_nothing() {
    let circle: Vec<[f64; 2]> = (0..40)
        .map(|i| f64::from(i) * std::f64::consts::TAU / 40.0)
        .map(|angle| [angle.cos(), angle.sin()])
        .collect();
    for preset in [Preset::Thesis, Preset::Hardened] {
        let spec = Testbed::Khepera.scenario("on-off", preset).unwrap();
        let scenario = Scenario::new(spec).unwrap();
        let given = scenario.controller();
        let on_loop = Controller::new(
            Path::closed(&circle).unwrap(),
            *given.body(),
            given.settings().clone(),
            given.hold_s(),
        )
        .unwrap();
        for controller in [given, &on_loop] {
            let region = Region::new(ALLOCATOR);
            steps(controller);
            let change = region.change();
            assert_eq!((change.allocations, change.reallocations), (0, 0));
        }
    }
    // The counter counts.
    let region = Region::new(ALLOCATOR);
    let grown = std::hint::black_box(vec![1; 1000]);
    assert!(region.change().allocations > 0 && grown.len() == 1000);
}
