//! Where a path comes so near to itself that bodies on both branches touch: at crossings, and where it runs beside itself.

use crate::path::Path;

/// Samples of the path at most, and their spacing as a share of what is near.
const MOST_SAMPLES: f64 = 2048.0;
const SPACING: f64 = 0.25;
/// Along the path two places are apart by more than half a circle of this diameter, in what is near: a bend is no crossing.
const APART: f64 = std::f64::consts::PI;

/// A part of a closed path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Where it begins, in m along the path
    pub from_m: f64,
    /// In m
    pub length_m: f64,
}

/// Two parts of a path, on which only one of two robots can be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Both parts
    pub branches: [Span; 2],
    /// Between their directions where they are nearest to each other, in rad
    pub angle_rad: f64,
}

impl Crossing {
    /// All of a path whose branches come nearer than `near_m` to each other; none of open paths.
    #[must_use]
    pub fn all(path: &Path, near_m: f64) -> Vec<Self> {
        let Some(length_m) = path.length_m() else {
            return Vec::new();
        };
        let count = (length_m / (SPACING * near_m)).ceil().min(MOST_SAMPLES) as usize;
        let step_m = length_m / count as f64;
        let apart = (APART * near_m / step_m).ceil() as usize;
        let places: Vec<[f64; 2]> = (0..count)
            .map(|sample| path.at(sample as f64 * step_m))
            .map(|point| [point.x_m, point.y_m])
            .collect();
        let square = |[i, j]: [usize; 2]| {
            (places[i][0] - places[j][0]).powi(2) + (places[i][1] - places[j][1]).powi(2)
        };
        let mut hits: Vec<[usize; 2]> = Vec::new();
        for i in 0..count {
            let beyond = i + apart..count.min((i + count).saturating_sub(apart));
            hits.extend(
                beyond
                    .map(|j| [i, j])
                    .filter(|hit| square(*hit) < near_m * near_m),
            );
        }
        clusters(hits, count, square)
            .into_iter()
            .map(|([first, second], middle)| {
                let span = |[from, to]: [isize; 2]| Span {
                    from_m: (from - 1).rem_euclid(count as isize) as f64 * step_m,
                    length_m: (to - from + 2) as f64 * step_m,
                };
                let [a, b] = middle.map(|sample| path.at(sample as f64 * step_m).tangent);
                Self {
                    branches: [span(first), span(second)],
                    angle_rad: (a[0] * b[0] + a[1] * b[1]).clamp(-1.0, 1.0).acos(),
                }
            })
            .collect()
    }
}

impl Span {
    /// How far a place is past the beginning, in m, from minus half a lap on.
    #[must_use]
    pub fn past_m(&self, path: &Path, s_m: f64) -> f64 {
        let past_m = path.distance_along_m(self.from_m, s_m);
        let lap_m = path.length_m().unwrap_or(f64::INFINITY);
        if past_m > 0.5 * (lap_m + self.length_m) {
            past_m - lap_m
        } else {
            past_m
        }
    }

    /// Whether a place is within.
    #[must_use]
    pub fn contains(&self, path: &Path, s_m: f64) -> bool {
        path.distance_along_m(self.from_m, s_m) <= self.length_m
    }
}

/// Groups of neighbouring hits, each by its least and largest indices on both branches, which go on beyond the end of the path, and by
/// its nearest hit.
fn clusters(
    mut hits: Vec<[usize; 2]>,
    count: usize,
    square: impl Fn([usize; 2]) -> f64,
) -> Vec<([[isize; 2]; 2], [usize; 2])> {
    let mut found = Vec::new();
    let lap = count as isize;
    while let Some(start) = hits.pop() {
        let [i, j] = start.map(|index| index as isize);
        let (mut bounds, mut nearest) = ([[i, i], [j, j]], start);
        let mut open = vec![[i, j]];
        while let Some([i, j]) = open.pop() {
            hits.retain(|hit| {
                let Some(near) = beside([i, j], *hit, lap) else {
                    return true;
                };
                for (bound, index) in bounds.iter_mut().zip(near) {
                    *bound = [bound[0].min(index), bound[1].max(index)];
                }
                if square(*hit) < square(nearest) {
                    nearest = *hit;
                }
                open.push(near);
                false
            });
        }
        found.push((bounds, nearest));
    }
    found
}

/// The indices of a hit that is a neighbour, on the laps on which it is; both branches may have changed places.
fn beside([i, j]: [isize; 2], hit: [usize; 2], lap: isize) -> Option<[isize; 2]> {
    let [a, b] = hit.map(|index| index as isize);
    let nearest = |from: isize, to: isize| {
        let by = (to - from).rem_euclid(lap);
        let by = if 2 * by > lap { by - lap } else { by };
        (by.abs() <= 2).then_some(from + by)
    };
    let same = || Some([nearest(i, a)?, nearest(j, b)?]);
    let swapped = || Some([nearest(i, b)?, nearest(j, a)?]);
    same().or_else(swapped)
}
