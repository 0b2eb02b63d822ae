//! What can be wrong with a path.

/// A path that cannot be, with the offending value.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PathError {
    /// A number that is not finite or beyond a million kilometres
    #[error("`{name}` is {value}; it must be finite and no larger than 1e9")]
    OutOfRange {
        /// Name of the number
        name: &'static str,
        /// What was given
        value: f64,
    },
    /// A polar path that reaches the origin
    #[error(
        "the radius is {radius_m} m and the amplitude {amplitude_m} m; the radius must be larger"
    )]
    Radius {
        /// `R`
        radius_m: f64,
        /// `b`
        amplitude_m: f64,
    },
    /// A polar path with more waves than are resolved
    #[error("{periods} periods; a polar path has at most {most}")]
    Periods {
        /// `n`
        periods: u32,
        /// Largest allowed value
        most: u32,
    },
    /// Not enough points for a loop
    #[error("{distinct} distinct points; a closed path needs at least 4")]
    TooFewPoints {
        /// How many distinct points were given
        distinct: usize,
    },
    /// A point that is not finite or beyond a million kilometres
    #[error("point {index} is ({x_m}, {y_m}); coordinates must be finite and no larger than 1e9")]
    Point {
        /// Index of the point, from 0
        index: usize,
        /// `x`
        x_m: f64,
        /// `y`
        y_m: f64,
    },
    /// A point in the same place as the one before it
    #[error("point {index} at ({x_m}, {y_m}) repeats the one before it")]
    RepeatedPoint {
        /// Index of the point, from 0
        index: usize,
        /// `x`
        x_m: f64,
        /// `y`
        y_m: f64,
    },
}

/// Largest coordinate or length, in m: squares of distances stay far from overflow.
const LARGEST: f64 = 1e9;

impl PathError {
    pub(super) fn check(name: &'static str, value: f64) -> Result<(), Self> {
        if value.abs() <= LARGEST {
            Ok(())
        } else {
            Err(Self::OutOfRange { name, value })
        }
    }

    pub(super) fn check_point(index: usize, [x_m, y_m]: [f64; 2]) -> Result<(), Self> {
        if x_m.abs() <= LARGEST && y_m.abs() <= LARGEST {
            Ok(())
        } else {
            Err(Self::Point { index, x_m, y_m })
        }
    }
}
