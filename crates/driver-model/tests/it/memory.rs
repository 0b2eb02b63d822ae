//! Models that go on learning: fitted and then updated is fitted to all drives.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use drive_log::{Channel, DriveLog};
use driver_model::live::{LivePredictor, LiveSettings};
use driver_model::{
    DriveBehaviour, DriverModel, Error, FitSettings, Fitted, Manoeuvre, ModelFile, ModelKind,
    Motion, PhaseExtent, PhaseMemory, PhaseModel, PhaseSettings, PointsOf, Prior, Subject,
    TrainingInput, TrainingRecord, fit_with, update,
};
use proptest::prelude::*;
use proptest::sample::Index;

use crate::support::{STEP_S, motion_of, trips_in};

/// The simulated drives, cut where the numbers say; each piece is a drive.
fn drives(cuts: &[f64]) -> Vec<Motion> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/drives");
    let logs = (1..=4).flat_map(|number| {
        let path = folder.join(format!("drive-{number:02}.csv"));
        let read = drive_log::read_file(&path, &drive_log::LayoutChoice::Auto).unwrap();
        read.logs
    });
    let logs: Vec<DriveLog> = logs
        .flat_map(|log| {
            drive_log::prepare(log, &drive_log::Preparation::default())
                .unwrap()
                .pieces
        })
        .collect();
    let mut drives = Vec::new();
    for log in &logs {
        let mut places: Vec<usize> = cuts
            .iter()
            .map(|c| (c * log.len() as f64) as usize)
            .collect();
        places.extend([0, log.len()]);
        places.sort_unstable();
        places.dedup();
        drives.extend(places.windows(2).map(|ends| cut(log, ends[0]..ends[1])));
    }
    drives
}

/// With a pedal, so that every model has something to learn from.
fn cut(log: &DriveLog, range: std::ops::Range<usize>) -> Motion {
    let channels = log
        .channels()
        .map(|(c, values)| (c, values[range.clone()].to_vec()));
    let mut channels: BTreeMap<Channel, Vec<f64>> = channels.collect();
    let pedal = log.accel_mps2().into_iter().map(|a| 40.0 + 20.0 * a);
    let pedal: Vec<f64> = pedal.skip(range.start).take(range.len()).collect();
    channels.insert(Channel::AcceleratorPedal, pedal);
    motion_of(&DriveLog::new(log.name(), 0.0, STEP_S, channels).unwrap())
}

fn file(fitted: Fitted, drives: usize, others: usize, weight: f64) -> ModelFile {
    let inputs = |count| {
        let input = |k: usize| TrainingInput {
            path: format!("{k}.csv"),
            sha256: format!("{k:064x}"),
        };
        (0..count).map(input).collect()
    };
    let record = TrainingRecord {
        phases: fitted.phases,
        points: fitted.points,
        inputs: inputs(drives),
        prior_inputs: inputs(others),
        prior_weight: weight,
        extent: fitted.memory.as_ref().unwrap().settings().extent,
    };
    let config = serde_json::json!({ "step": STEP_S });
    ModelFile::new(fitted.model, record, config).with_memory(fitted.memory)
}

fn settings(manoeuvre: Manoeuvre, extent: PhaseExtent) -> FitSettings {
    FitSettings {
        phases: PhaseSettings::default().reaching(extent),
        manoeuvre,
        ..FitSettings::default()
    }
}

/// Fits to the first part, writes and reads the file, and adds one part after the other.
fn in_steps(
    kind: ModelKind,
    parts: &[&[Motion]],
    prior: Option<Prior<'_>>,
    settings: &FitSettings,
) -> Result<Fitted, Error> {
    let mut fitted = fit_with(kind, parts[0], prior, settings, &|| {})?;
    let mut drives = parts[0].len();
    let others = prior.map_or(0, |prior| prior.motions.len());
    for part in &parts[1..] {
        let written = file(fitted, drives, others, prior.map_or(0.0, |p| p.weight));
        let read = ModelFile::from_json(&written.to_json()?)?;
        assert_eq!(read, written);
        fitted = update(kind, read.remembered()?.clone(), part, &|| {})?;
        drives += part.len();
    }
    Ok(fitted)
}

