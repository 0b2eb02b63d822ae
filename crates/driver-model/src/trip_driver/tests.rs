use drive_log::Channel;

use super::clock::Clock;
use super::*;
use crate::Motion;
use crate::road::*;

pub(super) fn driver() -> TripDriver {
    let wanted = WantedSpeed {
        by_limit: vec![],
        line: HabitLine::default(),
    };
    let acceleration = AccelerationLaw {
        scale_mps2: 1.9,
        max_mps2: 2.1,
        rises: 10,
    };
    let braking = BrakingLaw {
        scale_mps2: 0.4,
        exponent: 0.5,
        max_mps2: 2.3,
        falls: 10,
    };
    let slowdowns = Slowdowns {
        by_limit: vec![],
        per_m: 0.0,
        speed_mps: 5.0,
        at_change_share: 0.0,
        at_change_mps: 5.0,
    };
    TripDriver::new(wanted, acceleration, braking, slowdowns).unwrap()
}

/// One limit, from standstill.
fn map(length_m: f64, limit_mps: f64) -> RoadMap {
    RoadMap {
        length_m,
        limits: vec![LimitFrom {
            position_m: 0.0,
            limit_mps,
        }],
        ..RoadMap::default()
    }
}

pub(super) fn stop(position_m: f64, dwell_s: f64) -> RoadStop {
    RoadStop {
        position_m,
        dwell_s,
    }
}

pub(super) fn log_of(channels: Vec<(Channel, Vec<f64>)>, step_s: f64) -> Motion {
    Motion::of_channels("log", step_s, channels)
}

fn with_limit(speed_mps: Vec<f64>, limit_mps: f64, step_s: f64) -> Motion {
    let limits = vec![limit_mps; speed_mps.len()];
    let channels = vec![(Channel::Speed, speed_mps), (Channel::SpeedLimit, limits)];
    log_of(channels, step_s)
}

#[test]
fn a_stop_is_met_exactly_and_stood_at() {
    let road = Road::new(RoadMap {
        stops: vec![stop(0.0, 3.0), stop(500.0, 7.0), stop(502.0, 1.0)],
        ..map(1000.0, 14.0)
    });
    let run = driver().drive(&road.unwrap(), 0.1, None).unwrap();
    assert!(run.speed_mps[..=30].iter().all(|v| *v == 0.0) && run.speed_mps[31] > 0.0);
    let standing = (31..run.speed_mps.len()).filter(|&k| run.speed_mps[k] == 0.0);
    let standing: Vec<usize> = standing.collect();
    assert!((80..=81).contains(&standing.len()));
    assert!(standing.iter().all(|&k| run.position_m[k] == 500.0));
    // Braking by 14 m/s takes 0.4·√14 m/s².
    let decel_mps2 = 0.4 * 14.0_f64.sqrt();
    let (arrival, before) = (standing[0], standing[0] - 50);
    let left_m = 500.0 - run.position_m[before];
    assert!((run.speed_mps[before] - (2.0 * decel_mps2 * left_m).sqrt()).abs() < 1e-3);
    assert!(run.speed_mps[arrival - 1] < 0.1 * decel_mps2 + 1e-9);
    assert!((run.end_s - 0.1 * (run.speed_mps.len() - 1) as f64).abs() < 0.1);
    assert!(*run.position_m.last().unwrap() > 999.0);
}

#[test]
fn the_clock_keeps_a_constant_speed_and_ends_when_told() {
    let road = Road::new(RoadMap {
        start_speed_mps: 20.0,
        ..map(1000.0, 20.0)
    })
    .unwrap();
    let clock = Clock::of(&road, driver().plan(&road, road.cap_mps()));
    for (node, arrival_s) in clock.arrival_s.iter().enumerate() {
        assert!((arrival_s - node as f64 / 20.0).abs() < 1e-9);
    }
    let run = driver().drive(&road, 0.5, Some(10.0)).unwrap();
    assert_eq!((run.speed_mps.len(), run.end_s), (21, 10.0));
    assert!((run.position_m[20] - 200.0).abs() < 1e-9);
}

#[test]
fn a_free_start_follows_the_law_of_acceleration() {
    let road = Road::new(map(2000.0, 25.0)).unwrap();
    let run = driver().drive(&road, 0.1, None).unwrap();
    // v̇ = A√(1 − v/w) gives v = w − w(1 − A t/(2 w))², reached after 2 w/A.
    for t in [2.0, 10.0, 20.0, 26.0] {
        let expected = 25.0 - 25.0 * (1.0 - 1.9 * t / 50.0_f64).powi(2);
        let found = run.speed_mps[(t * 10.0) as usize];
        assert!((found - expected).abs() < 0.15, "{found} {expected} at {t}");
    }
    assert!((run.speed_mps[300] - 25.0).abs() < 1e-9);
}

