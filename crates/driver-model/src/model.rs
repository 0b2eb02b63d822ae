use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::phase_model::{
    ConditionedProfile, Conditioning, Constant, Exponential, Inverse, PredictiveBand, Profile,
    RiseTime, TransitionPoint, smoothstep, straight,
};
use crate::{AccelPoint, Error, PhaseOutline, TrainingSet};

/// The models and baselines, in the order in which tables print them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModelKind {
    /// `a = 1/(p1 v + p2)`.
    Inverse,
    /// `a = e^(−p1 v) + p2`, as printed in the thesis.
    Exponential,
    /// `a = p0·e^(−p1 v) + p2`.
    ExponentialAmplitude,
    /// Second-order step response with a mean time constant per speed group.
    RiseTime,
    /// The same, reaching 95 % of the gain exactly at the end of a phase of mean duration.
    RiseTimeExact,
    /// Step response of the order and with the constants most common in its speed group.
    TransitionPoint,
    /// The driver's mean normalised shape.
    Profile,
    /// The normalised shape as it depends on start speed, duration and pace.
    ProfileConditioned,
    /// The same, also on how the phase is entered.
    ProfileOnset,
    /// Baseline: mean acceleration.
    Constant,
    /// Baseline: straight line from start to end speed.
    Straight,
    /// Baseline: `3s² − 2s³` from start to end speed.
    Smoothstep,
}

impl ModelKind {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::Inverse,
        Self::Exponential,
        Self::ExponentialAmplitude,
        Self::RiseTime,
        Self::RiseTimeExact,
        Self::TransitionPoint,
        Self::Profile,
        Self::ProfileConditioned,
        Self::ProfileOnset,
        Self::Constant,
        Self::Straight,
        Self::Smoothstep,
    ];

    /// As on the command line and in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Inverse => "inverse",
            Self::Exponential => "exponential",
            Self::ExponentialAmplitude => "exponential-amplitude",
            Self::RiseTime => "rise-time",
            Self::RiseTimeExact => "rise-time-exact",
            Self::TransitionPoint => "transition-point",
            Self::Profile => "profile",
            Self::ProfileConditioned => "profile-conditioned",
            Self::ProfileOnset => "profile-onset",
            Self::Constant => "constant",
            Self::Straight => "straight",
            Self::Smoothstep => "smoothstep",
        }
    }

    /// Printed with every table and never chosen.
    #[must_use]
    pub fn is_baseline(self) -> bool {
        matches!(self, Self::Constant | Self::Straight | Self::Smoothstep)
    }

    /// What the model is told of a phase, in words.
    #[must_use]
    pub fn knows(self) -> &'static str {
        match self {
            Self::Inverse | Self::Exponential | Self::ExponentialAmplitude | Self::Constant => {
                "v0, T"
            }
            Self::RiseTime
            | Self::RiseTimeExact
            | Self::TransitionPoint
            | Self::Profile
            | Self::ProfileConditioned
            | Self::Straight
            | Self::Smoothstep => "v0, v_end, T",
            Self::ProfileOnset => "v0, v_end, T, onset",
        }
    }
}

impl fmt::Display for ModelKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for ModelKind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == text)
            .ok_or_else(|| {
                let names: Vec<_> = Self::ALL.iter().map(|kind| kind.name()).collect();
                format!("no model `{text}`; known: {}", names.join(", "))
            })
    }
}

/// A fitted model; parameters are checked when it comes from a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum DriverModel {
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
    /// See [`Constant`].
    Constant(Constant),
    /// See [`straight`].
    Straight,
    /// See [`smoothstep`].
    Smoothstep,
}

impl DriverModel {
    /// Fits one model.
    ///
    /// # Errors
    /// [`Error::TooFewPhases`] and [`Error::Fit`], naming the model.
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
            ModelKind::Constant => Self::Constant(Constant::fit(training)?),
            ModelKind::Straight => Self::Straight,
            ModelKind::Smoothstep => Self::Smoothstep,
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
            Self::Constant(_) => ModelKind::Constant,
            Self::Straight => ModelKind::Straight,
            Self::Smoothstep => ModelKind::Smoothstep,
        }
    }

    /// Predicted speed in m/s at every sample of the phase, at least 0 while braking.
    ///
    /// Braking is acceleration in reversed time: the functions of speed run backward from `v0`, the step responses from `v_end`.
    #[must_use]
    pub fn predict(&self, outline: &PhaseOutline) -> Vec<f64> {
        let &PhaseOutline {
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
    pub fn bands(&self, outline: &PhaseOutline) -> Vec<PredictiveBand> {
        match self {
            Self::ProfileConditioned(m) | Self::ProfileOnset(m) => m.bands(outline),
            _ => Vec::new(),
        }
    }

    /// Whether predicting this phase takes a parameter from another speed group, for want of training phases.
    #[must_use]
    pub fn falls_back(&self, outline: &PhaseOutline) -> bool {
        match self {
            Self::RiseTime(m) | Self::RiseTimeExact(m) => {
                !m.constant_for(outline.rising().group()).1
            }
            Self::TransitionPoint(m) => !m.response_for(outline.rising().group()).1,
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
            Self::Constant(m) => m.check(),
            Self::Straight | Self::Smoothstep => Ok(()),
        }
    }
}

fn over_time(outline: &PhaseOutline, speed: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..outline.samples)
        .map(|k| speed(k as f64 * outline.step_s))
        .collect()
}

fn over_share(outline: &PhaseOutline, speed: impl Fn(f64) -> f64) -> Vec<f64> {
    let last = (outline.samples.max(2) - 1) as f64;
    (0..outline.samples)
        .map(|k| speed(k as f64 / last))
        .collect()
}

/// Over the time of the phase with rising speed, given its start and end speed.
fn over_rising(outline: &PhaseOutline, speed: impl Fn(f64, f64, f64) -> f64) -> Vec<f64> {
    let rising = outline.rising();
    let (v0, v_end) = (rising.start_speed_mps, rising.end_speed_mps);
    let mut speed_mps = over_time(outline, |t| speed(v0, v_end, t));
    if outline.is_braking() {
        speed_mps.reverse();
    }
    speed_mps
}