fn assert_same(stepwise: Result<Fitted, Error>, at_once: Result<Fitted, Error>) {
    match (stepwise, at_once) {
        (Ok(stepwise), Ok(at_once)) => {
            assert_eq!(stepwise.model, at_once.model);
            assert_eq!(stepwise.memory, at_once.memory);
            assert_eq!(
                (stepwise.phases, stepwise.points),
                (at_once.phases, at_once.points)
            );
            assert_eq!(
                stepwise.residual_sum_of_squares,
                at_once.residual_sum_of_squares
            );
        }
        // A first part may be too little where all is enough.
        (Err(_), _) => {}
        (Ok(_), Err(error)) => panic!("{error}"),
    }
}

#[test]
fn every_model_of_phases_learns_in_steps_what_it_learns_at_once() {
    let drives = drives(&[]);
    let (own, others) = drives.split_at(3);
    for kind in ModelKind::of(Subject::Phases) {
        for manoeuvre in [Manoeuvre::Acceleration, Manoeuvre::Braking] {
            for prior in [
                None,
                Some(Prior {
                    motions: others,
                    weight: 0.33,
                }),
            ] {
                for extent in [PhaseExtent::Threshold, PhaseExtent::Whole] {
                    let settings = settings(manoeuvre, extent);
                    let parts = [&own[..1], &own[1..2], &own[2..]];
                    let stepwise = in_steps(kind, &parts, prior, &settings);
                    let at_once = fit_with(kind, own, prior, &settings, &|| {});
                    let is_refused = extent == PhaseExtent::Whole && kind.is_function_of_speed();
                    assert!(
                        stepwise.is_ok() || prior.is_none() || is_refused,
                        "{kind} {stepwise:?}"
                    );
                    assert_same(stepwise, at_once);
                }
            }
        }
    }
}

#[test]
fn points_of_samples_are_remembered_and_rules_as_well() {
    let drives = drives(&[]);
    let mut settings = FitSettings {
        points_of: PointsOf::Samples,
        ..FitSettings::default()
    };
    settings.phases.min_gain_mps = 4.0;
    settings.phases.statistical.accel_deadband_mps2 = 0.35;
    let parts = [&drives[..2], &drives[2..]];
    let stepwise = in_steps(ModelKind::Inverse, &parts, None, &settings).unwrap();
    assert_eq!(
        stepwise.memory.as_ref().unwrap().settings(),
        settings.phases
    );
    let at_once = fit_with(ModelKind::Inverse, &drives, None, &settings, &|| {});
    assert_same(Ok(stepwise), at_once);

    settings.phases.statistical.similarity = None;
    assert_eq!(PhaseMemory::new(&settings), None);
}

#[test]
fn what_keeps_no_drives_says_why() {
    let file = |kind, model| {
        let record = TrainingRecord {
            phases: 0,
            points: 0,
            inputs: Vec::new(),
            prior_inputs: Vec::new(),
            prior_weight: 0.0,
            extent: PhaseExtent::Threshold,
        };
        let file = ModelFile::new(model, record, serde_json::json!({}));
        assert_eq!(file.model.kind(), kind);
        file.remembered().unwrap_err().to_string()
    };
    let straight = DriverModel::Acceleration(PhaseModel::Straight);
    let said = file(ModelKind::Straight, straight);
    assert!(said.contains("fit it anew"), "{said}");
    let following = DriverModel::Following(driver_model::following::FollowingModel::Idm {
        idm: driver_model::following::Idm::default(),
        desired_speed_mps: 30.0,
    });
    let said = file(ModelKind::Idm, following);
    assert!(
        said.contains("keeps none") && said.contains("profile-onset"),
        "{said}"
    );
}

#[test]
fn drives_of_another_step_are_refused() {
    let drives = drives(&[]);
    let fitted = fit_with(
        ModelKind::Profile,
        &drives,
        None,
        &FitSettings::default(),
        &|| {},
    );
    let log = DriveLog::new("slow", 0.0, 1.0, [(Channel::Speed, vec![3.0; 50])].into()).unwrap();
    let refused = update(
        ModelKind::Profile,
        fitted.unwrap().memory.unwrap(),
        &[motion_of(&log)],
        &|| {},
    );
    assert!(matches!(refused, Err(Error::Steps { .. })), "{refused:?}");
}

