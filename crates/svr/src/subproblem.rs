//! Two-variable method on a working set that fits the cache, with Newton's steps where it is slow.
//!
//! The second variable is chosen by the decrease that it promises: R.-E. Fan, P.-H. Chen, C.-J. Lin, Working set
//! selection using second order information for training support vector machines, JMLR 6, 2005. Here it works on
//! `β = α* − α`, half as many variables, whose objective has a kink at 0.

use crate::face::{FaceStep, newton_step};
use crate::vectorised::vectorised;

/// Curvature below this is rounding.
pub(crate) const LEAST_CURVATURE: f64 = 1e-12;

/// Moves of pairs per member before Newton's steps are tried. Most working sets are done before.
const MOVES_PER_FACE: usize = 10;

/// `½ βᵀKβ − yᵀβ + ε‖β‖₁` in the variables of the working set, the others held.
pub(crate) struct Subproblem {
    /// `K` between members in double precision, row by row.
    kernel: Vec<f64>,
    diagonal: Vec<f64>,
    pub(crate) beta: Vec<f64>,
    bound: Vec<f64>,
    /// `(Kβ)_i − y_i`.
    gradient: Vec<f64>,
    /// What moving `β_i` up gains, −∞ at the upper bound.
    up: Vec<f64>,
    /// What moving `β_i` down costs, ∞ at the lower bound.
    down: Vec<f64>,
    tube_epsilon: f64,
}

/// What moving `β` up gains and what moving it down costs, per unit.
pub(crate) fn slopes(beta: f64, gradient: f64, bound: f64, tube_epsilon: f64) -> (f64, f64) {
    let up = if beta < 0.0 {
        tube_epsilon - gradient
    } else {
        -tube_epsilon - gradient
    };
    let down = if beta > 0.0 {
        -tube_epsilon - gradient
    } else {
        tube_epsilon - gradient
    };
    (
        if beta < bound { up } else { f64::NEG_INFINITY },
        if beta > -bound { down } else { f64::INFINITY },
    )
}

impl Subproblem {
    pub(crate) fn new(
        members: &[usize],
        kernel: Vec<f64>,
        beta: &[f64],
        gradient: &[f64],
        bound: &[f64],
        tube_epsilon: f64,
    ) -> Self {
        let pick = |values: &[f64]| members.iter().map(|&i| values[i]).collect::<Vec<_>>();
        let (beta, gradient, bound) = (pick(beta), pick(gradient), pick(bound));
        let slopes =
            (0..members.len()).map(|k| slopes(beta[k], gradient[k], bound[k], tube_epsilon));
        let (up, down) = slopes.unzip();
        Self {
            diagonal: (0..members.len())
                .map(|k| kernel[k * (members.len() + 1)])
                .collect(),
            kernel,
            beta,
            bound,
            gradient,
            up,
            down,
            tube_epsilon,
        }
    }

    /// Moves pairs until none promises more than `tolerance` per unit, and where that takes long goes along faces, too; at most
    /// `max_steps` moves and steps, and how many were made.
    pub(crate) fn minimise(&mut self, tolerance: f64, max_steps: usize) -> usize {
        let n = self.beta.len();
        let (mut steps, mut moves) = (0, 0_usize);
        while steps < max_steps {
            let (i, up) = greatest(&self.up);
            let row = &self.kernel[i * n..(i + 1) * n];
            let (j, lowest) = self.partner(i, up, row);
            if j == n || up - lowest <= tolerance {
                return steps;
            }
            self.exchange(i, j);
            (steps, moves) = (steps + 1, moves + 1);
            if moves.is_multiple_of(MOVES_PER_FACE * n) {
                steps += self.descend_faces(max_steps - steps);
            }
        }
        steps
    }

    /// Newton's steps until one ends inside its face; how many were made.
    fn descend_faces(&mut self, max_steps: usize) -> usize {
        for made in 0..max_steps {
            let step = newton_step(
                &self.kernel,
                &self.beta,
                &self.gradient,
                &self.bound,
                self.tube_epsilon,
            );
            let Some(step) = step else { return made };
            if !self.accept(&step) {
                return made;
            }
            if !step.blocked {
                return made + 1;
            }
        }
        max_steps
    }

    /// Takes the step if it lowers the objective. Says whether it did.
    fn accept(&mut self, step: &FaceStep) -> bool {
        let n = self.beta.len();
        let mut products = vec![0.0; n];
        for (&i, after) in step.free.iter().zip(&step.beta) {
            let change = after - self.beta[i];
            let row = &self.kernel[i * n..(i + 1) * n];
            for (product, k) in products.iter_mut().zip(row) {
                *product += change * k;
            }
        }
        let rises = step.free.iter().zip(&step.beta).zip(&step.slope);
        let rise: f64 = rises
            .map(|((&i, after), slope)| (after - self.beta[i]) * (slope + 0.5 * products[i]))
            .sum();
        if rise >= 0.0 || rise.is_nan() {
            return false;
        }
        for (&i, &after) in step.free.iter().zip(&step.beta) {
            self.beta[i] = after;
        }
        for (k, product) in products.iter().enumerate() {
            self.gradient[k] += product;
            (self.up[k], self.down[k]) = slopes(
                self.beta[k],
                self.gradient[k],
                self.bound[k],
                self.tube_epsilon,
            );
        }
        true
    }

