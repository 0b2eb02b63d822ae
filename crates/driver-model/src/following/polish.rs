//! Down from where a method with derivatives has ended, without any.

use argmin::core::{CostFunction, Executor, State};
use argmin::solver::neldermead::NelderMead;
use argmin_math::{ArgminAdd, ArgminMul, ArgminSub};

use super::fit::End;

/// Edges of the first simplex in free parameters, and of those after it.
const FIRST_EDGE: f64 = 0.3;
const EDGE: f64 = 0.15;

/// Simplices at most.
const SIMPLICES: usize = 6;

/// Steps of a simplex, per parameter.
const STEPS: u64 = 20;

/// A simplex has ended where the sums at its corners differ by less, and the last one is that which gained less, both relative.
const TOLERANCE: f64 = 1e-4;
const GAIN: f64 = 1e-3;

/// The best place that simplices reach from an end, each begun anew at the best one so far; never a worse one.
pub(super) fn polish(end: End, sum: impl Fn(&[f64]) -> f64) -> End {
    let mut best = end;
    for number in 0..SIMPLICES {
        let edge = if number == 0 { FIRST_EDGE } else { EDGE };
        let edge = if number % 2 == 0 { edge } else { -edge };
        let Some(found) = simplex(&best, edge, &sum) else {
            break;
        };
        let gained = best.sum - found.sum;
        let goes_on = gained > GAIN * found.sum;
        if gained > 0.0 {
            best = found;
        }
        if !goes_on {
            break;
        }
    }
    best
}

/// Where one simplex ends.
fn simplex(from: &End, edge: f64, sum: &impl Fn(&[f64]) -> f64) -> Option<End> {
    let corner = |k: usize| {
        let mut free = from.free.clone();
        if let Some(value) = k.checked_sub(1).and_then(|k| free.get_mut(k)) {
            *value += edge;
        }
        Place(free)
    };
    let corners = (0..=from.free.len()).map(corner).collect();
    let method = NelderMead::new(corners)
        .with_sd_tolerance(TOLERANCE * from.sum)
        .ok()?;
    let steps = STEPS * from.free.len() as u64;
    let outcome = Executor::new(Cost(sum), method)
        .configure(
            |state: argmin::core::IterState<Place, (), (), (), (), f64>| state.max_iters(steps),
        )
        .timer(false)
        .run()
        .ok()?;
    let free = outcome.state().get_best_param()?.0.clone();
    let sum = outcome.state().get_best_cost();
    Some(End { free, sum })
}

struct Cost<'a, F>(&'a F);

impl<F: Fn(&[f64]) -> f64> CostFunction for Cost<'_, F> {
    type Param = Place;
    type Output = f64;

    fn cost(&self, place: &Place) -> Result<f64, argmin::core::Error> {
        let sum = (self.0)(&place.0);
        Ok(if sum.is_finite() { sum } else { f64::MAX })
    }
}

/// Free parameters with the arithmetic that simplices need; argmin's own of vectors brings two crates for random numbers.
#[derive(Debug, Clone)]
struct Place(Vec<f64>);

impl Place {
    fn joined(&self, other: &Self, of: fn(f64, f64) -> f64) -> Self {
        Self(
            self.0
                .iter()
                .zip(&other.0)
                .map(|(a, b)| of(*a, *b))
                .collect(),
        )
    }
}

impl ArgminAdd<Self, Self> for Place {
    fn add(&self, other: &Self) -> Self {
        self.joined(other, |a, b| a + b)
    }
}

impl ArgminSub<Self, Self> for Place {
    fn sub(&self, other: &Self) -> Self {
        self.joined(other, |a, b| a - b)
    }
}

impl ArgminMul<f64, Self> for Place {
    fn mul(&self, factor: &f64) -> Self {
        Self(self.0.iter().map(|value| value * factor).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_is_followed_down_and_nothing_gets_worse() {
        let edge = |free: &[f64]| 1.0 + (free[0] - free[1]).abs() * 3.0 + (free[0] - 1.0).abs();
        let from = |free: [f64; 2]| End {
            sum: edge(&free),
            free: free.to_vec(),
        };
        let found = polish(from([-0.4, 0.5]), edge);
        assert!(found.sum < 1.01, "{found:?}");
        let kept = polish(from([1.0, 1.0]), edge);
        assert!((kept.sum - 1.0).abs() < 1e-12);
        let lost = polish(from([0.0, 0.0]), |_| f64::NAN);
        assert!((lost.sum - edge(&[0.0, 0.0])).abs() < 1e-12);
    }
}