#[test]
fn slopes_and_expected_slowdowns_are_where_they_belong() {
    let mut driver = driver();
    driver.slowdowns.per_m = 0.002;
    let hill = [(0.0, 0.0), (1000.0, 0.1)].map(|(position_m, slope_rad)| SlopeAt {
        position_m,
        slope_rad,
    });
    let map = RoadMap {
        slope: hill.to_vec(),
        ..map(1000.0, 14.0)
    };
    let road = Road::new(map.clone()).unwrap();
    let run = driver.drive(&road, 0.1, None).unwrap();
    for (position_m, slope_rad) in run.position_m.iter().zip(run.slope_rad.as_ref().unwrap()) {
        assert!((slope_rad - 1e-4 * position_m.min(1000.0)).abs() < 1e-12);
    }
    let expected = driver.expected_slowdowns(&road);
    assert_eq!(expected.len(), 2);
    let at = |run: &FreeRun, position_m| run.position_m.partition_point(|s| *s < position_m);
    let slow = at(&run, expected[0].position_m.round());
    assert!((run.speed_mps[slow] - 5.0).abs() < 0.2);

    let known = RoadMap {
        slow_points: Some(vec![]),
        ..map
    };
    let road = Road::new(known).unwrap();
    assert!(driver.expected_slowdowns(&road).is_empty());
    let run = driver.drive(&road, 0.1, None).unwrap();
    assert!(run.speed_mps[at(&run, 334.0)] > 13.9);
}

#[test]
fn neither_the_spacing_of_nodes_nor_the_step_matters() {
    let map = RoadMap {
        stops: vec![stop(0.0, 2.0), stop(800.0, 9.0), stop(2950.0, 5.0)],
        limits: [(0.0, 14.0), (1000.0, 28.0), (2000.0, 8.0)]
            .map(|(position_m, limit_mps)| LimitFrom {
                position_m,
                limit_mps,
            })
            .to_vec(),
        ..map(3000.0, 14.0)
    };
    let driver = driver();
    let end_s = |spacing_m| {
        let road = Road::with_spacing(map.clone(), spacing_m).unwrap();
        let clock = Clock::of(&road, driver.plan(&road, road.cap_mps()));
        clock.arrival_s[(3000.0 / spacing_m) as usize]
    };
    for spacing_m in [0.5, 2.0] {
        let off = end_s(spacing_m) / end_s(1.0) - 1.0;
        assert!(off.abs() < 4e-3, "{off} at {spacing_m} m");
    }
    let road = Road::new(map).unwrap();
    let coarse = driver.drive(&road, 1.0, None).unwrap();
    let fine = driver.drive(&road, 0.1, None).unwrap();
    for (k, v) in coarse.speed_mps.iter().enumerate() {
        assert!((v - fine.speed_mps[10 * k]).abs() < 1e-9);
        assert!((coarse.position_m[k] - fine.position_m[10 * k]).abs() < 1e-9);
    }
}

#[test]
fn a_driver_survives_its_file_and_files_are_checked() {
    let mut driver = driver();
    driver.wanted.by_limit = vec![
        LimitHabit {
            limit_mps: 13.89,
            bias_mps: 0.1 + 0.2,
        },
        LimitHabit {
            limit_mps: 13.9,
            bias_mps: 0.5,
        },
    ];
    let json = serde_json::to_string(&driver).unwrap();
    let read = |json: &str| serde_json::from_str::<TripDriver>(json);
    assert_eq!(read(&json).unwrap(), driver);
    for (what, instead) in [
        ("\"exponent\":0.5", "\"exponent\":1.5"),
        ("\"scale_mps2\":1.9", "\"scale_mps2\":0.0"),
        ("\"scale_mps2\":1.9", "\"scale_mps2\":1.9,\"other\":1"),
        ("\"wanted\":{", "\"other\":1,\"wanted\":{"),
        ("\"per_m\":0.0", "\"per_m\":1.0"),
        ("\"limit_mps\":13.9,", "\"limit_mps\":13.89,"),
        ("\"limit_mps\":13.9,", "\"limit_mps\":1e9,"),
    ] {
        assert!(json.contains(what), "{what} in {json}");
        assert!(read(&json.replace(what, instead)).is_err(), "{instead}");
    }
}

