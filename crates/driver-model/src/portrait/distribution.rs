use serde::Serialize;

use crate::statistics::quantile;

/// Where the values of a figure lie.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Distribution {
    /// A tenth is below.
    pub p10: f64,
    /// Half is below.
    pub median: f64,
    /// Nine tenths are below.
    pub p90: f64,
}

impl Distribution {
    /// `None` without values.
    pub(super) fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        Some(Self {
            p10: quantile(&values, 0.1)?,
            median: quantile(&values, 0.5)?,
            p90: quantile(&values, 0.9)?,
        })
    }
}
