//! Newton's step on the face of the free members, which are off the kink at 0 and inside their bounds: there the objective
//! is a quadratic with one equality. The step goes to its minimum, or as far as the first bound or kink in its way: one step of the
//! active-set method for convex quadratic programmes (J. Nocedal, S. Wright, Numerical Optimization, 2nd edition, 2006,
//! section 16.5). Members are released by the moves of pairs alone.

use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};

/// With more free members the factorisation costs more than moving pairs.
const MOST_FREE: usize = 256;

/// Of the trace. Where the kernel has no curvature, the step is then long, and down the slope.
const RIDGE: f64 = 1e-13;

/// New coefficients of the free members.
pub(crate) struct FaceStep {
    pub(crate) free: Vec<usize>,
    pub(crate) beta: Vec<f64>,
    /// Slopes of the objective before the step.
    pub(crate) slope: Vec<f64>,
    /// Whether a bound or a kink was in the way.
    pub(crate) blocked: bool,
}

/// `None` where there is nothing to move, too much, or no way to tell where to.
pub(crate) fn newton_step(
    kernel: &[f64],
    beta: &[f64],
    gradient: &[f64],
    bound: &[f64],
    tube_epsilon: f64,
) -> Option<FaceStep> {
    let n = beta.len();
    let free: Vec<usize> = (0..n)
        .filter(|&i| beta[i] != 0.0 && beta[i].abs() < bound[i])
        .collect();
    if !(2..=MOST_FREE).contains(&free.len()) {
        return None;
    }
    let slope = free
        .iter()
        .map(|&i| gradient[i] + tube_epsilon.copysign(beta[i]));
    let slope: Vec<f64> = slope.collect();
    let curvature = Mat::from_fn(free.len(), free.len(), |a, b| kernel[free[a] * n + free[b]]);
    let direction = direction(curvature, &slope)?;

    let limit = |i: usize, change: f64| {
        if beta[i] * change < 0.0 {
            0.0
        } else {
            bound[i].copysign(change)
        }
    };
    let rooms = free.iter().zip(&direction);
    let rooms: Vec<f64> = rooms
        .map(|(&i, &change)| (limit(i, change) - beta[i]) / change)
        .collect();
    // A member that stays where it is has no room to speak of: 0/0 or ∞, neither of which is less.
    let length = rooms.iter().copied().fold(1.0, f64::min);
    let after = free.iter().zip(&direction).zip(&rooms);
    let after = after.map(|((&i, &change), &room)| {
        if room <= length {
            limit(i, change)
        } else {
            beta[i] + length * change
        }
    });
    Some(FaceStep {
        beta: after.collect(),
        blocked: length < 1.0,
        free,
        slope,
    })
}

/// Where `½ pᵀKp + slope·p` is least with `Σp = 0`, in the kernel with the ridge.
fn direction(mut curvature: Mat<f64>, slope: &[f64]) -> Option<Vec<f64>> {
    let m = slope.len();
    let ridge = RIDGE * (0..m).map(|a| curvature[(a, a)]).sum::<f64>();
    for a in 0..m {
        curvature[(a, a)] += ridge;
    }
    let factors = Llt::new(curvature.as_ref(), Side::Lower).ok()?;
    let mean = slope.iter().sum::<f64>() / m as f64;
    let right = Mat::from_fn(m, 2, |a, column| match column {
        0 => mean - slope[a],
        _ => 1.0,
    });
    let solved = factors.solve(&right);
    let (newton, ones) = (solved.col(0), solved.col(1));
    let multiplier = newton.iter().sum::<f64>() / ones.iter().sum::<f64>();
    let changes = newton.iter().zip(ones.iter());
    let changes: Vec<f64> = changes.map(|(a, b)| a - multiplier * b).collect();
    // What rounding has left of the sum.
    let excess = changes.iter().sum::<f64>() / m as f64;
    let changes: Vec<f64> = changes.iter().map(|change| change - excess).collect();
    changes
        .iter()
        .all(|change| change.is_finite())
        .then_some(changes)
}
