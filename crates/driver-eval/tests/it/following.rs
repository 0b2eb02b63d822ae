//! Car following: known parameters come back from simulated stretches, and recorded platoons are followed.

use std::collections::BTreeMap;
use std::path::Path;

use drive_log::{Channel, DriveLog, LayoutChoice, Preparation, prepare, read_file};
use driver_eval::HoldOut;
use driver_eval::following::{FollowingEvaluation, ParametersOf, evaluate_following};
use driver_model::Error;
use driver_model::ModelKind;
use driver_model::following::{
    ConstantTimeGap, FollowingModel, FollowingSettings, FollowingStretch, Idm, following_stretches,
};
use proptest::prelude::*;

use crate::shared::shared;
use crate::support::motion_of;

const IDM: FollowingModel = FollowingModel::Idm {
    idm: Idm {
        max_accel_mps2: 1.6,
        comfortable_decel_mps2: 2.1,
        time_headway_s: 1.2,
        standstill_gap_m: 2.6,
    },
    desired_speed_mps: 24.0,
};

const LAW: FollowingModel = FollowingModel::ConstantTimeGap(ConstantTimeGap {
    time_gap_s: 1.3,
    standstill_gap_m: 3.0,
    gap_gain_per_s: 0.3,
});

/// A leader who stops now and then.
pub(crate) fn leader_mps(time_s: f64) -> f64 {
    let sine = |amplitude, period_s, phase| {
        amplitude * f64::sin(std::f64::consts::TAU * time_s / period_s + phase)
    };
    (9.0 + sine(7.0, 61.0, 0.0) + sine(4.0, 29.0, 1.0) + sine(0.8, 8.3, 2.0)).max(0.0)
}

/// Speed and gap of a model behind a leader every `step_s`, in steps as fine as asked for.
pub(crate) fn follow(
    model: &FollowingModel,
    leader_mps: impl Fn(f64) -> f64,
    step_s: f64,
    samples: usize,
    substeps: usize,
) -> [Vec<f64>; 3] {
    let fine_s = step_s / substeps as f64;
    let (mut speed, mut gap) = (leader_mps(0.0), 18.0);
    let mut series = [vec![], vec![], vec![]];
    for k in 0..samples * substeps {
        let time_s = k as f64 * fine_s;
        let lead = leader_mps(time_s);
        if k % substeps == 0 {
            for (series, value) in series.iter_mut().zip([speed, gap, lead]) {
                series.push(value);
            }
        }
        let next = (speed + model.accel_mps2(speed, gap, lead) * fine_s).max(0.0);
        gap += 0.5 * fine_s * (lead + leader_mps(time_s + fine_s) - speed - next);
        speed = next;
    }
    series
}

fn log_of(series: [Vec<f64>; 3], step_s: f64) -> DriveLog {
    log_named("log", series, step_s)
}

pub(crate) fn log_named(name: &str, [speed, gap, lead]: [Vec<f64>; 3], step_s: f64) -> DriveLog {
    let channels = BTreeMap::from([
        (Channel::Speed, speed),
        (Channel::LeadGap, gap),
        (Channel::LeadSpeed, lead),
    ]);
    DriveLog::new(name, 0.0, step_s, channels).unwrap()
}

pub(crate) fn one_stretch(log: &DriveLog) -> FollowingStretch {
    let mut found = following_stretches(&motion_of(log), &FollowingSettings::default());
    assert_eq!(found.len(), 1);
    let stretch = found.remove(0);
    assert_eq!(stretch.speed_mps().len(), log.len());
    stretch
}

/// Ten minutes in steps of 0.1 s, driven in steps of 0.01 s.
fn simulated(model: &FollowingModel) -> FollowingStretch {
    one_stretch(&log_of(follow(model, leader_mps, 0.1, 6000, 10), 0.1))
}

fn parameters(model: &FollowingModel) -> BTreeMap<String, f64> {
    fn collect(value: &serde_json::Value, into: &mut BTreeMap<String, f64>) {
        for (key, value) in value.as_object().unwrap() {
            if let Some(number) = value.as_f64() {
                into.insert(key.clone(), number);
            } else if value.is_object() {
                collect(value, into);
            }
        }
    }
    let mut found = BTreeMap::new();
    collect(&serde_json::to_value(model).unwrap(), &mut found);
    found
}

fn assert_close(found: &FollowingModel, truth: &FollowingModel, share: f64) {
    for ((name, found), truth) in parameters(found)
        .iter()
        .zip(parameters(truth).into_values())
    {
        let off = (found / truth - 1.0).abs();
        assert!(off < share, "{name} {found} instead of {truth}");
    }
}

#[test]
fn parameters_are_found_again() {
    for truth in [IDM, LAW] {
        let stretch = simulated(&truth);
        assert!(stretch.lead_speed_mps().contains(&0.0));
        let fit = FollowingModel::fit(truth.kind(), &[&stretch]).unwrap();
        assert_close(&fit.model, &truth, 0.02);
        assert!(fit.at_bound.is_empty() && fit.mean_square < 1e-4);
        assert!(fit.model.errors(&stretch).gap_rmse_m < 0.1);
    }
}

