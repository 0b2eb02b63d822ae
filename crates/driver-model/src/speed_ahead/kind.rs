//! What the kinds of models of the next seconds are made of.

use crate::ModelKind;

/// Time constant of [`ModelKind::DecayingAcceleration`].
const DECAY_S: f64 = 2.0;

impl ModelKind {
    /// Whether a model of the next seconds learns from drives.
    #[must_use]
    pub fn is_fitted(self) -> bool {
        self.baseline_change(1.0).is_none()
    }

    pub(super) fn has_trees(self) -> bool {
        matches!(self, Self::BoostedTrees | Self::Blend)
    }

    pub(super) fn has_regression(self) -> bool {
        self.is_fitted() && self != Self::BoostedTrees
    }

    /// What a unit of acceleration adds to the speed within the horizon; `None` for models that are fitted.
    pub(super) fn baseline_change(self, horizon_s: f64) -> Option<f64> {
        match self {
            Self::Persistence => Some(0.0),
            Self::ConstantAcceleration => Some(horizon_s),
            Self::DecayingAcceleration => Some(DECAY_S * (1.0 - (-horizon_s / DECAY_S).exp())),
            _ => None,
        }
    }
}
