//! Plans between their own bound and the optimum of an independent solver.

use ev_energy::{StepModel, Vehicle, VehicleSpec, library};
use proptest::prelude::*;
use speed_plan::{
    Answer, Case, Convergence, Demand, Envelope, EnvelopePoint, Error, Problem, Road, Settings,
    certify, plan,
};

use crate::shared::shared;
use crate::{kilometre, vehicle};

/// The plan is no cheaper than the relaxation and not far above it; in % of its energy, or `None` where nothing can be driven.
fn gap_pct(problem: &Problem, demand: Demand) -> Option<f64> {
    let Answer::Plan(plan) = plan(problem, demand, &Settings::default()).unwrap() else {
        return None;
    };
    let certificate = certify(problem, demand, &plan.run).unwrap();
    assert_ne!(certificate.convergence, Convergence::Failed);
    let (least_j, gap_pct) = (certificate.energy_j.unwrap(), certificate.gap_pct.unwrap());
    let rounding_j = 1e-6 * plan.run.energy_scale_j();
    assert!(plan.lower_bound_j <= plan.run.energy_j + rounding_j);
    if certificate.convergence == Convergence::Solved {
        assert!(
            plan.run.energy_j >= least_j - rounding_j,
            "{} J, by the other solver {least_j} J",
            plan.run.energy_j
        );
    }
    Some(gap_pct)
}

#[test]
fn reference_plans_are_no_cheaper_than_the_relaxation() {
    let Some(folder) = shared("vectors/planning") else {
        return;
    };
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let case = Case::from_json(&text, &name).unwrap();
        if !case.columns.signals.is_empty() || !case.columns.earliest_s.is_empty() {
            continue;
        }
        let model = StepModel::new(&case.vehicle);
        let problem = Problem::new(model, case.envelope.clone(), case.columns.clone()).unwrap();
        let demand = case
            .latest_arrival_s
            .map_or(Demand::Price(0.0), Demand::Arrival);
        if let Some(gap_pct) = gap_pct(&problem, demand) {
            assert!(gap_pct < 0.6, "{name}: {gap_pct} %");
        }
    }
}

/// Zones of 50, 100, 70 and 50 km/h, waves of 3 %, a stop.
#[test]
fn the_relaxation_is_near_on_ten_kilometres() {
    let wave = |at: f64| 15.0 * (at / 500.0).sin();
    let road = Road {
        length_m: 10_000.0,
        limits: [(0.0, 50.0), (2500.0, 100.0), (5500.0, 70.0), (8000.0, 50.0)]
            .map(|(at, kmh)| (at, kmh / 3.6))
            .into(),
        elevation: (0..=200)
            .map(|k| 50.0 * f64::from(k))
            .map(|at| (at, wave(at)))
            .collect(),
        stops: vec![(6800.0, 10.0)],
        ..Road::default()
    };
    let car = vehicle("b250e");
    let columns = road.columns().unwrap();
    let problem = Problem::new(StepModel::new(&car), Envelope::default(), columns).unwrap();
    for demand in [Demand::Arrival(650.0), Demand::Price(4000.0)] {
        let gap_pct = gap_pct(&problem, demand).unwrap();
        assert!(gap_pct < 0.3, "{gap_pct} %");
    }
}

#[test]
fn signals_leaders_and_tables_are_refused_by_name() {
    let car = vehicle("b250e");
    let mut columns = kilometre().columns().unwrap();
    let open = Problem::new(StepModel::new(&car), Envelope::default(), columns.clone()).unwrap();
    let demand = Demand::Price(3e3);
    let Answer::Plan(plan) = plan(&open, demand, &Settings::default()).unwrap() else {
        panic!("it can be driven");
    };
    columns.earliest_s = vec![0.0; columns.position_m.len()];
    let led = Problem::new(StepModel::new(&car), Envelope::default(), columns).unwrap();
    let error = certify(&led, demand, &plan.run).unwrap_err();
    assert!(matches!(error, Error::NotConvex { what: "a leader" }));
    let road = Road {
        signals: vec![(500.0, vec![[0.0, 100.0]])],
        ..kilometre()
    };
    let columns = road.columns().unwrap();
    let lit = Problem::new(StepModel::new(&car), Envelope::default(), columns).unwrap();
    let error = certify(&lit, demand, &plan.run).unwrap_err();
    assert!(matches!(error, Error::NotConvex { what: "signals" }));
}

#[derive(Debug, Clone)]
struct Trip {
    road: Road,
    envelope: Vec<EnvelopePoint>,
    car: VehicleSpec,
    /// Price of time in W, or arrival as a multiple of the earliest.
    price_w: Option<f64>,
    slack: f64,
}

fn trips() -> impl Strategy<Value = Trip> {
    let names: Vec<String> = library::names().map(str::to_owned).collect();
    let limits = prop::collection::vec(7.0..36.0_f64, 4);
    let heights = prop::collection::vec(-15.0..15.0_f64, 4);
    let envelope = prop::collection::vec((0.3..2.5_f64, 0.8..3.0_f64), 1..4);
    let changes = prop::option::of((0.0..1.0_f64, 5e3..60e3_f64, 0.0..6e3_f64));
    (
        prop::sample::select(names),
        (limits, heights, prop::option::of(450.0..750.0_f64)),
        envelope,
        changes,
        prop::option::of(0.0..2e4_f64),
        1.02..1.6_f64,
    )
        .prop_map(
            |(car, (limits, heights, stop), points, changes, price_w, slack)| {
                let mut car = Vehicle::builtin(&car).unwrap().spec().clone();
                car.sources.clear();
                if let (Some((torque, power_w, weakening_w)), Some(loss)) =
                    (changes, &mut car.motor.loss)
                {
                    car.regeneration.torque_fraction = torque;
                    car.regeneration.max_power_w = power_w;
                    loss.weakening_w = weakening_w;
                    loss.weakening_from_share = 0.3;
                }
                let at = (0_u8..).map(|k| 300.0 * f64::from(k));
                let envelope = points
                    .iter()
                    .zip(0_u8..)
                    .map(|((most, least), k)| EnvelopePoint {
                        speed_mps: 8.0 * f64::from(k),
                        min_mps2: -least,
                        max_mps2: *most,
                    });
                Trip {
                    road: Road {
                        length_m: 1200.0,
                        limits: at.clone().zip(limits).collect(),
                        elevation: at.map(|at| 1.3 * at).zip(heights).collect(),
                        stops: stop.map(|at| (at, 10.0)).into_iter().collect(),
                        ..Road::default()
                    },
                    envelope: envelope.collect(),
                    car,
                    price_w,
                    slack,
                }
            },
        )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn plans_of_random_roads_are_no_cheaper_than_the_relaxation(trip in trips()) {
        let car = Vehicle::new(trip.car.clone()).unwrap();
        let envelope = Envelope::new(trip.envelope.clone()).unwrap();
        let columns = trip.road.columns().unwrap();
        let problem = Problem::new(StepModel::new(&car), envelope, columns).unwrap();
        let demand = match trip.price_w {
            Some(price_w) => Demand::Price(price_w),
            None => {
                let answer = plan(&problem, Demand::Price(0.0), &Settings::default()).unwrap();
                let Some(plan) = answer.plan() else { return Ok(()) };
                Demand::Arrival(trip.slack * plan.earliest_arrival_s)
            }
        };
        gap_pct(&problem, demand);
    }
}
