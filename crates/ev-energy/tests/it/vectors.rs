//! Against an independent model: operating points, battery edge cases, cycle totals.

use ev_energy::{Trip, Vehicle};
use serde_json::Value;

use crate::shared::shared;

/// Names in the reference file, and here.
const VEHICLES: [(&str, &str); 2] = [("b250e", "b250e"), ("b250e_abc", "b250e-coast-down")];

fn reference() -> Option<Value> {
    let text = std::fs::read_to_string(shared("vectors/energy.json")?).unwrap();
    Some(serde_json::from_str(&text).unwrap())
}

#[track_caller]
fn assert_close(what: &str, actual: f64, expected: f64, relative: f64) {
    assert!(
        (actual - expected).abs() <= relative * expected.abs().max(1e-3),
        "{what}: {actual}, expected {expected}"
    );
}

#[test]
fn operating_points() {
    let Some(reference) = reference() else { return };
    for (theirs, ours) in VEHICLES {
        let vehicle = Vehicle::builtin(ours).unwrap();
        let points = reference["points"][theirs].as_array().unwrap();
        assert_eq!(points.len(), 50);
        for expected in points {
            let get = |key: &str| expected[key].as_f64().unwrap();
            let point = vehicle.operating_point(get("v"), get("a"), get("grade").atan());
            let pairs = [
                ("F_roll", point.rolling_n),
                ("F_air", point.aero_n),
                ("F_grade", point.grade_n),
                ("F_whl", point.wheel_force_n),
                ("w_em", point.motor_speed_rad_s),
                ("T_em", point.motor_torque_nm),
                ("F_brk", point.friction_brake_n),
                ("P_em_el", point.motor_electric_w),
                ("P_el", point.electric_power_w),
                ("I_bat", point.battery_current_a),
                ("P_bat", point.battery_power_w),
            ];
            for (key, actual) in pairs {
                assert_close(&format!("{ours} {expected} {key}"), actual, get(key), 1e-9);
            }
            assert_eq!(
                point.limited.torque,
                expected["torque_limited"].as_bool().unwrap()
            );
            assert_eq!(
                point.limited.battery,
                expected["battery_limited"].as_bool().unwrap()
            );
        }
    }
}

#[test]
fn battery_edge() {
    let Some(reference) = reference() else { return };
    let vehicle = Vehicle::builtin("b250e").unwrap();
    for expected in reference["battery_edge"].as_array().unwrap() {
        let draw = vehicle.battery().draw(expected["P_el"].as_f64().unwrap());
        assert_close(
            "current",
            draw.current_a,
            expected["I_bat"].as_f64().unwrap(),
            1e-9,
        );
        assert_close(
            "power",
            draw.power_w,
            expected["P_bat"].as_f64().unwrap(),
            1e-9,
        );
        assert_eq!(draw.limited, expected["limited"].as_bool().unwrap());
    }
}

#[test]
fn cycle_totals() {
    let Some(reference) = reference() else { return };
    for (theirs, ours) in VEHICLES {
        let vehicle = Vehicle::builtin(ours).unwrap();
        for cycle in ["udds", "us06"] {
            let Some(file) = shared(&format!("data/cycles/{cycle}.csv")) else {
                return;
            };
            let text = std::fs::read_to_string(file).unwrap();
            let speed_mps: Vec<f64> = text
                .lines()
                .skip(1)
                .map(|line| line.split(',').nth(1).unwrap().parse().unwrap())
                .collect();
            let trip = Trip {
                step_s: 1.0,
                speed_mps: &speed_mps,
                slope_rad: None,
                ..Trip::default()
            };
            let energy = vehicle.trip_energy(&trip).unwrap();
            let at_wheels_j = |sign: f64| -> f64 {
                vehicle
                    .trip_points(&trip)
                    .unwrap()
                    .map(|p| (sign * p.wheel_force_n * p.speed_mps).max(0.0))
                    .sum()
            };

            let expected = &reference["cycles"][theirs][cycle];
            let check = |key: &str, actual: f64| {
                assert_close(
                    &format!("{ours} {cycle} {key}"),
                    actual,
                    expected[key].as_f64().unwrap(),
                    1e-6,
                );
            };
            let per_100km = |energy_j: f64| energy_j / 3.6e6 / (energy.distance_m / 1e5);
            check("distance_km", energy.distance_m / 1e3);
            check("kwh_100km_battery", per_100km(energy.battery_energy_j));
            check(
                "kwh_100km_terminal",
                energy.consumption_kwh_per_100km().unwrap(),
            );
            check("kwh_100km_wall", per_100km(energy.wall_energy_j));
            check("wheel_pos_kwh_100km", per_100km(at_wheels_j(1.0)));
            check("wheel_neg_kwh_100km", per_100km(-at_wheels_j(-1.0)));
            check(
                "friction_brake_kwh_100km",
                per_100km(energy.budget.friction_brake_j),
            );
            check("aux_kwh_100km", per_100km(energy.budget.auxiliary_j));
            assert_eq!(
                expected["limited_samples"].as_f64().unwrap(),
                energy.limited.torque_s + energy.limited.battery_s
            );
        }
    }
}
