//! How phases that have just begun go on, predicted for drives that were held out.

use driver_model::live::{Beginning, BegunPhases, BegunSettings};
use driver_model::statistics::mean;
use driver_model::{
    BEGUN_S, DriveBehaviour, FitSettings, ModelKind, PhaseCurve, PhaseMemory, PhaseModel,
};
use serde::Serialize;

use crate::ratio_interval::RatioInterval;
use crate::{Error, HoldOut};

/// Of the phases that still went on after so many seconds, from [`BEGUN_S`] after their begin on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BegunScore {
    /// Seconds.
    pub after_s: f64,
    /// Phases.
    pub phases: usize,
    /// Of the prediction.
    pub band: BandScore,
    /// Of the band of all remembered phases, whatever they began like.
    pub band_of_all: BandScore,
    /// Root mean square error of the median.
    pub rmse_mps: f64,
    /// Of holding the speed.
    pub hold_rmse_mps: f64,
    /// Of the mean acceleration since the begin going on.
    pub constant_acceleration_rmse_mps: f64,
    /// Mean magnitude of the median's error less that of the better of these two, with its 95 % interval over units.
    pub gain_mps: Option<(f64, f64, f64)>,
}

/// How good a band is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BandScore {
    /// Share of measured speeds inside.
    pub coverage_pct: f64,
    /// Mean full width.
    pub width_mps: f64,
    /// Mean interval score (Gneiting and Raftery 2007).
    pub score_mps: f64,
}

/// One phase at one second.
struct Outcome {
    unit: usize,
    second: usize,
    counts: bool,
    error_mps: f64,
    hold_error_mps: f64,
    constant_error_mps: f64,
    band: Inside,
    band_of_all: Inside,
}

/// What one band makes of one speed.
#[derive(Clone, Copy)]
struct Inside {
    inside: bool,
    width_mps: f64,
    score_mps: f64,
}

impl Inside {
    fn of((low_mps, high_mps): (f64, f64), measured_mps: f64, coverage: f64) -> Self {
        let outside_mps = (low_mps - measured_mps)
            .max(measured_mps - high_mps)
            .max(0.0);
        let width_mps = high_mps - low_mps;
        Self {
            inside: outside_mps == 0.0,
            width_mps,
            score_mps: width_mps + 2.0 / (1.0 - coverage) * outside_mps,
        }
    }
}

/// Which phases are judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BegunOf {
    /// All that began, as a stream reports them.
    All,
    /// Those that came to count.
    Counting,
}

/// Holds each trip out once, fits the model to the others, and predicts the phases of the held-out trip from what is known
/// [`BEGUN_S`] after their begin; scores by second.
///
/// # Errors
/// [`Error::TooFewUnits`] below two trips, [`Error::Model`] where a fold has too little to learn from, and for settings that a memory cannot hold.
pub fn evaluate_begun(
    trips: &[DriveBehaviour],
    model: ModelKind,
    fit: &FitSettings,
    settings: &BegunSettings,
    judged: BegunOf,
) -> Result<Vec<BegunScore>, Error> {
    let hold_out = HoldOut::one_by_one(trips.iter().map(|trip| trip.name.clone()));
    hold_out.at_least(2)?;
    let kind = fit.manoeuvre.into();
    let folds = hold_out.run(&|| {}, |split| {
        let memory = PhaseMemory::new(fit).ok_or(driver_model::Error::NoMemory { model })?;
        let memory = memory.with_own(split.rest().map(|trip| &trips[trip]));
        let fitted = PhaseModel::fit(model, &memory.training())?;
        let begun = BegunPhases::new(fitted, &memory, settings)?;
        let of_all = begun.changes_of_all_mps();
        let mut outcomes = Vec::new();
        for trip in split.held_out() {
            let counting = trips[trip].phases_of(kind).map(|curve| (curve, true));
            let short = trips[trip]
                .short_phases_of(kind)
                .map(|curve| (curve, false));
            for (curve, counts) in counting.chain(short) {
                let of_curve = outcomes_of(curve, &begun, &of_all, settings.coverage);
                outcomes.extend(of_curve.into_iter().map(|outcome| Outcome {
                    unit: split.fold(),
                    counts,
                    ..outcome
                }));
            }
        }
        Ok(outcomes)
    })?;
    let all: Vec<Outcome> = folds.into_iter().flatten().collect();
    let counts = |outcome: &&Outcome| judged == BegunOf::All || outcome.counts;
    let judged: Vec<&Outcome> = all.iter().filter(counts).collect();
    let last = judged.iter().map(|outcome| outcome.second).max();
    Ok((1..=last.unwrap_or(0))
        .filter_map(|second| BegunScore::of(second, &judged))
        .collect())
}

