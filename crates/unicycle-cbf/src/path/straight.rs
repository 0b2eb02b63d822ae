//! A straight line.

use super::{PathError, PathPoint};

/// The straight line through a point, unbounded in both directions; `s` counts from the point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StraightPath {
    origin_m: [f64; 2],
    tangent: [f64; 2],
}

impl StraightPath {
    /// # Errors
    ///
    /// A number that is not finite.
    pub fn new(x_m: f64, y_m: f64, heading_rad: f64) -> Result<Self, PathError> {
        PathError::check("x_m", x_m)?;
        PathError::check("y_m", y_m)?;
        PathError::check("heading_rad", heading_rad)?;
        let (sin, cos) = heading_rad.sin_cos();
        Ok(Self {
            origin_m: [x_m, y_m],
            tangent: [cos, sin],
        })
    }

    /// The point `s_m` metres ahead of the origin.
    #[must_use]
    pub fn at(&self, s_m: f64) -> PathPoint {
        let ([x, y], [tx, ty]) = (self.origin_m, self.tangent);
        // NaN where `s_m` is not finite.
        let zero = 0.0 * s_m;
        PathPoint {
            s_m: s_m + zero,
            x_m: x + s_m * tx + zero,
            y_m: y + s_m * ty + zero,
            tangent: [tx + zero, ty + zero],
            curvature_1pm: zero,
            curvature_rate_1pm2: zero,
        }
    }

    /// The foot of the perpendicular from a point.
    #[must_use]
    pub fn nearest(&self, x_m: f64, y_m: f64) -> PathPoint {
        let ([x, y], [tx, ty]) = (self.origin_m, self.tangent);
        self.at((x_m - x) * tx + (y_m - y) * ty)
    }
}
