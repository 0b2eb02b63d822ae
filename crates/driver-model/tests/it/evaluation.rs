//! Leave-one-trip-out on simulated drives, and on recorded ones where they are at hand.

use std::path::Path;

use driver_model::{
    Error, Evaluation, EvaluationSettings, ModelKind, PhaseSettings, Trip, leave_one_trip_out,
};
use ev_energy::Vehicle;

fn fixture_trips() -> Vec<Trip> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/drives");
    trips_in(&folder, "csv", 4)
}

fn trips_in(folder: &Path, suffix: &str, most: usize) -> Vec<Trip> {
    let mut files: Vec<_> = folder
        .read_dir()
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == suffix))
        .collect();
    files.sort();
    files
        .iter()
        .take(most)
        .flat_map(|path| {
            drive_log::read_file(path, &drive_log::LayoutChoice::Auto)
                .unwrap()
                .logs
        })
        .map(|log| {
            let drive = drive_log::prepare(log, &drive_log::Preparation::default()).unwrap();
            Trip::from_drive(&drive, &PhaseSettings::default()).unwrap()
        })
        .collect()
}

fn evaluate(trips: &[Trip]) -> Evaluation {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    leave_one_trip_out(trips, &vehicle, &EvaluationSettings::default(), &|| {}).unwrap()
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
    let trips = fixture_trips();
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
    let trips = fixture_trips();
    let evaluation = evaluate(&trips);
    let phases: usize = trips.iter().map(|t| t.phases.len()).sum();
    assert_eq!(evaluation.models, ModelKind::ALL);
    assert_eq!(evaluation.folds.len(), trips.len() * ModelKind::ALL.len());
    assert_eq!(evaluation.phases.len(), phases);
    for (kind, summary) in evaluation.models.iter().zip(&evaluation.summaries) {
        assert_eq!(summary.phases, phases, "{kind}");
        assert!(
            summary.rmse_mps.is_finite() && summary.rmse_mps > 0.0,
            "{kind}"
        );
        assert!((summary.in_band_pct + summary.out_of_band_pct - 100.0).abs() < 1e-9);
        let in_groups: usize = summary.groups.values().map(|g| g.phases).sum();
        assert_eq!(in_groups, phases);
    }
}

#[test]
fn a_held_out_trip_does_not_leak_into_its_model() {
    let mut trips = fixture_trips();
    let before = evaluate(&trips);
    let held_out = trips.len() - 1;
    trips[held_out]
        .segment_means
        .iter_mut()
        .for_each(|(_, a)| *a *= 3.0);
    let after = evaluate(&trips);
    for (b, a) in before.folds.iter().zip(&after.folds) {
        if b.trip == held_out {
            assert_eq!(b.model, a.model);
        }
    }
    assert_ne!(before.folds[0].model, after.folds[0].model);
}

#[test]
fn one_trip_or_no_phase_is_an_error() {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let settings = EvaluationSettings::default();
    let mut trips = fixture_trips();
    let alone = leave_one_trip_out(&trips[..1], &vehicle, &settings, &|| {});
    assert!(matches!(alone, Err(Error::TooFewTrips { found: 1 })));
    for trip in &mut trips {
        trip.phases.clear();
    }
    let empty = leave_one_trip_out(&trips, &vehicle, &settings, &|| {});
    assert!(matches!(empty, Err(Error::TooFewPhases { .. })));
}

#[test]
fn on_recorded_drives_the_mean_shape_beats_every_baseline() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/bmw-i3");
    if !folder.is_dir() {
        eprintln!("skipped: no recorded drives beside the project");
        return;
    }
    let evaluation = evaluate(&trips_in(&folder, "csv", 8));
    let rmse = |kind| {
        let index = evaluation.models.iter().position(|&m| m == kind).unwrap();
        evaluation.summaries[index].rmse_mps
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
