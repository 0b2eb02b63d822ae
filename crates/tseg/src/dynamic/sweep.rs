//! One pass over all segments of a series that updates several recurrences at once, in memory proportional to the rows.

use std::ops::ControlFlow;

use rayon::prelude::*;

use crate::dynamic::lanes::{LANES, Lanes, vectorised};
use crate::dynamic::table::{CHUNK, ROUNDING, Recurrence, Table, chunk_starts};
use crate::dynamic::walk::{Walk, Walkable};
use crate::error::Error;

/// Ends between which values depend on each other only through stored costs; the rest is done in parallel.
const BLOCK: usize = 512;

/// Gets the costs of the segments from the starts `l, l + 1, …` to the ends `first_end + 0, …, first_end + LANES − 1`,
/// and the table so far, in which the values at these starts are final.
pub(crate) type Visitor<'a> = dyn Fn(&Table, usize, usize, &[Lanes]) + Sync + 'a;

/// How far a long computation is, between 0 and 1; `Break` cancels it.
pub type Progress<'a> = dyn Fn(f64) -> ControlFlow<()> + Sync + 'a;

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
        let inner = self.inner_costs(walkable, table.min_length);
        let lanes = LANES.min(table.len() + 1 - self.first_end);
        for row in 0..table.rows() {
            self.take_inner(table, row, &inner[..lanes]);
        }
        if let Some(visitor) = visitor {
            visitor(table, self.first_end, self.first_end, &inner[..lanes]);
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

    /// Costs of the segments that start and end in the tile.
    fn inner_costs(&self, walkable: &Walkable<'_>, min_length: usize) -> [Lanes; LANES] {
        let mut costs = [Lanes::all(f64::INFINITY); LANES];
        let ends = LANES.min(walkable.series().len() + 1 - self.first_end);
        for (l, row) in costs.iter_mut().enumerate() {
            for j in l + min_length..ends {
                row[j] = walkable.between(self.first_end + l, self.first_end + j);
            }
        }
        costs
    }

    /// Improves a row by the segments that start in the tile, and puts it into the table.
    #[inline(always)]
    fn take_inner(&mut self, table: &mut Table, row: usize, inner: &[Lanes]) {
        let (best, origin) = (&mut self.best[row], &mut self.origin[row]);
        let chunk = (self.first_end / CHUNK) as u32;
        for (l, costs) in inner.iter().enumerate() {
            let end = self.first_end + l;
            if end > 0 {
                table.put(row, end, best[l], origin[l]);
            }
            let before = table.source(row, end..end + 1)[0];
            for j in 0..LANES {
                let value = before + costs[j];
                let better = value < best[j];
                best[j] = if better { value } else { best[j] };
                origin[j] = if better { chunk } else { origin[j] };
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
