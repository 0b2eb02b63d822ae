//! What cannot be driven, and what is asked for badly.

use ev_energy::StepModel;
use speed_plan::{
    Answer, Arrival, Demand, Envelope, Error, Leader, Obstacle, Problem, Road, Settings, frontier,
    plan, replan,
};

use crate::{assert_drivable, kilometre, planned, vehicle};

fn answer(road: &Road, demand: Demand) -> Answer {
    let car = vehicle("b250e");
    let problem = problem(&car, road);
    plan(&problem, demand, &Settings::default()).unwrap()
}

fn problem<'a>(car: &'a ev_energy::Vehicle, road: &Road) -> Problem<'a> {
    Problem::new(
        StepModel::new(car),
        Envelope::default(),
        road.columns().unwrap(),
    )
    .unwrap()
}

fn obstacle(road: &Road, demand: Demand) -> Obstacle {
    match answer(road, demand) {
        Answer::Obstacle(obstacle) => obstacle,
        Answer::Plan(plan) => panic!("{} J in {} s", plan.run.energy_j, plan.run.time_s),
    }
}

#[test]
fn an_arrival_is_met_and_later_ones_cost_less() {
    let car = vehicle("b250e");
    let road = kilometre();
    let problem = problem(&car, &road);
    let mut before_j = f64::INFINITY;
    for latest_s in [90.0, 100.0, 120.0, 140.0] {
        let plan = planned(&problem, Demand::Arrival(latest_s));
        assert_drivable(&problem, &plan);
        assert_eq!(plan.arrival, Arrival::AsAsked);
        assert!(
            (plan.run.time_s - latest_s).abs() < 1e-6,
            "{}",
            plan.run.time_s
        );
        assert!(plan.run.energy_j < before_j && plan.price_w.unwrap() > 0.0);
        before_j = plan.run.energy_j;
    }
    let early = planned(&problem, Demand::Arrival(1000.0));
    assert_eq!((early.arrival, early.price_w), (Arrival::Early, Some(0.0)));
    assert!(early.run.time_s < 1000.0 && early.run.energy_j < before_j);
}

#[test]
fn a_price_is_the_slope_of_the_frontier() {
    let car = vehicle("bmw-i3-60ah");
    let problem = problem(&car, &kilometre());
    let plan = planned(&problem, Demand::Arrival(110.0));
    let (sooner, later) = (
        planned(&problem, Demand::Arrival(109.5)),
        planned(&problem, Demand::Arrival(110.5)),
    );
    let slope_w = sooner.run.energy_j - later.run.energy_j;
    assert!(
        (plan.price_w.unwrap() - slope_w).abs() < 0.01 * slope_w,
        "{} W, {slope_w} W",
        plan.price_w.unwrap()
    );
    let priced = planned(&problem, Demand::Price(plan.price_w.unwrap()));
    assert!(
        (priced.run.time_s - 110.0).abs() < 0.05,
        "{}",
        priced.run.time_s
    );
    assert!(priced.gap_pct < 0.01);
}

#[test]
fn a_frontier_falls_and_bends_upwards() {
    let car = vehicle("b250e");
    let problem = problem(&car, &kilometre());
    let answers = frontier(&problem, 6, &Settings::default()).unwrap();
    let plans: Vec<_> = answers
        .iter()
        .map(|answer| answer.plan().unwrap())
        .collect();
    assert_eq!(plans.len(), 6);
    for pair in plans.windows(2) {
        assert!(
            pair[1].run.time_s > pair[0].run.time_s && pair[1].run.energy_j < pair[0].run.energy_j
        );
        assert!(pair[1].price_w < pair[0].price_w);
    }
}

#[test]
fn a_replan_from_a_plan_is_that_plan() {
    let car = vehicle("b250e");
    let problem = problem(&car, &kilometre());
    let first = planned(&problem, Demand::Price(3000.0));
    let answer = replan(
        &problem,
        Demand::Price(3000.0),
        &Settings::default(),
        &first.run.speed_mps,
    )
    .unwrap();
    let second = answer.plan().unwrap();
    assert!((second.run.energy_j - first.run.energy_j).abs() < 1e-5 * first.run.energy_j);
    let short = replan(
        &problem,
        Demand::Price(3000.0),
        &Settings::default(),
        &[1.0],
    );
    assert!(matches!(short, Err(Error::Length { found: 1, .. })));
}

#[test]
fn too_late_says_when_it_could_be() {
    let Obstacle::TooLate { earliest_arrival_s } = obstacle(&kilometre(), Demand::Arrival(60.0))
    else {
        panic!();
    };
    assert!(
        (70.0..90.0).contains(&earliest_arrival_s),
        "{earliest_arrival_s}"
    );
}

#[test]
fn a_light_that_stays_red_is_unreachable_and_a_long_red_is_waited_for() {
    let mut road = kilometre();
    road.signals = vec![(500.0, vec![[0.0, 5.0]])];
    assert!(matches!(
        obstacle(&road, Demand::Arrival(200.0)),
        Obstacle::SignalsUnreachable { .. }
    ));
    road.signals = vec![(500.0, vec![[-10.0, 5.0], [120.0, 150.0]])];
    let car = vehicle("b250e");
    let problem = problem(&car, &road);
    let plan = planned(&problem, Demand::Arrival(220.0));
    assert_drivable(&problem, &plan);
    assert!(plan.gap_pct < 1.0, "{} %", plan.gap_pct);
}

