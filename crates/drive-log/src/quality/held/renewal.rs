//! How often the rows show something new.

/// How a held channel is renewed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Renewal {
    /// Mean time from update to update, and what a tenth exceeds, s.
    pub(super) interval_s: f64,
    pub(super) long_s: f64,
    /// Deviation of these times over their mean.
    pub(super) irregularity: f64,
}
