//! A step of robots among robots allocates nothing: counted by the allocator of this binary.
#![allow(clippy::unwrap_used, missing_docs)]

use std::alloc::System;

use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use testbed_sim::Convoy;
use unicycle_cbf::{
    PathSpec, Preset, RobotSpec, RowKind, Scenario, ScenarioSpec, StampedPose, Testbed,
    lateral::Deviation,
};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Six robots on a figure eight, at whose crossing some wait.
fn crossing() -> ScenarioSpec {
    let mut scenario = Testbed::Khepera
        .scenario("on-off", Preset::Hardened)
        .unwrap();
    let point = |at: u16| {
        let turn = std::f64::consts::TAU * f64::from(at) / 64.0;
        [2.0 * turn.sin(), 1.2 * (2.0 * turn).sin()]
    };
    scenario.path = PathSpec::Closed {
        points_m: (0..64).map(point).collect(),
    };
    let start = |robot: u16| 0.92 - 0.16 * f64::from(robot);
    scenario.robots = (0..6)
        .map(|robot| RobotSpec::steady(start(robot), 0.2))
        .collect();
    scenario.controller.lane.deviation = Deviation::Frenet;
    scenario
}

/// How often a robot gave way.
fn drive(scenario: &Scenario, convoy: &mut Convoy) -> usize {
    let hold_s = scenario.controller().hold_s();
    let mut poses: [_; 6] = std::array::from_fn(|robot| scenario.starts()[robot]);
    let mut gave_way = 0;
    for step in 0..2000_u32 {
        let now_s = f64::from(step) * hold_s;
        for (robot, pose) in poses.into_iter().enumerate() {
            let stamp_s = now_s;
            convoy.observe(robot, StampedPose { stamp_s, pose });
        }
        for (robot, pose) in poses.iter_mut().enumerate() {
            let decision = convoy.step(robot, now_s);
            gave_way += usize::from(decision.is_held_by(RowKind::GiveWay));
            *pose = pose.advanced(decision.speeds, hold_s);
        }
    }
    gave_way
}

#[test]
fn a_step_among_six_robots_allocates_nothing() {
    let scenario = Scenario::new(crossing()).unwrap();
    let mut convoy = Convoy::new(&scenario);
    let region = Region::new(ALLOCATOR);
    let gave_way = drive(&scenario, &mut convoy);
    let change = region.change();
    assert_eq!((change.allocations, change.reallocations), (0, 0));
    assert!(gave_way > 0);
}
