//! Parameters from power: the truth is found again, and what cannot be found is said.

use ev_energy::{
    CellIntakeSpec, CellState, Error, RoadLoadSpec, Trip, Vehicle, VehicleSpec, Weather,
    calibration::{Calibration, CalibrationTrip, calibrate, leave_one_out},
};

const STEP_S: f64 = 0.1;
const SAMPLES: usize = 4000;

/// Town and country, uphill and down, differently in every trip.
fn motion(number: usize) -> (Vec<f64>, Vec<f64>) {
    let k = 1.0 + 0.13 * number as f64;
    let top_mps = 9.0 + 3.5 * (number % 4) as f64;
    let speed = |i: usize| {
        let t = i as f64 * STEP_S;
        let wave = (t / (11.0 * k)).sin() + 0.4 * (t / (3.1 * k)).sin();
        (top_mps * (0.45 + 0.8 * wave)).max(0.0)
    };
    let slope = |i: usize| 0.03 * (i as f64 * STEP_S / (25.0 * k)).sin();
    (
        (0..SAMPLES).map(speed).collect(),
        (0..SAMPLES).map(slope).collect(),
    )
}

/// Trips as a true vehicle would have driven them, with noise of the power meter.
fn trips(truth: &Vehicle, count: usize, noise_w: f64) -> Vec<CalibrationTrip> {
    (0..count)
        .map(|number| {
            let (speed_mps, slope_rad) = motion(number);
            let trip = Trip {
                step_s: STEP_S,
                speed_mps: &speed_mps,
                slope_rad: Some(&slope_rad),
                weather: Some(Weather {
                    temperature_degc: if number % 2 == 0 { 22.0 } else { 3.0 },
                    elevation_m: 500.0,
                }),
                ..Trip::default()
            };
            let noise = |k: usize| noise_w * (k as f64 * (1.3 + 0.1 * number as f64)).sin();
            let power_w: Vec<f64> = truth
                .trip_points(&trip)
                .unwrap()
                .enumerate()
                .map(|(k, point)| point.terminal_power_w + noise(k))
                .collect();
            let mut measured = CalibrationTrip::default();
            let no_torque = vec![f64::NAN; power_w.len()];
            measured.add(truth, &trip, &power_w, &no_torque).unwrap();
            measured
        })
        .collect()
}

fn i3() -> Vehicle {
    Vehicle::builtin("bmw-i3-60ah").unwrap()
}

fn truth(change: impl FnOnce(&mut VehicleSpec)) -> Vehicle {
    let mut spec = i3().spec().clone();
    spec.mass_kg = 1600.0;
    spec.auxiliary_power_w = 700.0;
    spec.gear_efficiency = 0.96;
    spec.weather.winter_rolling_surcharge = 0.4;
    spec.regeneration.max_decel_mps2 = 0.9;
    if let RoadLoadSpec::CoastDown {
        constant_n,
        quadratic_n_per_mps2,
        ..
    } = &mut spec.road_load
    {
        *constant_n = 150.0;
        *quadratic_n_per_mps2 = 0.3;
    }
    change(&mut spec);
    Vehicle::new(spec).unwrap()
}

/// Fits until the intervals tell every parameter that is left.
fn told(trips: &[CalibrationTrip]) -> Calibration {
    let trips: Vec<&CalibrationTrip> = trips.iter().collect();
    let mut all = calibrate(&i3(), &trips).unwrap();
    loop {
        let fold = |k| leave_one_out(&i3(), &all, &trips, k).unwrap();
        // Of one trip nothing can be left out.
        let left_out = if trips.len() > 1 { trips.len() } else { 0 };
        let folds: Vec<_> = (0..left_out).map(fold).collect();
        all = all.with_intervals(&folds);
        match all.without_untold(&i3(), &trips).unwrap() {
            None => return all,
            Some(fewer) => all = fewer,
        }
    }
}

