//! Where a path comes so near to itself that bodies on both branches touch: at crossings, and where it runs beside itself.

use std::collections::{HashMap, HashSet};

use crate::error::Error;
use crate::path::Path;
use crate::path::Span;

/// Samples of the path at most, and their spacing as a share of what is near. Longer paths are sampled more coarsely, and what is near
/// is then more: no robot drives so far within a day.
const MOST_SAMPLES: f64 = 524_288.0;
const SPACING: f64 = 0.25;
/// Pairs of samples that are near to each other at most.
const MOST_HITS: usize = 1 << 22;
/// Hits that are no farther apart on either branch, in samples, belong together.
const TOGETHER: isize = 2;

/// Two parts of a path, on which only one of two robots can be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Both parts
    pub branches: [Span; 2],
    /// Between their directions where they are nearest to each other, in rad
    pub angle_rad: f64,
}

impl Crossing {
    /// All of a path whose branches come nearer than `near_m` to each other, at places that are at least `apart_m` from each other
    /// along it: a bend is no crossing. None of open paths.
    ///
    /// # Errors
    ///
    /// A path that lies upon itself too often.
    pub fn all(path: &Path, near_m: f64, apart_m: f64) -> Result<Vec<Self>, Error> {
        let Some(length_m) = path.length_m() else {
            return Ok(Vec::new());
        };
        let count = (length_m / (SPACING * near_m)).ceil().min(MOST_SAMPLES) as usize;
        let samples = Samples::new(path, count, length_m / count as f64);
        let hits = samples.hits(near_m, apart_m)?;
        let clusters = clusters(hits, count, |pair| samples.square_m2(pair));
        let crossing = |cluster| samples.crossing(path, cluster);
        Ok(clusters.iter().map(crossing).collect())
    }
}

/// Places of a path at equal steps.
struct Samples {
    step_m: f64,
    places: Vec<[f64; 2]>,
}

/// Neighbouring hits: the least and largest indices on both branches, which go on beyond the end of the path, and the nearest hit.
struct Cluster {
    bounds: [[isize; 2]; 2],
    nearest: Hit,
}

/// Samples that are near to each other, the first before the second.
type Hit = [u32; 2];

impl Samples {
    fn new(path: &Path, count: usize, step_m: f64) -> Self {
        let points = (0..count).map(|sample| path.at(sample as f64 * step_m));
        let places = points.map(|point| [point.x_m, point.y_m]).collect();
        Self { step_m, places }
    }

    fn square_m2(&self, pair: Hit) -> f64 {
        let [[ax, ay], [bx, by]] = pair.map(|sample| self.places[sample as usize]);
        (ax - bx).powi(2) + (ay - by).powi(2)
    }

    /// In order. Only what lies in neighbouring cells of a grid is compared.
    fn hits(&self, near_m: f64, apart_m: f64) -> Result<Vec<Hit>, Error> {
        let coarse = self.step_m > 1.01 * SPACING * near_m;
        let near_m = if coarse { near_m + self.step_m } else { near_m };
        let (count, apart) = (self.places.len(), (apart_m / self.step_m).ceil() as usize);
        let ways = apart..count.saturating_sub(apart);
        let is_hit = |pair: &Hit| {
            let [a, b] = *pair;
            ways.contains(&((b - a) as usize)) && self.square_m2(*pair) < near_m * near_m
        };
        let mut cells = HashMap::<[i64; 2], Vec<u32>>::new();
        let mut hits = Vec::new();
        for (sample, place) in (0..).zip(&self.places) {
            let [column, row] = place.map(|metres| (metres / near_m).floor() as i64);
            for [dx, dy] in NEIGHBOURS {
                let earlier = cells.get(&[column + dx, row + dy]).into_iter().flatten();
                hits.extend(earlier.map(|other| [*other, sample]).filter(is_hit));
            }
            if hits.len() > MOST_HITS {
                return Err(self.too_often(near_m));
            }
            cells.entry([column, row]).or_default().push(sample);
        }
        hits.sort_unstable();
        Ok(hits)
    }

    fn too_often(&self, near_m: f64) -> Error {
        let length_m = self.step_m * self.places.len() as f64;
        Error::DoesNotFit {
            what: format!(
                "the path of {length_m:.0} m comes nearer than {near_m:.3} m to itself too often to find out where; does it go round many times? give one lap of it"
            ),
        }
    }

    fn crossing(&self, path: &Path, cluster: &Cluster) -> Crossing {
        let count = self.places.len() as isize;
        let branches = cluster.bounds.map(|[from, to]| Span {
            from_m: (from - 1).rem_euclid(count) as f64 * self.step_m,
            length_m: (to - from + 2) as f64 * self.step_m,
        });
        let tangents = cluster
            .nearest
            .map(|sample| path.at(f64::from(sample) * self.step_m).tangent);
        let [a, b] = tangents;
        Crossing {
            branches,
            angle_rad: (a[0] * b[0] + a[1] * b[1]).clamp(-1.0, 1.0).acos(),
        }
    }
}

/// A cell and those around it.
#[rustfmt::skip]
const NEIGHBOURS: [[i64; 2]; 9] = [
    [-1, -1], [-1, 0], [-1, 1], [0, -1], [0, 0], [0, 1], [1, -1], [1, 0], [1, 1],
];

/// Groups of neighbouring hits.
fn clusters(mut hits: Vec<Hit>, count: usize, square_m2: impl Fn(Hit) -> f64) -> Vec<Cluster> {
    let mut left: HashSet<Hit> = hits.iter().copied().collect();
    let mut found = Vec::new();
    while let Some(start) = hits.pop() {
        if !left.remove(&start) {
            continue;
        }
        let [i, j] = start.map(|index| index as isize);
        let mut cluster = Cluster {
            bounds: [[i, i], [j, j]],
            nearest: start,
        };
        let mut open = vec![[i, j]];
        while let Some(place) = open.pop() {
            for near in around(place) {
                let hit = hit(near, count);
                if !left.remove(&hit) {
                    continue;
                }
                for (bound, index) in cluster.bounds.iter_mut().zip(near) {
                    *bound = [bound[0].min(index), bound[1].max(index)];
                }
                if square_m2(hit) < square_m2(cluster.nearest) {
                    cluster.nearest = hit;
                }
                open.push(near);
            }
        }
        found.push(cluster);
    }
    found
}

/// Pairs of indices beside a pair.
fn around([i, j]: [isize; 2]) -> impl Iterator<Item = [isize; 2]> {
    let steps = || -TOGETHER..=TOGETHER;
    steps().flat_map(move |di| steps().map(move |dj| [i + di, j + dj]))
}

/// The hit of two indices that may go on beyond the end of the path; both branches may have changed places.
fn hit(pair: [isize; 2], count: usize) -> Hit {
    let [a, b] = pair.map(|index| index.rem_euclid(count as isize) as u32);
    [a.min(b), a.max(b)]
}
