use drive_log::{Drive, DriveLog};
use ev_energy::{DEFAULT_SLOPE_BANDWIDTH_M, Vehicle};
use rayon::prelude::*;
use serde::Serialize;

use super::recording::Recording;
use super::road::{Road, RoadKnowledge, map_of};
use super::summary::FreeRunSummary;
use super::{FreeRunScore, TripDriver};
use crate::Error;
use crate::energy::slope_rad;
use crate::evaluate::numbered;

/// Logs that are held out together, such as those of one trip.
#[derive(Debug, Clone)]
pub struct FreeRunGroup<'a> {
    /// Name of the group.
    pub name: String,
    /// Its logs.
    pub logs: Vec<&'a DriveLog>,
}

impl<'a> FreeRunGroup<'a> {
    /// Drives with the same name of unit are a group; `unit_names` has one for every drive.
    #[must_use]
    pub fn by_unit(drives: impl Iterator<Item = &'a Drive>, unit_names: &[String]) -> Vec<Self> {
        let (names, unit_of) = numbered(unit_names);
        let empty = |name| Self {
            name,
            logs: Vec::new(),
        };
        let mut groups: Vec<Self> = names.into_iter().map(empty).collect();
        for (drive, unit) in drives.zip(unit_of) {
            groups[unit].logs.extend(&drive.pieces);
        }
        groups
    }
}

/// What is predicted and compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeRunSettings {
    /// What the road is known to hold; [`RoadKnowledge::Stops`].
    pub knowledge: RoadKnowledge,
    /// Trips are compared over their first part; 900 s.
    pub duration_s: f64,
    /// Shorter logs are learnt from, but not compared; 300 s.
    pub min_duration_s: f64,
    /// Groups are held out in this many folds; `None` holds every group out alone.
    pub folds: Option<usize>,
    /// Elevation is smoothed over this distance to either side before it gives a slope; 100 m.
    pub slope_bandwidth_m: f64,
}

impl Default for FreeRunSettings {
    fn default() -> Self {
        Self {
            knowledge: RoadKnowledge::default(),
            duration_s: 900.0,
            min_duration_s: 300.0,
            folds: None,
            slope_bandwidth_m: DEFAULT_SLOPE_BANDWIDTH_M,
        }
    }
}

/// One held-out trip.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FreeRunTrip {
    /// Name of the group.
    pub group: String,
    /// Name of the log.
    pub log: String,
    /// How far the prediction is off.
    #[serde(flatten)]
    pub score: FreeRunScore,
}

/// Groups held out together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FreeRunFold {
    /// Their names.
    pub held_out: Vec<String>,
    /// The driver as fitted to the others.
    pub driver: TripDriver,
}

/// The outcome of [`evaluate_free_run`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FreeRunEvaluation {
    /// Over all held-out trips.
    pub summary: FreeRunSummary,
    /// In input order.
    pub trips: Vec<FreeRunTrip>,
    /// Logs that were not compared, and why.
    pub left_out: Vec<(String, String)>,
    /// What was held out together.
    pub folds: Vec<FreeRunFold>,
    /// Fitted to all logs.
    pub driver: TripDriver,
}

