//! Loops through given points.

use std::fmt;

use super::arc_length::ArcLength;
use super::grid::Grid;
use super::search::{Nearest, minimum, peak};
use super::spline::Spline;
use super::{PathError, PathPoint, frenet, wrapped};

/// Samples of the curve that the search for the nearest point starts from.
const SAMPLES_PER_POINT: usize = 16;
const MIN_SAMPLES: usize = 256;
const MAX_SAMPLES: usize = 4096;

/// Points no farther apart than this share of the largest coordinate are the same.
const COINCIDENT: f64 = 1e-12;

/// A loop through points in order of travel, a periodic cubic spline over the chord length; `s` counts from the first point.
#[derive(Clone, PartialEq)]
pub struct ClosedPath {
    spline: Spline,
    arc: ArcLength,
    /// Points at equal steps of the parameter
    samples: Vec<[f64; 2]>,
    /// The longest step between samples along the curve, in m
    spacing_m: f64,
    grid: Grid,
    max_curvature_1pm: f64,
}

impl ClosedPath {
    /// The loop through points `[x, y]` in m, in order of travel; the first may be repeated at the end.
    ///
    /// # Errors
    ///
    /// Fewer than four distinct points, a point that is not finite or repeats the one before it.
    pub fn new(points_m: &[[f64; 2]]) -> Result<Self, PathError> {
        for (index, point) in points_m.iter().enumerate() {
            PathError::check_point(index, *point)?;
        }
        let largest = points_m
            .iter()
            .flatten()
            .fold(0.0, |most: f64, value| most.max(value.abs()));
        let coincide = |[ax, ay]: [f64; 2], [bx, by]: [f64; 2]| {
            (bx - ax).hypot(by - ay) <= COINCIDENT * largest
        };
        let points = match points_m {
            [first, between @ .., last] if coincide(*first, *last) => &points_m[..=between.len()],
            _ => points_m,
        };
        for (index, pair) in points.windows(2).enumerate() {
            if coincide(pair[0], pair[1]) {
                let [x_m, y_m] = pair[1];
                return Err(PathError::RepeatedPoint {
                    index: index + 1,
                    x_m,
                    y_m,
                });
            }
        }
        let distinct = distinct(points, coincide);
        if distinct < 4 {
            return Err(PathError::TooFewPoints { distinct });
        }

        let spline = Spline::new(points);
        let spans = spline.len();
        let arc = ArcLength::new(spans, |span, t| {
            let [_, [x1, y1], [x2, y2], _] = spline.on_span(span, t);
            let speed = x1.hypot(y1);
            let change = if speed > 0.0 {
                (x1 * x2 + y1 * y2) / speed
            } else {
                0.0
            };
            [speed, change]
        });
        let count = (SAMPLES_PER_POINT * spans).clamp(MIN_SAMPLES, MAX_SAMPLES);
        let step = spans as f64 / count as f64;
        let samples: Vec<[f64; 2]> = (0..count)
            .map(|sample| spline.at(sample as f64 * step)[0])
            .collect();
        let spacing_m = (0..count)
            .map(|sample| arc.at((sample + 1) as f64 * step) - arc.at(sample as f64 * step))
            .fold(0.0, f64::max);
        let curvature = |parameter| {
            let [_, c1, c2, c3] = spline.at(parameter);
            frenet(c1, c2, c3).1.abs()
        };
        let per_span = (1024 / spans).max(8);
        let max_curvature_1pm = peak(spans as f64, spans * per_span, curvature);
        Ok(Self {
            grid: Grid::new(&samples, spacing_m),
            spline,
            arc,
            samples,
            spacing_m,
            max_curvature_1pm,
        })
    }

    fn at_parameter(&self, parameter: f64) -> PathPoint {
        let spans = self.spline.len() as f64;
        let parameter = wrapped(parameter, spans);
        let [[x_m, y_m], c1, c2, c3] = self.spline.at(parameter);
        let (tangent, curvature_1pm, curvature_rate_1pm2) = frenet(c1, c2, c3);
        PathPoint {
            s_m: wrapped(self.arc.at(parameter), self.arc.length_m()),
            x_m,
            y_m,
            tangent,
            curvature_1pm,
            curvature_rate_1pm2,
        }
    }