/// What is not told has its value from before, in the vehicle too.
fn assert_kept(fitted: &Calibration) {
    for parameter in fitted.parameters.iter().filter(|p| !p.identified) {
        assert_eq!(parameter.value, parameter.start, "{parameter:?}");
        assert!(
            parameter.tried.is_some() && parameter.ci95.is_none(),
            "{parameter:?}"
        );
        assert!(
            parameter.remark.starts_with("not identified: "),
            "{parameter:?}"
        );
    }
    let told = fitted.parameters.iter().filter(|p| p.identified);
    assert!(told.clone().all(|p| p.tried.is_none()));
    if told.count() == 0 {
        assert_eq!(fitted.vehicle.spec(), i3().spec());
    }
}

fn fit(trips: &[CalibrationTrip]) -> Calibration {
    let trips: Vec<&CalibrationTrip> = trips.iter().collect();
    calibrate(&i3(), &trips).unwrap()
}

#[test]
fn the_truth_is_found_again() {
    let truth = truth(|_| {});
    let trips = trips(&truth, 6, 0.0);
    let fitted = fit(&trips);
    let value = |key: &str| {
        let mut parameters = fitted.parameters.iter();
        parameters.find(|p| p.key == key).unwrap().value
    };
    for (key, expected, tolerance) in [
        ("mass_kg", 1600.0, 2.0),
        ("road_load.coast_down.constant_n", 150.0, 3.0),
        ("road_load.coast_down.quadratic_n_per_mps2", 0.3, 0.01),
        ("weather.winter_rolling_surcharge", 0.4, 0.02),
        ("gear_efficiency", 0.96, 0.002),
        ("regeneration.max_decel_mps2", 0.9, 0.01),
    ] {
        assert!(
            (value(key) - expected).abs() < tolerance,
            "{key} {}",
            value(key)
        );
    }
    for trip in &trips {
        let comparison = trip.compare(&fitted.vehicle).unwrap();
        assert!(comparison.error_pct().unwrap().abs() < 0.1);
        assert!(comparison.power_rmse_w().unwrap() < 30.0);
    }
}

#[test]
fn intervals_come_from_leaving_trips_out_and_hold_the_truth() {
    let truth = truth(|_| {});
    let trips = trips(&truth, 6, 2000.0);
    let refs: Vec<&CalibrationTrip> = trips.iter().collect();
    let all = fit(&trips);
    let folds: Vec<_> = (0..trips.len())
        .map(|k| leave_one_out(&i3(), &all, &refs, k).unwrap())
        .collect();
    for fold in &folds {
        assert!(fold.held_out.error_pct().unwrap().abs() < 5.0);
    }
    assert!(matches!(
        leave_one_out(&i3(), &all, &refs, trips.len()),
        Err(Error::Calibration { .. })
    ));
    let all = all.with_intervals(&folds);
    let mass = &all.parameters[0];
    assert_eq!(mass.key, "mass_kg");
    let [low, high] = mass.ci95.unwrap();
    assert!(
        low < 1600.0 && 1600.0 < high && high - low < 300.0,
        "{mass:?}"
    );
    assert!(mass.identified && mass.std_error.unwrap() > 0.0, "{mass:?}");
    let n = all.parameters.len();
    assert!(all.correlation.len() == n && all.correlation.iter().all(|row| row.len() == n));
}

#[test]
fn a_trip_that_is_left_out_leaves_nothing_behind() {
    let trips = trips(&truth(|_| {}), 6, 100.0);
    // the last one is the only cold one
    let refs: Vec<&CalibrationTrip> = [0, 2, 4, 1].map(|k| &trips[k]).to_vec();
    let all = calibrate(&i3(), &refs).unwrap();
    let surcharge = all
        .parameters
        .iter()
        .position(|p| p.key == "weather.winter_rolling_surcharge")
        .unwrap();
    assert!(all.parameters[surcharge].value > 0.2);
    let fold = leave_one_out(&i3(), &all, &refs, 3).unwrap();
    assert_eq!(fold.values[surcharge], 0.0);
    assert!(fold.held_out.error_pct().unwrap() < -2.0);
}

