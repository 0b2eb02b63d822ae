//! Whole trips from the road alone, held out.

mod score;
mod summary;

use driver_model::Motion;
use driver_model::error::at_least;
use driver_model::road::{Road, RoadKnowledge};
use driver_model::trip_driver::{RecordedTrip, TripDriver};
use ev_energy::Vehicle;
use serde::Serialize;

use crate::hold_out::Split;
use crate::{Error, HoldOut};
pub use score::FreeRunScore;
pub use summary::{FreeRunSummary, PercentErrors};

/// What is predicted and compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeRunSettings {
    /// What the road is known to hold; [`RoadKnowledge::Stops`].
    pub knowledge: RoadKnowledge,
    /// Trips are compared over their first part; 900 s.
    pub duration_s: f64,
    /// Shorter logs are learnt from, but not compared; 300 s.
    pub min_duration_s: f64,
    /// Units are held out in this many folds; `None` holds every unit out alone.
    pub folds: Option<usize>,
}

impl Default for FreeRunSettings {
    fn default() -> Self {
        Self {
            knowledge: RoadKnowledge::default(),
            duration_s: 900.0,
            min_duration_s: 300.0,
            folds: None,
        }
    }
}

/// One held-out trip.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FreeRunTrip {
    /// Name of the unit.
    pub group: String,
    /// Name of the log.
    pub log: String,
    /// How far the prediction is off.
    #[serde(flatten)]
    pub score: FreeRunScore,
}

/// Units held out together.
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
    /// By unit.
    pub trips: Vec<FreeRunTrip>,
    /// Logs that were not compared, and why.
    pub left_out: Vec<(String, String)>,
    /// What was held out together.
    pub folds: Vec<FreeRunFold>,
    /// Fitted to all logs.
    pub driver: TripDriver,
    /// Share of the time over which the speed's reading was held and was joined to the next by a straight line.
    pub joined_pct: f64,
}

/// Holds each unit out once, fits the driver to the others, and predicts the held-out trips from their roads.
///
/// `unit_names` has one for every drive, whatever its pieces. `progress` is called after each fold, from any thread. Logs whose speed limit is not known
/// throughout are left out, and said.
///
/// # Errors
/// [`Error::TooFewUnits`] with less than two units that know their limits, [`Error::Model`] where no trip can be compared and for
/// settings out of range.
pub fn evaluate_free_run(
    motions: &[Motion],
    unit_names: &[String],
    settings: &FreeRunSettings,
    vehicle: &Vehicle,
    progress: &(dyn Fn() + Sync),
) -> Result<FreeRunEvaluation, Error> {
    settings.check()?;
    let mut left_out = Vec::new();
    let (trips, hold_out) = usable(motions, unit_names, &mut left_out);
    hold_out.at_least(2)?;
    let folds = settings.folds.unwrap_or(hold_out.units().len());
    let hold_out = hold_out.in_folds(folds);
    let outcomes = hold_out.run(progress, |split| {
        held_out(&trips, &hold_out, split, settings, vehicle)
    })?;
    let (mut folds, mut scored) = (Vec::new(), Vec::new());
    for outcome in outcomes {
        folds.push(outcome.fold);
        scored.extend(outcome.trips);
        left_out.extend(outcome.left_out);
    }
    scored.sort_by_key(|(item, _)| *item);
    let scored: Vec<FreeRunTrip> = scored.into_iter().map(|(_, trip)| trip).collect();
    Ok(FreeRunEvaluation {
        summary: FreeRunSummary::of(&scored)?,
        driver: fit(&trips, 0..trips.len())?,
        trips: scored,
        left_out,
        folds,
        joined_pct: joined_pct(&trips),
    })
}