/// Holds each group out once, fits the driver to the others, and predicts the held-out trips from their roads.
///
/// Folds run in parallel on the current rayon pool; the result does not depend on the number of threads. `on_fold` is called
/// after each, from any thread. Logs whose speed limit is not known throughout are left out, and said.
///
/// # Errors
/// [`Error::TooFewTrips`] with less than two groups that know their limits, [`Error::TooFewPhases`] where no trip can be compared,
/// [`Error::Option`] for settings out of range.
pub fn evaluate_free_run(
    groups: &[FreeRunGroup<'_>],
    settings: &FreeRunSettings,
    vehicle: &Vehicle,
    on_fold: &(dyn Fn() + Sync),
) -> Result<FreeRunEvaluation, Error> {
    settings.check()?;
    let mut left_out = Vec::new();
    let units = usable(groups, &mut left_out);
    if units.len() < 2 {
        return Err(Error::TooFewTrips {
            found: units.len(),
            needed: 2,
        });
    }
    let folds = settings.folds.unwrap_or(units.len()).min(units.len());
    let outcomes = (0..folds)
        .into_par_iter()
        .map(|fold| {
            let outcome = hold_out(&units, |unit| unit % folds == fold, settings, vehicle);
            on_fold();
            outcome
        })
        .collect::<Result<Vec<_>, _>>()?;
    let (mut folds, mut trips) = (Vec::new(), Vec::new());
    for outcome in outcomes {
        folds.push(outcome.fold);
        trips.extend(outcome.trips);
        left_out.extend(outcome.left_out);
    }
    trips.sort_by_key(|(unit, _)| *unit);
    let trips: Vec<FreeRunTrip> = trips.into_iter().map(|(_, trip)| trip).collect();
    Ok(FreeRunEvaluation {
        summary: FreeRunSummary::of(&trips)?,
        driver: fit(&units, |_| true)?,
        trips,
        left_out,
        folds,
    })
}

impl FreeRunSettings {
    fn check(&self) -> Result<(), Error> {
        Error::unless_at_least("duration_s", self.duration_s, 1.0, "at least 1 s")?;
        Error::unless_at_least("min_duration_s", self.min_duration_s, 0.0, "at least 0 s")?;
        let folds = self.folds.unwrap_or(2) as f64;
        Error::unless_at_least("folds", folds, 2.0, "at least 2")
    }
}

/// A group with the logs that know their limits.
struct Unit<'a> {
    name: &'a str,
    logs: Vec<(&'a DriveLog, Recording)>,
}

fn usable<'a>(
    groups: &'a [FreeRunGroup<'_>],
    left_out: &mut Vec<(String, String)>,
) -> Vec<Unit<'a>> {
    let mut units = Vec::new();
    for group in groups {
        let mut logs = Vec::new();
        for &log in &group.logs {
            match Recording::of(log) {
                Ok(recording) => logs.push((log, recording)),
                Err(reason) => left_out.push((log.name().to_owned(), reason.to_string())),
            }
        }
        if !logs.is_empty() {
            units.push(Unit {
                name: &group.name,
                logs,
            });
        }
    }
    units
}

fn fit(units: &[Unit<'_>], learns: impl Fn(usize) -> bool) -> Result<TripDriver, Error> {
    let units = units.iter().enumerate().filter(|(unit, _)| learns(*unit));
    let logs = units.flat_map(|(_, unit)| &unit.logs);
    TripDriver::fit_recordings(&logs.map(|(_, recording)| recording).collect::<Vec<_>>())
}

struct HeldOut {
    fold: FreeRunFold,
    /// With the number of their unit.
    trips: Vec<(usize, FreeRunTrip)>,
    left_out: Vec<(String, String)>,
}

fn hold_out(
    units: &[Unit<'_>],
    is_held_out: impl Fn(usize) -> bool,
    settings: &FreeRunSettings,
    vehicle: &Vehicle,
) -> Result<HeldOut, Error> {
    let mut held_out = HeldOut {
        fold: FreeRunFold {
            held_out: Vec::new(),
            driver: fit(units, |unit| !is_held_out(unit))?,
        },
        trips: Vec::new(),
        left_out: Vec::new(),
    };
    for (number, unit) in units.iter().enumerate().filter(|(u, _)| is_held_out(*u)) {
        held_out.fold.held_out.push(unit.name.to_owned());
        for (log, recording) in &unit.logs {
            match score(&held_out.fold.driver, log, recording, settings, vehicle) {
                Ok(score) => held_out.trips.push((
                    number,
                    FreeRunTrip {
                        group: unit.name.to_owned(),
                        log: log.name().to_owned(),
                        score,
                    },
                )),
                Err(reason) => held_out
                    .left_out
                    .push((log.name().to_owned(), reason.to_string())),
            }
        }
    }
    Ok(held_out)
}

/// Step of the prediction; times at equal distance are interpolated in it.
const STEP_S: f64 = 0.1;

fn score(
    driver: &TripDriver,
    log: &DriveLog,
    recording: &Recording,
    settings: &FreeRunSettings,
    vehicle: &Vehicle,
) -> Result<FreeRunScore, Error> {
    let (lasts_s, least_s) = (recording.duration_s(), settings.min_duration_s);
    // A log of ten minutes has its last sample a step before; the rest is rounding.
    let rounding_s = 1.5 * recording.step_s;
    let expected = "at least the shortest duration that is compared";
    Error::unless_at_least("duration_s", lasts_s, least_s - rounding_s, expected)?;
    let slope_rad = slope_rad(log, settings.slope_bandwidth_m)?;
    let slope_rad = slope_rad.as_deref();
    let road = Road::new(map_of(recording, slope_rad, settings.knowledge))?;
    let run = driver.drive(&road, STEP_S, None)?;
    FreeRunScore::of_recording(&run, recording, slope_rad, vehicle, settings.duration_s)
}
