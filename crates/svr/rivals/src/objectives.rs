//! Primal and dual objective of anybody's solution, in double precision.

use ndarray::{Array1, Array2, ArrayView1, Axis};
use svr::{Kernel, UsedPenalty};

/// `f(x) = Σ β_i K(x_i, x) + b`.
pub struct Solution<'a> {
    pub kernel: Kernel,
    /// Standardised and divided by the kernel scale.
    pub scaled: &'a Array2<f64>,
    pub response: &'a [f64],
    pub penalty: UsedPenalty,
    pub beta: &'a [f64],
    pub bias: f64,
}

pub struct Objectives {
    pub primal: f64,
    pub dual: f64,
    /// The greater of `|Σβ|` and the most by which a `|β_i|` exceeds `C`: the dual bounds the optimum where it is 0.
    pub infeasibility: f64,
}

pub fn evaluate(solution: &Solution<'_>) -> Objectives {
    let UsedPenalty {
        box_constraint,
        tube_epsilon,
    } = solution.penalty;
    let beta = ArrayView1::from(solution.beta);
    let products = products(solution.kernel, solution.scaled, &beta);
    let square = beta.dot(&products);
    let (mut loss, mut linear, mut excess) = (0.0, 0.0, 0.0_f64);
    for ((&y, &b), product) in solution.response.iter().zip(&beta).zip(&products) {
        loss += box_constraint * ((y - product - solution.bias).abs() - tube_epsilon).max(0.0);
        linear += y * b - tube_epsilon * b.abs();
        excess = excess.max(b.abs() - box_constraint);
    }
    Objectives {
        primal: 0.5 * square + loss,
        dual: linear - 0.5 * square,
        infeasibility: excess.max(beta.sum().abs()),
    }
}

fn products(kernel: Kernel, scaled: &Array2<f64>, beta: &ArrayView1<'_, f64>) -> Array1<f64> {
    if kernel == Kernel::Linear {
        return scaled.dot(&scaled.t().dot(beta));
    }
    let squares = scaled.map_axis(Axis(1), |row| row.dot(&row));
    let mut products = Vec::with_capacity(beta.len());
    for (rows, own) in scaled
        .axis_chunks_iter(Axis(0), 256)
        .zip(squares.axis_chunks_iter(Axis(0), 256))
    {
        let mut values = rows.dot(&scaled.t());
        for (mut row, own) in values.axis_iter_mut(Axis(0)).zip(own) {
            row.zip_mut_with(&squares, |value, other| {
                *value = match kernel {
                    Kernel::Linear => *value,
                    Kernel::Quadratic => (1.0 + *value).powi(2),
                    Kernel::Cubic => (1.0 + *value).powi(3),
                    Kernel::Rbf => (2.0 * *value - own - other).min(0.0).exp(),
                };
            });
        }
        products.extend(values.dot(beta));
    }
    Array1::from_vec(products)
}
