//! Phases from begin to end beside those that the threshold cuts.

use driver_eval::behaviour::{BehaviourSettings, evaluate_behaviour};
use driver_eval::phase::{EvaluationData, Verdict};
use driver_model::{LeadInfluenced, ModelKind};
use ev_energy::Vehicle;

use crate::support::fixture_trips;

fn settings() -> BehaviourSettings {
    let mut settings = BehaviourSettings::default();
    settings.phase.models = vec![ModelKind::Profile, ModelKind::ProfileOnset];
    settings
}

#[test]
fn whole_phases_are_longer_and_judged_against_the_best_baseline() {
    let trips = fixture_trips(5);
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let data = EvaluationData::by_trip(&trips);
    let found = evaluate_behaviour(&data, &vehicle, &settings(), &|| {}).unwrap();
    assert_eq!(found.whole.kinds().count(), 2);
    for (whole, cut) in found.whole.kinds().zip(found.phases()) {
        assert_eq!(whole.kind, cut.kind);
        let reach = &whole.reach;
        assert_eq!(reach.threshold_phases, cut.phases.len());
        let counted: usize = trips
            .iter()
            .map(|trip| trip.with_whole_phases().phases_of(whole.kind).count())
            .sum();
        assert_eq!(reach.phases, counted);
        assert!(
            reach.longer_pct > 0.0 && reach.gains_more_pct > 0.0,
            "{reach:?}"
        );
        let rmse_mps =
            |(_, figures): (ModelKind, &driver_eval::behaviour::WholeFigures)| figures.rmse_mps;
        let baselines = whole.rows().filter(|(model, _)| model.is_baseline());
        let least = baselines.map(rmse_mps).fold(f64::INFINITY, f64::min);
        for (model, figures) in whole.rows() {
            let same = model == whole.best_baseline;
            assert_eq!(same, figures.against_baseline.is_none(), "{model}");
            let Some(pair) = &figures.against_baseline else {
                continue;
            };
            assert_eq!((pair.model, pair.against), (model, whole.best_baseline));
            let difference_mps = figures.rmse_mps - least;
            assert!((pair.difference_rmse_mps - difference_mps).abs() < 1e-9);
            assert_eq!(
                figures.threshold_rmse_mps,
                cut.summary(model).map(|s| s.figures.rmse_mps)
            );
        }
        let (_, profile) = whole
            .rows()
            .find(|(m, _)| *m == ModelKind::Profile)
            .unwrap();
        let pair = profile.against_baseline.as_ref().unwrap();
        assert_eq!(pair.verdict, Verdict::Better);
    }
}

#[test]
fn without_whole_phases_the_others_are_evaluated_and_it_is_said() {
    let mut trips = fixture_trips(3);
    for trip in &mut trips {
        trip.whole_phases.clear();
        trip.whole_lead_influenced = LeadInfluenced::default();
    }
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let data = EvaluationData::by_trip(&trips);
    let found = evaluate_behaviour(&data, &vehicle, &settings(), &|| {}).unwrap();
    assert_eq!(found.whole.kinds().count(), 0);
    assert_eq!(found.phases().count(), 2);
    for part in ["whole acceleration", "whole braking"] {
        assert!(found.missing.contains_key(part), "{:?}", found.missing);
    }
}