    /// The point at an arc length, in m.
    #[must_use]
    pub fn at(&self, s_m: f64) -> PathPoint {
        let s_m = wrapped(s_m, self.arc.length_m());
        self.at_parameter(self.arc.parameter(s_m))
    }

    /// Circumference, in m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.arc.length_m()
    }

    /// The largest `|κ|`, in 1/m.
    #[must_use]
    pub fn max_curvature_1pm(&self) -> f64 {
        self.max_curvature_1pm
    }

    /// The nearest point of the path, by iteration from the samples that can be the nearest in the cell of the point.
    /// Outside of the grid, a quarter of the path's extent away from it, a local minimum of the distance.
    #[must_use]
    pub fn nearest(&self, x_m: f64, y_m: f64) -> PathPoint {
        let count = self.samples.len();
        let step = self.spline.len() as f64 / count as f64;
        let square = |sample: usize| {
            let [x, y] = self.samples[sample];
            (x - x_m).powi(2) + (y - y_m).powi(2)
        };
        let derivatives = |parameter: f64| {
            let [[x, y], [x1, y1], [x2, y2], [x3, y3]] = self.spline.at(parameter);
            let (dx, dy) = (x - x_m, y - y_m);
            [
                dx * x1 + dy * y1,
                x1 * x1 + y1 * y1 + dx * x2 + dy * y2,
                3.0 * (x1 * x2 + y1 * y2) + dx * x3 + dy * y3,
            ]
        };
        let foot = |sample: usize| {
            let at = sample as f64 * step;
            minimum([at - step, at + step], at, derivatives)
        };
        let starts = self.grid.starts(x_m, y_m);
        if let [start] = starts {
            let (sample, _) = descended(usize::from(*start), count, square);
            return self.at_parameter(foot(sample));
        }
        let mut nearest = Nearest::none();
        let mut last = count;
        for start in starts {
            let (sample, sample_square) = descended(usize::from(*start), count, square);
            if sample == last || sample_square.sqrt() - self.spacing_m > nearest.distance_m {
                continue;
            }
            last = sample;
            let parameter = foot(sample);
            let [[x, y], ..] = self.spline.at(parameter);
            nearest.offer(parameter, (x - x_m).hypot(y - y_m));
        }
        self.at_parameter(nearest.parameter)
    }
}

impl fmt::Debug for ClosedPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let points_m: Vec<[f64; 2]> = self.spline.points().collect();
        f.debug_struct("ClosedPath")
            .field("points_m", &points_m)
            .finish_non_exhaustive()
    }
}

/// Walks to a local minimum along a cycle, and its value.
fn descended(start: usize, count: usize, value: impl Fn(usize) -> f64) -> (usize, f64) {
    let next = |i: usize| if i + 1 < count { i + 1 } else { 0 };
    let previous = |i: usize| if i > 0 { i - 1 } else { count - 1 };
    let least = value(start);
    let (ahead, least) = walked(start, least, next, &value);
    if ahead == start {
        walked(start, least, previous, &value)
    } else {
        (ahead, least)
    }
}

#[inline]
fn walked(
    mut at: usize,
    mut least: f64,
    neighbour: impl Fn(usize) -> usize,
    value: &impl Fn(usize) -> f64,
) -> (usize, f64) {
    loop {
        let there = neighbour(at);
        let square = value(there);
        if square < least {
            (at, least) = (there, square);
        } else {
            return (at, least);
        }
    }
}

/// How many distinct points there are, counted up to four.
fn distinct(points: &[[f64; 2]], coincide: impl Fn([f64; 2], [f64; 2]) -> bool) -> usize {
    let mut found: Vec<[f64; 2]> = Vec::with_capacity(4);
    for point in points {
        if found.len() < 4 && !found.iter().any(|other| coincide(*other, *point)) {
            found.push(*point);
        }
    }
    found.len()
}
