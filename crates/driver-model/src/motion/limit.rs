//! Speed limits as they are recorded: missing in places.

use std::sync::Arc;

use super::held;
use crate::road::limit::LIMIT_MPS;

/// How a drive knows its speed limits.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct LimitCover {
    /// Time with a limit.
    pub known_s: f64,
    /// Time without, over which the one before was held.
    pub held_s: f64,
    /// Time before the first, which was taken there as well.
    pub back_filled_s: f64,
}

/// Where less of the time has a limit than this share, what would be filled in is no limit of the road.
const LEAST_KNOWN: f64 = 0.5;

impl LimitCover {
    /// Of all three.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.known_s + self.held_s + self.back_filled_s
    }

    /// Time that was filled.
    #[must_use]
    pub fn filled_s(&self) -> f64 {
        self.held_s + self.back_filled_s
    }

    /// Whether half of the time has a limit; with less none is used.
    #[must_use]
    pub fn is_enough(&self) -> bool {
        self.known_s >= LEAST_KNOWN * self.duration_s()
    }
}

/// Limits with their gaps filled, where there is enough of them, and how they are known; `None` without any.
pub(super) fn filled(
    recorded_mps: &[f64],
    step_s: f64,
) -> Option<(Option<Arc<[f64]>>, LimitCover)> {
    let is_limit = |limit: f64| LIMIT_MPS.contains(&limit);
    let or_unknown = |&limit: &f64| if is_limit(limit) { limit } else { f64::NAN };
    let limits: Vec<f64> = recorded_mps.iter().map(or_unknown).collect();
    let first = limits.iter().position(|limit| limit.is_finite())?;
    let known = limits.iter().filter(|limit| limit.is_finite()).count();
    let time_s = |samples: usize| samples as f64 * step_s;
    let cover = LimitCover {
        known_s: time_s(known),
        held_s: time_s(limits.len() - first - known),
        back_filled_s: time_s(first),
    };
    Some((held(&limits).filter(|_| cover.is_enough()), cover))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_held_the_start_is_filled_from_the_first_and_both_are_counted() {
        let nan = f64::NAN;
        let (limits, cover) = filled(&[nan, 10.0, nan, 20.0, 0.0, 20.0], 0.5).unwrap();
        assert_eq!(*limits.unwrap(), [10.0, 10.0, 10.0, 20.0, 20.0, 20.0]);
        let expected = LimitCover {
            known_s: 1.5,
            held_s: 1.0,
            back_filled_s: 0.5,
        };
        assert_eq!(cover, expected);
        assert!((cover.duration_s() - 3.0).abs() < 1e-12);
    }

    #[test]
    fn less_than_half_is_none() {
        let (limits, cover) = filled(&[10.0, f64::NAN, f64::NAN], 1.0).unwrap();
        assert_eq!((limits, cover.is_enough()), (None, false));
        assert_eq!(filled(&[f64::NAN, 300.0], 1.0), None);
    }
}
