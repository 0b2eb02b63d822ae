//! What happens where the car cannot follow, at standstill, and with inputs that are no motion.

use ev_energy::{CellIntakeSpec, CellState, Error, Trip, Vehicle, Weather};

fn trip(speed_mps: &[f64]) -> Trip<'_> {
    Trip {
        step_s: 1.0,
        speed_mps,
        slope_rad: None,
        ..Trip::default()
    }
}

#[test]
fn torque_limit_is_reported_in_seconds_and_joules() {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let energy = vehicle.trip_energy(&trip(&[10.0, 20.0, 20.0])).unwrap();
    assert_eq!(energy.limited.torque_s, 1.0);
    assert_eq!(energy.limited.battery_s, 0.0);

    let point = vehicle
        .trip_points(&trip(&[10.0, 20.0]))
        .unwrap()
        .next()
        .unwrap();
    assert!(point.motor_torque_nm <= 340.0 && point.limited.torque);
    let given_n = point.motor_torque_nm * 9.73 * 0.97 / 0.315;
    let missing_w = (point.wheel_force_n - given_n) * 15.0;
    assert!((point.undelivered_w - missing_w).abs() < 1e-6);
    assert!((energy.limited.undelivered_j - missing_w).abs() < 1e-6);
}

#[test]
fn battery_limit_is_reported() {
    let mut spec = Vehicle::builtin("b250e").unwrap().spec().clone();
    spec.battery.resistance_ohm = 0.5;
    let vehicle = Vehicle::new(spec).unwrap();
    assert_eq!(vehicle.battery().max_power_w(), 315.0 * 315.0 / 2.0);

    let point = vehicle.operating_point(20.0, 2.0, 0.0);
    assert!(point.limited.battery && !point.limited.torque);
    assert_eq!(point.terminal_power_w, vehicle.battery().max_power_w());
    assert!((point.undelivered_w - (point.electric_power_w - point.terminal_power_w)).abs() < 1e-9);
}

#[test]
fn a_parked_car_draws_its_auxiliaries_only() {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let energy = vehicle.trip_energy(&trip(&[0.0; 61])).unwrap();
    assert_eq!(energy.duration_s, 60.0);
    assert_eq!(energy.terminal_energy_j, 400.0 * 60.0);
    assert_eq!(energy.consumption_kwh_per_100km(), None);
}

#[test]
fn negative_zero_speed_is_standstill() {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    assert_eq!(
        vehicle.operating_point(-0.0, 1.0, 0.0).motor_torque_nm,
        vehicle.operating_point(0.0, 1.0, 0.0).motor_torque_nm
    );
}

#[test]
fn no_torque_above_the_maximum_motor_speed() {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let fast = vehicle.operating_point(50.0, 0.0, 0.0);
    assert!(fast.motor_speed_rad_s > 1500.0 && fast.limited.torque);
    assert_eq!(fast.motor_torque_nm, 0.0);
    assert_eq!(
        vehicle.operating_point(50.0, -3.0, 0.0).motor_torque_nm,
        0.0
    );
}

#[test]
fn regeneration_fades_in_with_speed() {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let torque_nm = |v| vehicle.operating_point(v, -3.0, 0.0).motor_torque_nm;
    assert_eq!(torque_nm(1.5), 0.0);
    assert!((torque_nm(3.0) / torque_nm(4.5) - 0.5).abs() < 1e-12);
    assert_eq!(torque_nm(4.5), torque_nm(8.0));
}

#[test]
fn trips_without_a_step_are_empty() {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    for speed_mps in [&[][..], &[3.0][..]] {
        let energy = vehicle.trip_energy(&trip(speed_mps)).unwrap();
        assert_eq!((energy.duration_s, energy.battery_energy_j), (0.0, 0.0));
    }
}

#[test]
fn slope_and_auxiliaries_are_means_of_two_samples() {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let energy = vehicle
        .trip_energy(&Trip {
            step_s: 2.0,
            speed_mps: &[10.0, 10.0],
            slope_rad: Some(&[0.0, 0.02]),
            extra_aux_power_w: Some(&[100.0, 300.0]),
            ..Trip::default()
        })
        .unwrap();
    assert_eq!(energy.budget.auxiliary_j, 2.0 * (400.0 + 200.0));
    let climb_j = 1928.0 * 9.81 * 20.0 * 0.01_f64.sin();
    assert!((energy.budget.grade_j - climb_j).abs() < 1e-6);
}