#[test]
fn a_short_phase_is_none_that_counts_and_has_lasted_a_second() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/drives");
    for trip in trips_in(&folder, "csv", 4) {
        let starts = |of: fn(&DriveBehaviour) -> &Vec<driver_model::PhaseCurve>| -> Vec<u64> {
            of(&trip)
                .iter()
                .map(|curve| curve.start_s().to_bits())
                .collect()
        };
        for (short, counting) in [
            (starts(|t| &t.short_phases), starts(|t| &t.phases)),
            (
                starts(|t| &t.whole_short_phases),
                starts(|t| &t.whole_phases),
            ),
        ] {
            assert!(!short.is_empty());
            assert!(short.iter().all(|start| !counting.contains(start)));
        }
        for short in trip.short_phases.iter().chain(&trip.whole_short_phases) {
            assert!(short.early_gain_mps().is_some());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Drives cut anywhere, and learnt in parts that are cut anywhere.
    #[test]
    fn drives_cut_at_random_teach_the_same(
        cuts in prop::collection::vec(0.02..0.98f64, 1..6),
        parts in prop::collection::vec(any::<Index>(), 1..4),
        kind in 0..4usize,
        braking in any::<bool>(),
        weight in prop::option::of(0.0..2.0f64),
    ) {
        let kinds = [ModelKind::Inverse, ModelKind::RiseTime, ModelKind::ProfileConditioned, ModelKind::ProfileOnset];
        let kind = kinds[kind];
        let drives = drives(&cuts);
        let (others, own) = drives.split_at(drives.len() / 4);
        let prior = weight.map(|weight| Prior { motions: others, weight });
        let manoeuvre = if braking { Manoeuvre::Braking } else { Manoeuvre::Acceleration };
        let settings = settings(manoeuvre, PhaseExtent::Threshold);
        let mut places: Vec<usize> = parts.iter().map(|p| 1 + p.index(own.len() - 1)).collect();
        places.extend([0, own.len()]);
        places.sort_unstable();
        places.dedup();
        let parts: Vec<&[Motion]> = places.windows(2).map(|ends| &own[ends[0]..ends[1]]).collect();
        let at_once = fit_with(kind, own, prior, &settings, &|| {});
        assert_same(in_steps(kind, &parts, prior, &settings), at_once);
    }
}

static WRITTEN: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let drives = drives(&[]);
    let kind = ModelKind::ProfileConditioned;
    let fitted = fit_with(kind, &drives[..2], None, &FitSettings::default(), &|| {}).unwrap();
    file(fitted, 2, 0, 0.0).to_json().unwrap().into_bytes()
});

static NEW: LazyLock<Vec<Motion>> = LazyLock::new(|| drives(&[]).split_off(3));

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    /// Whatever happens to a file, it ends in an error or in a memory that can be learnt from and told by.
    #[test]
    fn a_changed_file_is_an_error_or_harmless(
        changes in prop::collection::vec((any::<Index>(), prop::sample::select(b"0123456789.-e,[]{}nul\"".to_vec())), 1..4),
    ) {
        let mut bytes = WRITTEN.clone();
        for (place, byte) in changes {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        if let Ok(read) = ModelFile::from_json(&String::from_utf8_lossy(&bytes)) {
            let memory = read.remembered().unwrap().clone();
            let _ = update(read.model.kind(), memory, &NEW, &|| {});
            let settings = LiveSettings {
                step_s: STEP_S,
                smoothing: drive_log::Smoothing::None,
                max_gap_s: 2.0,
                told: Vec::new(),
                horizons_s: Vec::new(),
            };
            if let Ok(mut predictor) = LivePredictor::new(vec![read], &settings) {
                for k in 0..60 {
                    let row = drive_log::Row {
                        time_s: STEP_S * f64::from(k),
                        speed_mps: 0.15 * f64::from(k),
                        lead_gap_m: f64::NAN,
                        told: Vec::new(),
                        starts_piece: k == 0,
                    };
                    predictor.push(&row).unwrap();
                }
                predictor.finish();
            }
        }
    }
}

