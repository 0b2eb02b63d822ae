//! The speed ahead and whole drives by recursion, held out.

mod data;
mod horizon;
mod trip_figures;

use std::time::Instant;

use driver_model::error::at_least;
use driver_model::speed_ahead::{
    DirectModel, DirectSettings, FittedTrial, Trial, TrialSettings, origins,
};
use driver_model::{DriverChannel, ModelKind, Motion, Subject};
use ev_energy::Vehicle;
use rayon::prelude::*;

use crate::Error;
use crate::hold_out::Split;
pub use data::TrajectoryData;
use horizon::{HorizonErrors, Judged, verdicts};
pub use horizon::{HorizonFigures, HorizonRow, HorizonVerdict, IntervalFigures};
pub use trip_figures::{TripFigures, TripSummary};

/// What is evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectorySettings {
    /// Models of the speed ahead; the baselines are always added.
    pub models: Vec<ModelKind>,
    /// How direct models are fitted.
    pub direct: DirectSettings,
    /// How the five trials are fitted.
    pub trials: TrialSettings,
    /// Number of folds: unit `u` is held out in fold `u mod folds`; 3.
    pub folds: usize,
    /// Full width of the band of Table 4.1; 5 km/h.
    pub band_mps: f64,
}

impl Default for TrajectorySettings {
    fn default() -> Self {
        Self {
            models: ModelKind::of(Subject::SpeedAhead).collect(),
            direct: DirectSettings::default(),
            trials: TrialSettings::default(),
            folds: 3,
            band_mps: 5.0 / 3.6,
        }
    }
}

/// One drive as a trial predicts it from its limits.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialTrip {
    /// Index of the motion.
    pub motion: usize,
    /// Predicted speed; not a number where the recursion has run away.
    pub speed_mps: Vec<f64>,
    /// How good that is.
    pub figures: TripFigures,
}

/// A trial on all drives, each predicted from the others.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialResult {
    /// Which trial.
    pub trial: Trial,
    /// As fitted in each fold.
    pub fits: Vec<FittedTrial>,
    /// In the order of drives.
    pub trips: Vec<TrialTrip>,
}

impl TrialResult {
    /// The row of Table 4.1; `None` without trips.
    #[must_use]
    pub fn summary(&self) -> Option<TripSummary> {
        let figures: Vec<&TripFigures> = self.trips.iter().map(|trip| &trip.figures).collect();
        TripSummary::of(&figures)
    }
}

/// The outcome of [`evaluate_trajectory`].
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryEvaluation {
    /// Seconds ahead.
    pub horizons_s: Vec<f64>,
    /// What models are told that have it in their name; empty where no drive has it.
    pub channels: Vec<DriverChannel>,
    /// Models with baselines, and the trials by recursion where there are limits.
    pub rows: Vec<HorizonRow>,
    /// The best model against the best baseline that knows the same, per horizon.
    pub verdicts: Vec<HorizonVerdict>,
    /// Empty where a drive has no speed limits.
    pub trials: Vec<TrialResult>,
    /// Models that could not be fitted, fitted baselines among them, and why.
    pub left_out: Vec<(String, String)>,
}

/// Holds every unit out once and predicts the speed ahead, and whole drives by the five trials where all have limits.
///
/// `progress` is called [`TrajectorySettings::steps`] times.
///
/// # Errors
/// [`Error::TooFewUnits`] with fewer units than folds, [`Error::Model`] for less than two folds, for drives of different sampling
/// intervals, and what all models refuse alike. Drives that lack something are to be left out before, by
/// [`TrajectoryData::usable`].
pub fn evaluate_trajectory(
    data: &TrajectoryData,
    vehicle: &Vehicle,
    settings: &TrajectorySettings,
    progress: &(dyn Fn() + Sync),
) -> Result<TrajectoryEvaluation, Error> {
    let expected = "at least 2, so that other drives are left to learn from";
    at_least("folds", settings.folds as f64, 2.0, expected)?;
    data.hold_out.at_least(settings.folds)?;
    let hold_out = data.hold_out.clone().in_folds(settings.folds);
    let units = hold_out.units().len();
    let contestants = settings.contestants(data.has_limits());
    let jobs: Vec<(usize, usize)> = (0..contestants.len())
        .flat_map(|c| (0..settings.folds).map(move |fold| (c, fold)))
        .collect();
    let run = |&(c, fold): &(usize, usize)| {
        let outcome = contestants[c].run(hold_out.split(fold), data, vehicle, settings);
        progress();
        outcome
    };
    let outcomes: Vec<Result<FoldOutcomes, Error>> = jobs.par_iter().map(run).collect();

    let mut evaluation = TrajectoryEvaluation {
        horizons_s: settings.direct.horizons_s.clone(),
        channels: data.channels(&settings.direct),
        rows: Vec::new(),
        verdicts: Vec::new(),
        trials: Vec::new(),
        left_out: Vec::new(),
    };
    let mut outcomes = outcomes.into_iter();
    for contestant in contestants {
        let folds: Result<Vec<FoldOutcomes>, Error> =
            outcomes.by_ref().take(settings.folds).collect();
        match folds {
            Ok(folds) => {
                let (untold, told): (Vec<_>, Vec<_>) = folds
                    .into_iter()
                    .map(|fold| (fold.untold, fold.told))
                    .unzip();
                evaluation.add(contestant, false, untold, units);
                let told: Vec<FoldOutcome> = told.into_iter().flatten().collect();
                if !told.is_empty() {
                    evaluation.add(contestant, true, told, units);
                }
            }
            Err(error) if contestant.learns() => {
                evaluation
                    .left_out
                    .push((contestant.name(), error.to_string()));
            }
            Err(error) => return Err(error),
        }
    }
    HorizonRow::compare_with_persistence(&mut evaluation.rows);
    evaluation.verdicts = verdicts(&evaluation.rows, &evaluation.horizons_s);
    Ok(evaluation)
}

