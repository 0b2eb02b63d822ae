//! One pass over all segments of a series that updates several recurrences at once, in memory proportional to the rows.

use std::ops::ControlFlow;

use rayon::prelude::*;

use crate::dynamic::walk::{LANES, Lanes, Walk, Walkable};
use crate::error::Error;

/// Starts that are handled together; where a minimum was found is remembered per chunk.
const CHUNK: usize = LANES;

/// Relative allowance for the rounding of bounds.
const ROUNDING: f64 = 1e-12;

/// Ends between which values depend on each other only through stored costs; the rest is done in parallel.
const BLOCK: usize = 512;

/// What is minimised over the segments `[l, r)`.
pub(crate) enum Recurrence<'a> {
    /// `E_k(r) = min_l E_{k−1}(l) + c(l, r)` for `k = 1 … rows`, `E_0(0) = 0`: thesis (3.18).
    Counted(usize),
    /// `F_λ(r) = min_l F_λ(l) + c(l, r) + λ`, `F_λ(0) = 0`, a row per `λ`.
    Penalised(&'a [f64]),
}

/// Gets the costs of the segments from the starts `l, l + 1, …` to the ends `first_end + 0, …, first_end + LANES − 1`,
/// and the table so far, in which the values at these starts are final.
pub(crate) type Visitor<'a> = dyn Fn(&Table, usize, usize, &[Lanes]) + Sync + 'a;

/// How far a long computation is, between 0 and 1; `Break` cancels it.
pub type Progress<'a> = dyn Fn(f64) -> ControlFlow<()> + Sync + 'a;

/// The values of a recurrence at all ends, and where their minima were found.
pub(crate) struct Table {
    len: usize,
    min_length: usize,
    /// 1 where a row takes its values from the row before, 0 where from itself.
    shift: usize,
    penalties: Vec<f64>,
    /// `[row][end]`, with the start row of a counted recurrence first; infinite where there is no segmentation.
    values: Vec<f64>,
    /// What values gain per sample on average, times `0 … CHUNK − 1`.
    tilt: [f64; CHUNK],
    /// The least of the values at the starts of each chunk, `[chunk][row]`.
    floors: Vec<f64>,
    /// The chunk of the start that gave the minimum, `[row][end]`; of several the first.
    origins: Vec<u32>,
}

