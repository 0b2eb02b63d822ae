use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// A way to predict the speed some seconds ahead.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DirectKind {
    /// The present speed.
    Persistence,
    /// The acceleration of the last second goes on.
    ConstantAcceleration,
    /// It decays with 2 s.
    DecayingAcceleration,
    /// Ridge regression.
    Ridge,
    /// Gradient boosted trees.
    BoostedTrees,
    /// Support vector regression, linear.
    SvrLinear,
    /// Support vector regression, quadratic kernel.
    SvrQuadratic,
    /// Support vector regression, cubic kernel.
    SvrCubic,
    /// Support vector regression, Gaussian kernel.
    SvrRbf,
    /// Least-squares support vector machine, Gaussian kernel on weighted predictors.
    LeastSquares,
    /// Mean of [`Self::LeastSquares`] and [`Self::BoostedTrees`].
    Blend,
}

/// Time constant of [`DirectKind::DecayingAcceleration`].
const DECAY_S: f64 = 2.0;

impl DirectKind {
    /// All, baselines first.
    pub const ALL: [Self; 11] = [
        Self::Persistence,
        Self::ConstantAcceleration,
        Self::DecayingAcceleration,
        Self::Ridge,
        Self::BoostedTrees,
        Self::SvrLinear,
        Self::SvrQuadratic,
        Self::SvrCubic,
        Self::SvrRbf,
        Self::LeastSquares,
        Self::Blend,
    ];

    /// As on the command line and in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Persistence => "persistence",
            Self::ConstantAcceleration => "constant-acceleration",
            Self::DecayingAcceleration => "decaying-acceleration",
            Self::Ridge => "ridge",
            Self::BoostedTrees => "boosted-trees",
            Self::SvrLinear => "svr-linear",
            Self::SvrQuadratic => "svr-quadratic",
            Self::SvrCubic => "svr-cubic",
            Self::SvrRbf => "svr-rbf",
            Self::LeastSquares => "least-squares",
            Self::Blend => "blend",
        }
    }

    /// Whether every table has it.
    #[must_use]
    pub fn is_baseline(self) -> bool {
        !self.is_fitted() || matches!(self, Self::Ridge | Self::BoostedTrees)
    }

    /// Whether it learns from drives.
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

impl fmt::Display for DirectKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for DirectKind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|kind| kind.name() == text);
        found.ok_or_else(|| format!("known models: {}", Self::ALL.map(Self::name).join(", ")))
    }
}
