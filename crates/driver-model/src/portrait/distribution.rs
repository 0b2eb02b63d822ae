use serde::Serialize;

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

/// Of sorted values, linear between them.
pub(super) fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let position = share * (sorted.len().checked_sub(1)? as f64);
    let left = position as usize;
    let right = (left + 1).min(sorted.len() - 1);
    Some(sorted[left] + (sorted[right] - sorted[left]) * (position - left as f64))
}
