//! Conditioned profiles: shapes, bands, files and hostile outlines.

use drive_sim::{SynthSettings, simulate};
use driver_eval::phase::{Evaluation, EvaluationData, EvaluationSettings, leave_one_out};
use driver_model::phase_model::{ConditionedProfile, Conditioning};
use driver_model::{
    DriveBehaviour, DriverInput, DriverModel, Error, ModelFile, ModelKind, Onset, Phase,
    PhaseCurve, PhaseExtent, PhaseKind, PhaseModel, PhaseSettings, TrainingRecord,
};
use ev_energy::Vehicle;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::{assorted, curve_from, motion_of, plain_set, shaped};

/// Errors of all samples over the gain of their phase.
fn errors(model: &PhaseModel, curves: &[PhaseCurve]) -> Vec<f64> {
    let of_curve = |curve: &PhaseCurve| {
        let outline = curve.outline();
        let pairs = model.predict(&outline).into_iter();
        let pairs = pairs.zip(curve.speed_mps().to_vec());
        pairs.map(move |(p, m)| (p - m) / outline.gain_mps())
    };
    curves.iter().flat_map(of_curve).collect()
}

fn worst(model: &PhaseModel, curves: &[PhaseCurve]) -> f64 {
    let errors = errors(model, curves);
    errors.into_iter().map(f64::abs).fold(0.0, f64::max)
}

