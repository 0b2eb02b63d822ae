//! Everything that a driver does in phases and stretches, held out: acceleration, braking, cruising, following.

mod contents;
mod document;
mod missing;
mod whole;

use std::collections::BTreeMap;

use driver_model::following::FollowingStretch;
use driver_model::phase_model::TransitionPoint;
use driver_model::{
    DriveBehaviour, Error as ModelError, FunctionFit, LeftOut, PhaseKind, TrainingSet,
    function_fits,
};
use ev_energy::Vehicle;

use crate::Error;
use crate::cruise::{CruiseEvaluation, evaluate_cruise};
use crate::following::{FollowingEvaluation, evaluate_following};
use crate::phase::{
    Evaluation, EvaluationData, EvaluationSettings, LearningPoint, learning_curve, leave_one_out,
};
pub use contents::{contents, contents_of};
pub use document::{BehaviourDocument, with_curves};
use missing::Missing;
pub use whole::{Reach, WholeEvaluation, WholeFigures, WholePhases};

/// What is evaluated.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BehaviourSettings {
    /// Of phases.
    pub phase: EvaluationSettings,
    /// Also the error over the number of own trips that a model has seen.
    pub learning_curve: bool,
}

/// Everything that was found out.
#[derive(Debug, Clone, PartialEq)]
pub struct BehaviourEvaluation {
    /// `None` where no drive has an acceleration phase that counts.
    pub acceleration: Option<Evaluation>,
    /// `None` where no drive has a braking phase that counts.
    pub braking: Option<Evaluation>,
    /// The same from where phases begin to where they end.
    pub whole: WholePhases,
    /// Functions of speed fitted to everything, accelerations first.
    pub fits: [(PhaseKind, Vec<FunctionFit>); 2],
    /// Of accelerations; `None` where it was not asked for.
    pub learning: Option<Vec<LearningPoint>>,
    /// `None` where less than two units cruise.
    pub cruise: Option<CruiseEvaluation>,
    /// The transition-point model of all acceleration phases; `None` where none can be identified.
    pub systems: Option<TransitionPoint>,
    /// With the stretches; `None` where less than two units follow a vehicle.
    pub following: Option<(FollowingEvaluation, Vec<FollowingStretch>)>,
    /// Parts that there is too little for, with the reason.
    pub missing: BTreeMap<&'static str, String>,
    /// Drives that have nothing to evaluate.
    pub left_out: Vec<LeftOut>,
}

/// Evaluates acceleration, braking, cruising and following, as far as there is enough of each. `progress` is called four times per unit.
///
/// # Errors
/// [`Error::TooFewUnits`], [`Error::Nothing`] where there is too little for every part, [`Error::Model`] for settings out of range and
/// whatever the vehicle model refuses.
pub fn evaluate_behaviour(
    data: &EvaluationData<'_>,
    vehicle: &Vehicle,
    settings: &BehaviourSettings,
    progress: &(dyn Fn() + Sync),
) -> Result<BehaviourEvaluation, Error> {
    let phases = |kind| leave_one_out(kind, data, vehicle, &settings.phase, progress);
    let mut missing = Missing::default();
    let acceleration = missing.unless_enough("acceleration", || phases(PhaseKind::Acceleration))?;
    let braking = missing.unless_enough("braking", || phases(PhaseKind::Braking))?;
    let (cruising, by_unit) = data.stretches(|trip| &trip.cruise);
    let cruise = missing.unless_enough("cruise", || evaluate_cruise(&cruising, &by_unit))?;
    let (behind, by_unit) = data.stretches(|trip| &trip.following);
    let following = missing.unless_enough("following", || evaluate_following(&behind, &by_unit))?;
    let trips = data.trips();
    let mut missing = missing.unless_everything(trips)?;
    let mut too_short = Missing::default();
    let at_threshold = [acceleration.as_ref(), braking.as_ref()];
    let whole = WholePhases::evaluate(
        data,
        at_threshold,
        vehicle,
        &settings.phase,
        &mut too_short,
        progress,
    )?;
    missing.extend(too_short.into_parts());
    let learning = match (&acceleration, settings.learning_curve) {
        (_, false) => None,
        (None, true) => Some(Vec::new()),
        (Some(_), true) => {
            let kind = PhaseKind::Acceleration;
            Some(learning_curve(kind, data, &settings.phase)?)
        }
    };
    Ok(BehaviourEvaluation {
        acceleration,
        braking,
        whole,
        fits: [PhaseKind::Acceleration, PhaseKind::Braking]
            .map(|kind| (kind, function_fits(kind, trips))),
        learning,
        cruise,
        systems: systems(trips)?,
        following: following.map(|evaluation| (evaluation, behind)),
        missing,
        left_out: contents::without_anything(trips),
    })
}

impl BehaviourEvaluation {
    /// The evaluations of phases that there are.
    pub fn phases(&self) -> impl Iterator<Item = &Evaluation> {
        [&self.acceleration, &self.braking].into_iter().flatten()
    }

    /// Without the times of fitting and predicting, which differ from run to run.
    #[must_use]
    pub fn without_times(mut self) -> Self {
        for evaluation in [&mut self.acceleration, &mut self.braking]
            .into_iter()
            .flatten()
        {
            for summary in &mut evaluation.summaries {
                (summary.fit_seconds, summary.predict_seconds) = (f64::NAN, f64::NAN);
            }
        }
        if let Some((following, _)) = &mut self.following {
            for fold in &mut following.folds {
                (fold.fit_seconds.idm, fold.fit_seconds.constant_time_gap) = (f64::NAN, f64::NAN);
            }
        }
        self
    }
}

fn systems(trips: &[DriveBehaviour]) -> Result<Option<TransitionPoint>, Error> {
    let training = TrainingSet::from_trips(PhaseKind::Acceleration, trips);
    match TransitionPoint::fit(&training) {
        Err(ModelError::TooFewPhases { .. } | ModelError::Fit { .. }) => Ok(None),
        model => Ok(Some(model?)),
    }
}
