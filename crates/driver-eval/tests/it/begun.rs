//! Phases that have begun, and drivers who are new.

use driver_eval::Error;
use driver_eval::begun::{BegunOf, evaluate_begun};
use driver_eval::live_words;
use driver_eval::new_driver::new_driver_curve;
use driver_model::live::{BegunSettings, Event, Horizon};
use driver_model::{FitSettings, Manoeuvre, ModelKind, PhaseKind};

use crate::support::fixture_trips;

#[test]
fn the_band_of_begun_phases_holds_about_its_share_and_the_median_beats_holding_the_speed() {
    let trips = fixture_trips(12);
    for manoeuvre in [Manoeuvre::Acceleration, Manoeuvre::Braking] {
        let fit = FitSettings {
            manoeuvre,
            ..FitSettings::default()
        };
        let scores = |judged| {
            let (model, settings) = (ModelKind::Profile, BegunSettings::default());
            evaluate_begun(&trips, model, &fit, &settings, judged).unwrap()
        };
        let all = scores(BegunOf::All);
        assert!(all.windows(2).all(|pair| pair[0].phases >= pair[1].phases));
        for score in all.iter().take(5) {
            let share = score.band.coverage_pct;
            assert!((75.0..=100.0).contains(&share), "{score:?}");
            assert!(score.band.score_mps >= score.band.width_mps && score.band.width_mps > 0.0);
            assert!(score.rmse_mps < score.hold_rmse_mps, "{score:?}");
        }
        let counting = scores(BegunOf::Counting);
        assert!(counting[0].phases <= all[0].phases);
    }
    let alone = evaluate_begun(
        &trips[..1],
        ModelKind::Profile,
        &FitSettings::default(),
        &BegunSettings::default(),
        BegunOf::All,
    );
    assert!(matches!(alone, Err(Error::TooFewUnits { .. })), "{alone:?}");
}

#[test]
fn a_new_driver_is_judged_on_trips_that_were_kept_back() {
    let trips = fixture_trips(12);
    let (own, others) = trips.split_at(6);
    let orders = [vec![0, 1, 2, 3, 4, 5], vec![5, 3, 1, 4, 2, 0]];
    let curve = |others: &[driver_model::DriveBehaviour]| {
        let (model, fit) = (ModelKind::Profile, FitSettings::default());
        new_driver_curve(own, others, model, &fit, 0.33, &[0, 1, 4, 5], &orders).unwrap()
    };
    let points = curve(others);
    let trips: Vec<usize> = points.iter().map(|point| point.own_trips).collect();
    // Two of six are kept back, so that five cannot be learnt.
    assert_eq!(trips, [0, 1, 4]);
    assert_eq!(
        (points[0].fitted_orders, points[0].own_rmse_mps),
        ((0, 2), None)
    );
    assert!(points[0].updated_rmse_all_mps > 0.0);
    assert_eq!(points[2].fitted_orders, (2, 2));
    let (difference, low, high) = points[2].difference_mps.unwrap();
    let (own_mps, updated_mps) = (
        points[2].own_rmse_mps.unwrap(),
        points[2].updated_rmse_mps.unwrap(),
    );
    assert!((difference - (updated_mps - own_mps)).abs() < 1e-9);
    assert!(low <= difference && difference <= high);
    // Without others an update is a fit to the own trips, and there is nothing before the first.
    let alone = curve(&[]);
    assert_eq!(alone[0].own_trips, 1);
    assert_eq!(alone[1].own_rmse_mps, alone[1].updated_rmse_mps);
}

#[test]
fn lines_say_what_is_predicted() {
    let ahead = Event::Ahead {
        time_s: 12.0,
        known_s: 12.2,
        speed_mps: 10.0,
        horizons: vec![Horizon {
            horizon_s: 5.0,
            speed_mps: 12.0,
            low_mps: Some(11.0),
            high_mps: None,
        }],
    };
    let line = live_words::line(&ahead);
    assert!(line.starts_with("     12.0  ahead"), "{line}");
    assert!(line.ends_with("5 s 43.2\n"), "{line}");
    let ends = Event::PhaseEnds {
        phase: PhaseKind::Braking,
        begin_s: 1.0,
        end_s: 3.5,
        end_speed_mps: 0.0,
        counts: false,
        rmse_mps: Some(0.5),
        in_band_pct: Some(100.0),
    };
    let line = live_words::line(&ends);
    assert!(
        line.contains("ended after 2.5 s, off by 1.8 km/h, 100 % in the band; none that counts"),
        "{line}"
    );
}