fn root_mean_square(model: &PhaseModel, curves: &[PhaseCurve]) -> f64 {
    let errors = errors(model, curves);
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

fn fit(kind: ModelKind, curves: &[PhaseCurve]) -> PhaseModel {
    PhaseModel::fit(kind, &plain_set(curves)).unwrap()
}

#[test]
fn a_shape_that_all_phases_share_is_found_exactly() {
    // Samples at the knots: as many steps as a multiple of theirs.
    let curves: Vec<PhaseCurve> = (0..30)
        .map(|k| {
            shaped(f64::from(k), 40.0, 26 + 25 * (k as usize % 4), |s| {
                s * s * (3.0 - 2.0 * s)
            })
        })
        .collect();
    let model = fit(ModelKind::ProfileConditioned, &curves);
    let is_at_knots = |curve: &&PhaseCurve| curve.outline().samples == ConditionedProfile::KNOTS;
    let at_knots: Vec<PhaseCurve> = curves.iter().filter(is_at_knots).cloned().collect();
    assert!(worst(&model, &at_knots) < 1e-12);
    // A line instead of a curve with second derivative 6, over a twenty-fifth.
    let most = 6.0 / 8.0 / 25.0_f64.powi(2);
    assert!(worst(&model, &curves) < most * 1.01);
}

#[test]
fn a_shape_that_depends_smoothly_on_start_and_duration_is_found() {
    let curves = assorted(1300);
    let (known, unseen) = curves.split_at(1200);
    let mean_shape = root_mean_square(&fit(ModelKind::Profile, known), unseen);
    let left = |count: usize| {
        let model = fit(ModelKind::ProfileConditioned, &known[..count]);
        root_mean_square(&model, unseen) / mean_shape
    };
    // The ridge pulls towards the mean shape, less and less the more phases there are.
    assert!(mean_shape > 0.04);
    assert!(left(100) < 0.2);
    assert!(left(400) < 0.1);
    assert!(left(1200) < 0.05);
}

#[test]
fn the_onset_tells_what_the_outline_does_not() {
    // Phases of one outline; how steeply they begin shows just before.
    let phase = |k: i32| {
        let early = 0.2 * f64::from(k % 21 - 10) / 10.0;
        let inside = shaped(5.0, 15.0, 51, |s| {
            s + early * (std::f64::consts::PI * s).sin()
        });
        let before = [3.0, 2.0, 1.0].map(|steps| 5.0 - steps * 0.1 * (1.0 + early));
        let speed = before.iter().chain(inside.speed_mps());
        curve_from(3, speed.copied().collect())
    };
    let curves: Vec<PhaseCurve> = (0..210).map(phase).collect();
    let error = |kind| root_mean_square(&fit(kind, &curves), &curves);
    let (without, with) = (
        error(ModelKind::ProfileConditioned),
        error(ModelKind::ProfileOnset),
    );
    assert!((without / error(ModelKind::Profile) - 1.0).abs() < 0.01);
    assert!(with < 0.1 * without, "{with} {without}");
}

fn simulated(kind: PhaseKind, seed: u64) -> Evaluation {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let settings = SynthSettings {
        seed,
        drives: 16,
        ..SynthSettings::default()
    };
    let trips: Vec<DriveBehaviour> = simulate(&settings, &vehicle)
        .unwrap()
        .into_iter()
        .map(|drive| {
            DriveBehaviour::of_drive(&[motion_of(&drive.log)], &PhaseSettings::default()).unwrap()
        })
        .collect();
    let settings = EvaluationSettings {
        models: vec![ModelKind::ProfileConditioned, ModelKind::ProfileOnset],
        ..EvaluationSettings::default()
    };
    let data = EvaluationData::by_trip(&trips);
    leave_one_out(kind, &data, &vehicle, &settings, &|| {}).unwrap()
}

#[test]
fn bands_hold_their_share_of_simulated_phases_that_were_held_out() {
    for (kind, seed) in [
        (PhaseKind::Acceleration, 1),
        (PhaseKind::Acceleration, 2),
        (PhaseKind::Braking, 3),
    ] {
        let evaluation = simulated(kind, seed);
        assert!(evaluation.phases.len() > 100);
        assert_eq!(evaluation.bands.len(), 2);
        for (model, levels) in &evaluation.bands {
            let promised: Vec<f64> = levels.iter().map(|l| l.level_pct).collect();
            assert_eq!(promised, [50.0, 80.0, 90.0, 95.0]);
            for level in levels {
                // Some hundred phases, whose samples are off together: 90 % within 4 points, 50 % within 8.
                let tolerance = if level.level_pct < 60.0 { 8.0 } else { 4.0 };
                let off = level.inside_pct - level.level_pct;
                assert!(off.abs() < tolerance, "{kind:?} {seed} {model} {level:?}");
            }
            let widths: Vec<f64> = levels.iter().map(|l| l.mean_width_mps).collect();
            assert!(widths[0] > 0.0 && widths.is_sorted());
        }
    }
}

fn fitted(conditioning: Conditioning) -> PhaseModel {
    let curves = assorted(40);
    let model = ConditionedProfile::fit(conditioning, &plain_set(&curves)).unwrap();
    match conditioning {
        Conditioning::Outline => PhaseModel::ProfileConditioned(model),
        Conditioning::Onset | Conditioning::Input => PhaseModel::ProfileOnset(model),
    }
}

fn file(model: PhaseModel) -> ModelFile {
    let training = TrainingRecord {
        phases: 40,
        points: 0,
        inputs: Vec::new(),
        prior_inputs: Vec::new(),
        prior_weight: 0.0,
        extent: PhaseExtent::default(),
    };
    ModelFile::new(DriverModel::Acceleration(model), training, json!({}))
}

#[test]
fn written_and_read_it_predicts_the_same_bits() {
    for conditioning in [Conditioning::Outline, Conditioning::Onset] {
        let written = file(fitted(conditioning));
        let read = ModelFile::from_json(&written.to_json().unwrap()).unwrap();
        assert_eq!(read, written);
        let (DriverModel::Acceleration(read), DriverModel::Acceleration(written)) =
            (read.model, written.model)
        else {
            panic!("models of phases");
        };
        let outline = assorted(3)[2].outline();
        assert_eq!(read.predict(&outline), written.predict(&outline));
        assert_eq!(read.bands(&outline), written.bands(&outline));
    }
}

/// A change to the value at a JSON pointer.
type Damage = (&'static str, fn(&mut Value));

fn pop(value: &mut Value) {
    value.as_array_mut().unwrap().pop();
}

fn push(value: &mut Value) {
    value.as_array_mut().unwrap().push(json!(0.5));
}

fn empty(value: &mut Value) {
    *value = json!([]);
}

#[test]
fn damaged_lists_are_refused() {
    let lists = [
        "/basis/mean",
        "/basis/deviation",
        "/basis/centres/3",
        "/mean_shape",
        "/shape_coefficients/2",
        "/log_spread_coefficients",
        "/bands/1/half_width",
    ];
    let mut damages: Vec<Damage> = Vec::new();
    for list in lists {
        for damage in [pop, push, empty] {
            damages.push((list, damage));
        }
    }
    for list in ["/basis/centres", "/shape_coefficients"] {
        damages.push((list, pop));
        damages.push((list, empty));
    }
    for number in [
        "/basis/mean/0",
        "/basis/deviation/1",
        "/basis/centres/0/0",
        "/mean_shape/7",
        "/shape_coefficients/0/25",
        "/mean_log_spread",
        "/log_spread_coefficients/0",
        "/bands/0/half_width/5",
        "/bands/3/level_pct",
    ] {
        damages.push((number, |v| *v = json!(null)));
        damages.push((number, |v| *v = json!(1e300)));
        damages.push((number, |v| *v = json!(-1e300)));
        damages.push((number, |v| *v = json!("0.1")));
    }
    damages.push(("/bands/0/half_width/5", |v| *v = json!(-1e-9)));
    damages.push(("/basis/deviation/0", |v| *v = json!(0.0)));
    damages.push(("/basis/deviation/0", |v| *v = json!(-1.0)));
    damages.push(("/bands/0/level_pct", |v| *v = json!(0.0)));
    damages.push(("/bands/0/level_pct", |v| *v = json!(101.0)));

    for conditioning in [Conditioning::Outline, Conditioning::Onset] {
        let whole: Value =
            serde_json::from_str(&file(fitted(conditioning)).to_json().unwrap()).unwrap();
        for (place, damage) in &damages {
            let mut damaged = whole.clone();
            damage(damaged["model"].pointer_mut(place).unwrap());
            let outcome = ModelFile::from_json(&damaged.to_string());
            let refused = matches!(
                outcome,
                Err(Error::ModelFile { .. } | Error::Parameter { .. })
            );
            assert!(
                refused,
                "{place} {}",
                damaged["model"].pointer(place).unwrap_or(&Value::Null)
            );
        }
    }
}

#[test]
fn one_kind_does_not_pass_for_the_other() {
    let swapped = [
        (
            Conditioning::Outline,
            "profile-conditioned",
            "profile-onset",
        ),
        (Conditioning::Onset, "profile-onset", "profile-conditioned"),
    ];
    for (conditioning, from, to) in swapped {
        let text = file(fitted(conditioning))
            .to_json()
            .unwrap()
            .replace(from, to);
        assert!(matches!(
            ModelFile::from_json(&text),
            Err(Error::Parameter { .. })
        ));
    }
}

#[test]
fn numbers_that_are_none_are_refused_without_a_file() {
    let PhaseModel::ProfileConditioned(whole) = fitted(Conditioning::Outline) else {
        unreachable!()
    };
    let refused = |damage: fn(&mut ConditionedProfile)| {
        let mut model = whole.clone();
        damage(&mut model);
        let check = PhaseModel::ProfileConditioned(model).check();
        assert!(matches!(check, Err(Error::Parameter { .. })));
    };
    refused(|m| m.basis.mean[0] = f64::NAN);
    refused(|m| m.basis.centres[0][1] = f64::INFINITY);
    refused(|m| m.shape_coefficients[1][1] = f64::NAN);
    refused(|m| m.log_spread_coefficients[0] = f64::NEG_INFINITY);
    refused(|m| m.mean_log_spread = f64::NAN);
    refused(|m| m.bands[0].half_width[0] = f64::NAN);
    refused(|m| m.bands[0].level_pct = f64::NAN);
}

fn hostile() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => 0.0..60.0f64,
        1 => prop_oneof![Just(0.0), Just(1e-300), Just(1e-9), Just(1e6), Just(1e100)],
    ]
}

