//! What a fitted model predicts of recorded drives, beside what was measured.

use driver_model::cruise::{CruiseModel, CruiseStretch};
use driver_model::following::{FollowingErrors, FollowingModel, FollowingStretch};
use driver_model::road::{Road, RoadKnowledge};
use driver_model::speed_ahead::{DirectModel, HorizonScore};
use driver_model::trip_driver::{FreeRun, TripDriver};
use driver_model::{
    DriveBehaviour, DriverModel, Error as ModelError, LeftOut, Motion, Phase, PhaseCurve,
    PhaseKind, PhaseModel, PhaseSettings, find_behaviour, without,
};
use serde::Serialize;

use crate::Error;
use crate::phase::PhasePrediction;
use crate::words::plural;

/// Distance of two moments of which the speed ahead is predicted.
const MOMENTS_S: f64 = 1.0;

/// What is predicted.
#[derive(Debug, Clone, PartialEq)]
pub struct PredictionSettings {
    /// Which phases and stretches count.
    pub phases: PhaseSettings,
    /// Full width of the band around the measured speed.
    pub band_mps: f64,
    /// Which of the horizons of a model of the next seconds; none for all.
    pub horizons_s: Vec<f64>,
}

/// Predictions of every drive, by the behaviour of the model.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Predictions {
    /// Of acceleration or braking.
    Phases(Vec<Predicted<PredictedPhase>>),
    /// Of cruising.
    Cruise(Vec<Predicted<PredictedCruise>>),
    /// Of following.
    Following(Vec<Predicted<PredictedFollowing>>),
    /// Of the next seconds.
    SpeedAhead(Vec<PredictedAhead>),
    /// Of whole trips.
    Trips(Vec<PredictedTrip>),
}

impl Predictions {
    /// How much was predicted without what the model knows of the driver, since the log does not say it; `None` for nothing.
    #[must_use]
    pub fn fallbacks_in_words(&self) -> Option<String> {
        match self {
            Self::SpeedAhead(logs) => {
                let fallen = logs.iter().filter(|log| log.falls_back).count();
                let drives = plural(logs.len(), "drive");
                (fallen > 0).then(|| {
                    format!("{fallen} of {drives} predicted without what the driver does, which the model knows and the log does not say")
                })
            }
            Self::Phases(logs) => {
                let phases = || logs.iter().flat_map(|log| &log.phases);
                let fallen = phases().filter(|phase| phase.prediction.fallback).count();
                let phases = plural(phases().count(), "phase");
                (fallen > 0).then(|| {
                    format!("{fallen} of {phases} predicted by a fallback: the nearest speed group, or without what the log does not say")
                })
            }
            _ => None,
        }
    }
}

/// A drive with its phases or stretches.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Predicted<T> {
    /// Name of the drive.
    pub name: String,
    /// Phases, or stretches.
    pub phases: Vec<T>,
}

/// An acceleration or braking phase.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictedPhase {
    /// Time of its first sample in the drive.
    pub start_s: f64,
    /// Time of its last sample.
    pub end_s: f64,
    /// What the model may know.
    #[serde(flatten)]
    pub phase: Phase,
    /// What it makes of it.
    #[serde(flatten)]
    pub prediction: PhasePrediction,
}

/// A stretch of cruising.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PredictedCruise {
    /// Time of its first sample in the drive.
    pub start_s: f64,
    /// Time of its last sample.
    pub end_s: f64,
    /// Limit, if it is known.
    pub limit_mps: Option<f64>,
    /// Speed at its start.
    pub start_speed_mps: f64,
    /// Root mean square error.
    pub rmse_mps: f64,
    /// The same of holding the speed.
    pub hold_rmse_mps: f64,
    /// Share of samples in the band of 90 %.
    pub in_90_pct_band_pct: f64,
}

/// A stretch behind a vehicle.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictedFollowing {
    /// Time of its first sample in the drive.
    pub start_s: f64,
    /// Time of its last sample.
    pub end_s: f64,
    /// How far the simulation is off.
    #[serde(flatten)]
    pub errors: FollowingErrors,
    /// Simulated speed.
    pub speed_mps: Vec<f64>,
    /// Simulated gap.
    pub gap_m: Vec<f64>,
}

