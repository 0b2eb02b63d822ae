//! The JSON document of an evaluation, and what the report gets beyond it.

use std::collections::BTreeMap;

use driver_model::cruise::CruiseModel;
use driver_model::following::{FollowingModel, FollowingStretch};
use driver_model::phase_model::{GroupResponse, PredictiveBand, StepResponse, identify};
use driver_model::{
    AccelDensity, DriveBehaviour, FunctionFit, LeftOut, ModelKind, PhaseKind, PhaseModel,
};
use serde::Serialize;
use serde_json::{Value, json};

use super::{BehaviourEvaluation, WholePhases};
use crate::cruise::{CruiseEvaluation, CruiseFold, CruiseSummary};
use crate::following::{
    DriverComparison, FollowingEvaluation, FollowingFold, FollowingSummary, PairedDifference,
    PerFollowingModel, ScoredStretch,
};
use crate::phase::{
    BandCoverage, EvaluatedPhase, Evaluation, Fold, LearningPoint, PairedComparison,
    PhasePrediction, Summary,
};
use crate::units::{UnitKind, Units, UnitsEntry};
use crate::words::{plural, rounded};

/// What a document says of a [`BehaviourEvaluation`].
#[derive(Debug, Serialize)]
pub struct BehaviourDocument<'a> {
    hold_out: UnitKind,
    held_out: UnitsEntry,
    /// Acceleration on the outside, as scripts have known it.
    #[serde(flatten)]
    acceleration: Kind<'a>,
    braking: Option<Kind<'a>>,
    /// From where phases begin to where they end.
    whole_phases: &'a WholePhases,
    function_fits: BTreeMap<&'static str, FunctionFits<'a>>,
    learning_curve: Option<&'a [LearningPoint]>,
    cruise: Option<Cruise<'a>>,
    following: Option<Following<'a>>,
    system_identification: Option<SystemIdentification<'a>>,
    /// Parts without figures, with the reason.
    not_evaluated: &'a BTreeMap<&'static str, String>,
    /// Drives that have nothing to evaluate.
    left_out_drives: &'a [LeftOut],
    /// The vehicle, where none was named.
    default_vehicle: Option<&'static str>,
}

/// Functions of speed fitted to everything.
#[derive(Debug, Serialize)]
struct FunctionFits<'a> {
    fits: &'a [FunctionFit],
}

/// The transition-point method on all acceleration phases.
#[derive(Debug, Serialize)]
struct SystemIdentification<'a> {
    thrown_away: usize,
    groups: Vec<GroupEntry<'a>>,
}

#[derive(Debug, Serialize)]
struct GroupEntry<'a> {
    group: String,
    response: &'a StepResponse,
    used: usize,
    other_form: usize,
    unidentified: usize,
}

/// Cruising.
#[derive(Debug, Serialize)]
struct Cruise<'a> {
    models: BTreeMap<&'static str, CruiseSummary>,
    parameters: CruiseModel,
    folds: &'a [CruiseFold],
}

/// Behind a vehicle.
#[derive(Debug, Serialize)]
struct Following<'a> {
    /// Held out.
    models: BTreeMap<&'static str, FollowingSummary>,
    in_sample: BTreeMap<&'static str, FollowingSummary>,
    paired: PairedDifference,
    folds: &'a [FollowingFold],
    stretches: &'a [ScoredStretch],
    /// Parameters per driver; none where no driver is known from elsewhere.
    drivers: &'a [DriverComparison],
}

/// One kind of phase.
#[derive(Debug, Default, Serialize)]
struct Kind<'a> {
    models: BTreeMap<&'static str, &'a Summary>,
    folds: Vec<FoldEntry<'a>>,
    baselines: BTreeMap<&'static str, &'a Summary>,
    paired: &'a [PairedComparison],
    bands: BTreeMap<&'static str, &'a [BandCoverage]>,
    left_out: BTreeMap<&'static str, &'a str>,
}

#[derive(Debug, Serialize)]
struct FoldEntry<'a> {
    held_out: &'a str,
    model: &'static str,
    phases: usize,
    rmse_mps: Option<f64>,
    in_band_pct: Option<f64>,
    /// `null` for the conditioned profiles with their thousands; `drivekit fit` writes them.
    parameters: Option<&'a PhaseModel>,
    notes: Vec<String>,
}

