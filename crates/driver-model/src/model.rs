use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::phase_model::{Constant, Exponential, Inverse, Profile, RiseTime, smoothstep, straight};
use crate::{Error, PhaseCurve, PhaseOutline};

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
    /// The driver's mean normalised shape.
    Profile,
    /// Baseline: mean acceleration.
    Constant,
    /// Baseline: straight line from start to end speed.
    Straight,
    /// Baseline: `3s² − 2s³` from start to end speed.
    Smoothstep,
}

impl ModelKind {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Inverse,
        Self::Exponential,
        Self::ExponentialAmplitude,
        Self::RiseTime,
        Self::Profile,
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
            Self::Profile => "profile",
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

    /// Whether the model is told the end speed beside start speed and duration.
    #[must_use]
    pub fn knows_end_speed(self) -> bool {
        match self {
            Self::Inverse | Self::Exponential | Self::ExponentialAmplitude | Self::Constant => {
                false
            }
            Self::RiseTime | Self::Profile | Self::Straight | Self::Smoothstep => true,
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

/// What models are fitted to: phases by the heuristic route, segment means by the statistical route.
#[derive(Debug, Clone, Default)]
pub struct TrainingSet<'a> {
    /// Acceleration phases without a leader.
    pub phases: Vec<&'a PhaseCurve>,
    /// `(mean speed in m/s, mean acceleration in m/s²)` of acceleration segments without a leader.
    pub segment_means: Vec<(f64, f64)>,
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
    /// See [`Profile`].
    Profile(Profile),
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
        let outlines =
            || -> Vec<PhaseOutline> { training.phases.iter().map(|p| p.outline()).collect() };
        let means = &training.segment_means;
        Ok(match kind {
            ModelKind::Inverse => Self::Inverse(Inverse::fit(means)?),
            ModelKind::Exponential => Self::Exponential(Exponential::fit_printed(means)?),
            ModelKind::ExponentialAmplitude => {
                Self::ExponentialAmplitude(Exponential::fit_with_amplitude(means)?)
            }
            ModelKind::RiseTime => Self::RiseTime(RiseTime::fit(&outlines())?),
            ModelKind::Profile => Self::Profile(Profile::fit(&training.phases)?),
            ModelKind::Constant => Self::Constant(Constant::fit(&outlines())?),
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
            Self::Profile(_) => ModelKind::Profile,
            Self::Constant(_) => ModelKind::Constant,
            Self::Straight => ModelKind::Straight,
            Self::Smoothstep => ModelKind::Smoothstep,
        }
    }

    /// Predicted speed in m/s at every sample of the phase.
    #[must_use]
    pub fn predict(&self, outline: &PhaseOutline) -> Vec<f64> {
        let &PhaseOutline {
            start_speed_mps: v0,
            end_speed_mps: v_end,
            step_s,
            samples,
        } = outline;
        let over_time = |speed: &dyn Fn(f64) -> f64| -> Vec<f64> {
            (0..samples).map(|k| speed(k as f64 * step_s)).collect()
        };
        let last = (samples.max(2) - 1) as f64;
        let over_share = |speed: &dyn Fn(f64) -> f64| -> Vec<f64> {
            (0..samples).map(|k| speed(k as f64 / last)).collect()
        };
        match self {
            Self::Inverse(m) => over_time(&|t| m.speed_mps(v0, t)),
            Self::Exponential(m) | Self::ExponentialAmplitude(m) => {
                over_time(&|t| m.speed_mps(v0, t))
            }
            Self::RiseTime(m) => {
                let (time_constant_s, _) = m.constant_for(outline.group());
                over_time(&|t| RiseTime::speed_mps(time_constant_s, v0, v_end, t))
            }
            Self::Profile(m) => over_share(&|share| m.speed_mps(v0, v_end, share)),
            Self::Constant(m) => over_time(&|t| v0 + m.accel_mps2 * t),
            Self::Straight => over_share(&|share| straight(v0, v_end, share)),
            Self::Smoothstep => over_share(&|share| smoothstep(v0, v_end, share)),
        }
    }

    /// Whether predicting this phase takes a parameter from another speed group, for want of training phases.
    #[must_use]
    pub fn falls_back(&self, outline: &PhaseOutline) -> bool {
        match self {
            Self::RiseTime(m) => !m.constant_for(outline.group()).1,
            _ => false,
        }
    }

    /// Sum of squared residuals in (m/s²)² over segment means, the entry of Table 3.6, for the function fits.
    #[must_use]
    pub fn residual_sum_of_squares(&self, segment_means: &[(f64, f64)]) -> Option<f64> {
        match self {
            Self::Inverse(m) => Some(m.residual_sum_of_squares(segment_means)),
            Self::Exponential(m) | Self::ExponentialAmplitude(m) => {
                Some(m.residual_sum_of_squares(segment_means))
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
            Self::RiseTime(m) => m.check(),
            Self::Profile(m) => m.check(),
            Self::Constant(m) => m.check(),
            Self::Straight | Self::Smoothstep => Ok(()),
        }
    }
}