/// The speed ahead of every second of a drive.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictedAhead {
    /// Name of the log.
    pub name: String,
    /// Whether the model knows what the driver does and the log does not say it.
    pub falls_back: bool,
    /// Moments predicted from, on the clock of the drive's start.
    pub moments_s: Vec<f64>,
    /// By horizon.
    pub horizons: Vec<HorizonScore>,
}

/// A drive from its road alone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictedTrip {
    /// Name of the log.
    pub name: String,
    /// Sampling interval.
    pub step_s: f64,
    /// How long it would take.
    pub duration_s: f64,
    /// How long it took.
    pub measured_duration_s: f64,
    /// Length of the road.
    pub distance_m: f64,
    /// Predicted speed.
    pub speed_mps: Vec<f64>,
}

/// Predicts what a model is about in every drive, and says which drives it cannot predict. `progress` is called after each drive in which
/// phases were found.
///
/// # Errors
/// [`Error::Horizon`] for a horizon that the model does not have, [`Error::Model`] where no drive can be predicted and for settings out of
/// range.
pub fn predict(
    model: &DriverModel,
    motions: &[Motion],
    settings: &PredictionSettings,
    progress: &(dyn Fn() + Sync),
) -> Result<(Predictions, Vec<LeftOut>), Error> {
    let trips = || find_behaviour(motions, &settings.phases, progress);
    Ok(match model {
        DriverModel::Acceleration(model) => {
            of_phases(&trips()?, PhaseKind::Acceleration, model, settings.band_mps)
        }
        DriverModel::Braking(model) => {
            of_phases(&trips()?, PhaseKind::Braking, model, settings.band_mps)
        }
        DriverModel::Cruise(model) => {
            let (trips, reason) = (trips()?, "no stretch of cruising that counts");
            let left_out = without(&trips, |trip| !trip.cruise.is_empty(), reason);
            let predicted = of_each(
                &trips,
                |trip| &trip.cruise,
                |s| PredictedCruise::of(model, s),
            );
            (Predictions::Cruise(predicted), left_out)
        }
        DriverModel::Following(model) => {
            let (trips, reason) = (trips()?, "no stretch behind a vehicle that counts");
            let left_out = without(&trips, |trip| !trip.following.is_empty(), reason);
            let predicted = of_each(
                &trips,
                |trip| &trip.following,
                |s| PredictedFollowing::of(model, s),
            );
            (Predictions::Following(predicted), left_out)
        }
        DriverModel::SpeedAhead(model) => of_speed_ahead(motions, model, &settings.horizons_s)?,
        DriverModel::Trip(driver) => of_trips(motions, driver)?,
    })
}

fn of_each<S, T>(
    trips: &[DriveBehaviour],
    of: impl Fn(&DriveBehaviour) -> &Vec<S>,
    predict: impl Fn(&S) -> T,
) -> Vec<Predicted<T>> {
    let predicted = trips.iter().map(|trip| Predicted {
        name: trip.name.clone(),
        phases: of(trip).iter().map(&predict).collect(),
    });
    predicted.collect()
}

fn of_phases(
    trips: &[DriveBehaviour],
    kind: PhaseKind,
    model: &PhaseModel,
    band_mps: f64,
) -> (Predictions, Vec<LeftOut>) {
    let counts = |trip: &DriveBehaviour| trip.phases_of(kind).next().is_some();
    let predicted = trips.iter().map(|trip| Predicted {
        name: trip.name.clone(),
        phases: trip
            .phases_of(kind)
            .map(|curve| PredictedPhase::of(model, curve, band_mps))
            .collect(),
    });
    (
        Predictions::Phases(predicted.collect()),
        without(trips, counts, "no phase that counts"),
    )
}

impl PredictedPhase {
    fn of(model: &PhaseModel, curve: &PhaseCurve, band_mps: f64) -> Self {
        let phase = curve.outline();
        Self {
            start_s: curve.start_s(),
            end_s: curve.start_s() + phase.duration_s(),
            prediction: PhasePrediction::new(model, curve, band_mps),
            phase,
        }
    }
}

impl PredictedCruise {
    fn of(model: &CruiseModel, stretch: &CruiseStretch) -> Self {
        let errors = model.errors(stretch);
        Self {
            start_s: stretch.start_s(),
            end_s: stretch.start_s() + stretch.duration_s(),
            limit_mps: stretch.limit_mps(),
            start_speed_mps: stretch.speed_mps()[0],
            rmse_mps: errors.cruise_mps,
            hold_rmse_mps: errors.hold_mps,
            in_90_pct_band_pct: errors.inside_pct,
        }
    }
}

