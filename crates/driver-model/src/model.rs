use serde::{Deserialize, Serialize};

use crate::phase_model::{
    ConditionedProfile, Conditioning, Constant, Exponential, Inverse, PedalProfile, PredictiveBand,
    Profile, RiseTime, TransitionPoint, smoothstep, straight,
};
use crate::{AccelPoint, Error, ModelKind, Phase, Subject, TrainingSet};

/// A fitted model; parameters are checked when it comes from a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum PhaseModel {
    /// See [`Inverse`].
    Inverse(Inverse),
    /// See [`Exponential`], with `p0 = 1`.
    Exponential(Exponential),
    /// See [`Exponential`].
    ExponentialAmplitude(Exponential),
    /// See [`RiseTime`].
    RiseTime(RiseTime),
    /// See [`RiseTime::EXACT_RISE_TIME_CONSTANTS`].
    RiseTimeExact(RiseTime),
    /// See [`TransitionPoint`].
    TransitionPoint(TransitionPoint),
    /// See [`Profile`].
    Profile(Profile),
    /// See [`ConditionedProfile`].
    ProfileConditioned(ConditionedProfile),
    /// See [`ConditionedProfile`], over six features.
    ProfileOnset(ConditionedProfile),
    /// See [`PedalProfile`].
    ProfilePedal(PedalProfile),
    /// See [`Constant`].
    Constant(Constant),
    /// See [`straight`].
    Straight,
    /// See [`smoothstep`].
    Smoothstep,
}

impl PhaseModel {
    /// Fits one model.
    ///
    /// # Errors
    /// [`Error::TooFewPhases`] and [`Error::Fit`], naming the model; [`Error::Subject`] for a model of anything else.
    pub fn fit(kind: ModelKind, training: &TrainingSet<'_>) -> Result<Self, Error> {
        let points = &training.points;
        Ok(match kind {
            ModelKind::Inverse => Self::Inverse(Inverse::fit(points)?),
            ModelKind::Exponential => Self::Exponential(Exponential::fit_printed(points)?),
            ModelKind::ExponentialAmplitude => {
                Self::ExponentialAmplitude(Exponential::fit_with_amplitude(points)?)
            }
            ModelKind::RiseTime => {
                Self::RiseTime(RiseTime::fit(training, RiseTime::RISE_TIME_CONSTANTS)?)
            }
            ModelKind::RiseTimeExact => Self::RiseTimeExact(RiseTime::fit(
                training,
                RiseTime::EXACT_RISE_TIME_CONSTANTS,
            )?),
            ModelKind::TransitionPoint => Self::TransitionPoint(TransitionPoint::fit(training)?),
            ModelKind::Profile => Self::Profile(Profile::fit(training)?),
            ModelKind::ProfileConditioned => {
                Self::ProfileConditioned(ConditionedProfile::fit(Conditioning::Outline, training)?)
            }
            ModelKind::ProfileOnset => {
                Self::ProfileOnset(ConditionedProfile::fit(Conditioning::Onset, training)?)
            }
            ModelKind::ProfilePedal => Self::ProfilePedal(PedalProfile::fit(training)?),
            ModelKind::Constant => Self::Constant(Constant::fit(training)?),
            ModelKind::Straight => Self::Straight,
            ModelKind::Smoothstep => Self::Smoothstep,
            _ => return Err(Error::not_of(Subject::Phases, kind)),
        })
    }

    /// Which model this is.
    #[must_use]
    pub fn kind(&self) -> ModelKind {
        match self {
            Self::Inverse(_) => ModelKind::Inverse,
            Self::Exponential(_) => ModelKind::Exponential,
            Self::ExponentialAmplitude(_) => ModelKind::ExponentialAmplitude,
            Self::RiseTime(_) => ModelKind::RiseTime,
            Self::RiseTimeExact(_) => ModelKind::RiseTimeExact,
            Self::TransitionPoint(_) => ModelKind::TransitionPoint,
            Self::Profile(_) => ModelKind::Profile,
            Self::ProfileConditioned(_) => ModelKind::ProfileConditioned,
            Self::ProfileOnset(_) => ModelKind::ProfileOnset,
            Self::ProfilePedal(_) => ModelKind::ProfilePedal,
            Self::Constant(_) => ModelKind::Constant,
            Self::Straight => ModelKind::Straight,
            Self::Smoothstep => ModelKind::Smoothstep,
        }
    }