impl Table {
    fn new(walkable: &Walkable<'_>, min_length: usize, recurrence: &Recurrence<'_>) -> Self {
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

    fn rows(&self) -> usize {
        self.penalties.len()
    }

    /// What row `row` reads at the starts `range`.
    fn source(&self, row: usize, range: std::ops::Range<usize>) -> &[f64] {
        let first = row * (self.len + 1);
        &self.values[first + range.start..first + range.end]
    }

    fn sources(&self) -> usize {
        self.penalties.len() + self.shift
    }

    /// A lower bound of what every row reads at the starts of a chunk.
    fn floors(&self, chunk: usize) -> &[f64] {
        &self.floors[chunk * self.sources()..][..self.rows()]
    }

    /// Takes note of the final values at the starts of a chunk.
    fn close_chunk(&mut self, chunk: usize) {
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

/// Runs the recurrence over the whole series, segments of at least `min_length` samples.
pub(crate) fn sweep(
    walkable: &Walkable<'_>,
    min_length: usize,
    recurrence: &Recurrence<'_>,
    visitor: Option<&Visitor<'_>>,
    progress: &Progress<'_>,
) -> Result<Table, Error> {
    let len = walkable.series().len();
    let mut table = Table::new(walkable, min_length, recurrence);
    for block in (0..=len).step_by(BLOCK) {
        let tiles: Vec<usize> = (block..(block + BLOCK).min(len + 1))
            .step_by(LANES)
            .collect();
        let finished: Vec<Tile> = tiles
            .par_iter()
            .map_init(
                || walkable.walk(),
                |walk, &first_end| {
                    vectorised(FromBefore {
                        table: &table,
                        walk,
                        first_end,
                        block,
                        visitor,
                    })
                },
            )
            .collect();
        for tile in finished {
            vectorised(Finish {
                tile,
                walkable,
                table: &mut table,
                block,
                visitor,
            });
        }
        let done = ((block + BLOCK).min(len) as f64 / len as f64).powi(2);
        if progress(done).is_break() {
            return Err(Error::Cancelled);
        }
    }
    Ok(table)
}

/// A kernel is compiled once per instruction set and run with the best that the processor has. Rust contracts no
/// multiplications and additions, so results do not depend on which.
pub(crate) fn vectorised<K: pulp::NullaryFnOnce>(kernel: K) -> K::Output {
    pulp::Arch::new().dispatch(kernel)
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

struct FromBefore<'a, 'b> {
    table: &'a Table,
    walk: &'a mut Walk<'b>,
    first_end: usize,
    block: usize,
    visitor: Option<&'a Visitor<'a>>,
}

impl pulp::NullaryFnOnce for FromBefore<'_, '_> {
    type Output = Tile;
    #[inline(always)]
    fn call(self) -> Tile {
        Tile::from_before(
            self.table,
            self.walk,
            self.first_end,
            self.block,
            self.visitor,
        )
    }
}

struct Finish<'a, 'b> {
    tile: Tile,
    walkable: &'a Walkable<'b>,
    table: &'a mut Table,
    block: usize,
    visitor: Option<&'a Visitor<'a>>,
}

impl pulp::NullaryFnOnce for Finish<'_, '_> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        self.tile
            .finish(self.walkable, self.table, self.block, self.visitor);
    }
}

/// First starts of the chunks of `lo..hi`.
fn chunk_starts(lo: usize, hi: usize) -> std::iter::StepBy<std::ops::Range<usize>> {
    (lo..hi).step_by(CHUNK)
}

/// The values at `LANES` ends while they are being found.
struct Tile {
    first_end: usize,
    /// Per row.
    best: Vec<Lanes>,
    origin: Vec<[u32; LANES]>,
    /// Costs of the segments that start in `block..first_end`.
    near: Vec<Lanes>,
}

impl Tile {
    /// All segments that start before `block`, where the table is final; the costs of later ones are kept.
    #[inline(always)]
    fn from_before(
        table: &Table,
        walk: &mut Walk<'_>,
        first_end: usize,
        block: usize,
        visitor: Option<&Visitor<'_>>,
    ) -> Self {
        let mut tile = Self {
            first_end,
            best: vec![Lanes::all(f64::INFINITY); table.rows()],
            origin: vec![[0; LANES]; table.rows()],
            near: vec![Lanes::all(0.0); first_end - block],
        };
        walk.begin(first_end);
        for lo in chunk_starts(block, first_end).rev() {
            let hi = (lo + CHUNK).min(first_end);
            walk.walk_to(lo, &mut tile.near[lo - block..hi - block]);
        }
        let mut costs = [Lanes::all(0.0); CHUNK];
        for lo in chunk_starts(0, block).rev() {
            walk.walk_to(lo, &mut costs);
            tile.take_chunk(table, lo, &mut costs, visitor, |found, best| found <= best);
        }
        tile
    }

    /// The segments that start in `block..`, given the values before this tile; puts the tile into the table.
    #[inline(always)]
    fn finish(
        mut self,
        walkable: &Walkable<'_>,
        table: &mut Table,
        block: usize,
        visitor: Option<&Visitor<'_>>,
    ) {
        let mut near = std::mem::take(&mut self.near);
        for (chunk, lo) in near
            .chunks_mut(CHUNK)
            .zip(chunk_starts(block, self.first_end))
        {
            self.take_chunk(table, lo, chunk, visitor, |found, best| found < best);
        }
        for j in 0..LANES.min(table.len + 1 - self.first_end) {
            let end = self.first_end + j;
            for l in self.first_end..(end + 1).saturating_sub(table.min_length) {
                let cost = walkable.between(l, end);
                self.take_one(table, cost, l, j);
                if let Some(visitor) = visitor {
                    let mut alone = Lanes::all(f64::INFINITY);
                    alone[j] = cost;
                    visitor(table, self.first_end, l, &[alone]);
                }
            }
            if end > 0 {
                for row in 0..table.rows() {
                    let at = row * (table.len + 1) + end;
                    table.values[at + table.shift * (table.len + 1)] =
                        self.best[row][j] + table.penalties[row];
                    table.origins[at] = self.origin[row][j];
                }
            }
        }
        table.close_chunk(self.first_end / CHUNK);
    }

    /// Improves the tile by the segments that start at `lo, lo + 1, …`.
    #[inline(always)]
    fn take_chunk(
        &mut self,
        table: &Table,
        lo: usize,
        costs: &mut [Lanes],
        visitor: Option<&Visitor<'_>>,
        better: impl Fn(f64, f64) -> bool,
    ) {
        let hi = lo + costs.len();
        if hi + table.min_length > self.first_end + 1 {
            forbid_short(costs, lo, self.first_end, table.min_length);
        }
        if let Some(visitor) = visitor {
            visitor(table, self.first_end, lo, costs);
        }
        let chunk = (lo / CHUNK) as u32;
        let mut least = Lanes::all(f64::INFINITY);
        for (cost, offset) in costs.iter().zip(&table.tilt) {
            for j in 0..LANES {
                let tilted = cost[j] + offset;
                least[j] = if tilted < least[j] { tilted } else { least[j] };
            }
        }
        for j in 0..LANES {
            least[j] -= ROUNDING * least[j];
        }
        for (row, floor) in table.floors(lo / CHUNK).iter().enumerate() {
            let mut hopeless = true;
            for j in 0..LANES {
                hopeless &= floor + least[j] > self.best[row][j];
            }
            if hopeless {
                continue;
            }
            let mut found = Lanes::all(f64::INFINITY);
            for (before, cost) in table.source(row, lo..hi).iter().zip(&*costs) {
                for j in 0..LANES {
                    let value = before + cost[j];
                    found[j] = if value < found[j] { value } else { found[j] };
                }
            }
            let (best, origin) = (&mut self.best[row], &mut self.origin[row]);
            for j in 0..LANES {
                let better = better(found[j], best[j]);
                best[j] = if better { found[j] } else { best[j] };
                origin[j] = if better { chunk } else { origin[j] };
            }
        }
    }

    /// Improves the tile by one segment that starts in it.
    fn take_one(&mut self, table: &Table, cost: f64, l: usize, lane: usize) {
        for row in 0..table.rows() {
            let value = table.values[row * (table.len + 1) + l] + cost;
            if value < self.best[row][lane] {
                self.best[row][lane] = value;
                self.origin[row][lane] = (l / CHUNK) as u32;
            }
        }
    }
}

/// Makes segments of less than `min_length` samples infinitely expensive.
fn forbid_short(costs: &mut [Lanes], lo: usize, first_end: usize, min_length: usize) {
    for (l, row) in (lo..).zip(costs) {
        for j in 0..LANES {
            if first_end + j < l + min_length {
                row[j] = f64::INFINITY;
            }
        }
    }
}
