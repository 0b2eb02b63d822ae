//! Paths that a robot can be kept on, and the Frenet frame under it.
//!
//! ```text
//! polar      R_path(φ) = R + b sin nφ     about the origin, counter-clockwise (thesis 2.23)
//! straight   a point and a heading        unbounded
//! closed     through given points         periodic cubic spline over the chord length, twice continuously differentiable
//! ```
//!
//! Arc length `s`, curvature `κ` and `dκ/ds` follow from the derivatives of the curve `c` by its parameter:
//!
//! ```text
//! κ = (x'y'' − y'x'')/|c'|³,     dκ/ds = [(x'y''' − y'x''')/|c'|³ − 3κ (c'·c'')/|c'|²]/|c'|
//! ```
//!
//! ```
//! use unicycle_cbf::path::Path;
//!
//! let path = Path::polar(0.9, 0.0, 0)?;
//! let foot = path.nearest(0.0, 1.0);
//! assert!((foot.deviation_m(0.0, 1.0) - 0.1).abs() < 1e-12);
//! assert!((foot.curvature_1pm - 1.0 / 0.9).abs() < 1e-12);
//! # Ok::<(), unicycle_cbf::path::PathError>(())
//! ```

mod arc_length;
mod closed;
mod error;
mod grid;
mod polar;
mod search;
mod span;
pub use span::Span;
mod spline;
mod straight;

pub use closed::ClosedPath;
pub use error::PathError;
pub use polar::PolarPath;
pub use straight::StraightPath;

/// A point of a path and the Frenet frame there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPoint {
    /// Arc length from the path's start, in m; in `[0, L)` on closed paths
    pub s_m: f64,
    /// `x`, in m
    pub x_m: f64,
    /// `y`, in m
    pub y_m: f64,
    /// Unit vector in the direction of travel
    pub tangent: [f64; 2],
    /// `κ`, positive where the path turns left, in 1/m
    pub curvature_1pm: f64,
    /// `dκ/ds`, in 1/m²; jumps at the given points of a closed path, which are the joints of its spline
    pub curvature_rate_1pm2: f64,
}

impl PathPoint {
    /// Unit vector to the right of the direction of travel, on a counter-clockwise loop outward: `(t_y, −t_x)`.
    #[must_use]
    pub fn normal(&self) -> [f64; 2] {
        [self.tangent[1], -self.tangent[0]]
    }

    /// Direction of travel, in rad, in `(−π, π]`.
    #[must_use]
    pub fn heading_rad(&self) -> f64 {
        self.tangent[1].atan2(self.tangent[0])
    }

    /// How far a point lies along the normal, in m, positive to the right. Of a point whose foot this is, its distance.
    #[must_use]
    pub fn deviation_m(&self, x_m: f64, y_m: f64) -> f64 {
        let [nx, ny] = self.normal();
        (x_m - self.x_m) * nx + (y_m - self.y_m) * ny
    }
}

/// A path in the plane with a direction of travel.
///
/// No method panics; a coordinate or arc length that is not finite gives a [`PathPoint`] of NaNs.
#[derive(Debug, Clone, PartialEq)]
pub enum Path {
    /// `R + b sin nφ` about the origin
    Polar(PolarPath),
    /// A straight line
    Straight(StraightPath),
    /// A loop through points
    Closed(ClosedPath),
}

impl Path {
    /// The path `R + b sin nφ`, see [`PolarPath::new`].
    ///
    /// # Errors
    ///
    /// A number that is not finite, a radius not above the amplitude, too many periods.
    pub fn polar(radius_m: f64, amplitude_m: f64, periods: u32) -> Result<Self, PathError> {
        PolarPath::new(radius_m, amplitude_m, periods).map(Self::Polar)
    }

    /// The straight line through a point, see [`StraightPath::new`].
    ///
    /// # Errors
    ///
    /// A number that is not finite.
    pub fn straight(x_m: f64, y_m: f64, heading_rad: f64) -> Result<Self, PathError> {
        StraightPath::new(x_m, y_m, heading_rad).map(Self::Straight)
    }

    /// The loop through points `[x, y]` in m, see [`ClosedPath::new`].
    ///
    /// # Errors
    ///
    /// Fewer than four distinct points, a point that is not finite or repeats the one before it.
    pub fn closed(points_m: &[[f64; 2]]) -> Result<Self, PathError> {
        ClosedPath::new(points_m).map(Self::Closed)
    }

    /// The point of the path that is nearest to a given one: the foot of the normal through it.
    #[must_use]
    pub fn nearest(&self, x_m: f64, y_m: f64) -> PathPoint {
        match self {
            Self::Polar(path) => path.nearest(x_m, y_m),
            Self::Straight(path) => path.nearest(x_m, y_m),
            Self::Closed(path) => path.nearest(x_m, y_m),
        }
    }

    /// The point at an arc length, in m, which wraps around on closed paths.
    #[must_use]
    pub fn at(&self, s_m: f64) -> PathPoint {
        match self {
            Self::Polar(path) => path.at(s_m),
            Self::Straight(path) => path.at(s_m),
            Self::Closed(path) => path.at(s_m),
        }
    }

    /// Circumference `L`, in m; `None` for a straight line.
    #[must_use]
    pub fn length_m(&self) -> Option<f64> {
        match self {
            Self::Polar(path) => Some(path.length_m()),
            Self::Straight(_) => None,
            Self::Closed(path) => Some(path.length_m()),
        }
    }

    /// How far `to_s_m` is ahead of `from_s_m`, in m: in `[0, L)` on closed paths, negative behind on a straight line.
    #[must_use]
    pub fn distance_along_m(&self, from_s_m: f64, to_s_m: f64) -> f64 {
        let ahead_m = to_s_m - from_s_m;
        match self.length_m() {
            Some(length_m) => wrapped(ahead_m, length_m),
            None => ahead_m,
        }
    }

    /// The largest `|κ|`, in 1/m.
    #[must_use]
    pub fn max_curvature_1pm(&self) -> f64 {
        match self {
            Self::Polar(path) => path.max_curvature_1pm(),
            Self::Straight(_) => 0.0,
            Self::Closed(path) => path.max_curvature_1pm(),
        }
    }
}

/// `value` modulo `period`, in `[0, period)` even where `rem_euclid` rounds up to the period.
fn wrapped(value: f64, period: f64) -> f64 {
    if (0.0..period).contains(&value) {
        return value;
    }
    let once = value + period;
    if value < 0.0 && (0.0..period).contains(&once) {
        return once;
    }
    let rest = value.rem_euclid(period);
    if rest >= period { 0.0 } else { rest }
}

/// Unit tangent, `κ` and `dκ/ds` from the first three derivatives of a curve.
fn frenet(c1: [f64; 2], c2: [f64; 2], c3: [f64; 2]) -> ([f64; 2], f64, f64) {
    let inverse = 1.0 / (c1[0] * c1[0] + c1[1] * c1[1]).sqrt();
    let tangent = [c1[0] * inverse, c1[1] * inverse];
    let square = inverse * inverse;
    let curvature = (tangent[0] * c2[1] - tangent[1] * c2[0]) * square;
    let along = (tangent[0] * c2[0] + tangent[1] * c2[1]) * square;
    let change = (tangent[0] * c3[1] - tangent[1] * c3[0]) * square * inverse;
    (tangent, curvature, change - 3.0 * curvature * along)
}
