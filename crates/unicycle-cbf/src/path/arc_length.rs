//! Arc length as a function of a curve's parameter, and back.

/// Quadrature of five points, Gauss-Legendre: nodes on `[0, 1]` and weights.
const GAUSS: [[f64; 2]; 5] = [
    [0.046_910_077_030_668_0, 0.118_463_442_528_094_54],
    [0.230_765_344_947_158_45, 0.239_314_335_249_683_24],
    [0.5, 0.284_444_444_444_444_44],
    [0.769_234_655_052_841_5, 0.239_314_335_249_683_24],
    [0.953_089_922_969_332, 0.118_463_442_528_094_54],
];

/// Error allowed in the middle of a piece, relative to the whole length.
const ACCURACY: f64 = 1e-12;
const MAX_PIECES: usize = 1 << 16;

/// `s(u)` on `[0, spans]`, a quintic on each of equal pieces that has the right length and, at the ends, speed and acceleration.
#[derive(Clone, PartialEq)]
pub(super) struct ArcLength {
    pieces: Vec<[f64; 6]>,
    pieces_per_span: f64,
    length_m: f64,
}

impl ArcLength {
    /// `rate(span, t)` is `[ds/dt, d²s/dt²]`, smooth for `t` in `[0, 1]`.
    pub(super) fn new(spans: usize, rate: impl Fn(usize, f64) -> [f64; 2]) -> Self {
        let mut pieces_per_span = 1;
        loop {
            let (table, error_m) = Self::with_pieces(spans, pieces_per_span, &rate);
            pieces_per_span *= 2;
            let converged = error_m <= ACCURACY * table.length_m;
            if converged || spans * pieces_per_span > MAX_PIECES {
                return table;
            }
        }
    }

    /// The table and its largest error.
    fn with_pieces(
        spans: usize,
        pieces_per_span: usize,
        rate: &impl Fn(usize, f64) -> [f64; 2],
    ) -> (Self, f64) {
        let step = 1.0 / pieces_per_span as f64;
        let mut pieces = Vec::with_capacity(spans * pieces_per_span);
        let (mut length_m, mut error_m) = (0.0, 0.0f64);
        for span in 0..spans {
            for piece in 0..pieces_per_span {
                let start = piece as f64 * step;
                let half = |from: f64| -> f64 {
                    GAUSS
                        .iter()
                        .map(|[node, weight]| {
                            0.5 * step * weight * rate(span, from + 0.5 * step * node)[0]
                        })
                        .sum()
                };
                let (first, second) = (half(start), half(start + 0.5 * step));
                let ends = [rate(span, start), rate(span, start + step)];
                let [[v0, a0], [v1, a1]] = ends.map(|[v, a]| [v * step, a * step * step]);
                let length = first + second - v0 - 0.5 * a0;
                let (speed, change) = (v1 - v0 - a0, a1 - a0);
                let quintic = [
                    length_m,
                    v0,
                    0.5 * a0,
                    10.0 * length - 4.0 * speed + 0.5 * change,
                    -15.0 * length + 7.0 * speed - change,
                    6.0 * length - 3.0 * speed + 0.5 * change,
                ];
                let [value, slope] = evaluated(&quintic, 0.5);
                let speed = rate(span, start + 0.5 * step)[0] * step;
                error_m = error_m
                    .max((value - length_m - first).abs())
                    .max((slope - speed).abs());
                pieces.push(quintic);
                length_m += first + second;
            }
        }
        let table = Self {
            pieces,
            pieces_per_span: pieces_per_span as f64,
            length_m,
        };
        (table, error_m)
    }

    /// `L`, in m
    pub(super) fn length_m(&self) -> f64 {
        self.length_m
    }

    /// `s` at a parameter in `[0, spans]`, in m.
    pub(super) fn at(&self, parameter: f64) -> f64 {
        let place = parameter * self.pieces_per_span;
        let piece = (place as usize).min(self.pieces.len() - 1);
        evaluated(&self.pieces[piece], place - piece as f64)[0]
    }

    /// The parameter in `[0, spans]` at an arc length in `[0, L]`.
    pub(super) fn parameter(&self, s_m: f64) -> f64 {
        let piece = self
            .pieces
            .partition_point(|quintic| quintic[0] <= s_m)
            .max(1)
            - 1;
        let quintic = &self.pieces[piece];
        let end_m = self
            .pieces
            .get(piece + 1)
            .map_or(self.length_m, |next| next[0]);
        let mut place = (s_m - quintic[0]) / (end_m - quintic[0]);
        for _ in 0..MAX_STEPS {
            let [value, slope] = evaluated(quintic, place);
            let step = (s_m - value) / slope;
            place = (place + step).clamp(0.0, 1.0);
            if step.abs() < TOLERANCE {
                break;
            }
        }
        (piece as f64 + place) / self.pieces_per_span
    }
}

const TOLERANCE: f64 = 1e-9;
const MAX_STEPS: usize = 20;

/// Value and derivative of a quintic.
fn evaluated(quintic: &[f64; 6], x: f64) -> [f64; 2] {
    let [c0, c1, c2, c3, c4, c5] = *quintic;
    let value = c0 + x * (c1 + x * (c2 + x * (c3 + x * (c4 + x * c5))));
    let slope = c1 + x * (2.0 * c2 + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)));
    [value, slope]
}
