//! Periodic cubic splines through points of the plane.

/// One cubic per span between neighbouring points; the parameter is the index of the span plus a fraction of its chord.
#[derive(Clone, PartialEq)]
pub(super) struct Spline {
    /// Coefficients of `x` and of `y` by ascending power
    spans: Vec<[[f64; 2]; 4]>,
}

/// Each sweep at least halves the error, so that after these it is below rounding.
const MAX_SWEEPS: usize = 60;

impl Spline {
    /// The spline through points, each in another place than the one before it, closed from the last to the first. Over the
    /// chord length `h` it is twice continuously differentiable, so its derivatives `m` at the points satisfy
    ///
    /// ```text
    /// h_i m_(i−1) + 2 (h_(i−1) + h_i) m_i + h_(i−1) m_(i+1) = 3 (h_i Δ_(i−1)/h_(i−1) + h_(i−1) Δ_i/h_i)
    /// ```
    ///
    /// with `Δ_i` from point `i` to the next: diagonally dominant, solved by Gauss-Seidel sweeps.
    pub(super) fn new(points: &[[f64; 2]]) -> Self {
        let count = points.len();
        let next = |i: usize| if i + 1 < count { i + 1 } else { 0 };
        let previous = |i: usize| if i > 0 { i - 1 } else { count - 1 };
        let steps: Vec<[f64; 2]> = (0..count)
            .map(|i| [0, 1].map(|axis| points[next(i)][axis] - points[i][axis]))
            .collect();
        let chords: Vec<f64> = steps.iter().map(|[x, y]| x.hypot(*y)).collect();
        let equations: Vec<[f64; 4]> = (0..count)
            .map(|i| {
                let (before, after) = (chords[previous(i)], chords[i]);
                let scale = 0.5 / (before + after);
                let right = [0, 1].map(|axis| {
                    3.0 * scale
                        * (after / before * steps[previous(i)][axis]
                            + before / after * steps[i][axis])
                });
                [right[0], right[1], scale * after, scale * before]
            })
            .collect();
        let mut slopes: Vec<[f64; 2]> = equations.iter().map(|[x, y, ..]| [*x, *y]).collect();
        for _ in 0..MAX_SWEEPS {
            let mut change = 0.0f64;
            for (i, [x, y, before, after]) in equations.iter().enumerate() {
                let ([bx, by], [ax, ay]) = (slopes[previous(i)], slopes[next(i)]);
                let solved = [x - before * bx - after * ax, y - before * by - after * ay];
                change = change
                    .max((solved[0] - slopes[i][0]).abs())
                    .max((solved[1] - slopes[i][1]).abs());
                slopes[i] = solved;
            }
            // Slopes over the chord length are about 1.
            if change < f64::EPSILON {
                break;
            }
        }
        let spans = (0..count)
            .map(|i| {
                let by_power = [0, 1].map(|axis| {
                    let (step, m0, m1) = (
                        steps[i][axis],
                        slopes[i][axis] * chords[i],
                        slopes[next(i)][axis] * chords[i],
                    );
                    [
                        points[i][axis],
                        m0,
                        3.0 * step - 2.0 * m0 - m1,
                        m0 + m1 - 2.0 * step,
                    ]
                });
                [0, 1, 2, 3].map(|power| [by_power[0][power], by_power[1][power]])
            })
            .collect();
        Self { spans }
    }

    pub(super) fn len(&self) -> usize {
        self.spans.len()
    }

    pub(super) fn points(&self) -> impl Iterator<Item = [f64; 2]> {
        self.spans.iter().map(|[point, ..]| *point)
    }

    /// The point and its first three derivatives by the parameter, which may leave `[0, len]` by less than one turn.
    pub(super) fn at(&self, parameter: f64) -> [[f64; 2]; 4] {
        let count = self.spans.len() as f64;
        let inside = if parameter < 0.0 {
            parameter + count
        } else if parameter >= count {
            parameter - count
        } else {
            parameter
        };
        let span = (inside as usize).min(self.spans.len() - 1);
        self.on_span(span, inside - span as f64)
    }

    /// The same at a fraction of a span.
    pub(super) fn on_span(&self, span: usize, t: f64) -> [[f64; 2]; 4] {
        let [c0, c1, c2, c3] = self.spans[span];
        let by_order = [0, 1].map(|axis| {
            let (c0, c1, c2, c3) = (c0[axis], c1[axis], c2[axis], c3[axis]);
            [
                c0 + t * (c1 + t * (c2 + t * c3)),
                c1 + t * (2.0 * c2 + t * 3.0 * c3),
                2.0 * c2 + t * 6.0 * c3,
                6.0 * c3,
            ]
        });
        [0, 1, 2, 3].map(|order| [by_order[0][order], by_order[1][order]])
    }
}