impl PredictedFollowing {
    fn of(model: &FollowingModel, stretch: &FollowingStretch) -> Self {
        let simulated = model.simulate(stretch);
        Self {
            start_s: stretch.start_s(),
            end_s: stretch.start_s() + stretch.duration_s(),
            errors: model.errors(stretch),
            speed_mps: simulated.speed_mps,
            gap_m: simulated.gap_m,
        }
    }
}

fn same_horizon(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// Refuses horizons that a model does not have.
///
/// # Errors
/// [`Error::Horizon`] for the first.
pub fn check_horizons(model: &DirectModel, horizons_s: &[f64]) -> Result<(), Error> {
    let known_s: Vec<f64> = model.horizons_s().collect();
    let unknown = |h: &&f64| !known_s.iter().any(|k| same_horizon(*k, **h));
    match horizons_s.iter().find(unknown) {
        Some(&asked_s) => Err(Error::Horizon { asked_s, known_s }),
        None => Ok(()),
    }
}

fn of_speed_ahead(
    motions: &[Motion],
    model: &DirectModel,
    horizons_s: &[f64],
) -> Result<(Predictions, Vec<LeftOut>), Error> {
    check_horizons(model, horizons_s)?;
    let wanted = |h: f64| horizons_s.is_empty() || horizons_s.iter().any(|a| same_horizon(*a, h));
    let entry = |motion: &Motion| {
        let mut entry = PredictedAhead::of(model, motion)?;
        entry.horizons.retain(|score| wanted(score.horizon_s));
        Ok(entry)
    };
    let (entries, left_out) = as_far_as(motions, "the speed ahead", entry)?;
    Ok((Predictions::SpeedAhead(entries), left_out))
}

impl PredictedAhead {
    /// The reason where the model cannot predict a drive.
    fn of(model: &DirectModel, motion: &Motion) -> Result<Self, String> {
        let origins = model.moments(motion, MOMENTS_S);
        if origins.is_empty() {
            return Err("too short for the past that a prediction needs".to_owned());
        }
        let horizons = model
            .score(motion, &origins)
            .map_err(|error| error.to_string())?;
        let moments_s = origins.iter().map(|&o| o as f64 * motion.step_s());
        Ok(Self {
            name: motion.name().to_owned(),
            falls_back: model.falls_back(motion),
            moments_s: moments_s.collect(),
            horizons,
        })
    }
}

fn of_trips(motions: &[Motion], driver: &TripDriver) -> Result<(Predictions, Vec<LeftOut>), Error> {
    let entry = |motion: &Motion| PredictedTrip::of(driver, motion).map_err(|e| e.to_string());
    let (entries, left_out) = as_far_as(motions, "whole trips from the road", entry)?;
    Ok((Predictions::Trips(entries), left_out))
}

impl PredictedTrip {
    fn of(driver: &TripDriver, motion: &Motion) -> Result<Self, ModelError> {
        let road = Road::of_motion(motion, RoadKnowledge::Stops)?;
        let FreeRun {
            step_s,
            speed_mps,
            end_s,
            ..
        } = driver.drive(&road, motion.step_s(), None)?;
        Ok(Self {
            name: motion.name().to_owned(),
            step_s,
            duration_s: end_s,
            measured_duration_s: motion.duration_s(),
            distance_m: road.length_m(),
            speed_mps,
        })
    }
}

/// Drives that cannot be predicted are left out with the reason, as long as there are others.
fn as_far_as<T>(
    motions: &[Motion],
    task: &'static str,
    predict: impl Fn(&Motion) -> Result<T, String>,
) -> Result<(Vec<T>, Vec<LeftOut>), Error> {
    let (mut entries, mut left_out) = (Vec::new(), Vec::new());
    for motion in motions {
        match predict(motion) {
            Ok(entry) => entries.push(entry),
            Err(reason) => left_out.push(LeftOut::new(motion.name(), reason)),
        }
    }
    if entries.is_empty() {
        return Err(ModelError::NothingUsable { task, left_out }.into());
    }
    Ok((entries, left_out))
}