fn joined_pct(trips: &[Usable<'_>]) -> f64 {
    let sum = |of: fn(&RecordedTrip) -> f64| trips.iter().map(|(_, trip)| of(trip)).sum::<f64>();
    100.0 * sum(RecordedTrip::joined_s) / sum(RecordedTrip::duration_s).max(f64::MIN_POSITIVE)
}

impl FreeRunSettings {
    fn check(&self) -> Result<(), Error> {
        at_least("duration_s", self.duration_s, 1.0, "at least 1 s")?;
        at_least("min_duration_s", self.min_duration_s, 0.0, "at least 0 s")?;
        let folds = self.folds.unwrap_or(2) as f64;
        Ok(at_least("folds", folds, 2.0, "at least 2")?)
    }
}

/// A log that knows its limits.
type Usable<'a> = (&'a Motion, RecordedTrip);

/// The logs that know their limits, those of a unit together.
fn usable<'a>(
    motions: &'a [Motion],
    unit_names: &[String],
    left_out: &mut Vec<(String, String)>,
) -> (Vec<Usable<'a>>, HoldOut) {
    let hold_out = HoldOut::of_motions(motions, unit_names);
    let mut trips = Vec::new();
    let mut by_unit: Vec<(usize, &Motion)> =
        hold_out.unit_of().iter().copied().zip(motions).collect();
    by_unit.sort_by_key(|(unit, _)| *unit);
    let mut units = Vec::new();
    for (unit, motion) in by_unit {
        match RecordedTrip::of(motion) {
            Ok(trip) => {
                trips.push((motion, trip));
                units.push(unit);
            }
            Err(reason) => left_out.push((motion.name().to_owned(), reason.to_string())),
        }
    }
    (trips, hold_out.of_items(&units))
}

fn fit(trips: &[Usable<'_>], items: impl Iterator<Item = usize>) -> Result<TripDriver, Error> {
    let recorded: Vec<&RecordedTrip> = items.map(|item| &trips[item].1).collect();
    Ok(TripDriver::fit_recorded(&recorded)?)
}

struct Outcome {
    fold: FreeRunFold,
    /// With their number.
    trips: Vec<(usize, FreeRunTrip)>,
    left_out: Vec<(String, String)>,
}

fn held_out(
    trips: &[Usable<'_>],
    hold_out: &HoldOut,
    split: Split<'_>,
    settings: &FreeRunSettings,
    vehicle: &Vehicle,
) -> Result<Outcome, Error> {
    let units = hold_out.units();
    let mut outcome = Outcome {
        fold: FreeRunFold {
            held_out: split.units().map(|unit| units[unit].clone()).collect(),
            driver: fit(trips, split.rest())?,
        },
        trips: Vec::new(),
        left_out: Vec::new(),
    };
    for item in split.held_out() {
        let (motion, trip) = &trips[item];
        match score(&outcome.fold.driver, motion, trip, settings, vehicle) {
            Ok(score) => {
                let trip = FreeRunTrip {
                    group: units[hold_out.unit_of()[item]].clone(),
                    log: motion.name().to_owned(),
                    score,
                };
                outcome.trips.push((item, trip));
            }
            Err(reason) => outcome
                .left_out
                .push((motion.name().to_owned(), reason.to_string())),
        }
    }
    Ok(outcome)
}

/// Step of the prediction; times at equal distance are interpolated in it.
const STEP_S: f64 = 0.1;

fn score(
    driver: &TripDriver,
    motion: &Motion,
    trip: &RecordedTrip,
    settings: &FreeRunSettings,
    vehicle: &Vehicle,
) -> Result<FreeRunScore, Error> {
    let (lasts_s, least_s) = (trip.duration_s(), settings.min_duration_s);
    // A log of ten minutes has its last sample a step before; the rest is rounding.
    let rounding_s = 1.5 * motion.step_s();
    let expected = "at least the shortest duration that is compared";
    at_least("duration_s", lasts_s, least_s - rounding_s, expected)?;
    let road = Road::of_trip(trip, settings.knowledge)?;
    let run = driver.drive(&road, STEP_S, None)?;
    FreeRunScore::of(&run, trip, motion.slope_rad(), vehicle, settings.duration_s)
}