#[test]
fn logs_that_cannot_be_used_say_why() {
    let speed = vec![10.0; 50];
    let said = |motion: &Motion| TripDriver::fit(&[motion]).unwrap_err();
    let without = log_of(vec![(Channel::Speed, speed.clone())], 0.1);
    assert!(matches!(said(&without), Error::NoLimits { .. }));
    let known_until = |known: usize| {
        let limits = (0..50).map(|k| if k < known { 13.9 } else { f64::NAN });
        let channels = [
            (Channel::Speed, speed.clone()),
            (Channel::SpeedLimit, limits.collect()),
        ];
        log_of(channels.to_vec(), 0.1)
    };
    assert!(matches!(said(&known_until(24)), Error::NoLimits { .. }));
    assert!(TripDriver::fit(&[&known_until(25)]).is_ok());
    let none = with_limit(speed.clone(), 139.0, 0.1);
    assert!(matches!(said(&none), Error::NoLimits { .. }));
    assert!(matches!(TripDriver::fit(&[]), Err(Error::Fit { .. })));
}

#[test]
fn absurd_roads_are_refused() {
    for bad in [
        map(1.2e6, 30.0),
        map(f64::INFINITY, 30.0),
        map(f64::NAN, 30.0),
        map(100.0, 0.0),
        RoadMap {
            limits: vec![],
            ..map(100.0, 30.0)
        },
        RoadMap {
            stops: vec![stop(90.0, 1.0), stop(80.0, 1.0)],
            ..map(100.0, 30.0)
        },
        RoadMap {
            stops: vec![stop(110.0, 1.0)],
            ..map(100.0, 30.0)
        },
    ] {
        assert!(matches!(Road::new(bad), Err(Error::Option { .. })));
    }
    // 1200 km in 50 min.
    let fast = with_limit(vec![400.0; 3000], 30.0, 1.0);
    let road = Road::of_motion(&fast, RoadKnowledge::Stops);
    assert!(matches!(
        road,
        Err(Error::Option {
            name: "length_m",
            ..
        })
    ));
    let road = Road::new(map(1e5, 30.0)).unwrap();
    for step_s in [1e-6, 0.0, -1.0, f64::NAN] {
        assert!(driver().drive(&road, step_s, None).is_err());
    }
}

#[test]
fn what_logs_do_not_show_has_fallbacks() {
    for log in [
        with_limit(vec![14.4; 1000], 13.89, 0.1),
        with_limit(vec![0.0; 1000], 13.89, 0.1),
        with_limit(vec![3.0], 13.89, 1.0),
    ] {
        let driver = TripDriver::fit(&[&log]).unwrap();
        assert_eq!((driver.acceleration.rises, driver.braking.falls), (0, 0));
        assert_eq!(
            (driver.acceleration.scale_mps2, driver.acceleration.max_mps2),
            (1.5, 2.0)
        );
        let braking = driver.braking;
        assert_eq!(
            (braking.scale_mps2, braking.exponent, braking.max_mps2),
            (0.4, 0.5, 2.5)
        );
        assert_eq!(driver.slowdowns.per_m, 0.0);
        let cruises = log.speed_mps()[0] > 10.0;
        let bias_mps = if cruises { 0.51 } else { 0.0 };
        assert!((driver.wanted.mps(13.89) - 13.89 - bias_mps).abs() < 1e-9);
        let road = Road::of_motion(&log, RoadKnowledge::Stops).unwrap();
        assert!(driver.drive(&road, 0.1, None).unwrap().end_s.is_finite());
    }
}

#[test]
fn stops_and_slow_points_are_read_from_a_log() {
    let ramp = |from: f64, to: f64| (0..50).map(move |k| from + (to - from) * f64::from(k) / 50.0);
    let speed: Vec<f64> = std::iter::repeat_n(0.0, 20)
        .chain(ramp(0.0, 14.0))
        .chain(ramp(14.0, 5.0))
        .chain(ramp(5.0, 14.0))
        .chain(ramp(14.0, 0.0))
        .chain(std::iter::repeat_n(0.0, 30))
        .chain(ramp(0.0, 14.0))
        .collect();
    let recording = recording::RecordedTrip::of(&with_limit(speed, 13.89, 0.1)).unwrap();
    let stops: Vec<(f64, f64)> = recording
        .map
        .stops
        .iter()
        .map(|s| (s.position_m, s.dwell_s))
        .collect();
    assert_eq!(stops.len(), 2);
    // 0.3 m/s are crossed 0.3/14·5 s after the ramp begins.
    let crossing_s = 5.0 * 0.3 / 14.0;
    assert!((stops[0].1 - 2.0 - crossing_s).abs() < 1e-9 && stops[0].0 == 0.0);
    assert!((stops[1].1 - 3.0 - 2.0 * crossing_s).abs() < 0.03 && (stops[1].0 - 165.0).abs() < 0.1);
    let slow = recording.map.slow_points.unwrap();
    assert_eq!((slow.len(), slow[0].speed_mps), (1, 5.0));
}

