use faer::linalg::matmul::{matmul, triangular};
use faer::linalg::solvers::{Llt, Solve};
use faer::{Accum, Col, ColMut, ColRef, Mat, MatRef, Par, Side};

/// Scaled predictors, each row with a one at its end.
pub(crate) struct LinearRows {
    pub(crate) values: Vec<f64>,
    pub(crate) columns: usize,
}

/// Rows whose scaled copy stays in the cache.
const BLOCK: usize = 256;

impl LinearRows {
    pub(crate) fn new(scaled: &[f64], predictors: usize) -> Self {
        let mut rows = Self::with_capacity(predictors, scaled.len() / predictors);
        rows.extend(scaled);
        rows
    }

    pub(crate) fn with_capacity(predictors: usize, samples: usize) -> Self {
        let columns = predictors + 1;
        Self {
            values: Vec::with_capacity(samples * columns),
            columns,
        }
    }

    /// Adds rows without their ones.
    pub(crate) fn extend(&mut self, scaled: &[f64]) {
        for row in scaled.chunks_exact(self.columns - 1) {
            self.values.extend_from_slice(row);
            self.values.push(1.0);
        }
    }

    fn matrix(&self) -> MatRef<'_, f64> {
        MatRef::from_row_major_slice(&self.values, self.values.len() / self.columns, self.columns)
    }

    /// `x̃_i·ω` of every sample.
    pub(crate) fn products(&self, omega: &[f64], out: &mut [f64]) {
        let out = ColMut::from_slice_mut(out);
        matmul(
            out.as_mat_mut(),
            Accum::Replace,
            self.matrix(),
            ColRef::from_slice(omega).as_mat(),
            1.0,
            Par::Seq,
        );
    }

    /// `Σ q_i x̃_i`.
    pub(crate) fn combination(&self, q: &[f64], out: &mut [f64]) {
        let out = ColMut::from_slice_mut(out);
        matmul(
            out.as_mat_mut(),
            Accum::Replace,
            self.matrix().transpose(),
            ColRef::from_slice(q).as_mat(),
            1.0,
            Par::Seq,
        );
    }

    /// Minimises `½‖w‖² + C/2 Σ (y − x̃·ω)²`; one `ω` per response. `None` where the system cannot be factored.
    pub(crate) fn least_squares(
        &self,
        responses: &[&[f64]],
        box_constraint: f64,
    ) -> Option<Vec<Vec<f64>>> {
        let n = self.values.len() / self.columns;
        let normal = self.normal_matrix(&vec![box_constraint; n], &mut Vec::new());
        let factors = Llt::new(normal.as_ref(), Side::Lower).ok()?;
        let solve = |response: &&[f64]| {
            let mut right = vec![0.0; self.columns];
            self.combination(response, &mut right);
            for value in &mut right {
                *value *= box_constraint;
            }
            let solved: Col<f64> = factors.solve(ColRef::from_slice(&right));
            solved.iter().copied().collect()
        };
        Some(responses.iter().map(solve).collect())
    }

    /// Lower triangle of `diag(1, …, 1, 0) + Σ D_i x̃_i x̃_iᵀ`.
    pub(crate) fn normal_matrix(&self, d: &[f64], scratch: &mut Vec<f64>) -> Mat<f64> {
        let columns = self.columns;
        let mut normal = Mat::identity(columns, columns);
        normal[(columns - 1, columns - 1)] = 0.0;
        for (rows, d) in self.values.chunks(BLOCK * columns).zip(d.chunks(BLOCK)) {
            scratch.clear();
            for (row, d) in rows.chunks_exact(columns).zip(d) {
                let root = d.sqrt();
                scratch.extend(row.iter().map(|x| root * x));
            }
            let block = MatRef::from_row_major_slice(scratch, d.len(), columns);
            triangular::matmul(
                normal.as_mut(),
                triangular::BlockStructure::TriangularLower,
                Accum::Add,
                block.transpose(),
                triangular::BlockStructure::Rectangular,
                block,
                triangular::BlockStructure::Rectangular,
                1.0,
                Par::Seq,
            );
        }
        normal
    }
}
