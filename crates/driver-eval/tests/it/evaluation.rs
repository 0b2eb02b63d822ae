//! Leave-one-out on simulated drives, and on recorded ones where they are at hand.

use driver_eval::Error;
use driver_eval::phase::{
    Evaluation, EvaluationData, EvaluationSettings, Fold, LearningPoint, TrainingSource,
    learning_curve, leave_one_out,
};
use driver_model::{DriveBehaviour, ModelKind, PhaseKind, PhaseModel, Subject};
use ev_energy::Vehicle;

use crate::shared::shared;
use crate::support::{assorted, fixture_trips, points_of, trip_of, trips_in};

fn evaluate(trips: &[DriveBehaviour]) -> Evaluation {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    leave_one_out(
        PhaseKind::Acceleration,
        &EvaluationData::by_trip(trips),
        &vehicle,
        &EvaluationSettings::default(),
        &|| {},
    )
    .unwrap()
}

/// Everything but the seconds that it took.
fn without_times(mut evaluation: Evaluation) -> Evaluation {
    for fold in &mut evaluation.folds {
        (fold.fit_seconds, fold.predict_seconds) = (0.0, 0.0);
    }
    for summary in &mut evaluation.summaries {
        (summary.fit_seconds, summary.predict_seconds) = (0.0, 0.0);
    }
    evaluation
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    let trips = fixture_trips(4);
    let on = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
            .install(|| without_times(evaluate(&trips)))
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn every_model_and_baseline_is_judged_on_every_phase() {
    let trips = fixture_trips(4);
    let evaluation = evaluate(&trips);
    let accelerations = |t: &DriveBehaviour| t.phases_of(PhaseKind::Acceleration).count();
    let phases: usize = trips.iter().map(accelerations).sum();
    // The logs do not say what the driver does.
    let (left_out, reason) = &evaluation.left_out[0];
    assert_eq!(*left_out, ModelKind::ProfilePedal);
    assert!(reason.contains("what the driver does"), "{reason}");
    let others = ModelKind::of(Subject::Phases).filter(|kind| kind != left_out);
    let others: Vec<ModelKind> = others.collect();
    assert_eq!(evaluation.models, others);
    assert_eq!(evaluation.folds.len(), trips.len() * others.len());
    assert_eq!(evaluation.phases.len(), phases);
    for (kind, summary) in evaluation.models.iter().zip(&evaluation.summaries) {
        assert_eq!(summary.figures.phases, phases, "{kind}");
        assert!(
            summary.figures.rmse_mps.is_finite() && summary.figures.rmse_mps > 0.0,
            "{kind}"
        );
        assert!(
            (summary.figures.in_band_pct + summary.figures.out_of_band_pct - 100.0).abs() < 1e-9
        );
        let in_groups: usize = summary.groups.values().map(|g| g.phases).sum();
        assert_eq!(in_groups, phases);
    }
}

#[test]
fn a_held_out_trip_does_not_leak_into_its_model() {
    let mut trips = fixture_trips(4);
    let before = evaluate(&trips);
    let held_out = trips.len() - 1;
    trips[held_out]
        .segments
        .iter_mut()
        .for_each(|segment| segment.mean.accel_mps2 *= 3.0);
    let after = evaluate(&trips);
    for (b, a) in before.folds.iter().zip(&after.folds) {
        if b.unit == held_out {
            assert_eq!(b.model, a.model);
        }
    }
    assert_ne!(before.folds[0].model, after.folds[0].model);
}

#[test]
fn one_trip_or_no_phase_is_an_error() {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let settings = EvaluationSettings::default();
    let mut trips = fixture_trips(4);
    let run = |trips: &[DriveBehaviour]| {
        let data = EvaluationData::by_trip(trips);
        leave_one_out(PhaseKind::Acceleration, &data, &vehicle, &settings, &|| {})
    };
    let alone = run(&trips[..1]);
    assert!(matches!(alone, Err(Error::TooFewUnits { found: 1, .. })));
    for trip in &mut trips {
        trip.phases.clear();
    }
    let empty = run(&trips);
    assert!(matches!(
        empty,
        Err(Error::Model(driver_model::Error::TooFewPhases { .. }))
    ));
}

#[test]
fn on_recorded_drives_the_mean_shape_beats_every_baseline() {
    let Some(folder) = shared("data/bmw-i3") else {
        return;
    };
    let evaluation = evaluate(&trips_in(&folder, "csv", 8));
    let rmse = |kind| {
        let index = evaluation.models.iter().position(|&m| m == kind).unwrap();
        evaluation.summaries[index].figures.rmse_mps
    };
    let baselines = [
        ModelKind::Constant,
        ModelKind::Straight,
        ModelKind::Smoothstep,
    ];
    for baseline in baselines {
        assert!(rmse(ModelKind::Profile) < rmse(baseline), "{baseline}");
    }
}

fn units(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

/// Half the speed everywhere, and points of three times the acceleration.
fn changed(trip: &DriveBehaviour) -> DriveBehaviour {
    let mut changed = trip.clone();
    changed.phases = assorted(12);
    for segment in &mut changed.segments {
        segment.mean.accel_mps2 *= 3.0;
    }
    changed
}

#[test]
fn phases_of_one_unit_never_train_that_unit() {
    let trips = fixture_trips(6);
    let names = units(&["a", "b", "a", "c", "c", "b"]);
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let run = |trips: &[DriveBehaviour]| {
        let data = EvaluationData::by_unit(trips, &names);
        let settings = EvaluationSettings::default();
        leave_one_out(PhaseKind::Acceleration, &data, &vehicle, &settings, &|| {}).unwrap()
    };
    let before = run(&trips);
    assert_eq!(before.units, ["a", "b", "c"]);
    for held_out in 0..3 {
        let is_held_out = |trip: usize| names[trip] == before.units[held_out];
        let with_others = |(k, trip)| {
            if is_held_out(k) {
                changed(trip)
            } else {
                trip.clone()
            }
        };
        let after = run(&trips
            .iter()
            .enumerate()
            .map(with_others)
            .collect::<Vec<_>>());
        assert_eq!(before.models, after.models);
        let folds = |evaluation: &Evaluation, own: bool| -> Vec<PhaseModel> {
            let wanted = |fold: &&Fold| (fold.unit == held_out) == own;
            let folds = evaluation.folds.iter().filter(wanted);
            folds.map(|fold| fold.model.clone()).collect()
        };
        assert_eq!(folds(&before, true), folds(&after, true));
        let others = folds(&before, false).into_iter().zip(folds(&after, false));
        let learns =
            |model: &PhaseModel| !matches!(model, PhaseModel::Straight | PhaseModel::Smoothstep);
        assert!(others.filter(|(b, _)| learns(b)).all(|(b, a)| b != a));
    }
    for phase in &before.phases {
        assert_eq!(before.units[phase.unit], names[phase.trip]);
    }
}

#[test]
fn a_prior_of_weight_0_changes_nothing_and_is_never_held_out() {
    let trips = fixture_trips(6);
    let (own, prior) = trips.split_at(3);
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let run = |prior: &[DriveBehaviour], prior_weight: f64| {
        let data = EvaluationData::by_trip(own).with_prior(prior);
        let settings = EvaluationSettings {
            prior_weight,
            ..EvaluationSettings::default()
        };
        leave_one_out(PhaseKind::Braking, &data, &vehicle, &settings, &|| {}).unwrap()
    };
    let alone = without_times(run(&[], 1.0));
    assert_eq!(without_times(run(prior, 0.0)), alone);
    let with = without_times(run(prior, 0.5));
    assert_eq!(with.trips, alone.trips);
    assert_eq!(with.phases.len(), alone.phases.len());
    assert_ne!(with.folds, alone.folds);
}

#[test]
fn a_model_with_too_little_to_learn_is_left_out_and_the_others_stay() {
    let curves = assorted(12);
    let trips: Vec<DriveBehaviour> = curves
        .chunks(4)
        .map(|own| trip_of("few", own.to_vec(), &points_of(own)))
        .collect();
    let evaluation = evaluate(&trips);
    let left_out: Vec<ModelKind> = evaluation.left_out.iter().map(|(kind, _)| *kind).collect();
    for kind in [ModelKind::ProfileConditioned, ModelKind::ProfileOnset] {
        assert!(left_out.contains(&kind) && !evaluation.models.contains(&kind));
    }
    for kind in [ModelKind::Inverse, ModelKind::RiseTime, ModelKind::Profile] {
        assert!(evaluation.models.contains(&kind), "{kind}");
    }
    let reason = &evaluation.left_out[0].1;
    assert!(reason.contains("8 of at least 10 phases"), "{reason}");
    let models = evaluation.models.len();
    assert_eq!(
        models + left_out.len(),
        ModelKind::of(Subject::Phases).count()
    );
    assert_eq!(evaluation.summaries.len(), models);
    assert_eq!(evaluation.folds.len(), 3 * models);
    assert_eq!(evaluation.phases.len(), 12);
    for phase in &evaluation.phases {
        assert_eq!(phase.predictions.len(), models);
        assert_eq!(phase.predicted_energy_j.len(), models);
    }
}

fn curve_of_profile(trips: &[DriveBehaviour], prior: &[DriveBehaviour]) -> Vec<LearningPoint> {
    let data = EvaluationData::by_trip(trips).with_prior(prior);
    let settings = EvaluationSettings {
        models: vec![ModelKind::Profile, ModelKind::Straight],
        ..EvaluationSettings::default()
    };
    learning_curve(PhaseKind::Acceleration, &data, &settings).unwrap()
}

#[test]
fn a_learning_curve_doubles_up_to_all_but_one() {
    let trips = fixture_trips(8);
    let counts = |n: usize| -> Vec<usize> {
        let points = curve_of_profile(&trips[..n], &[]);
        assert!(points.iter().all(|p| p.training == TrainingSource::Own));
        assert!(points.iter().all(|p| p.model == ModelKind::Profile));
        points.iter().map(|p| p.own_trips).collect()
    };
    assert_eq!(counts(2), [1]);
    assert_eq!(counts(3), [1, 2]);
    assert_eq!(counts(5), [1, 2, 4]);
    assert_eq!(counts(6), [1, 2, 4, 5]);
    assert_eq!(counts(8), [1, 2, 4, 7]);
}

#[test]
fn a_learning_curve_has_rows_of_the_prior_only_with_one() {
    use TrainingSource::{Own, OwnAndPrior, Prior};
    let trips = fixture_trips(5);
    let (own, prior) = trips.split_at(3);
    let points = curve_of_profile(own, prior);
    let rows: Vec<_> = points.iter().map(|p| (p.training, p.own_trips)).collect();
    let expected = [
        (Prior, 0),
        (OwnAndPrior, 1),
        (OwnAndPrior, 2),
        (Own, 1),
        (Own, 2),
    ];
    assert_eq!(rows, expected);
    let without = curve_of_profile(own, &[]);
    assert_eq!(points[3..], without);
    // The last point is the evaluation itself.
    let evaluation = evaluate(own);
    let profile = evaluation
        .models
        .iter()
        .position(|&m| m == ModelKind::Profile);
    let figures = &evaluation.summaries[profile.unwrap()].figures;
    assert_eq!(without[1].phases, figures.phases);
    assert!((without[1].rmse_mps - figures.rmse_mps).abs() < 1e-12);
}