#[test]
fn what_runs_into_its_bound_is_not_identified() {
    let truth = truth(|spec| spec.auxiliary_power_w = 4000.0);
    let fitted = fit(&trips(&truth, 4, 0.0));
    let auxiliary = fitted
        .parameters
        .iter()
        .find(|p| p.key == "auxiliary_power_w")
        .unwrap();
    assert!(!auxiliary.identified, "{auxiliary:?}");
    assert!(auxiliary.remark.contains("upper bound"), "{auxiliary:?}");
    assert!(auxiliary.tried.unwrap() > 1900.0, "{auxiliary:?}");
    assert_kept(&fitted);
}

#[test]
fn copies_of_one_trip_tell_nothing() {
    let truth = truth(|_| {});
    for count in [1, 2, 4] {
        // a copy measured with other noise is still a copy
        let copy = |k: usize| trips(&truth, 1, 2000.0 + k as f64).remove(0);
        let fitted = told(&(0..count).map(copy).collect::<Vec<_>>());
        assert!(
            fitted.parameters.iter().all(|p| !p.identified),
            "{:?}",
            fitted.parameters
        );
        assert_kept(&fitted);
    }
}

#[test]
fn one_speed_tells_nothing() {
    let speed_mps: Vec<f64> = (0..SAMPLES)
        .map(|k| 25.0 + 0.1 * (k as f64 * 0.07).sin())
        .collect();
    let trip = Trip {
        speed_mps: &speed_mps,
        ..Trip::default()
    };
    let steady = |noise_w: f64| {
        let mut steady = CalibrationTrip::default();
        let power_w = (1..SAMPLES).map(|k| 15e3 + noise_w * (k as f64).sin());
        steady
            .add(
                &i3(),
                &trip,
                &power_w.collect::<Vec<_>>(),
                &[f64::NAN; SAMPLES - 1],
            )
            .unwrap();
        steady
    };
    let fitted = fit(&[steady(100.0), steady(200.0), steady(300.0)]);
    assert!(
        fitted
            .parameters
            .iter()
            .all(|p| p.remark.contains("one speed, 90 km/h"))
    );
    assert_kept(&fitted);
}

#[test]
fn of_two_that_go_together_one_keeps_its_value_and_the_other_says_so() {
    let fitted = told(&trips(&truth(|_| {}), 6, 2000.0));
    assert_kept(&fitted);
    for held in fitted
        .parameters
        .iter()
        .filter(|p| p.remark.contains("correlation"))
    {
        let other = fitted
            .parameters
            .iter()
            .find(|p| held.remark.contains(p.key))
            .unwrap();
        assert!(
            !other.identified || other.remark.contains(held.key),
            "{other:?}"
        );
    }
}

#[test]
fn a_road_load_of_zero_is_no_parameter() {
    let mut spec = i3().spec().clone();
    if let RoadLoadSpec::CoastDown {
        quadratic_n_per_mps2,
        ..
    } = &mut spec.road_load
    {
        *quadratic_n_per_mps2 = 0.0;
    }
    let without_drag = Vehicle::new(spec).unwrap();
    let trips = trips(&truth(|_| {}), 3, 0.0);
    let refs: Vec<&CalibrationTrip> = trips.iter().collect();
    let fitted = calibrate(&without_drag, &refs).unwrap();
    let keys: Vec<&str> = fitted.parameters.iter().map(|p| p.key).collect();
    assert!(!keys.contains(&"road_load.coast_down.quadratic_n_per_mps2"));
    assert!(keys.contains(&"road_load.coast_down.constant_n"));
    assert!(fitted.parameters.iter().all(|p| p.value.is_finite()));
}

#[test]
fn fitted_values_have_a_source_and_make_a_vehicle_file() {
    let fitted = fit(&trips(&truth(|_| {}), 3, 100.0));
    let check = fitted.vehicle.check().unwrap();
    assert_eq!(check.without_source, [""; 0]);
    let text = fitted.vehicle.spec().to_toml().unwrap();
    let read = Vehicle::from_toml(&text, "fitted.toml").unwrap();
    assert_eq!(read.spec(), fitted.vehicle.spec());
}

