//! Robots that are measured where their commands cannot have led them: named with the size, and stopped.

use testbed_sim::Verdict;
use unicycle_cbf::{Body, Preset, ScenarioSpec, Testbed};

use super::doubt::Driven;
use super::faulty::Faults;

fn straight(duration_s: f64) -> ScenarioSpec {
    let mut spec = Testbed::Khepera
        .scenario("straight", Preset::Hardened)
        .unwrap();
    spec.duration_s = duration_s;
    spec
}

/// Whether all robots or the last one stood from a time on.
fn stood(driven: &Driven, all: bool, from_s: f64) -> bool {
    let late = driven.ticks.iter().filter(|tick| tick.time_s > from_s);
    let mut looked_at = late.filter(|tick| all || tick.robot == 1);
    looked_at.all(|tick| tick.decision.speeds.speed_mps == 0.0)
}

/// How far off the last robot is said to be, in mm.
fn size_mm(driven: &Driven) -> f64 {
    let mut notes = driven.notes.iter();
    let said = notes.find_map(|(_, text)| text.split_once("cannot have led it, "));
    let (mm, _) = said.unwrap().1.split_once(" mm").unwrap();
    mm.parse().unwrap()
}

#[test]
fn a_place_where_commands_cannot_have_led_is_never_believed() {
    for elsewhere_m in [[-0.6, 0.0], [-0.3, 0.0], [0.0, 0.1]] {
        let faults = Faults {
            elsewhere_after_s: 4.0,
            elsewhere_m,
            ..Faults::NONE
        };
        let driven = Driven::of(straight(9.0), faults, f64::INFINITY);
        let at_s = driven.named_at_s("robot 2: for 0.5 s its poses have said that it is at");
        assert!(at_s < 5.0, "{at_s}");
        let [dx_m, dy_m] = elsewhere_m;
        let off_mm = size_mm(&driven);
        assert!((off_mm - 1e3 * dx_m.hypot(dy_m)).abs() < 30.0, "{off_mm}");
        let mut notes = driven.notes.iter();
        assert!(notes.all(|(_, text)| !text.contains("seen again")));
        assert!(stood(&driven, false, at_s + 0.2));
        driven.stays();
        let (summary, _) = driven.ended.as_ref().unwrap();
        assert_eq!(summary.verdict, Verdict::NotKnown);
        assert_eq!(driven.replay().verdict, Verdict::NotKnown);
    }
}

#[test]
fn steps_across_the_heading_do_not_add_up() {
    for (steps, size) in [([4.0, 0.04], "jumps by 4"), ([3.0, 0.025], "jumps by 2")] {
        let faults = Faults {
            steps,
            ..Faults::NONE
        };
        let driven = Driven::of(straight(10.0), faults, f64::INFINITY);
        // The session begins a little after the clock of the steps does.
        assert!(driven.named_at_s(size) < 2.0 * steps[0] + 0.9);
        driven.named_at_s("it stands for good");
        assert!(stood(&driven, true, 8.5));
        assert!(driven.least.lane_clearance_m > 0.05, "{:?}", driven.least);
        driven.stays();
    }
}

/// With a point of interest 25 cm ahead of the axle, in a lane of this half width.
fn long(half_width_m: f64) -> ScenarioSpec {
    let mut spec = straight(8.0);
    spec.body = Body {
        offset_m: 0.25,
        mass_kg: 3.0,
        inertia_kgm2: 0.04,
        wheel_base_m: 0.3,
        radius_m: Some(0.2),
        max_wheel_speed_mps: 0.5,
        max_turn_rate_rad_s: 3.0,
        ..spec.body
    };
    spec.controller.lane.half_width_m = half_width_m;
    spec.robots[0].start = 1.2;
    spec
}

#[test]
fn a_heading_whose_error_the_lane_does_not_hold_is_refused_at_the_start() {
    for half_width_m in [0.09, 0.1] {
        for degrees in [20.0_f64, -20.0] {
            let faults = Faults {
                yaw_rad: degrees.to_radians(),
                ..Faults::NONE
            };
            let driven = Driven::of(long(half_width_m), faults, f64::INFINITY);
            driven.refused("if that is an error of its heading");
        }
    }
}

#[test]
fn a_heading_that_is_off_by_more_than_the_clearance_is_not_called_safe() {
    let faults = Faults {
        yaw_rad: 20_f64.to_radians(),
        ..Faults::NONE
    };
    let driven = Driven::of(long(0.12), faults, f64::INFINITY);
    driven.stays();
    driven.named_at_s("does not move where it heads but 20° to the right");
    let (summary, report) = driven.ended.as_ref().unwrap();
    assert_eq!(summary.verdict, Verdict::NotKnown, "{summary:?}");
    let doubt = "was measured beside where it was by more than there was to the edge of its lane";
    assert!(
        report.doubts.iter().all(|text| text.contains(doubt)),
        "{report:?}"
    );
    let replay = driven.replay();
    assert_eq!(
        (replay.verdict, &replay.doubts),
        (summary.verdict, &report.doubts)
    );
}

#[test]
fn robots_with_a_long_offset_that_are_as_stated_are_not_doubted() {
    let driven = Driven::of(long(0.09), Faults::NONE, f64::INFINITY);
    driven.stays();
    let (summary, _) = driven.ended.as_ref().unwrap();
    assert_eq!(summary.verdict, Verdict::Safe);
    let mut notes = driven.notes.iter();
    assert!(notes.all(|(_, text)| !text.starts_with("robot")));
}