    /// Predicted speed in m/s at every sample of the phase, at least 0 while braking.
    ///
    /// Braking is acceleration in reversed time: the functions of speed run backward from `v0`, the step responses from `v_end`.
    #[must_use]
    pub fn predict(&self, outline: &Phase) -> Vec<f64> {
        let &Phase {
            start_speed_mps: v0,
            end_speed_mps: v_end,
            ..
        } = outline;
        let sign = if outline.is_braking() { -1.0 } else { 1.0 };
        let mut speed_mps: Vec<f64> = match self {
            Self::Inverse(m) => over_time(outline, |t| m.speed_mps(v0, sign * t)),
            Self::Exponential(m) | Self::ExponentialAmplitude(m) => {
                over_time(outline, |t| m.speed_mps(v0, sign * t))
            }
            Self::RiseTime(m) | Self::RiseTimeExact(m) => {
                let (time_constant_s, _) = m.constant_for(outline.rising().group());
                over_rising(outline, |v0, v_end, t| {
                    RiseTime::speed_mps(time_constant_s, v0, v_end, t)
                })
            }
            Self::TransitionPoint(m) => {
                let (response, _) = m.response_for(outline.rising().group());
                over_rising(outline, |v0, v_end, t| response.speed_mps(v0, v_end, t))
            }
            Self::Profile(m) => over_share(outline, |share| m.speed_mps(v0, v_end, share)),
            Self::ProfileConditioned(m) | Self::ProfileOnset(m) => m.speeds_mps(outline),
            Self::ProfilePedal(m) => m.for_phase(outline).speeds_mps(outline),
            Self::Constant(m) => over_time(outline, |t| v0 + sign * m.accel_mps2 * t),
            Self::Straight => over_share(outline, |share| straight(v0, v_end, share)),
            Self::Smoothstep => over_share(outline, |share| smoothstep(v0, v_end, share)),
        };
        if outline.is_braking() {
            speed_mps.iter_mut().for_each(|v| *v = v.max(0.0));
        }
        speed_mps
    }

    /// Bands around the predicted speed by rising level, where the model has them.
    #[must_use]
    pub fn bands(&self, outline: &Phase) -> Vec<PredictiveBand> {
        match self {
            Self::ProfileConditioned(m) | Self::ProfileOnset(m) => m.bands(outline),
            Self::ProfilePedal(m) => m.for_phase(outline).bands(outline),
            _ => Vec::new(),
        }
    }

    /// Whether predicting this phase takes a parameter from another speed group, for want of training phases, or does without what its log
    /// does not say.
    #[must_use]
    pub fn falls_back(&self, outline: &Phase) -> bool {
        match self {
            Self::RiseTime(m) | Self::RiseTimeExact(m) => {
                !m.constant_for(outline.rising().group()).1
            }
            Self::TransitionPoint(m) => !m.response_for(outline.rising().group()).1,
            Self::ProfilePedal(m) => m.falls_back(outline),
            _ => false,
        }
    }

    /// Sum of squared residuals in (m/s²)² over points of acceleration, the entry of Table 3.6, for the function fits.
    #[must_use]
    pub fn residual_sum_of_squares(&self, points: &[AccelPoint]) -> Option<f64> {
        match self {
            Self::Inverse(m) => Some(m.residual_sum_of_squares(points)),
            Self::Exponential(m) | Self::ExponentialAmplitude(m) => {
                Some(m.residual_sum_of_squares(points))
            }
            _ => None,
        }
    }

    /// Checks parameters that come from outside.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the first that no fit can produce.
    pub fn check(&self) -> Result<(), Error> {
        match self {
            Self::Inverse(m) => m.check(),
            Self::Exponential(m) | Self::ExponentialAmplitude(m) => m.check(self.kind()),
            Self::RiseTime(m) | Self::RiseTimeExact(m) => m.check(),
            Self::TransitionPoint(m) => m.check(),
            Self::Profile(m) => m.check(),
            Self::ProfileConditioned(m) => m.check(Conditioning::Outline),
            Self::ProfileOnset(m) => m.check(Conditioning::Onset),
            Self::ProfilePedal(m) => m.check(),
            Self::Constant(m) => m.check(),
            Self::Straight | Self::Smoothstep => Ok(()),
        }
    }
}

fn over_time(outline: &Phase, speed: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..outline.samples)
        .map(|k| speed(k as f64 * outline.step_s))
        .collect()
}

fn over_share(outline: &Phase, speed: impl Fn(f64) -> f64) -> Vec<f64> {
    let last = (outline.samples.max(2) - 1) as f64;
    (0..outline.samples)
        .map(|k| speed(k as f64 / last))
        .collect()
}

/// Over the time of the phase with rising speed, given its start and end speed.
fn over_rising(outline: &Phase, speed: impl Fn(f64, f64, f64) -> f64) -> Vec<f64> {
    let rising = outline.rising();
    let (v0, v_end) = (rising.start_speed_mps, rising.end_speed_mps);
    let mut speed_mps = over_time(outline, |t| speed(v0, v_end, t));
    if outline.is_braking() {
        speed_mps.reverse();
    }
    speed_mps
}