#[test]
fn without_measured_power_there_is_nothing_to_fit() {
    let (speed_mps, _) = motion(0);
    let trip = Trip {
        speed_mps: &speed_mps,
        ..Trip::default()
    };
    let mut blind = CalibrationTrip::default();
    blind
        .add(
            &i3(),
            &trip,
            &[f64::NAN; SAMPLES - 1],
            &[f64::NAN; SAMPLES - 1],
        )
        .unwrap();
    assert_eq!(blind.means(), 0);
    let error = calibrate(&i3(), &[&blind]).unwrap_err();
    assert!(matches!(error, Error::Calibration { .. }), "{error}");
    let short = blind.add(&i3(), &trip, &[1.0], &[1.0]).unwrap_err();
    assert!(
        matches!(
            short,
            Error::Length {
                channel: "power_w",
                ..
            }
        ),
        "{short}"
    );
}

/// Trips from a cold start, with motor torque and the temperature of the cells.
fn told_trips(truth: &Vehicle, count: usize) -> Vec<CalibrationTrip> {
    let trip = |number: usize| {
        let (speed_mps, slope_rad) = motion(number);
        let speed_mps: Vec<f64> = speed_mps.iter().map(|v| 1.6 * v).collect();
        let trip = Trip {
            step_s: STEP_S,
            speed_mps: &speed_mps,
            slope_rad: Some(&slope_rad),
            since_cold_start_s: Some(0.0),
            cells: Some(CellState {
                temperature_degc: 25.0 - 6.0 * (number % 5) as f64,
                soc_pct: Some(40.0 + 20.0 * (number % 3) as f64),
            }),
            ..Trip::default()
        };
        let points: Vec<_> = truth.trip_points(&trip).unwrap().collect();
        let power_w: Vec<f64> = points.iter().map(|p| p.terminal_power_w).collect();
        let torque_nm: Vec<f64> = points.iter().map(|p| p.motor_torque_nm).collect();
        let mut measured = CalibrationTrip::default();
        measured.add(truth, &trip, &power_w, &torque_nm).unwrap();
        measured
    };
    (0..count).map(trip).collect()
}

#[test]
fn torque_and_cold_starts_tell_what_power_alone_does_not() {
    let truth = truth(|spec| {
        spec.wheel_radius_m = 0.339;
        spec.warm_up.force_n = 200.0;
        spec.motor.loss.as_mut().unwrap().weakening_w = 4000.0;
        spec.weather.winter_rolling_surcharge = 0.0;
        spec.regeneration.cells = Some(CellIntakeSpec {
            power_w: 20e3,
            power_w_per_k: 2e3,
            power_w_per_soc_pct: 300.0,
        });
    });
    let fitted = fit(&told_trips(&truth, 8));
    for (key, expected, tolerance) in [
        ("wheel_radius_m", 0.339, 0.001),
        ("warm_up.force_n", 200.0, 20.0),
        ("motor.loss.weakening_w", 4000.0, 800.0),
    ] {
        let found = fitted.parameters.iter().find(|p| p.key == key).unwrap();
        assert!((found.value - expected).abs() < tolerance, "{found:?}");
    }
    let keys = |trips: &[CalibrationTrip]| -> Vec<&str> {
        fit(trips).parameters.iter().map(|p| p.key).collect()
    };
    assert!(!keys(&trips(&truth, 3, 0.0)).contains(&"warm_up.force_n"));
    assert!(!keys(&trips(&truth, 3, 0.0)).contains(&"wheel_radius_m"));
}

#[test]
fn a_smaller_wheel_leaves_the_top_speed() {
    let truth = truth(|spec| spec.wheel_radius_m = 0.339);
    let fitted = fit(&told_trips(&truth, 4));
    let top_mps = |vehicle: &Vehicle| {
        let spec = vehicle.spec();
        spec.motor.max_speed_rad_s * spec.wheel_radius_m / spec.gear_ratio
    };
    assert!((top_mps(&fitted.vehicle) - top_mps(&i3())).abs() < 1e-9);
}