/// A number of the memory turned into one that no car has.
#[test]
fn impossible_numbers_are_refused() {
    let drives = drives(&[]);
    let fitted = fit_with(
        ModelKind::Profile,
        &drives,
        None,
        &FitSettings::default(),
        &|| {},
    );
    let good = file(fitted.unwrap(), drives.len(), 0, 0.0);
    let good = serde_json::to_value(&good).unwrap();
    let drive = "/memory/own_drives/0";
    for (place, lie) in [
        ("/memory/rules/min_duration_s", serde_json::json!(-1.0)),
        ("/memory/prior_weight", serde_json::json!(-0.5)),
        ("/memory/manoeuvre", serde_json::json!("braking")),
        ("/memory/rules/extent", serde_json::json!("whole")),
        ("/training/phases", serde_json::json!(3)),
        (
            &format!("{drive}/phases/0/speed_mps"),
            serde_json::json!([]),
        ),
        (
            &format!("{drive}/phases/0/speed_mps"),
            serde_json::json!([9.0, 5.0]),
        ),
        (
            &format!("{drive}/phases/0/speed_mps"),
            serde_json::json!([0.0, 1e9]),
        ),
        (&format!("{drive}/phases/0/step_s"), serde_json::json!(0.0)),
        (
            &format!("{drive}/phases/0/onset"),
            serde_json::json!([1e300, 0.0, 0.0]),
        ),
        (
            &format!("{drive}/short_phases/0/samples"),
            serde_json::json!(1),
        ),
        (
            &format!("{drive}/short_phases/0/speed_mps"),
            serde_json::json!([4.0, 3.0]),
        ),
        (&format!("{drive}/points/0"), serde_json::json!([1.0, 1e99])),
        (&format!("{drive}/points/0"), serde_json::json!([1.0])),
        (drive, serde_json::json!(null)),
    ] {
        let mut file = good.clone();
        *file.pointer_mut(place).unwrap() = lie.clone();
        let refused = ModelFile::from_json(&file.to_string());
        assert!(
            matches!(refused, Err(Error::ModelFile { .. })),
            "{place} = {lie}: {refused:?}"
        );
    }
}

/// What a file says against itself is refused by the name of the field.
#[test]
fn contradictions_are_refused() {
    let drives = drives(&[]);
    let kind = ModelKind::Profile;
    let fitted = fit_with(kind, &drives, None, &FitSettings::default(), &|| {}).unwrap();
    let good = serde_json::to_value(file(fitted, drives.len(), 0, 0.0)).unwrap();
    let drive = "/memory/own_drives/0";
    let speeds = |from: f64, to: f64| serde_json::json!([from, to]);
    for (place, lie, words) in [
        (
            format!("{drive}/phases/0/speed_mps"),
            speeds(0.0, 9.0),
            "memory.own_drives[0].phases[0]: too short",
        ),
        (
            format!("{drive}/phases/0/speed_mps"),
            speeds(-40.0, 9.0),
            "memory.own_drives[0].phases[0]: no acceleration",
        ),
        (
            format!("{drive}/short_phases/0/samples"),
            serde_json::json!(4),
            "memory.own_drives[0].short_phases[0]: shorter",
        ),
        (
            "/config".to_owned(),
            serde_json::json!({ "step": STEP_S, "to": "samples" }),
            "config.to is \"samples\"",
        ),
        (
            "/config".to_owned(),
            serde_json::json!({ "step": STEP_S, "min_gain": 5.0 }),
            "config.min_gain is 5.0",
        ),
        (
            "/config".to_owned(),
            serde_json::json!({}),
            "config.step is missing",
        ),
        (
            "/config/step".to_owned(),
            serde_json::json!(0.2),
            "config.step is 0.2",
        ),
        (
            "/training/inputs/1/sha256".to_owned(),
            serde_json::json!("zz"),
            "training.inputs[1].sha256",
        ),
    ] {
        let mut file = good.clone();
        *file.pointer_mut(&place).unwrap() = lie;
        let said = ModelFile::from_json(&file.to_string())
            .unwrap_err()
            .to_string();
        assert!(said.contains(words), "{words}: {said}");
    }
}
