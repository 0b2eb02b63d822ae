//! Laws that hold for every motion and every vehicle.

use ev_energy::{
    CellState, LossTable, LossTableSpec, OperatingPoint, Trip, Vehicle, VoltageCurveSpec, Weather,
    library,
};
use proptest::prelude::*;

fn vehicle() -> impl Strategy<Value = Vehicle> {
    let names: Vec<_> = library::names().collect();
    // A weak battery, so that its limit is met too.
    let weak = (proptest::sample::select(names), 0.0..1.0_f64, 0.5..1.0_f64);
    (weak, any::<bool>(), any::<bool>()).prop_map(
        |((name, resistance_ohm, gear_efficiency), has_table, has_curve)| {
            let mut spec = Vehicle::builtin(name).unwrap().spec().clone();
            spec.sources.clear();
            spec.battery.resistance_ohm = resistance_ohm;
            spec.gear_efficiency = gear_efficiency;
            if has_table {
                spec.motor.loss = None;
                spec.motor.loss_table = Some(loss_table());
            }
            spec.battery.open_circuit_voltage_curve = has_curve.then(|| VoltageCurveSpec {
                soc_pct: vec![0.0, 40.0, 100.0],
                voltage_v: vec![280.0, 330.0, 390.0],
            });
            spec.battery.capacity_ah = Some(1.0);
            Vehicle::new(spec).unwrap()
        },
    )
}

fn loss_table() -> LossTableSpec {
    let text = "speed_rad_s,torque_nm,loss_w\n0,-200,2000\n0,0,0\n0,250,2500\n1400,-200,4000\n1400,0,900\n1400,250,5000\n";
    LossTableSpec {
        file: "loss.csv".to_owned(),
        spin_share_in_road_load: 0.0,
        table: Some(LossTable::from_csv(text, "loss.csv").unwrap()),
    }
}

/// Speed, slope and auxiliary power per sample; reverse and steep included.
fn motion() -> impl Strategy<Value = Vec<(f64, f64, f64)>> {
    let speed_mps = prop_oneof![Just(0.0), -5.0..50.0_f64];
    prop::collection::vec((speed_mps, -0.3..0.3_f64, 0.0..5e3_f64), 0..200)
}

fn weather() -> impl Strategy<Value = Option<Weather>> {
    proptest::option::of((-30.0..45.0_f64, -100.0..3000.0_f64).prop_map(
        |(temperature_degc, elevation_m)| Weather {
            temperature_degc,
            elevation_m,
        },
    ))
}

fn is_finite(point: &OperatingPoint) -> bool {
    let value = serde_json::to_value(point).unwrap();
    // JSON has no NaN and no infinity: they become null.
    value
        .as_object()
        .unwrap()
        .values()
        .all(|value| !value.is_null())
}

fn close(actual: f64, expected: f64, scale: f64) -> bool {
    (actual - expected).abs() <= 1e-9 * scale.max(1.0)
}

