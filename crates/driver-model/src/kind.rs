use serde::{Deserialize, Serialize};
use strum::{Display, EnumMessage, EnumString, IntoStaticStr, VariantArray};

/// Every model, in the order in which tables print them; names as on the command line and in JSON.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Serialize,
    Deserialize,
    Display,
    EnumMessage,
    EnumString,
    IntoStaticStr,
    VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum ModelKind {
    /// Of phases: `a = 1/(p1 v + p2)`.
    Inverse,
    /// Of phases: `a = e^(−p1 v) + p2`, as printed in the thesis.
    Exponential,
    /// Of phases: `a = p0·e^(−p1 v) + p2`.
    ExponentialAmplitude,
    /// Of phases: second-order step response with a mean time constant per speed group.
    RiseTime,
    /// Of phases: the same, reaching 95 % of the gain exactly at the end of a phase of mean duration.
    RiseTimeExact,
    /// Of phases: step response of the order and with the constants most common in its speed group.
    TransitionPoint,
    /// Of phases: the driver's mean normalised shape.
    Profile,
    /// Of phases: the normalised shape as it depends on start speed, duration and pace.
    ProfileConditioned,
    /// Of phases: the same, also on how the phase is entered.
    ProfileOnset,
    /// Of phases: the same, also on what the driver does as it begins.
    ProfilePedal,
    /// Baseline of phases: mean acceleration.
    Constant,
    /// Baseline of phases: straight line from start to end speed.
    Straight,
    /// Baseline of phases: `3s² − 2s³` from start to end speed.
    Smoothstep,
    /// Of holding a speed, see [`crate::cruise`].
    Cruise,
    /// Of following: intelligent driver model, see [`crate::following`].
    Idm,
    /// Baseline of following: constant-time-gap law.
    ConstantTimeGap,
    /// Baseline of the next seconds: the present speed.
    Persistence,
    /// Baseline of the next seconds: the acceleration of the last second goes on.
    ConstantAcceleration,
    /// Baseline of the next seconds: it decays with 2 s.
    DecayingAcceleration,
    /// Baseline of the next seconds: ridge regression, see [`crate::speed_ahead`].
    Ridge,
    /// Baseline of the next seconds: gradient boosted trees.
    BoostedTrees,
    /// Of the next seconds: support vector regression, linear.
    SvrLinear,
    /// Of the next seconds: support vector regression, quadratic kernel.
    SvrQuadratic,
    /// Of the next seconds: support vector regression, cubic kernel.
    SvrCubic,
    /// Of the next seconds: support vector regression, Gaussian kernel.
    SvrRbf,
    /// Of the next seconds: least-squares support vector machine, Gaussian kernel on weighted predictors.
    LeastSquares,
    /// Of the next seconds: [`Self::Ridge`], [`Self::LeastSquares`] and [`Self::BoostedTrees`], each with the share that does best on drives held
    /// back.
    Blend,
    /// Of whole trips over a road, see [`crate::trip_driver`].
    TripDriver,
}

/// What a model predicts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Display)]
pub enum Subject {
    /// Acceleration and braking phases.
    #[strum(to_string = "acceleration and braking phases")]
    Phases,
    /// Stretches of holding a speed.
    #[strum(to_string = "holding a speed")]
    Cruise,
    /// Stretches behind a vehicle.
    #[strum(to_string = "following a vehicle")]
    Following,
    /// The speed of the next seconds.
    #[strum(to_string = "the speed of the next seconds")]
    SpeedAhead,
    /// Whole trips.
    #[strum(to_string = "whole trips")]
    Trips,
}

impl ModelKind {
    /// As on the command line and in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// What it predicts.
    #[must_use]
    pub fn subject(self) -> Subject {
        use ModelKind as K;
        match self {
            K::Inverse
            | K::Exponential
            | K::ExponentialAmplitude
            | K::RiseTime
            | K::RiseTimeExact
            | K::TransitionPoint
            | K::Profile
            | K::ProfileConditioned
            | K::ProfileOnset
            | K::ProfilePedal
            | K::Constant
            | K::Straight
            | K::Smoothstep => Subject::Phases,
            K::Cruise => Subject::Cruise,
            K::Idm | K::ConstantTimeGap => Subject::Following,
            K::Persistence
            | K::ConstantAcceleration
            | K::DecayingAcceleration
            | K::Ridge
            | K::BoostedTrees
            | K::SvrLinear
            | K::SvrQuadratic
            | K::SvrCubic
            | K::SvrRbf
            | K::LeastSquares
            | K::Blend => Subject::SpeedAhead,
            K::TripDriver => Subject::Trips,
        }
    }

    /// All models of a subject, in the order in which tables print them.
    pub fn of(subject: Subject) -> impl Iterator<Item = Self> {
        let all = Self::VARIANTS.iter().copied();
        all.filter(move |kind| kind.subject() == subject)
    }

    /// Printed with every table and never chosen.
    #[must_use]
    pub fn is_baseline(self) -> bool {
        matches!(
            self,
            Self::Constant
                | Self::Straight
                | Self::Smoothstep
                | Self::ConstantTimeGap
                | Self::Persistence
                | Self::ConstantAcceleration
                | Self::DecayingAcceleration
                | Self::Ridge
                | Self::BoostedTrees
        )
    }

    /// Whether it is a function of speed that is fitted to points of acceleration.
    #[must_use]
    pub fn is_function_of_speed(self) -> bool {
        matches!(
            self,
            Self::Inverse | Self::Exponential | Self::ExponentialAmplitude
        )
    }

    /// What a model of phases is told of one, in words; empty for the others.
    #[must_use]
    pub fn knows(self) -> &'static str {
        match self {
            Self::Constant => "v0, T",
            _ if self.is_function_of_speed() => "v0, T",
            Self::ProfileOnset => "v0, v_end, T, onset",
            Self::ProfilePedal => "v0, v_end, T, onset, pedal",
            _ if self.subject() == Subject::Phases => "v0, v_end, T",
            _ => "",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_the_same_in_files_on_the_command_line_and_back() {
        for &kind in ModelKind::VARIANTS {
            assert_eq!(kind.name().parse(), Ok(kind));
            assert_eq!(serde_json::to_value(kind).ok(), Some(kind.name().into()));
        }
        assert_eq!(ModelKind::of(Subject::Phases).count(), 13);
        assert_eq!(ModelKind::of(Subject::SpeedAhead).count(), 11);
    }
}
