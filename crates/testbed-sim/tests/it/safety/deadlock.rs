//! Robots that wait for each other.

use unicycle_cbf::{RobotSpec, Testbed, settings::HeadwaySettings};

use super::{driven, hardened, then};

/// Its follower does not let it back off, and it does not let its follower on.
#[test]
fn robots_that_stand_and_wait_for_each_other_are_a_deadlock() {
    let leader = then(RobotSpec::steady(0.6, 0.1), 15.0, -0.1);
    let robots = vec![leader, RobotSpec::steady(0.0, 0.2)];
    let driven = driven(hardened(Testbed::Khepera, "straight", robots));
    driven.assert_safe(HeadwaySettings::CLEARANCE_M, "deadlock");
    let names = |robot| testbed_sim::summary::outcomes_of(&driven.ticks, robot);
    assert!(names(0).contains_key("braking-deadlock"), "{:?}", names(0));
}

/// Whom a robot waits for is told apart from a robot ahead of it that is out of reach.
#[test]
fn a_deadlock_far_behind_a_robot_is_one() {
    let reverses = then(RobotSpec::steady(0.15, 0.1), 5.0, -0.1);
    let robots = vec![
        RobotSpec::steady(0.5, 0.0),
        reverses,
        RobotSpec::steady(0.0, 0.2),
    ];
    let driven = driven(hardened(Testbed::Khepera, "on-off", robots));
    driven.assert_safe(HeadwaySettings::CLEARANCE_M, "deadlock on a loop");
    let names = |robot| testbed_sim::summary::outcomes_of(&driven.ticks, robot);
    assert!(names(1).contains_key("braking-deadlock"), "{:?}", names(1));
    assert!(names(2).contains_key("braking-deadlock"), "{:?}", names(2));
    assert!(!names(0).contains_key("braking-deadlock"), "{:?}", names(0));
}