#[test]
fn parameters_are_found_again_under_noise() {
    for truth in [IDM, LAW] {
        let mut series = follow(&truth, leader_mps, 0.1, 6000, 10);
        let mut state = 1_u64;
        for gap in &mut series[1] {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            *gap += ((state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5) * 0.8;
        }
        let stretch = one_stretch(&log_of(series, 0.1));
        let fit = FollowingModel::fit(truth.kind(), &[&stretch]).unwrap();
        assert_close(&fit.model, &truth, 0.08);
    }
}

#[test]
fn without_a_leaders_speed_its_gap_tells_enough() {
    let series = follow(&IDM, leader_mps, 0.1, 6000, 10);
    let [speed, gap, _] = series;
    let channels = BTreeMap::from([(Channel::Speed, speed), (Channel::LeadGap, gap)]);
    let stretch = one_stretch(&DriveLog::new("log", 0.0, 0.1, channels).unwrap());
    let fit = FollowingModel::fit(ModelKind::Idm, &[&stretch]).unwrap();
    assert!(fit.model.errors(&stretch).gap_rmse_m < 0.3);
}

#[test]
fn steady_following_rests_at_the_equilibrium_gap() {
    let speed_mps: f64 = 15.0;
    let idm_m = (2.6 + 1.2 * speed_mps) / (1.0 - (speed_mps / 24.0).powi(4)).sqrt();
    for (model, gap_m) in [(IDM, idm_m), (LAW, 3.0 + 1.3 * speed_mps)] {
        let n = 3000;
        let log = log_of([vec![speed_mps; n], vec![30.0; n], vec![speed_mps; n]], 0.1);
        let simulated = model.simulate(&one_stretch(&log));
        assert!((simulated.gap_m[n - 1] - gap_m).abs() < 1e-6);
        assert!((simulated.speed_mps[n - 1] - speed_mps).abs() < 1e-6);
        assert_eq!((simulated.gap_m[0], simulated.collisions), (30.0, 0));
    }
}

#[test]
fn ballistic_steps_are_near_to_much_finer_ones() {
    for model in [IDM, LAW] {
        let stretch = one_stretch(&log_of(follow(&model, leader_mps, 0.1, 6000, 100), 0.1));
        let simulated = model.simulate(&stretch);
        let furthest = |found: &[f64], fine: &[f64]| {
            let off = found.iter().zip(fine).map(|(a, b)| (a - b).abs());
            off.fold(0.0, f64::max)
        };
        let gap_off_m = furthest(&simulated.gap_m, stretch.gap_m());
        let speed_off_mps = furthest(&simulated.speed_mps, stretch.speed_mps());
        assert!(gap_off_m < 0.2 && speed_off_mps < 0.2);
        assert_eq!(simulated.collisions, 0);
    }
}

#[test]
fn running_into_the_leader_is_counted() {
    let braking = |time_s: f64| 20.0 - 2.5 * (time_s - 4.0).clamp(0.0, 8.0);
    let stretch = one_stretch(&log_of(follow(&IDM, braking, 0.1, 300, 1), 0.1));
    let sluggish = FollowingModel::ConstantTimeGap(ConstantTimeGap {
        time_gap_s: 5.0,
        standstill_gap_m: 0.5,
        gap_gain_per_s: 0.01,
    });
    let simulated = sluggish.simulate(&stretch);
    assert_eq!(simulated.collisions, 1);
    assert!(simulated.gap_m.iter().all(|gap| *gap >= 0.1));
    assert!(simulated.speed_mps.iter().all(|speed| *speed >= 0.0));
}

#[test]
fn too_little_to_learn_from_is_an_error() {
    let few = |stretches: &[FollowingStretch]| {
        let one = HoldOut::by_unit(&vec!["unit"; stretches.len()]);
        matches!(
            evaluate_following(stretches, &one),
            Err(driver_eval::Error::Model(Error::TooFewStretches { .. }))
        )
    };
    assert!(few(&[]));
    assert!(few(&[simulated(&IDM), simulated(&IDM)]));
    assert!(FollowingModel::fit(ModelKind::Idm, &[]).is_err());
}

/// Everything but the seconds that it took.
fn without_times(mut evaluation: FollowingEvaluation) -> FollowingEvaluation {
    for fold in &mut evaluation.folds {
        fold.fit_seconds.idm = 0.0;
        fold.fit_seconds.constant_time_gap = 0.0;
    }
    evaluation
}

#[test]
fn the_true_model_wins_for_any_number_of_threads() {
    let stretches: Vec<FollowingStretch> = (0..3)
        .map(|k| {
            let later = |time_s: f64| leader_mps(time_s + 97.0 * f64::from(k));
            one_stretch(&log_of(follow(&IDM, later, 0.1, 1500, 10), 0.1))
        })
        .collect();
    let units = HoldOut::by_unit(&["group 0", "group 1", "group 2"]);
    let on = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
            .install(|| without_times(evaluate_following(&stretches, &units).unwrap()))
    };
    let evaluation = on(1);
    assert_eq!(evaluation, on(3));
    let difference = evaluation.held_out_difference;
    assert!(difference.gap_rmse_m < -0.5, "{difference:?}");
    assert_eq!(difference.idm_better, 3);
    assert_close(&evaluation.all.idm.model, &IDM, 0.05);
    assert!(evaluation.in_sample.idm.gap_rmse_m < 0.2);
    assert_eq!(evaluation.stretches[2].group, "group 2");
}

