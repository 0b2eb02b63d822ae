//! One way to fit any model.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::cruise::CruiseModel;
use crate::following::FollowingModel;
use crate::speed_ahead::{DirectModel, DirectSettings};
use crate::trip_driver::TripDriver;
use crate::{
    DriveBehaviour, DriverModel, Error, LeftOut, ModelKind, Motion, PhaseExtent, PhaseKind,
    PhaseMemory, PhaseModel, PhaseSettings, PointsOf, Subject, TrainingSet, motion,
};

/// Drives of other drivers, from which models of phases learn as well.
#[derive(Debug, Clone, Copy)]
pub struct Prior<'a> {
    /// The drives.
    pub motions: &'a [Motion],
    /// Weight of each of their phases beside 1 for an own one; 0 is the own data alone.
    pub weight: f64,
}

/// How models are fitted.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FitSettings {
    /// Which phases and stretches count.
    pub phases: PhaseSettings,
    /// Whether a model of phases is one of acceleration or of braking.
    pub manoeuvre: Manoeuvre,
    /// What a function of speed is fitted to.
    pub points_of: PointsOf,
    /// Of a model of the next seconds.
    pub speed_ahead: DirectSettings,
}

/// What a model of phases is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Manoeuvre {
    /// Speeding up.
    #[default]
    Acceleration,
    /// Slowing down.
    Braking,
}

impl From<Manoeuvre> for PhaseKind {
    fn from(manoeuvre: Manoeuvre) -> Self {
        match manoeuvre {
            Manoeuvre::Acceleration => Self::Acceleration,
            Manoeuvre::Braking => Self::Braking,
        }
    }
}

/// A fitted model with what it was fitted to.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Fitted {
    /// The model.
    pub model: DriverModel,
    /// Phases, stretches or drives, those of other drivers included.
    pub phases: usize,
    /// Segments, samples or moments; 0 for stretches and whole trips.
    pub points: usize,
    /// In (m/s²)², of functions of speed.
    pub residual_sum_of_squares: Option<f64>,
    /// Drives that it could learn nothing from, with the reason.
    pub left_out: Vec<LeftOut>,
    /// What a model of phases was fitted to, by which [`update`] adds drives; `None` for the others, and where [`PhaseMemory::new`] gives none.
    pub memory: Option<PhaseMemory>,
}

/// Fits a model of any kind to drives, of accelerations where it is one of phases.
///
/// # Errors
/// As [`fit_with`].
pub fn fit(
    kind: ModelKind,
    motions: &[Motion],
    prior: Option<Prior<'_>>,
) -> Result<DriverModel, Error> {
    Ok(fit_with(kind, motions, prior, &FitSettings::default(), &|| {})?.model)
}

/// Fits a model of any kind to drives. Phases of drives are found in parallel on the current rayon pool; `progress` is called after each
/// drive in which they were.
///
/// # Errors
/// [`Error::TooFewPhases`], [`Error::TooFewStretches`], [`Error::TooFewMoments`] and [`Error::NothingUsable`] where there is too little to
/// learn from, [`Error::NoPrior`] for a prior and [`Error::NoPhases`] for whole phases where the model is none of phases, [`Error::Fit`] where an optimiser stops without a result,
/// and whatever finding phases refuses.
pub fn fit_with(
    kind: ModelKind,
    motions: &[Motion],
    prior: Option<Prior<'_>>,
    settings: &FitSettings,
    progress: &(dyn Fn() + Sync),
) -> Result<Fitted, Error> {
    if prior.is_some() && kind.subject() != Subject::Phases {
        return Err(Error::NoPrior { model: kind });
    }
    let learns_from_phases = kind.subject() == Subject::Phases && !kind.is_function_of_speed();
    if settings.phases.extent == PhaseExtent::Whole && !learns_from_phases {
        return Err(Error::NoPhases { model: kind });
    }
    let trips = || find_behaviour(motions, &settings.phases, progress);
    match kind.subject() {
        Subject::Phases => fit_phases(kind, &trips()?, prior, settings, progress),
        Subject::Cruise => fit_cruise(&trips()?),
        Subject::Following => fit_following(kind, &trips()?),
        Subject::SpeedAhead => fit_speed_ahead(kind, motions, &settings.speed_ahead),
        Subject::Trips => fit_trip_driver(motions),
    }
}

/// Finds what counts in every drive, in parallel on the current rayon pool; `progress` is called after each.
///
/// # Errors
/// As [`DriveBehaviour::of_drive`].
pub fn find_behaviour(
    motions: &[Motion],
    settings: &PhaseSettings,
    progress: &(dyn Fn() + Sync),
) -> Result<Vec<DriveBehaviour>, Error> {
    let drives: Vec<&[Motion]> = motion::drives(motions).collect();
    let find = |drive: &[Motion]| {
        let trip = DriveBehaviour::of_drive(drive, settings);
        progress();
        trip
    };
    drives.into_par_iter().map(find).collect()
}