impl TrajectoryEvaluation {
    /// The horizons nearest to 5 and to 10 s, where intervals are compared.
    pub fn shown_horizons(&self) -> impl Iterator<Item = usize> {
        let nearest = |to_s: f64| {
            let horizons = self.horizons_s.iter().enumerate();
            let off = |(_, horizon_s): &(usize, &f64)| (*horizon_s - to_s).abs();
            horizons
                .min_by(|a, b| off(a).total_cmp(&off(b)))
                .map(|(k, _)| k)
        };
        let (five, ten) = (nearest(5.0), nearest(10.0));
        five.into_iter().chain(ten.filter(|_| ten != five))
    }
}

impl TrajectorySettings {
    /// How often an evaluation reports progress.
    #[must_use]
    pub fn steps(&self, data: &TrajectoryData) -> usize {
        self.contestants(data.has_limits()).len() * self.folds
    }

    fn contestants(&self, with_limits: bool) -> Vec<Contestant> {
        let wanted = |kind: &ModelKind| kind.is_baseline() || self.models.contains(kind);
        let direct = ModelKind::of(Subject::SpeedAhead)
            .filter(wanted)
            .map(Contestant::Direct);
        let trials = Trial::ALL.into_iter().map(Contestant::Trial);
        direct.chain(trials.filter(|_| with_limits)).collect()
    }
}

/// Behind the name of a model that is told what the driver does.
const TOLD: &str = "+channels";

/// What predicts.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Contestant {
    Direct(ModelKind),
    Trial(Trial),
}

/// One contestant on one fold, and told what the driver does where the drives know it.
struct FoldOutcomes {
    untold: FoldOutcome,
    told: Option<FoldOutcome>,
}

/// One model on one fold.
struct FoldOutcome {
    errors: Vec<HorizonErrors>,
    trial: Option<(FittedTrial, Vec<TrialTrip>)>,
    fit_seconds: f64,
    predict_seconds: f64,
    unfinished: usize,
}

impl Contestant {
    fn name(self) -> String {
        match self {
            Self::Direct(kind) => kind.name().to_owned(),
            Self::Trial(trial) => format!("trial-{}", trial.number()),
        }
    }

    fn is_baseline(self) -> bool {
        matches!(self, Self::Direct(kind) if kind.is_baseline())
    }

    /// What has nothing to learn from is left out.
    fn learns(self) -> bool {
        !matches!(self, Self::Direct(kind) if !kind.is_fitted())
    }

    fn run(
        self,
        split: Split<'_>,
        data: &TrajectoryData,
        vehicle: &Vehicle,
        settings: &TrajectorySettings,
    ) -> Result<FoldOutcomes, Error> {
        match self {
            Self::Direct(kind) => run_direct(kind, split, data, settings),
            Self::Trial(trial) => Ok(FoldOutcomes {
                untold: run_trial(trial, split, data, vehicle, settings)?,
                told: None,
            }),
        }
    }
}

fn learnt_from<'a>(split: Split<'_>, data: &'a TrajectoryData) -> Vec<&'a Motion> {
    split.rest().map(|item| &data.motions[item]).collect()
}

fn run_direct(
    kind: ModelKind,
    split: Split<'_>,
    data: &TrajectoryData,
    settings: &TrajectorySettings,
) -> Result<FoldOutcomes, Error> {
    let started = Instant::now();
    let motions = learnt_from(split, data);
    let model = DirectModel::fit_untold(kind, &motions, &settings.direct)?;
    let fit_seconds = started.elapsed().as_secs_f64();
    let untold = predict_held_out(&model, split, data, settings, fit_seconds)?;
    if !kind.is_fitted() || data.channels(&settings.direct).is_empty() {
        return Ok(FoldOutcomes { untold, told: None });
    }
    let started = Instant::now();
    let told = model.learn_channels(&motions, &settings.direct)?;
    let fit_seconds = started.elapsed().as_secs_f64();
    let told = predict_held_out(&told, split, data, settings, fit_seconds)?;
    Ok(FoldOutcomes {
        untold,
        told: Some(told),
    })
}