fn outcomes_of(
    curve: &PhaseCurve,
    begun: &BegunPhases,
    of_all: &[(f64, f64)],
    coverage: f64,
) -> Vec<Outcome> {
    let Some(beginning) = Beginning::of(curve) else {
        return Vec::new();
    };
    let now_mps = beginning.start_speed_mps + beginning.early_gain_mps;
    let forecast = begun.forecast(&beginning);
    let seconds = forecast.seconds.iter().zip(of_all);
    let outcome = |(second, (low_mps, high_mps)): (&driver_model::live::Second, &(f64, f64))| {
        let sample = ((BEGUN_S + second.after_s) / curve.step_s()).round() as usize;
        let measured_mps = *curve.speed_mps().get(sample)?;
        let constant_mps = now_mps + beginning.early_gain_mps / BEGUN_S * second.after_s;
        let of_all = (now_mps + low_mps, now_mps + high_mps);
        Some(Outcome {
            unit: 0,
            second: second.after_s as usize,
            counts: false,
            error_mps: second.speed_mps - measured_mps,
            hold_error_mps: now_mps - measured_mps,
            constant_error_mps: constant_mps.max(0.0) - measured_mps,
            band: Inside::of((second.low_mps, second.high_mps), measured_mps, coverage),
            band_of_all: Inside::of(of_all, measured_mps, coverage),
        })
    };
    seconds.filter_map(outcome).collect()
}

impl BegunScore {
    fn of(second: usize, outcomes: &[&Outcome]) -> Option<Self> {
        let at = || outcomes.iter().filter(|outcome| outcome.second == second);
        let rms = |of: fn(&Outcome) -> f64| {
            let squares = at().map(|outcome| of(outcome).powi(2));
            mean(squares).map(f64::sqrt)
        };
        let band = |of: fn(&Outcome) -> Inside| {
            Some(BandScore {
                coverage_pct: mean(at().map(|o| f64::from(u8::from(of(o).inside))))? * 100.0,
                width_mps: mean(at().map(|o| of(o).width_mps))?,
                score_mps: mean(at().map(|o| of(o).score_mps))?,
            })
        };
        let (hold, constant) = (rms(|o| o.hold_error_mps)?, rms(|o| o.constant_error_mps)?);
        let baseline: fn(&Outcome) -> f64 = if hold < constant {
            |o| o.hold_error_mps
        } else {
            |o| o.constant_error_mps
        };
        let mut units = std::collections::BTreeMap::<usize, (f64, f64)>::new();
        for outcome in at() {
            let sums = units.entry(outcome.unit).or_default();
            sums.0 += outcome.error_mps.abs() - baseline(outcome).abs();
            sums.1 += 1.0;
        }
        let gain = RatioInterval::of(units.values().copied());
        Some(Self {
            after_s: second as f64,
            phases: at().count(),
            band: band(|o| o.band)?,
            band_of_all: band(|o| o.band_of_all)?,
            rmse_mps: rms(|o| o.error_mps)?,
            hold_rmse_mps: hold,
            constant_acceleration_rmse_mps: constant,
            gain_mps: gain.map(|interval| (interval.ratio, interval.low, interval.high)),
        })
    }
}
