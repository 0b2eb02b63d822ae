//! Poses that are elsewhere at once, or headings: the robot stands for good, and whoever comes near it stands.

use testbed_sim::Verdict;
use unicycle_cbf::{Preset, ScenarioSpec, Testbed};

use super::doubt::Driven;
use super::faulty::Faults;

/// The first stops at 12 s, the second comes up to it.
fn straight(half_width_m: f64) -> ScenarioSpec {
    let mut spec = Testbed::Khepera
        .scenario("straight", Preset::Hardened)
        .unwrap();
    spec.duration_s = 16.0;
    spec.controller.lane.half_width_m = half_width_m;
    for (robot, start) in spec.robots.iter_mut().zip([0.6, 0.0]) {
        robot.start = start;
        robot.desired_speed_mps = vec![[0.0, 0.25]];
    }
    spec.robots[0].desired_speed_mps.push([12.0, 0.0]);
    spec.robots.truncate(2);
    spec
}

fn is_not_known(driven: &Driven) {
    let (summary, _) = driven.ended.as_ref().unwrap();
    assert_eq!(summary.verdict, Verdict::NotKnown);
    assert_eq!(driven.replay().verdict, Verdict::NotKnown);
}

#[test]
fn a_leader_that_leaps_ahead_stands_for_good_and_whoever_follows_does_not_touch_it() {
    for (from_s, ahead_m) in [(8.0, 0.08), (6.0, 0.055)] {
        let faults = Faults {
            ahead: [from_s, ahead_m],
            ..Faults::NONE
        };
        let driven = Driven::of(straight(0.2), faults, f64::INFINITY);
        let named_s = driven.named_at_s("robot 1 jumps by");
        assert!(named_s < from_s + 1.0, "{named_s}");
        driven.stays();
        is_not_known(&driven);
    }
}

#[test]
fn a_leap_while_no_poses_come_is_one() {
    let faults = Faults {
        ahead: [8.0, 0.1],
        hidden_s: [8.0, 8.6],
        ..Faults::NONE
    };
    let driven = Driven::of(straight(0.2), faults, f64::INFINITY);
    let named_s = driven.named_at_s("robot 1 jumps by");
    assert!(named_s < 9.8, "{named_s}");
    driven.stays();
    is_not_known(&driven);
}

#[test]
fn a_time_without_poses_is_no_leap() {
    let faults = Faults {
        hidden_s: [8.0, 8.6],
        ..Faults::NONE
    };
    let driven = Driven::of(straight(0.2), faults, f64::INFINITY);
    let mut notes = driven.notes.iter();
    assert!(notes.all(|(_, text)| !text.contains("jumps by")));
    let (summary, _) = driven.ended.as_ref().unwrap();
    assert_eq!(summary.verdict, Verdict::Safe);
}

#[test]
fn a_heading_that_leaps_in_a_narrow_lane_is_named_before_the_lane_ends() {
    for (half_width_m, off_rad) in [(0.03, 0.349), (0.05, -0.349)] {
        let faults = Faults {
            turned: [8.0, off_rad],
            ..Faults::NONE
        };
        let mut spec = straight(half_width_m);
        spec.controller.hardening.wheel_error = 0.0;
        spec.duration_s = 11.0;
        let driven = Driven::of(spec, faults, f64::INFINITY);
        let named_s = driven.named_at_s("jumps by");
        assert!(named_s < 9.0, "{named_s}");
        driven.stays();
    }
}

#[test]
fn a_latency_that_does_not_change_is_named_with_its_size() {
    for late_s in [0.3, 0.4] {
        let faults = Faults {
            late_s,
            ..Faults::NONE
        };
        let driven = Driven::of(straight(0.1), faults, f64::INFINITY);
        driven.named_at_s("follows its commands 0.");
        driven.stays();
    }
}
