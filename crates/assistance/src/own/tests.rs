#![allow(clippy::unwrap_used, clippy::panic, clippy::float_cmp)]

use driver_model::trip_driver::{
    AccelerationLaw, BrakingLaw, HabitLine, Slowdowns, TripDriver, WantedSpeed,
};
use ev_energy::{StepModel, Vehicle};
use speed_plan::{Answer, Demand, Settings, plan};

use super::*;
use crate::{RoadSettings, planned_road};

fn driver() -> TripDriver {
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

const ROAD: &str = "length_m = 2500.0
limits = [{ position_m = 0, limit_kmh = 50 }, { position_m = 1000, limit_kmh = 80 }]
stops = [{ position_m = 600, dwell_s = 8 }]
slow_points = []
";

fn road(lights: &str) -> RoadFile {
    RoadFile::from_toml(&format!("{ROAD}{lights}"), "road.toml").unwrap()
}

/// The own way over a road, with its problem.
fn with_own<T>(lights: &str, then: impl FnOnce(&Problem, Result<OwnWay, Error>) -> T) -> T {
    let car = Vehicle::builtin("b250e").unwrap();
    let file = road(lights);
    let (road, _) = planned_road(&file, &RoadSettings::default());
    let problem = Problem::new(
        StepModel::new(&car),
        Envelope::default(),
        road.columns().unwrap(),
    );
    let problem = problem.unwrap();
    then(&problem, OwnWay::new(&driver(), &file, &problem))
}

fn styled(problem: &Problem, own: &OwnWay, style: Style) -> Answer {
    let columns = own.columns(problem.columns(), style).unwrap();
    let envelope = own.envelope(style).unwrap();
    let problem = Problem::new(problem.model().clone(), envelope, columns).unwrap();
    let arrival = Demand::Arrival(own.run.time_s);
    plan(&problem, arrival, &Settings::default()).unwrap()
}

#[test]
fn plans_in_the_own_time_save_more_the_wider_the_band() {
    with_own("", |problem, own| {
        let own = own.unwrap();
        let limits = &problem.columns().max_mps;
        for (speed, limit) in own.run.speed_mps.iter().zip(limits) {
            assert!(*speed <= limit + 1e-9);
        }
        assert_eq!(own.band, Band::Assumed);
        let mut before_j = own.run.energy_j * (1.0 + 1e-6);
        for style in [0.0, 0.5, 1.0, 2.0].map(Style::Within) {
            let Answer::Plan(plan) = styled(problem, &own, style) else {
                panic!("{style:?} has no plan");
            };
            assert!(plan.run.time_s <= own.run.time_s + 1e-6);
            assert!(
                plan.run.energy_j <= before_j,
                "{style:?}: {} {before_j}",
                plan.run.energy_j
            );
            before_j = plan.run.energy_j * (1.0 + 1e-6);
            let distance = own.distance(problem, &plan.run);
            if matches!(style, Style::Within(half_widths) if half_widths <= 1.0) {
                assert!(distance.inside_band_pct > 99.0, "{style:?}: {distance:?}");
            }
        }
        assert!(before_j < 0.97 * own.run.energy_j);
        let at_own = own.distance(problem, &own.run);
        assert!(at_own.rms_mps < 1e-9 && at_own.inside_band_pct > 99.999);
        assert!(own.columns(problem.columns(), Style::Within(-1.0)).is_err());
    });
}

#[test]
fn the_driver_stops_at_red_and_leaves_at_green() {
    let free_s = with_own("", |problem, own| {
        let node = problem
            .columns()
            .position_m
            .iter()
            .position(|at| *at >= 1500.0);
        own.unwrap().run.arrival_s[node.unwrap()]
    });
    let light = |from_s: f64, to_s: f64| {
        format!("signals = [{{ position_m = 1500, green_s = [[{from_s}, {to_s}]] }}]")
    };
    with_own(&light(free_s - 20.0, free_s + 20.0), |problem, own| {
        let node = problem.columns().signals[0].node;
        assert!(own.unwrap().run.stood_s[node] == 0.0);
    });
    let green_s = free_s + 40.0;
    with_own(&light(green_s, green_s + 30.0), |problem, own| {
        let own = own.unwrap();
        let node = problem.columns().signals[0].node;
        assert_eq!(own.run.speed_mps[node], 0.0);
        // A second after green begins.
        let left_s = own.run.arrival_s[node] + own.run.stood_s[node];
        assert!((left_s - green_s - 1.0).abs() < 1e-6, "{left_s}");
        // The way without red is what plans are near to.
        assert!(matches!(
            styled(problem, &own, Style::Within(1.0)),
            Answer::Plan(_)
        ));
    });
    with_own(&light(1.0, 5.0), |_, own| {
        assert!(matches!(own, Err(Error::Red { .. })));
    });
}
