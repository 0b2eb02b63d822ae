//! Roads into columns.

use speed_plan::{Leader, Road};

#[test]
fn steps_are_short_beside_a_standstill_and_even_between() {
    let road = Road {
        length_m: 2000.0,
        ..Road::default()
    };
    let columns = road.columns().unwrap();
    let steps: Vec<f64> = columns
        .position_m
        .windows(2)
        .map(|ends| ends[1] - ends[0])
        .collect();
    assert_eq!(steps[..3], [1.0, 1.5, 2.25]);
    assert!((steps[steps.len() - 1] - 1.0).abs() < 1e-9);
    assert!(steps.iter().all(|step| *step <= 40.0 + 1e-9));
    assert_eq!(steps.len(), 65);
    assert_eq!(
        (columns.max_mps[0], columns.min_mps[1], columns.max_mps[65]),
        (0.0, 0.5, 0.0)
    );
}

#[test]
fn places_are_nodes_with_the_lower_limit_of_both_sides() {
    let road = Road {
        length_m: 3000.0,
        limits: vec![(0.0, 14.0), (1000.0, 28.0), (2000.0, 20.0)],
        stops: vec![(1500.0, 12.0)],
        slow_points: vec![(700.0, 6.0)],
        curves: vec![[2500.0, 2600.0, 50.0]],
        signals: vec![(2800.0, vec![[0.0, 1000.0]])],
        ..Road::default()
    };
    let columns = road.columns().unwrap();
    let node = |at: f64| {
        columns
            .position_m
            .iter()
            .position(|s| (s - at).abs() < 1e-9)
            .unwrap()
    };
    let limits = [700.0, 999.9, 1000.0, 2000.0, 2500.0, 2600.0]
        .map(|at| {
            columns
                .position_m
                .iter()
                .rposition(|s| *s <= at + 1e-9)
                .unwrap()
        })
        .map(|k| columns.max_mps[k]);
    assert_eq!(limits, [6.0, 14.0, 14.0, 20.0, 10.0, 10.0]);
    assert_eq!(columns.max_mps[node(1000.0) + 1], 28.0);
    assert_eq!(
        (columns.max_mps[node(1500.0)], columns.dwell_s[node(1500.0)]),
        (0.0, 12.0)
    );
    assert_eq!(columns.signals[0].node, node(2800.0));
}

#[test]
fn slopes_keep_the_climb() {
    let road = Road {
        elevation: vec![(0.0, 100.0), (333.0, 120.0), (700.0, 90.0), (1000.0, 95.0)],
        ..Road::default()
    };
    let columns = road.columns().unwrap();
    let climb_m: f64 = columns
        .position_m
        .windows(2)
        .zip(&columns.slope_rad)
        .map(|(ends, slope)| slope.tan() * (ends[1] - ends[0]))
        .sum();
    assert!((climb_m + 5.0).abs() < 1e-9, "{climb_m}");
}

#[test]
fn what_is_not_on_the_road_or_out_of_order_is_named() {
    let good = Road::default;
    let bad = [
        (
            Road {
                stops: vec![(1500.0, 1.0)],
                ..good()
            },
            "stops",
        ),
        (
            Road {
                limits: vec![(0.0, 0.0)],
                ..good()
            },
            "limits",
        ),
        (
            Road {
                limits: vec![(0.0, 10.0), (0.0, 12.0)],
                ..good()
            },
            "limits",
        ),
        (
            Road {
                limits: vec![(10.0, 10.0)],
                ..good()
            },
            "limits",
        ),
        (
            Road {
                length_m: f64::NAN,
                ..good()
            },
            "length_m",
        ),
        (
            Road {
                length_m: 2e6,
                ..good()
            },
            "length_m",
        ),
        (
            Road {
                curves: vec![[10.0, 5.0, 30.0]],
                ..good()
            },
            "curves",
        ),
        (
            Road {
                elevation: vec![(5.0, 0.0), (1.0, 3.0)],
                ..good()
            },
            "elevation",
        ),
        (
            Road {
                leader: Some(Leader {
                    positions: vec![(0.0, 50.0), (1.0, 40.0)],
                    standstill_gap_m: 2.0,
                    headway_s: 1.5,
                }),
                ..good()
            },
            "leader",
        ),
    ];
    for (road, name) in bad {
        let error = road.columns().unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    }
}

#[test]
fn a_road_of_two_metres_is_one() {
    let road = Road {
        length_m: 2.0,
        ..Road::default()
    };
    let columns = road.columns().unwrap();
    assert!(columns.position_m.len() >= 3 && columns.position_m.last() == Some(&2.0));
}

#[test]
fn what_cannot_be_planned_is_named_with_its_place() {
    let good = Road::default;
    let bad = [
        (
            Road {
                elevation: vec![(0.0, 0.0), (500.0, 0.0), (500.01, 200.0)],
                ..good()
            },
            "slope is",
        ),
        (
            Road {
                curves: vec![[500.0, 520.0, 0.01]],
                ..good()
            },
            "at 500.00 m: a curve",
        ),
        (
            Road {
                signals: vec![(0.0, vec![[20.0, 50.0]])],
                ..good()
            },
            "at 0.00 m: a signal at the start",
        ),
        (
            Road {
                signals: vec![(500.0, vec![[0.0, 50.0]]), (500.1, vec![[0.0, 50.0]])],
                ..good()
            },
            "at 500.10 m: a signal nearer than",
        ),
        (
            Road {
                start_mps: 5.0,
                stops: vec![(0.0, 9.0)],
                ..good()
            },
            "at 0.00 m: the car stands",
        ),
    ];
    for (road, part) in bad {
        let error = road.columns().unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn a_leader_is_known_to_be_before_a_place_until_his_last_time() {
    let road = Road {
        leader: Some(Leader {
            positions: vec![(0.0, 30.0), (10.0, 100.0), (1000.0, 100.0)],
            standstill_gap_m: 2.0,
            headway_s: 1.5,
        }),
        stops: vec![(98.0, 0.0)],
        ..Road::default()
    };
    let columns = road.columns().unwrap();
    let bounds = columns.position_m.iter().zip(&columns.earliest_s);
    for (&at, &earliest_s) in bounds {
        match at {
            at if at < 28.0 => assert!(earliest_s < 0.0),
            at if at < 98.0 => assert!((1.5..11.5).contains(&earliest_s)),
            _ => assert_eq!(earliest_s, 1001.5),
        }
    }
}
