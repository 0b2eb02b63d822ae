//! Steps over a distance against trips over time, and their derivatives against differences.

use ev_energy::{KinkWidths, RoadStep, StepModel, Trip, Vehicle, library};
use proptest::prelude::*;

fn vehicle() -> impl Strategy<Value = Vehicle> {
    prop::sample::select(library::names().collect::<Vec<_>>())
        .prop_map(|name| Vehicle::builtin(name).unwrap())
}

const SHARP: KinkWidths = KinkWidths {
    force_n: 1e-6,
    fade: 1e-9,
};

const ROUND: KinkWidths = KinkWidths {
    force_n: 100.0,
    fade: 0.05,
};

proptest! {
    /// The same two speeds and the time that lies between them make a step of a trip.
    #[test]
    fn a_step_is_that_of_a_trip(
        vehicle in vehicle(), from in 0.0..40.0_f64, to in 0.0..40.0_f64, length_m in 0.5..60.0_f64, slope in -0.1..0.1_f64,
    ) {
        prop_assume!(from + to > 1.0);
        let step_s = length_m / (0.5 * (from + to));
        let (speed_mps, slope_rad) = ([from, to], [slope, slope]);
        let trip = Trip { step_s, speed_mps: &speed_mps, slope_rad: Some(&slope_rad), ..Trip::default() };
        let expected = vehicle.trip_energy(&trip).unwrap();
        let point = StepModel::new(&vehicle).operating_point(&RoadStep::new(length_m, slope), from, to);
        let energy_j = point.battery_power_w * step_s;
        let scale_j = 1.0 + expected.battery_energy_j.abs() + expected.budget.inertia_j.abs();
        prop_assert!((energy_j - expected.battery_energy_j).abs() < 1e-10 * scale_j);
        let limited = point.limited.torque || point.limited.battery;
        prop_assert_eq!(StepModel::new(&vehicle).energy_j(&RoadStep::new(length_m, slope), from, to).is_infinite(), limited);
    }

    /// With sharp kinks the formulas are the model.
    #[test]
    fn formulas_are_the_model(
        vehicle in vehicle(), from in 0.3..35.0_f64, to in 0.3..35.0_f64, length_m in 0.5..60.0_f64, slope in -0.1..0.1_f64,
    ) {
        let model = StepModel::new(&vehicle);
        let step = RoadStep::new(length_m, slope);
        let point = model.operating_point(&step, from, to);
        prop_assume!(!point.limited.torque && !point.limited.battery);
        let time_s = length_m / (0.5 * (from + to));
        let smooth = model.formula().unwrap().step(&step, from * from, to * to, SHARP);
        prop_assert!((smooth.time_s - time_s).abs() < 1e-12 * time_s);
        let scale_j = (point.battery_power_w.abs() + 1e3) * time_s;
        prop_assert!((smooth.energy_j - point.battery_power_w * time_s).abs() < 1e-8 * scale_j,
            "{} {}", smooth.energy_j, point.battery_power_w * time_s);
    }

    #[test]
    fn derivatives_are_those_of_differences(
        vehicle in vehicle(), from in 1.0..1000.0_f64, to in 1.0..1000.0_f64, length_m in 2.0..60.0_f64, slope in -0.1..0.1_f64,
    ) {
        // Beyond ±3 m/s² nobody plans, and the motor's limits are not part of the formulas.
        prop_assume!((to - from).abs() < 6.0 * length_m);
        let formula = StepModel::new(&vehicle).formula().unwrap();
        let step = RoadStep::new(length_m, slope);
        let at = |x: f64, y: f64| formula.step(&step, x, y, ROUND);
        let here = at(from, to);
        for (k, (dx, dy)) in [(1e-5 * from, 0.0), (0.0, 1e-5 * to)].into_iter().enumerate() {
            let (more, less) = (at(from + dx, to + dy), at(from - dx, to - dy));
            let span = 2.0 * (dx + dy);
            let close = |difference: f64, derivative: f64, scale: f64| {
                prop_assert!((difference / span - derivative).abs() < 2e-4 * (derivative.abs() + scale),
                    "{} against {}", difference / span, derivative);
                Ok(())
            };
            let slope_scale = here.energy_gradient[0].abs() + here.energy_gradient[1].abs();
            let bend_scale = here.energy_hessian.iter().map(|h| h.abs()).sum::<f64>() + slope_scale / span * 1e-3;
            close(more.energy_j - less.energy_j, here.energy_gradient[k], slope_scale)?;
            close(more.time_s - less.time_s, here.time_gradient[k], 0.0)?;
            for l in 0..2 {
                close(more.energy_gradient[l] - less.energy_gradient[l], here.energy_hessian[k + l], bend_scale)?;
                close(more.time_gradient[l] - less.time_gradient[l], here.time_hessian[k + l], 1e-9)?;
            }
        }
    }
}

#[test]
fn rows_are_their_steps_and_what_cannot_be_driven_is_infinite() {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let model = StepModel::new(&vehicle);
    let step = RoadStep::new(5.0, 0.02);
    let to_mps: Vec<f64> = (0..30).map(f64::from).collect();
    let mut energy_j = vec![0.0; 30];
    model.energies_j(&step, 10.0, &to_mps, &mut energy_j);
    for (to, energy_j) in to_mps.iter().zip(energy_j) {
        assert_eq!(
            energy_j.to_bits(),
            model.energy_j(&step, 10.0, *to).to_bits()
        );
        assert_eq!(energy_j.is_infinite(), *to > 12.5, "{to}");
    }
}

#[test]
fn the_propulsion_limit_is_where_the_model_says_so() {
    for name in library::names() {
        let vehicle = Vehicle::builtin(name).unwrap();
        let model = StepModel::new(&vehicle);
        let step = RoadStep::new(1.0, 0.0);
        for speed in [1.0, 8.0, 20.0, 35.0] {
            let spare_n = model.propulsion_limit_n(speed) - model.resistance_n(&step, speed);
            let accel = spare_n / vehicle.effective_mass_kg();
            let limited = |accel| {
                let limited = model.at(&step, speed, accel).limited;
                limited.torque || limited.battery
            };
            assert!(
                !limited(accel - 1e-6) && limited(accel + 1e-6),
                "{name} at {speed} m/s"
            );
        }
    }
}
