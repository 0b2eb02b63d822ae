//! Parts of a path.

use super::{Path, PathPoint};

/// Samples of a part of a path, and steps of refinement from the best.
const SPAN_SAMPLES: u32 = 12;
const SPAN_STEPS: u32 = 4;

/// A part of a closed path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Where it begins, in m along the path
    pub from_m: f64,
    /// In m
    pub length_m: f64,
}

impl Span {
    /// How far a place is past the beginning, in m, from minus half a lap on.
    #[must_use]
    pub fn past_m(&self, path: &Path, s_m: f64) -> f64 {
        let past_m = path.distance_along_m(self.from_m, s_m);
        let lap_m = path.length_m().unwrap_or(f64::INFINITY);
        if past_m > 0.5 * (lap_m + self.length_m) {
            past_m - lap_m
        } else {
            past_m
        }
    }

    /// Whether a place is within.
    #[must_use]
    pub fn contains(&self, path: &Path, s_m: f64) -> bool {
        path.distance_along_m(self.from_m, s_m) <= self.length_m
    }
}

impl Path {
    /// The point of a part of the path that is nearest to a given one: the best of samples, refined.
    #[must_use]
    pub fn nearest_within(&self, span: &Span, x_m: f64, y_m: f64) -> PathPoint {
        let at = |share: f64| self.at(span.from_m + share * span.length_m);
        let square = |point: &PathPoint| (point.x_m - x_m).powi(2) + (point.y_m - y_m).powi(2);
        let mut best = at(0.0);
        for sample in 1..=SPAN_SAMPLES {
            let point = at(f64::from(sample) / f64::from(SPAN_SAMPLES));
            if square(&point) < square(&best) {
                best = point;
            }
        }
        for _ in 0..SPAN_STEPS {
            let [tx, ty] = best.tangent;
            let along_m = (x_m - best.x_m) * tx + (y_m - best.y_m) * ty;
            let stretch = 1.0 + best.curvature_1pm * best.deviation_m(x_m, y_m);
            best = self.at(best.s_m + along_m / stretch.max(0.5));
        }
        best
    }
}