impl<'a> BehaviourDocument<'a> {
    /// `default_vehicle` is the vehicle where none was named.
    #[must_use]
    pub fn new(
        units: &Units,
        findings: &'a BehaviourEvaluation,
        default_vehicle: Option<&'static str>,
    ) -> Self {
        let fits = findings.fits.iter().filter(|(_, fits)| !fits.is_empty());
        Self {
            hold_out: units.kind,
            held_out: units.entry(),
            default_vehicle,
            acceleration: findings
                .acceleration
                .as_ref()
                .map_or_else(Kind::default, Kind::new),
            braking: findings.braking.as_ref().map(Kind::new),
            whole_phases: &findings.whole,
            function_fits: fits
                .map(|(kind, fits)| (kind.name(), FunctionFits { fits }))
                .collect(),
            learning_curve: findings.learning.as_deref(),
            cruise: findings.cruise.as_ref().map(Cruise::new),
            following: findings.following.as_ref().map(|(e, _)| Following::new(e)),
            system_identification: findings.systems.as_ref().map(|model| SystemIdentification {
                thrown_away: model.thrown_away(),
                groups: model.groups.iter().map(GroupEntry::new).collect(),
            }),
            not_evaluated: &findings.missing,
            left_out_drives: &findings.left_out,
        }
    }
}

impl<'a> GroupEntry<'a> {
    fn new(group: &'a GroupResponse) -> Self {
        Self {
            group: group.group.name(),
            response: &group.response,
            used: group.phases,
            other_form: group.other_form,
            unidentified: group.unidentified,
        }
    }
}

impl<'a> Cruise<'a> {
    fn new(evaluation: &'a CruiseEvaluation) -> Self {
        let models = [
            ("cruise", Some(evaluation.cruise)),
            ("hold", Some(evaluation.hold)),
            ("limit", evaluation.limit),
            ("cruise-with-limit", evaluation.cruise_with_limit),
        ];
        Self {
            models: models
                .into_iter()
                .filter_map(|(name, s)| Some((name, s?)))
                .collect(),
            parameters: evaluation.parameters,
            folds: &evaluation.folds,
        }
    }
}

impl<'a> Following<'a> {
    fn new(evaluation: &'a FollowingEvaluation) -> Self {
        let by_name = |summaries: &PerFollowingModel<FollowingSummary>| {
            let [idm, law] = [ModelKind::Idm, ModelKind::ConstantTimeGap].map(ModelKind::name);
            BTreeMap::from([(idm, summaries.idm), (law, summaries.constant_time_gap)])
        };
        Self {
            models: by_name(&evaluation.held_out),
            in_sample: by_name(&evaluation.in_sample),
            paired: evaluation.held_out_difference,
            folds: &evaluation.folds,
            stretches: &evaluation.stretches,
            drivers: &evaluation.drivers,
        }
    }
}

impl<'a> Kind<'a> {
    fn new(evaluation: &'a Evaluation) -> Self {
        let table = |baselines: bool| {
            let all = evaluation.models.iter().zip(&evaluation.summaries);
            all.filter(|(kind, _)| kind.is_baseline() == baselines)
                .map(|(kind, summary)| (kind.name(), summary))
                .collect()
        };
        let bands = evaluation.bands.iter();
        let left_out = evaluation.left_out.iter();
        Self {
            models: table(false),
            folds: evaluation
                .folds
                .iter()
                .map(|fold| FoldEntry::new(fold, &evaluation.units))
                .collect(),
            baselines: table(true),
            paired: &evaluation.paired,
            bands: bands.map(|(kind, b)| (kind.name(), b.as_slice())).collect(),
            left_out: left_out
                .map(|(kind, why)| (kind.name(), why.as_str()))
                .collect(),
        }
    }
}

impl<'a> FoldEntry<'a> {
    fn new(fold: &'a Fold, units: &'a [String]) -> Self {
        let notes = match fold.fallbacks {
            0 => Vec::new(),
            n if matches!(fold.model, PhaseModel::ProfilePedal(_)) => vec![format!(
                "{} of logs that do not say what the driver does: predicted as by profile-onset",
                plural(n, "phase")
            )],
            n => vec![format!(
                "{} in speed groups without training phases: nearest group used",
                plural(n, "phase")
            )],
        };
        let is_long = matches!(
            fold.model,
            PhaseModel::ProfileConditioned(_)
                | PhaseModel::ProfileOnset(_)
                | PhaseModel::ProfilePedal(_)
        );
        Self {
            held_out: &units[fold.unit],
            model: fold.model.kind().name(),
            phases: fold.phases,
            rmse_mps: fold.rmse_mps,
            in_band_pct: fold.in_band_pct,
            parameters: (!is_long).then_some(&fold.model),
            notes,
        }
    }
}

/// The document with every curve, for the report.
#[must_use]
pub fn with_curves(
    mut document: Value,
    findings: &BehaviourEvaluation,
    trips: &[DriveBehaviour],
) -> Value {
    document["phases"] = findings.acceleration.as_ref().map_or(json!([]), phases);
    if let Some(braking) = &findings.braking {
        document["braking"]["phases"] = phases(braking);
    }
    for (kind, fits) in &findings.fits {
        if !fits.is_empty() {
            let entry = &mut document["function_fits"][kind.name()];
            entry["means"] = json!(means(*kind, trips));
            entry["density"] = json!(AccelDensity::of(*kind, trips));
        }
    }
    if let (Some(_), Some(acceleration)) = (&findings.systems, &findings.acceleration) {
        document["system_identification"]["phases"] = systems(acceleration);
    }
    if let Some((evaluation, measured)) = &findings.following {
        document["following"]["stretches"] = stretches(evaluation, measured);
    }
    document
}

