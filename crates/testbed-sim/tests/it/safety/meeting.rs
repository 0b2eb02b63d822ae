//! Paths that meet themselves: whoever reaches the crossing second waits.

use testbed_sim::Tick;
use unicycle_cbf::{
    Demands, RobotSpec, RowKind, Scenario, ScenarioSpec, Testbed,
    settings::{Distance, HeadwaySettings},
};

use super::{Driven, driven, eight, hardened};

/// Two robots that come to the crossing from as far as these shares of a lap.
fn meeting(shares: [f64; 2], distance: Distance) -> ScenarioSpec {
    let [first, second] = shares;
    let robots = vec![
        RobotSpec::steady(0.5 - first, 0.15),
        RobotSpec::steady(1.0 - second, 0.15),
    ];
    let mut scenario = hardened(Testbed::Khepera, "on-off", robots);
    scenario.path = eight(1.2, 0.6);
    scenario.controller.headway.distance = distance;
    scenario
}

/// When a robot is nearest to the crossing for the first time.
fn through_s(driven: &Driven, robot: usize) -> f64 {
    let from_crossing_m = |tick: &Tick| {
        let state = tick.truth.unwrap().state;
        state.x_m.hypot(state.y_m)
    };
    let near = |tick: &&Tick| from_crossing_m(tick) < 0.05;
    driven.of(robot).find(near).unwrap().time_s
}

#[test]
fn of_two_that_reach_a_crossing_at_once_one_waits() {
    for distance in [Distance::Chord, Distance::Path] {
        let driven = driven(meeting([0.1, 0.1], distance));
        driven.assert_safe(HeadwaySettings::CLEARANCE_M, &format!("{distance:?}"));
        assert!(driven.is_ever_held(1, RowKind::GiveWay), "{distance:?}");
        assert!(!driven.is_ever_held(0, RowKind::GiveWay), "{distance:?}");
        assert!(through_s(&driven, 0) < through_s(&driven, 1));
    }
}

#[test]
fn who_comes_to_a_crossing_first_goes_first() {
    for (shares, first) in [([0.1, 0.13], 0), ([0.13, 0.1], 1)] {
        let driven = driven(meeting(shares, Distance::Chord));
        driven.assert_safe(HeadwaySettings::CLEARANCE_M, &format!("{shares:?}"));
        let second = 1 - first;
        assert!(driven.is_ever_held(second, RowKind::GiveWay), "{shares:?}");
        assert!(through_s(&driven, first) < through_s(&driven, second));
    }
}

#[test]
fn what_a_crossing_asks_for_is_said() {
    let demands = |distance| Demands::new(&Scenario::new(meeting([0.1, 0.1], distance)).unwrap());
    assert_eq!(demands(Distance::Chord).crossings, 1);
    assert!(demands(Distance::Chord).along_path_instead);
    assert!(!demands(Distance::Path).along_path_instead);
}