#[test]
fn bad_trips_name_channel_and_sample() {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let nan = vehicle
        .trip_energy(&trip(&[0.0, f64::NAN, 1.0]))
        .unwrap_err();
    assert!(
        matches!(
            nan,
            Error::Sample {
                channel: "speed_mps",
                index: 1,
                ..
            }
        ),
        "{nan}"
    );
    let short = vehicle
        .trip_energy(&Trip {
            slope_rad: Some(&[0.0]),
            ..trip(&[0.0, 1.0])
        })
        .unwrap_err();
    assert!(
        matches!(
            short,
            Error::Length {
                channel: "slope_rad",
                found: 1,
                expected: 2
            }
        ),
        "{short}"
    );
    let step = vehicle
        .trip_energy(&Trip {
            step_s: 0.0,
            ..trip(&[0.0, 1.0])
        })
        .unwrap_err();
    assert!(
        matches!(step, Error::Argument { name: "step_s", .. }),
        "{step}"
    );
}

#[test]
fn a_cold_start_costs_and_the_cost_fades() {
    let mut spec = Vehicle::builtin("bmw-i3-60ah").unwrap().spec().clone();
    spec.warm_up.force_n = 150.0;
    spec.warm_up.cold_rise_n = 100.0;
    let vehicle = Vehicle::new(spec).unwrap();
    let speed_mps = [10.0; 601];
    let energy_j = |since_cold_start_s, temperature_degc| {
        let trip = Trip {
            step_s: 1.0,
            speed_mps: &speed_mps,
            since_cold_start_s,
            weather: Some(Weather {
                temperature_degc,
                elevation_m: 0.0,
            }),
            ..Trip::default()
        };
        let budget = vehicle.trip_energy(&trip).unwrap().budget;
        budget.rolling_j
    };
    let warm_j = energy_j(None, 20.0);
    // 150 N for 150 s at 10 m/s, less what is left after ten minutes
    let expected_j = 150.0 * 150.0 * 10.0 * (1.0 - f64::exp(-4.0));
    let cost_j = energy_j(Some(0.0), 20.0) - warm_j;
    assert!((cost_j / expected_j - 1.0).abs() < 1e-3, "{cost_j}");
    assert!(energy_j(Some(0.0), 0.0) - energy_j(None, 0.0) > 1.5 * cost_j);
    assert!(energy_j(Some(3600.0), 20.0) - warm_j < 1e-3 * cost_j);
    let built_in = Vehicle::builtin("b250e").unwrap();
    assert!(!built_in.warms_up() && vehicle.warms_up());
    assert!(!vehicle.started(true).warms_up());
}

#[test]
fn cold_and_full_cells_take_less_of_the_braking() {
    let mut spec = Vehicle::builtin("bmw-i3-60ah").unwrap().spec().clone();
    spec.regeneration.cells = Some(CellIntakeSpec {
        power_w: 20e3,
        power_w_per_k: 3e3,
        power_w_per_soc_pct: 500.0,
    });
    let vehicle = Vehicle::new(spec).unwrap();
    let braking: Vec<f64> = (0..10).map(|k| 25.0 - 1.5 * f64::from(k)).collect();
    let regained_j = |cells| {
        let trip = Trip {
            step_s: 1.0,
            speed_mps: &braking,
            cells,
            ..Trip::default()
        };
        vehicle.trip_energy(&trip).unwrap().budget.regenerated_j
    };
    let state = |temperature_degc, soc_pct| {
        Some(CellState {
            temperature_degc,
            soc_pct: Some(soc_pct),
        })
    };
    let (cold, full, warm) = (state(2.0, 70.0), state(2.0, 90.0), state(25.0, 70.0));
    assert!(regained_j(full) < regained_j(cold) && regained_j(cold) < regained_j(warm));
    assert!((regained_j(warm) - regained_j(None)).abs() < 1e-9);
    let wrong = Trip {
        cells: state(500.0, 70.0),
        ..Trip::default()
    };
    assert!(vehicle.trip_energy(&wrong).is_err());
}