/// What the transition-point method reads off every phase.
fn systems(evaluation: &Evaluation) -> Value {
    let entry = |phase: &EvaluatedPhase| {
        let (characteristics, response) = identify(&phase.curve)?;
        let mut entry = serde_json::to_value(characteristics).ok()?;
        entry["response"] = json!(response);
        Some(entry)
    };
    evaluation.phases.iter().map(entry).collect()
}

/// Gaps of held-out stretches, measured and simulated, at half a second.
fn stretches(evaluation: &FollowingEvaluation, measured: &[FollowingStretch]) -> Value {
    let scored = evaluation.stretches.iter().zip(measured);
    let entries = scored.filter_map(|(scored, stretch)| {
        let mut folds = evaluation.folds.iter();
        let fold = folds.find(|fold| fold.group == scored.group)?;
        Some(gaps(stretch, fold))
    });
    entries.collect()
}

fn gaps(stretch: &FollowingStretch, fold: &FollowingFold) -> Value {
    let every = (0.5 / stretch.step_s()).round().max(1.0) as usize;
    let thinned = |gap_m: &[f64]| -> Vec<f64> {
        let thinned = gap_m.iter().step_by(every);
        thinned.map(|&gap| to_hundredths(gap)).collect()
    };
    let simulated = |model: &FollowingModel| {
        json!({
            "gap_m": thinned(&model.simulate(stretch).gap_m),
            "gap_rmse_m": model.errors(stretch).gap_rmse_m,
        })
    };
    let [idm, law] = [ModelKind::Idm, ModelKind::ConstantTimeGap].map(ModelKind::name);
    json!({
        "name": stretch.log(),
        "start_s": stretch.start_s(),
        "time_s": (0..stretch.gap_m().len()).step_by(every)
            .map(|k| to_hundredths(k as f64 * stretch.step_s()))
            .collect::<Vec<_>>(),
        "gap_m": thinned(stretch.gap_m()),
        "predictions": {
            idm: simulated(&fold.fits.idm.model),
            law: simulated(&fold.fits.constant_time_gap.model),
        },
    })
}

fn means(kind: PhaseKind, trips: &[DriveBehaviour]) -> Vec<[f64; 2]> {
    let segments = trips.iter().flat_map(|trip| trip.segments_of(kind));
    segments
        .map(|s| [s.mean.speed_mps, s.mean.accel_mps2].map(to_hundredths))
        .collect()
}

fn phases(evaluation: &Evaluation) -> Value {
    let entry = |phase: &EvaluatedPhase| {
        let models = evaluation.models.iter().zip(&phase.predictions);
        let predictions: serde_json::Map<_, _> = models
            .zip(&phase.predicted_energy_j)
            .map(|((kind, p), energy_j)| (kind.name().to_owned(), prediction(p, *energy_j)))
            .collect();
        let outline = phase.curve.outline();
        json!({
            "trip": evaluation.trips[phase.trip],
            "start_s": phase.curve.start_s(),
            "step_s": outline.step_s,
            "group": outline.group().name(),
            "measured_mps": hundredths(phase.curve.speed_mps()),
            "energy_j": phase.energy_j,
            "predictions": predictions,
        })
    };
    evaluation.phases.iter().map(entry).collect()
}

fn prediction(p: &PhasePrediction, energy_j: f64) -> Value {
    let mut entry = json!({
        "speed_mps": hundredths(&p.speed_mps),
        "energy_j": energy_j,
        "rmse_mps": p.rmse_mps,
        "in_band_pct": p.in_band_pct,
        "sqrt_sse_per_sample_mps": p.sqrt_sse_per_sample_mps,
    });
    if let Some(band) = PredictiveBand::of_90_pct(&p.bands) {
        let edge = |sign: f64| -> Vec<f64> {
            let speeds = p.speed_mps.iter().zip(&band.half_width_mps);
            speeds.map(|(v, w)| to_hundredths(v + sign * w)).collect()
        };
        entry["low_mps"] = edge(-1.0).into();
        entry["high_mps"] = edge(1.0).into();
    }
    entry
}

fn hundredths(speed_mps: &[f64]) -> Vec<f64> {
    speed_mps.iter().map(|v| to_hundredths(*v)).collect()
}

fn to_hundredths(value: f64) -> f64 {
    rounded(value, 2)
}