fn predict_held_out(
    model: &DirectModel,
    split: Split<'_>,
    data: &TrajectoryData,
    settings: &TrajectorySettings,
    fit_seconds: f64,
) -> Result<FoldOutcome, Error> {
    let started = Instant::now();
    let units = data.hold_out.units().len();
    let mut errors = vec![HorizonErrors::none(units); model.horizons_s().len()];
    for i in split.held_out() {
        let motion = &data.motions[i];
        let one_width: Vec<Option<f64>> = model.one_width_mps(Some(motion)).collect();
        let origins = model.origins(motion, settings.direct.sample_step_s);
        for (&origin, ahead) in origins.iter().zip(model.predict(motion, &origins)?) {
            for (k, (errors, horizon_s)) in errors.iter_mut().zip(model.horizons_s()).enumerate() {
                let judged = Judged {
                    predicted_mps: ahead.speed_mps[k],
                    measured_mps: motion.speed_mps()[origin + motion.samples_in(horizon_s)],
                    interval_mps: ahead.interval_mps[k],
                    one_width_mps: one_width[k],
                };
                errors.add(data.hold_out.unit_of()[i], judged, settings.direct.coverage);
            }
        }
    }
    Ok(FoldOutcome {
        errors,
        trial: None,
        unfinished: model.unfinished_s().count(),
        fit_seconds,
        predict_seconds: started.elapsed().as_secs_f64(),
    })
}

fn run_trial(
    trial: Trial,
    split: Split<'_>,
    data: &TrajectoryData,
    vehicle: &Vehicle,
    settings: &TrajectorySettings,
) -> Result<FoldOutcome, Error> {
    let started = Instant::now();
    let fitted = trial.fit(&learnt_from(split, data), &settings.trials)?;
    let fit_seconds = started.elapsed().as_secs_f64();
    let started = Instant::now();
    let horizons_s = &settings.direct.horizons_s;
    let units = data.hold_out.units().len();
    let mut errors = vec![HorizonErrors::none(units); horizons_s.len()];
    let mut trips = Vec::new();
    for i in split.held_out() {
        let motion = &data.motions[i];
        let speed_mps = fitted.predict(motion)?;
        let figures = TripFigures::compare(motion, &speed_mps, vehicle, settings.band_mps)
            .map_err(|error| error.in_log(motion.name()))?;
        trips.push(TrialTrip {
            motion: i,
            speed_mps,
            figures,
        });

        let longest_s = horizons_s.iter().copied().fold(0.0, f64::max);
        let origins = origins(motion, longest_s, settings.direct.sample_step_s);
        let ahead = fitted.predict_ahead(motion, &origins, motion.samples_in(longest_s))?;
        for (&origin, ahead) in origins.iter().zip(ahead) {
            for (errors, &horizon_s) in errors.iter_mut().zip(horizons_s) {
                let steps = motion.samples_in(horizon_s);
                let judged = Judged {
                    predicted_mps: ahead[steps - 1],
                    measured_mps: motion.speed_mps()[origin + steps],
                    interval_mps: None,
                    one_width_mps: None,
                };
                errors.add(data.hold_out.unit_of()[i], judged, settings.direct.coverage);
            }
        }
    }
    Ok(FoldOutcome {
        errors,
        unfinished: usize::from(fitted.fit.status != svr::Status::Optimal),
        trial: Some((fitted, trips)),
        fit_seconds,
        predict_seconds: started.elapsed().as_secs_f64(),
    })
}

impl TrajectoryEvaluation {
    fn add(&mut self, contestant: Contestant, told: bool, folds: Vec<FoldOutcome>, units: usize) {
        let mut errors = vec![HorizonErrors::none(units); self.horizons_s.len()];
        let (mut fit_seconds, mut predict_seconds, mut unfinished) = (0.0, 0.0, 0);
        let (mut fits, mut trips) = (Vec::new(), Vec::new());
        for fold in folds {
            for (all, of_fold) in errors.iter_mut().zip(&fold.errors) {
                all.merge(of_fold);
            }
            fit_seconds += fold.fit_seconds;
            predict_seconds += fold.predict_seconds;
            unfinished += fold.unfinished;
            if let Some((fitted, predicted)) = fold.trial {
                fits.push(fitted);
                trips.extend(predicted);
            }
        }
        let name = contestant.name() + if told { TOLD } else { "" };
        let foresees = matches!(contestant, Contestant::Trial(_));
        let mut row = HorizonRow::new(name, contestant.is_baseline(), told, foresees, errors);
        (row.fit_seconds, row.predict_seconds, row.unfinished) =
            (fit_seconds, predict_seconds, unfinished);
        self.rows.push(row);
        if let Contestant::Trial(trial) = contestant {
            trips.sort_by_key(|trip| trip.motion);
            self.trials.push(TrialResult { trial, fits, trips });
        }
    }
}
