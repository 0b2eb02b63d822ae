//! A straight line through points, by least squares.

/// Points that are nearer together than rounding tells apart have no slope, in m².
const LEAST_M2: f64 = 1e-12;

/// Sums of squares and products of points about their means.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Line {
    pub(super) xx: f64,
    xy: f64,
    yy: f64,
}

impl Line {
    pub(super) fn through(points: impl Iterator<Item = (f64, f64)> + Clone) -> Self {
        let count = points.clone().count().max(1) as f64;
        let sums = points
            .clone()
            .fold([0.0; 2], |[xs, ys], (x, y)| [xs + x, ys + y]);
        let [x_mean, y_mean] = sums.map(|sum| sum / count);
        points.fold(Self::default(), |line, (x, y)| {
            let (x, y) = (x - x_mean, y - y_mean);
            Self {
                xx: line.xx + x * x,
                xy: line.xy + x * y,
                yy: line.yy + y * y,
            }
        })
    }

    /// Of the line that is nearest to the points; of points that are all above each other, one.
    pub(super) fn slope(&self) -> f64 {
        if self.xx > LEAST_M2 {
            self.xy / self.xx
        } else {
            1.0
        }
    }

    /// Sum of the squares that a line of this slope leaves.
    pub(super) fn rest(&self, slope: f64) -> f64 {
        (self.yy - 2.0 * slope * self.xy + slope * slope * self.xx).max(0.0)
    }
}