fn hostile_onset() -> impl Strategy<Value = Option<Onset>> {
    let value = || {
        prop_oneof![
            3 => -50.0..50.0f64,
            1 => prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(-1e300), Just(1e300)],
        ]
    };
    let onset = (value(), value(), value()).prop_map(|(a, j, p)| Onset {
        accel_mps2: a,
        jerk_mps3: j,
        previous_jerk_mps3: p,
    });
    proptest::option::of(onset)
}

proptest! {
    #[test]
    fn extreme_outlines_get_finite_predictions(
        start in hostile(), end in hostile(), samples in 1..300usize,
        step in prop_oneof![Just(1e-6), Just(0.1), Just(1e6)], onset in hostile_onset(),
    ) {
        let outline = Phase { start_speed_mps: start, end_speed_mps: end, step_s: step, samples, onset, input: DriverInput::default() };
        thread_local! {
            static MODELS: [PhaseModel; 2] = [fitted(Conditioning::Outline), fitted(Conditioning::Onset)];
        }
        MODELS.with(|models| {
            for model in models {
                let speed = model.predict(&outline);
                prop_assert_eq!(speed.len(), samples);
                prop_assert!(speed.iter().all(|v| v.is_finite()), "{:?}", speed);
                for band in model.bands(&outline) {
                    prop_assert_eq!(band.half_width_mps.len(), samples);
                    prop_assert!(band.half_width_mps.iter().all(|w| w.is_finite() && *w >= 0.0));
                }
            }
            Ok(())
        })?;
    }
}