    /// The partner of `i` that promises the greatest decrease, and the lowest cost of any.
    fn partner(&self, i: usize, up: f64, row: &[f64]) -> (usize, f64) {
        const LANES: usize = 8;
        let n = row.len();
        let own = self.diagonal[i];
        let (down, diagonal) = (&self.down[..n], &self.diagonal[..n]);
        let mut best = [(0.0_f64); LANES];
        let mut at = [n as u64; LANES];
        let mut lowest = [f64::INFINITY; LANES];
        vectorised(
            #[inline(always)]
            || {
                let whole = n - n % LANES;
                for from in (0..whole).step_by(LANES) {
                    for lane in 0..LANES {
                        let k = from + lane;
                        let gain = (up - down[k]).max(0.0);
                        let curvature = own + diagonal[k] - 2.0 * row[k];
                        let decrease = gain * gain / curvature.max(LEAST_CURVATURE);
                        let better = decrease > best[lane];
                        at[lane] = if better { k as u64 } else { at[lane] };
                        best[lane] = if better { decrease } else { best[lane] };
                        lowest[lane] = lowest[lane].min(down[k]);
                    }
                }
                for k in whole..n {
                    let gain = (up - down[k]).max(0.0);
                    let curvature = own + diagonal[k] - 2.0 * row[k];
                    let decrease = gain * gain / curvature.max(LEAST_CURVATURE);
                    if decrease > best[0] {
                        (best[0], at[0]) = (decrease, k as u64);
                    }
                    lowest[0] = lowest[0].min(down[k]);
                }
            },
        );
        let mut winner = 0;
        for lane in 1..LANES {
            if best[lane] > best[winner] {
                winner = lane;
            }
        }
        (
            at[winner] as usize,
            lowest.into_iter().fold(f64::INFINITY, f64::min),
        )
    }

    /// Raises `β_i` and lowers `β_j` by the same, to the minimum along that line.
    fn exchange(&mut self, i: usize, j: usize) {
        let n = self.beta.len();
        let (row_i, row_j) = (
            &self.kernel[i * n..(i + 1) * n],
            &self.kernel[j * n..(j + 1) * n],
        );
        let curvature = self.diagonal[i] + self.diagonal[j] - 2.0 * row_i[j];
        let before = (self.beta[i], self.beta[j]);
        let after = line_minimum(
            before,
            (self.bound[i], self.bound[j]),
            self.up[i] - self.down[j],
            curvature.max(LEAST_CURVATURE),
            self.tube_epsilon,
        );
        (self.beta[i], self.beta[j]) = after;
        let (change_i, change_j) = (after.0 - before.0, after.1 - before.1);
        let (gradient, up, down) = (
            &mut self.gradient[..n],
            &mut self.up[..n],
            &mut self.down[..n],
        );
        vectorised(
            #[inline(always)]
            || {
                for k in 0..n {
                    let change = change_i * row_i[k] + change_j * row_j[k];
                    gradient[k] += change;
                    up[k] -= change;
                    down[k] -= change;
                }
            },
        );
        for k in [i, j] {
            (self.up[k], self.down[k]) = slopes(
                self.beta[k],
                self.gradient[k],
                self.bound[k],
                self.tube_epsilon,
            );
        }
    }
}

#[expect(
    clippy::float_cmp,
    reason = "a step that ends at a kink is the kink itself"
)]
/// Where `½ a δ² − gain·δ + kinks` is least for `β_i + δ`, `β_j − δ` within their bounds. Bounds and kinks are hit exactly.
fn line_minimum(
    beta: (f64, f64),
    bound: (f64, f64),
    gain: f64,
    curvature: f64,
    tube_epsilon: f64,
) -> (f64, f64) {
    let room = (bound.0 - beta.0, beta.1 + bound.1);
    let kinks = (
        if beta.0 < 0.0 { -beta.0 } else { f64::INFINITY },
        if beta.1 > 0.0 { beta.1 } else { f64::INFINITY },
    );
    let mut gain = gain;
    let mut delta = gain / curvature;
    for kink in [kinks.0.min(kinks.1), kinks.0.max(kinks.1)] {
        if delta > kink {
            gain -= 2.0 * tube_epsilon;
            delta = (gain / curvature).max(kink);
        }
    }
    let delta = delta.min(room.0).min(room.1);
    let first = if delta >= room.0 {
        bound.0
    } else if delta == kinks.0 {
        0.0
    } else {
        beta.0 + delta
    };
    let second = if delta >= room.1 {
        -bound.1
    } else if delta == kinks.1 {
        0.0
    } else {
        beta.1 - delta
    };
    (first, second)
}

fn greatest(values: &[f64]) -> (usize, f64) {
    const LANES: usize = 8;
    let mut best = [f64::NEG_INFINITY; LANES];
    vectorised(
        #[inline(always)]
        || {
            let chunks = values.chunks_exact(LANES);
            for (lane, value) in chunks.remainder().iter().enumerate() {
                best[lane] = *value;
            }
            for chunk in chunks {
                for lane in 0..LANES {
                    best[lane] = if chunk[lane] > best[lane] {
                        chunk[lane]
                    } else {
                        best[lane]
                    };
                }
            }
        },
    );
    let best = best.into_iter().fold(f64::NEG_INFINITY, f64::max);
    (
        values.iter().position(|value| *value >= best).unwrap_or(0),
        best,
    )
}
