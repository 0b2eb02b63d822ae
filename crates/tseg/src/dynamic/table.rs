//! The values of a recurrence over all segments, and the segmentation behind each.

use std::iter::StepBy;
use std::ops::Range;

use crate::dynamic::lanes::{LANES, Lanes, vectorised};
use crate::dynamic::walk::{Walk, Walkable};

/// Starts that are handled together; where a minimum was found is remembered per chunk.
pub(crate) const CHUNK: usize = LANES;

/// Relative allowance for the rounding of bounds.
pub(crate) const ROUNDING: f64 = 1e-12;

/// What is minimised over the segments `[l, r)`.
pub(crate) enum Recurrence<'a> {
    /// `E_k(r) = min_l E_{k−1}(l) + c(l, r)` for `k = 1 … rows`, `E_0(0) = 0`: thesis (3.18).
    Counted(usize),
    /// `F_λ(r) = min_l F_λ(l) + c(l, r) + λ`, `F_λ(0) = 0`, a row per `λ`.
    Penalised(&'a [f64]),
}

/// The values of a recurrence at all ends, and where their minima were found.
pub(crate) struct Table {
    len: usize,
    pub(crate) min_length: usize,
    /// 1 where a row takes its values from the row before, 0 where from itself.
    shift: usize,
    penalties: Vec<f64>,
    /// `[row][end]`, with the start row of a counted recurrence first; infinite where there is no segmentation.
    values: Vec<f64>,
    /// What values gain per sample on average, times `0 … CHUNK − 1`.
    pub(crate) tilt: [f64; CHUNK],
    /// The least of the values at the starts of each chunk, `[chunk][row]`.
    floors: Vec<f64>,
    /// The chunk of the start that gave the minimum, `[row][end]`; of several the first.
    origins: Vec<u32>,
}

impl Table {
    pub(crate) fn new(
        walkable: &Walkable<'_>,
        min_length: usize,
        recurrence: &Recurrence<'_>,
    ) -> Self {
        let len = walkable.series().len();
        let slope = walkable.between(0, len) / len as f64;
        let (shift, penalties) = match *recurrence {
            Recurrence::Counted(rows) => (1, vec![0.0; rows]),
            Recurrence::Penalised(penalties) => (0, penalties.to_vec()),
        };
        let sources = penalties.len() + shift;
        let mut values = vec![f64::INFINITY; sources * (len + 1)];
        let starts = if shift == 1 { 1 } else { sources };
        for row in 0..starts {
            values[row * (len + 1)] = 0.0;
        }
        Self {
            len,
            min_length,
            shift,
            tilt: std::array::from_fn(|t| slope * t as f64),
            origins: vec![0; penalties.len() * (len + 1)],
            floors: vec![f64::INFINITY; sources * (len / CHUNK + 1)],
            penalties,
            values,
        }
    }

    pub(crate) fn rows(&self) -> usize {
        self.penalties.len()
    }

    /// What row `row` reads at the starts `range`.
    pub(crate) fn source(&self, row: usize, range: Range<usize>) -> &[f64] {
        let first = row * (self.len + 1);
        &self.values[first + range.start..first + range.end]
    }

    fn sources(&self) -> usize {
        self.penalties.len() + self.shift
    }

    /// A lower bound of what every row reads at the starts of a chunk.
    pub(crate) fn floors(&self, chunk: usize) -> &[f64] {
        &self.floors[chunk * self.sources()..][..self.rows()]
    }

    /// Puts in the final value of a row at `end`, and where it comes from.
    pub(crate) fn put(&mut self, row: usize, end: usize, best: f64, origin: u32) {
        let width = self.len + 1;
        self.values[(row + self.shift) * width + end] = best + self.penalties[row];
        self.origins[row * width + end] = origin;
    }

    /// Takes note of the final values at the starts of a chunk.
    pub(crate) fn close_chunk(&mut self, chunk: usize) {
        let starts = chunk * CHUNK..(chunk * CHUNK + CHUNK).min(self.len + 1);
        let sources = self.sources();
        for row in 0..sources {
            let tilted = self
                .source(row, starts.clone())
                .iter()
                .zip(&self.tilt)
                .map(|(value, offset)| value - offset);
            let floor = tilted.fold(f64::INFINITY, f64::min);
            let floor = floor - ROUNDING * floor.abs();
            self.floors[chunk * sources + row] = floor;
        }
    }

    /// Number of samples.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// The value of row `row`, counted from 0, at `end`.
    pub(crate) fn value(&self, row: usize, end: usize) -> f64 {
        self.values[(row + self.shift) * (self.len + 1) + end]
    }

    /// The segmentation behind `value(row, len)`, as boundaries; of several optima the one whose last segment starts
    /// first, recursively. There must be one.
    pub(crate) fn boundaries(&self, walkable: &Walkable<'_>, row: usize) -> Vec<usize> {
        let mut walk = walkable.walk();
        let mut boundaries = vec![self.len];
        let (mut row, mut end) = (row, self.len);
        while end > 0 {
            end = self.start_of_last(walkable, &mut walk, row, end);
            boundaries.push(end);
            row = row.saturating_sub(self.shift);
        }
        boundaries.reverse();
        boundaries
    }

    fn start_of_last(
        &self,
        walkable: &Walkable<'_>,
        walk: &mut Walk<'_>,
        row: usize,
        end: usize,
    ) -> usize {
        let first_end = end / LANES * LANES;
        let origin = self.origins[row * (self.len + 1) + end] as usize;
        let chunk = origin * CHUNK..((origin + 1) * CHUNK).min(end + 1 - self.min_length);
        let mut best = (f64::INFINITY, chunk.start);
        let mut consider = |l: usize, cost: f64| {
            let value = self.values[row * (self.len + 1) + l] + cost;
            if value < best.0 {
                best = (value, l);
            }
        };
        if chunk.start < first_end {
            let mut costs = [Lanes::all(0.0); CHUNK];
            walk.begin(first_end);
            for lo in chunk_starts(0, first_end).rev() {
                let hi = (lo / CHUNK * CHUNK + CHUNK).min(first_end);
                vectorised(WalkTo {
                    walk,
                    lo,
                    costs: &mut costs[..hi - lo],
                });
                if lo <= chunk.start {
                    break;
                }
            }
            for l in chunk.start..chunk.end.min(first_end) {
                consider(l, costs[l - chunk.start][end - first_end]);
            }
        }
        for l in chunk.start.max(first_end)..chunk.end {
            consider(l, walkable.between(l, end));
        }
        best.1
    }
}

struct WalkTo<'a, 'b> {
    walk: &'a mut Walk<'b>,
    lo: usize,
    costs: &'a mut [Lanes],
}

impl pulp::NullaryFnOnce for WalkTo<'_, '_> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        self.walk.walk_to(self.lo, self.costs);
    }
}

/// First starts of the chunks of `lo..hi`.
pub(crate) fn chunk_starts(lo: usize, hi: usize) -> StepBy<Range<usize>> {
    (lo..hi).step_by(CHUNK)
}