fn fit_phases(
    kind: ModelKind,
    own: &[DriveBehaviour],
    prior: Option<Prior<'_>>,
    settings: &FitSettings,
    progress: &(dyn Fn() + Sync),
) -> Result<Fitted, Error> {
    let others = prior.map_or_else(
        || Ok(Vec::new()),
        |prior| find_behaviour(prior.motions, &settings.phases, progress),
    )?;
    let phase_kind = PhaseKind::from(settings.manoeuvre);
    let weight = prior.map_or(0.0, |prior| prior.weight);
    let training = TrainingSet::with_points(settings.points_of, phase_kind, own)
        .with_prior(phase_kind, &others, weight);
    let mut fitted = fit_to(kind, settings.manoeuvre, &training, own)?;
    let memory = PhaseMemory::new(settings);
    fitted.memory = memory.map(|memory| memory.with_own(own).with_prior(&others, weight));
    Ok(fitted)
}

/// Fits a model of phases to what it remembers and to more drives: the same as [`fit_with`] on all own drives in this order, with the same
/// drives of others. `progress` is called after each drive.
///
/// # Errors
/// [`Error::Subject`] for a model that is none of phases, [`Error::Steps`] for a drive of another sampling interval, and whatever [`fit_with`] refuses.
pub fn update(
    kind: ModelKind,
    memory: PhaseMemory,
    motions: &[Motion],
    progress: &(dyn Fn() + Sync),
) -> Result<Fitted, Error> {
    if let Some(expected_s) = memory.step_s() {
        let other = |motion: &&Motion| (motion.step_s() - expected_s).abs() > 1e-9;
        if let Some(motion) = motions.iter().find(other) {
            return Err(Error::Steps {
                log: motion.name().to_owned(),
                found_s: motion.step_s(),
                expected_s,
            });
        }
    }
    let new = find_behaviour(motions, &memory.settings(), progress)?;
    let memory = memory.with_own(&new);
    let fitted = fit_to(kind, memory.manoeuvre(), &memory.training(), &new)?;
    Ok(Fitted {
        memory: Some(memory),
        ..fitted
    })
}

/// `trips` are those of which is said whether they have a phase.
fn fit_to(
    kind: ModelKind,
    manoeuvre: Manoeuvre,
    training: &TrainingSet<'_>,
    trips: &[DriveBehaviour],
) -> Result<Fitted, Error> {
    let model = PhaseModel::fit(kind, training)?;
    let phase_kind = PhaseKind::from(manoeuvre);
    let counts = |trip: &DriveBehaviour| trip.phases_of(phase_kind).next().is_some();
    let reason = format!("no {} phase that counts", phase_kind.name());
    Ok(Fitted {
        phases: training.phases.len(),
        points: training.points.len(),
        residual_sum_of_squares: model.residual_sum_of_squares(&training.points),
        left_out: without(trips, counts, &reason),
        memory: None,
        model: match manoeuvre {
            Manoeuvre::Acceleration => DriverModel::Acceleration(model),
            Manoeuvre::Braking => DriverModel::Braking(model),
        },
    })
}

fn fit_cruise(trips: &[DriveBehaviour]) -> Result<Fitted, Error> {
    let stretches: Vec<_> = trips.iter().flat_map(|trip| &trip.cruise).collect();
    let counts = |trip: &DriveBehaviour| !trip.cruise.is_empty();
    Ok(Fitted {
        model: DriverModel::Cruise(CruiseModel::fit(&stretches)?),
        phases: stretches.len(),
        points: 0,
        residual_sum_of_squares: None,
        left_out: without(trips, counts, "no stretch of cruising that counts"),
        memory: None,
    })
}

fn fit_following(kind: ModelKind, trips: &[DriveBehaviour]) -> Result<Fitted, Error> {
    let stretches: Vec<_> = trips.iter().flat_map(|trip| &trip.following).collect();
    let counts = |trip: &DriveBehaviour| !trip.following.is_empty();
    Ok(Fitted {
        model: DriverModel::Following(FollowingModel::fit(kind, &stretches)?.model),
        phases: stretches.len(),
        points: 0,
        residual_sum_of_squares: None,
        left_out: without(trips, counts, "no stretch behind a vehicle that counts"),
        memory: None,
    })
}

fn fit_speed_ahead(
    kind: ModelKind,
    motions: &[Motion],
    settings: &DirectSettings,
) -> Result<Fitted, Error> {
    let (usable, left_out) = settings.usable(motions.to_vec())?;
    let model = DirectModel::fit(kind, &usable.iter().collect::<Vec<_>>(), settings)?;
    Ok(Fitted {
        phases: usable.len(),
        points: model.samples(),
        model: DriverModel::SpeedAhead(model),
        residual_sum_of_squares: None,
        left_out,
        memory: None,
    })
}

fn fit_trip_driver(motions: &[Motion]) -> Result<Fitted, Error> {
    let (driver, left_out) = TripDriver::fit_usable(&motions.iter().collect::<Vec<_>>())?;
    Ok(Fitted {
        model: DriverModel::Trip(driver),
        phases: motions.len() - left_out.len(),
        points: 0,
        residual_sum_of_squares: None,
        left_out,
        memory: None,
    })
}

/// The drives of which nothing counts, with the reason.
pub fn without(
    trips: &[DriveBehaviour],
    counts: impl Fn(&DriveBehaviour) -> bool,
    reason: &str,
) -> Vec<LeftOut> {
    let empty = trips.iter().filter(|trip| !counts(trip));
    empty.map(|trip| LeftOut::new(&trip.name, reason)).collect()
}
