//! Where the curves of similar phases lie.

use super::precedent::{Beginning, Case};
use super::{BegunPhases, LEAST_CASES};

/// A curve that misses the early gain by so much counts 0.6 times; chosen on the drives of `bmw-i3`.
const EARLY_MISS_MPS: f64 = 0.4;

/// However much a curve misses it, it counts so many times.
const LEAST_SHARE: f64 = 1e-6;

/// The curves of similar phases, each made once.
pub(super) struct Curves<'a> {
    begun: &'a BegunPhases,
    beginning: &'a Beginning,
    by_place: Vec<Vec<f64>>,
}

impl<'a> Curves<'a> {
    pub(super) fn of(begun: &'a BegunPhases, beginning: &'a Beginning) -> Self {
        Self {
            begun,
            beginning,
            by_place: Vec::new(),
        }
    }

    /// Lower tail, median and upper tail of the change of speed since the early gain after so many seconds, by the most similar phases that
    /// lasted so long, each counting as well as its curve meets the early gain; `None` where there are too few.
    pub(super) fn spread_mps(
        &mut self,
        sorted: &[&Case],
        second: usize,
    ) -> Option<(f64, f64, f64)> {
        self.by_place.resize(sorted.len(), Vec::new());
        let lasting = sorted.iter().enumerate();
        let lasting = lasting.filter(|(_, case)| case.lasts(second));
        let mut gains = Vec::new();
        for (place, case) in lasting.take(self.begun.settings.similar) {
            if self.by_place[place].is_empty() {
                self.by_place[place] = self.begun.curve(self.beginning, case);
            }
            let curve = &self.by_place[place];
            if let (Some(early_mps), Some(gain_mps)) = (curve.first(), curve.get(second)) {
                let miss = (early_mps - self.beginning.early_gain_mps) / EARLY_MISS_MPS;
                let fits = (-0.5 * miss * miss).exp().max(LEAST_SHARE);
                gains.push((*gain_mps, case.weight * fits));
            }
        }
        if gains.len() < LEAST_CASES {
            return None;
        }
        let tail = 0.5 * (1.0 - self.begun.settings.coverage);
        let mut at = |share| quantile(&mut gains, share);
        Some((at(tail), at(0.5), at(1.0 - tail)))
    }
}

/// The value below which this share of the weight lies, between the two nearest.
pub(super) fn quantile(values: &mut [(f64, f64)], share: f64) -> f64 {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = values.iter().map(|(_, weight)| weight).sum();
    let mut below = 0.0;
    let mut before: Option<(f64, f64)> = None;
    for &(value, weight) in values.iter() {
        // Each value stands at the middle of its weight.
        let place = (below + 0.5 * weight) / total;
        if place >= share {
            return match before {
                Some((last, last_place)) if place > last_place => {
                    last + (value - last) * (share - last_place) / (place - last_place)
                }
                _ => value,
            };
        }
        before = Some((value, place));
        below += weight;
    }
    before.map_or(f64::NAN, |(value, _)| value)
}