#[test]
fn a_leader_holds_up_and_may_block() {
    let mut road = kilometre();
    let leader = |speed: f64| Leader {
        positions: (0..400)
            .map(|t| (f64::from(t), 20.0 + speed * f64::from(t)))
            .collect(),
        standstill_gap_m: 2.0,
        headway_s: 1.5,
    };
    road.leader = Some(leader(7.0));
    let car = vehicle("b250e");
    let held_up = problem(&car, &road);
    let plan = planned(&held_up, Demand::Arrival(180.0));
    assert_drivable(&held_up, &plan);
    road.leader = Some(leader(4.0));
    let Obstacle::LeaderBlocks { earliest_arrival_s } = obstacle(&road, Demand::Arrival(180.0))
    else {
        panic!();
    };
    assert!(
        (240.0..260.0).contains(&earliest_arrival_s),
        "{earliest_arrival_s}"
    );
}

#[test]
fn braking_and_climbing_have_their_limits() {
    let mut road = Road {
        length_m: 20.0,
        start_mps: 13.0,
        ..Road::default()
    };
    let Obstacle::CannotStop {
        allowed_mps2,
        needed_mps2,
        ..
    } = obstacle(&road, Demand::Price(0.0))
    else {
        panic!();
    };
    assert!(needed_mps2 < allowed_mps2);
    road = Road {
        elevation: vec![(0.0, 0.0), (500.0, 0.0), (1000.0, 250.0)],
        ..Road::default()
    };
    let car = vehicle("nissan-leaf-2013");
    let steep = problem(&car, &road);
    let answer = plan(&steep, Demand::Price(0.0), &Settings::default()).unwrap();
    let Answer::Obstacle(Obstacle::TooSteep {
        position_m,
        slope_rad,
    }) = answer
    else {
        panic!("{answer:?}");
    };
    assert!(
        (500.0..1000.0).contains(&position_m) && slope_rad > 0.4,
        "{position_m} {slope_rad}"
    );
}

#[test]
fn demands_and_settings_out_of_range_are_named() {
    let car = vehicle("b250e");
    let problem = problem(&car, &kilometre());
    for (demand, name) in [
        (Demand::Arrival(f64::NAN), "latest_arrival_s"),
        (Demand::Price(-1.0), "price_w"),
    ] {
        let error = plan(&problem, demand, &Settings::default()).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    }
}

#[test]
fn above_the_limit_at_the_start_there_is_one_motion_and_a_tight_bound() {
    let car = vehicle("b250e");
    for start_kmh in [51.0, 70.0, 80.0, 130.0] {
        let road = Road {
            start_mps: start_kmh / 3.6,
            ..kilometre()
        };
        let problem = problem(&car, &road);
        let plan = planned(&problem, Demand::Price(3000.0));
        assert_drivable(&problem, &plan);
        assert!(plan.gap_pct < 0.02, "{start_kmh} km/h: {} %", plan.gap_pct);
    }
    let road = Road {
        start_mps: 60.0 / 3.6,
        stops: vec![(10.0, 3.0)],
        ..kilometre()
    };
    assert!(matches!(
        obstacle(&road, Demand::Price(3000.0)),
        Obstacle::CannotStop { position_m, .. } if position_m == 10.0
    ));
}

#[test]
fn a_slowest_speed_gives_way_after_and_before_stops_and_slow_places() {
    let car = vehicle("b250e");
    let road = Road {
        slowest_mps: 30.0 / 3.6,
        stops: vec![(400.0, 5.0)],
        slow_points: vec![(700.0, 3.0)],
        ..kilometre()
    };
    let problem = problem(&car, &road);
    let plan = planned(&problem, Demand::Price(0.0));
    assert_drivable(&problem, &plan);
    assert!(plan.gap_pct < 0.02, "{} %", plan.gap_pct);
    let columns = problem.columns();
    let slow = plan.run.speed_mps.iter().zip(&columns.position_m);
    let far = |at: f64| {
        [0.0, 400.0, 700.0, 1000.0]
            .iter()
            .all(|p| (at - p).abs() > 30.0)
    };
    for (speed, at) in slow.filter(|(_, at)| far(**at)) {
        assert!(*speed >= road.slowest_mps - 1e-9, "{speed} m/s at {at} m");
    }
    let at_limit = Road {
        slowest_mps: 60.0 / 3.6,
        ..kilometre()
    };
    let plan = answer(&at_limit, Demand::Price(0.0));
    let plan = plan.plan().unwrap();
    assert!((plan.run.time_s - plan.earliest_arrival_s).abs() < 1e-6);
    assert!(plan.gap_pct < 0.001, "{} %", plan.gap_pct);
    let mut lit = road.clone();
    lit.signals = vec![(550.0, vec![[100.0, 130.0]])];
    let problem = Problem::new(
        StepModel::new(&car),
        Envelope::default(),
        lit.columns().unwrap(),
    )
    .unwrap();
    let plan = planned(&problem, Demand::Price(3000.0));
    assert_drivable(&problem, &plan);
}