fn hostile() -> impl Strategy<Value = Vec<[f64; 3]>> {
    let value = prop_oneof![
        6 => 0.0..40.0_f64,
        1 => prop_oneof![
            Just(f64::NAN),
            Just(f64::INFINITY),
            Just(-3.0),
            Just(0.0),
            Just(1e-300),
            Just(1e300),
        ],
    ];
    let speed = prop_oneof![8 => 0.0..40.0_f64, 1 => prop_oneof![Just(-1e300), Just(1e300)]];
    // The same row some times over, so that stretches get longer than a sample.
    proptest::collection::vec(((speed, value.clone(), value), 1..40_usize), 1..12).prop_map(
        |rows| {
            rows.into_iter()
                .flat_map(|((speed, gap, lead), times)| vec![[speed, gap, lead]; times])
                .collect()
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn hostile_logs_never_panic_and_stay_finite(rows in hostile()) {
        let column = |k: usize| rows.iter().map(|row| row[k]).collect::<Vec<f64>>();
        let log = log_of([column(0), column(1), column(2)], 0.1);
        let settings = FollowingSettings { min_duration_s: 0.0 };
        for stretch in following_stretches(&motion_of(&log), &settings) {
            prop_assert!(stretch.gap_m().iter().all(|gap| *gap > 0.0));
            prop_assert!(stretch.lead_speed_mps().iter().all(|v| v.is_finite()));
            for model in [IDM, LAW] {
                let errors = model.errors(&stretch);
                prop_assert!(errors.gap_rmse_m.is_finite() && errors.speed_rmse_mps.is_finite());
                let fit = FollowingModel::fit(model.kind(), &[&stretch]);
                prop_assert!(fit.is_err() || fit.unwrap().model.check().is_ok());
            }
        }
    }
}

/// The stretches of every file in a folder, by file.
pub(crate) fn recorded(folder: &Path) -> BTreeMap<String, Vec<FollowingStretch>> {
    let mut found: BTreeMap<String, Vec<FollowingStretch>> = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        if file.extension().is_none_or(|extension| extension != "csv") {
            continue;
        }
        let stretches = found.entry(file.display().to_string()).or_default();
        for log in read_file(&file, &LayoutChoice::Auto).unwrap().logs {
            for piece in prepare(log, &Preparation::default()).unwrap().pieces {
                let settings = FollowingSettings::default();
                stretches.extend(following_stretches(&motion_of(&piece), &settings));
            }
        }
    }
    found
}

#[test]
fn a_law_of_ordinary_stretches_does_not_end_at_its_bounds() {
    let drives = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/drives");
    let by_file = recorded(&drives);
    let stretches: Vec<&FollowingStretch> = by_file.values().flatten().collect();
    let fit = FollowingModel::fit(ModelKind::ConstantTimeGap, &stretches).unwrap();
    assert!(stretches.len() > 15 && fit.at_bound.is_empty(), "{fit:?}");
}

/// Two platoons on a handling course, human drivers; a fit to one of them follows in the other.
#[test]
fn recorded_platoons_are_followed() {
    let Some(folder) = shared("data/openacc") else {
        return;
    };
    let (mut stretches, mut files) = (Vec::new(), Vec::new());
    for (file, found) in recorded(&folder) {
        files.extend(found.iter().map(|_| file.clone()));
        stretches.extend(found);
    }
    let evaluation = evaluate_following(&stretches, &HoldOut::by_unit(&files)).unwrap();
    assert_eq!(evaluation.stretches.len(), 14);
    for figures in [
        evaluation.held_out.idm,
        evaluation.held_out.constant_time_gap,
    ] {
        assert!(
            figures.gap_rmse_m < 6.2 && figures.speed_rmse_mps < 0.7,
            "{figures:?}"
        );
        assert_eq!(figures.collisions, 0);
    }
    for fold in &evaluation.folds {
        assert!(fold.fits.constant_time_gap.at_bound.is_empty());
    }
    for row in &evaluation.drivers {
        if row.parameters_of == ParametersOf::OwnWithPrior {
            assert!(row.against_all.unwrap().gap_rmse_m < -0.5, "{row:?}");
        }
    }
}