#[test]
fn readings_that_are_held_are_joined_but_not_standstill_nor_what_holds_for_long() {
    let read = |speed: &[f64]| {
        recording::RecordedTrip::of(&with_limit(speed.to_vec(), 13.89, 1.0)).unwrap()
    };
    let standing_and_steady = [[0.0; 20], [4.0; 20]].concat();
    let recording = read(
        &[
            &standing_and_steady[..],
            &[7.0, 7.0, 5.0, 5.0, 5.0, 5.0, 9.0],
        ]
        .concat(),
    );
    assert_eq!(recording.speed_mps[..40], standing_and_steady);
    assert_eq!(
        recording.speed_mps[40..],
        [7.0, 6.0, 5.0, 6.0, 7.0, 8.0, 9.0]
    );
    assert_eq!(recording.joined_s(), 4.0);

    let few = [
        &[2.0, 3.0, 3.0][..],
        &(4..40).map(f64::from).collect::<Vec<_>>(),
    ]
    .concat();
    let recording = read(&few);
    assert_eq!((&recording.speed_mps, recording.joined_s()), (&few, 0.0));
}

/// A driver's own free runs, as recordings.
fn recorded(driver: &TripDriver, unrest_mps2: f64) -> Vec<recording::RecordedTrip> {
    let trips = (0..4).map(|k| {
        let limits = (0..12).map(|i| LimitFrom {
            position_m: 900.0 * f64::from(i),
            limit_mps: if (i + k) % 3 == 0 { 8.33 } else { 13.89 },
        });
        let road = Road::new(RoadMap {
            limits: limits.collect(),
            stops: vec![stop(0.0, 4.0), stop(2500.0 + 300.0 * f64::from(k), 20.0)],
            ..map(10_000.0, 13.89)
        });
        let road = road.unwrap();
        let run = driver.drive(&road, 1.0, None).unwrap();
        let at = |&position_m: &f64| road.limit_mps()[position_m as usize];
        let channels = vec![
            (Channel::Speed, restless(&run.speed_mps, 1.0, unrest_mps2)),
            (Channel::SpeedLimit, run.position_m.iter().map(at).collect()),
        ];
        recording::RecordedTrip::of(&log_of(channels, 1.0)).unwrap()
    });
    trips.collect()
}

#[test]
fn unrest_is_found_again() {
    for unrest_mps2 in [0.0, 0.3, 0.8] {
        let recordings = recorded(&driver(), unrest_mps2);
        let found = driver().with_unrest_of(&recordings.iter().collect::<Vec<_>>());
        let found_mps2 = found.unwrap().unrest_mps2();
        // Stops of a recording at 1 Hz are where its samples are.
        assert!(
            (found_mps2 - unrest_mps2).abs() < 0.08,
            "{found_mps2} for {unrest_mps2}"
        );
    }
}

#[test]
fn a_car_that_stands_shows_no_unrest() {
    let standing = with_limit(vec![0.0; 600], 13.89, 1.0);
    assert_eq!(TripDriver::fit(&[&standing]).unwrap().unrest_mps2(), 0.0);
}

#[test]
fn the_style_of_trips_kept_back_is_the_spread_around_the_expected_speed() {
    let recordings = recorded(&driver(), 0.0);
    let recordings: Vec<&recording::RecordedTrip> = recordings.iter().collect();
    let plain = TripDriver::fit_recorded(&recordings).unwrap();
    let seen = plain.clone().with_style_of(&recordings).unwrap();
    let style = seen.style().unwrap();
    // Trips that are the driver's own free runs hardly stray.
    let steady = style.steady.unwrap();
    assert!(steady.half_width_mps < 1.0, "{steady:?}");
    assert!(steady.places > 100, "{steady:?}");
    assert!(seen.half_width(13.0, 0.0).is_fitted);
    for at in &style.accelerations {
        assert!(at.accel_mps2 <= 2.2 && at.decel_mps2 <= 2.4, "{at:?}");
    }
    // Of one trip nothing is kept back, and the band is assumed.
    let of_one = plain.with_style_of(&recordings[..1]).unwrap();
    assert_eq!(of_one.style(), None);
    let assumed = of_one.half_width(20.0, 0.0);
    assert_eq!((assumed.mps, assumed.is_fitted), (0.12 * 20.0, false));
    assert_eq!(of_one.half_width(5.0, 0.0).mps, 1.5);

    let text = serde_json::to_string(&seen).unwrap();
    assert_eq!(serde_json::from_str::<TripDriver>(&text).unwrap(), seen);
    let broken = text.replace("\"half_width_mps\":", "\"half_width_mps\":-");
    assert!(serde_json::from_str::<TripDriver>(&broken).is_err());
}