proptest! {
    #[test]
    fn finite_inputs_give_finite_points(
        vehicle in vehicle(),
        speed_mps in any::<f64>().prop_filter("finite", |x| x.is_finite()),
        accel_mps2 in any::<f64>().prop_filter("finite", |x| x.is_finite()),
        slope_rad in any::<f64>().prop_filter("finite", |x| x.is_finite()),
    ) {
        prop_assert!(is_finite(&vehicle.operating_point(speed_mps, accel_mps2, slope_rad)));
        prop_assert!(is_finite(&vehicle.operating_point(speed_mps.clamp(-60.0, 60.0), accel_mps2, slope_rad)));
        prop_assert!(is_finite(&vehicle.operating_point(0.0, accel_mps2.clamp(-5.0, 5.0), slope_rad)));
    }

    #[test]
    fn the_power_balance_closes(
        vehicle in vehicle(), v in -60.0..60.0_f64, a in -10.0..10.0_f64, slope_rad in -1.5..1.5_f64,
    ) {
        let p = vehicle.operating_point(v, a, slope_rad);
        let wheels_w = (p.inertia_n + p.rolling_n + p.aero_n + p.grade_n) * v;
        let losses_w = p.gear_loss_w + p.motor_loss_w + p.battery_loss_w + p.friction_brake_w;
        let sum_w = wheels_w + losses_w + p.auxiliary_power_w - p.undelivered_w;
        let scale_w = wheels_w.abs() + losses_w + p.undelivered_w;
        prop_assert!(close(p.battery_power_w, sum_w, scale_w), "{} is not {sum_w}", p.battery_power_w);
        for loss_w in [p.motor_loss_w, p.battery_loss_w, p.friction_brake_w, p.undelivered_w] {
            prop_assert!(loss_w >= 0.0, "{p:?}");
        }
        prop_assert!(p.gear_loss_w >= -1e-9 * scale_w, "{p:?}");
        prop_assert_eq!(p.limited.torque || p.limited.battery, p.undelivered_w > 0.0 || (v == 0.0 && p.limited.torque));
    }

    #[test]
    fn the_budget_closes_and_energy_is_the_integral_of_power(
        vehicle in vehicle(), motion in motion(), step_s in 0.05..2.0_f64, constant_aux in any::<bool>(),
        weather in weather(), soc_start_pct in proptest::option::of(0.0..100.0_f64),
        since_cold_start_s in proptest::option::of(0.0..1000.0_f64), cells_degc in proptest::option::of(-20.0..50.0_f64),
    ) {
        let speed_mps: Vec<f64> = motion.iter().map(|m| m.0).collect();
        let slope_rad: Vec<f64> = motion.iter().map(|m| m.1).collect();
        let aux_power_w: Vec<f64> = motion.iter().map(|m| m.2).collect();
        let trip = Trip {
            step_s,
            speed_mps: &speed_mps,
            slope_rad: Some(&slope_rad),
            extra_aux_power_w: (!constant_aux).then_some(&aux_power_w),
            weather,
            soc_start_pct,
            since_cold_start_s,
            cells: cells_degc.map(|temperature_degc| CellState { temperature_degc, soc_pct: soc_start_pct }),
        };
        let energy = vehicle.trip_energy(&trip).unwrap();
        let points: Vec<_> = vehicle.trip_points(&trip).unwrap().collect();
        prop_assert_eq!(points.len(), motion.len().saturating_sub(1));

        let turnover_w = |p: &OperatingPoint| (p.wheel_force_n * p.speed_mps).abs() + p.battery_power_w.abs();
        let scale_j = points.iter().map(turnover_w).sum::<f64>() * step_s;
        let integral_j = points.iter().map(|p| p.battery_power_w * step_s).sum();
        prop_assert!(close(energy.battery_energy_j, integral_j, scale_j));
        let budget_j = energy.budget.total_j() - energy.limited.undelivered_j;
        prop_assert!(close(energy.battery_energy_j, budget_j, scale_j), "{budget_j}: {energy:?}");
        let through_wheels_j = energy.wheel.propelled_j - energy.wheel.braked_j;
        let budget = energy.budget;
        let motion_j = budget.inertia_j + budget.rolling_j + budget.aero_j + budget.grade_j;
        prop_assert!(close(through_wheels_j, motion_j, scale_j));
        let at_terminals_j = energy.battery_energy_j - energy.budget.battery_loss_j;
        prop_assert!(close(energy.terminal_energy_j, at_terminals_j, scale_j));

        if let (Some(first), Some(last)) = (speed_mps.first(), speed_mps.last()) {
            let kinetic_j = 0.5 * vehicle.effective_mass_kg() * (last * last - first * first);
            prop_assert!(close(energy.budget.inertia_j, kinetic_j, scale_j));
        }
    }

    #[test]
    fn reverse_mirrors_forwards(
        vehicle in vehicle(), v in 0.01..50.0_f64, a in -5.0..5.0_f64, slope_rad in -0.5..0.5_f64,
    ) {
        let forwards = vehicle.operating_point(v, a, slope_rad);
        let backwards = vehicle.operating_point(-v, -a, -slope_rad);
        prop_assert_eq!(forwards.battery_power_w, backwards.battery_power_w);
        prop_assert_eq!(forwards.wheel_force_n, -backwards.wheel_force_n);
        prop_assert_eq!(forwards.motor_torque_nm, -backwards.motor_torque_nm);
    }

    #[test]
    fn battery_power_is_continuous_above_standstill(
        vehicle in vehicle(), v in 0.1..40.0_f64, a in -4.0..3.0_f64, slope_rad in -0.2..0.2_f64,
    ) {
        const NUDGE: f64 = 1e-7;
        let here = vehicle.operating_point(v, a, slope_rad).battery_power_w;
        // Near the battery limit the power goes with a square root, hence the wide bound.
        for near in [
            vehicle.operating_point(v + NUDGE, a, slope_rad),
            vehicle.operating_point(v, a + NUDGE, slope_rad),
            vehicle.operating_point(v, a, slope_rad + NUDGE),
        ] {
            prop_assert!((near.battery_power_w - here).abs() < 500.0, "{} and {here}", near.battery_power_w);
        }
    }
}
