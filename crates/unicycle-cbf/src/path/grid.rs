//! Which samples of a closed curve the search for the nearest point has to start from.

/// Cells along each axis.
const CELLS: usize = 64;

/// The grid reaches this share of the curve's larger extent beyond it on each side.
const MARGIN: f64 = 0.25;

/// Starts per cell at most.
const STARTS: usize = 8;

/// Cells over the bounding box of a curve and a margin, each with its starts.
#[derive(Clone, PartialEq)]
pub(super) struct Grid {
    lower: [f64; 2],
    cells_per_m: [f64; 2],
    cells: Vec<Starts>,
}

#[derive(Clone, Copy, PartialEq, Default)]
struct Starts {
    count: u8,
    samples: [u16; STARTS],
}

impl Grid {
    /// The grid of at most 65536 samples of a curve, at most `spacing_m` apart along it.
    pub(super) fn new(samples: &[[f64; 2]], spacing_m: f64) -> Self {
        let range = |axis: usize| {
            let values = samples.iter().map(|sample| sample[axis]);
            let lower = values.clone().fold(f64::INFINITY, f64::min);
            (lower, values.fold(f64::NEG_INFINITY, f64::max) - lower)
        };
        let ((x, width), (y, height)) = (range(0), range(1));
        let margin = MARGIN * width.max(height);
        let lower = [x - margin, y - margin];
        let pitch = [width, height].map(|side| (side + 2.0 * margin) / CELLS as f64);
        // To the centre of a cell from any of its points, and back.
        let across_m = pitch[0].hypot(pitch[1]);
        let count = samples.len();
        let bends: Vec<f64> = (0..count)
            .map(|i| {
                [
                    samples[(i + count - 1) % count],
                    samples[i],
                    samples[(i + 1) % count],
                ]
            })
            .map(|[a, b, c]| (a[0] - 2.0 * b[0] + c[0]).hypot(a[1] - 2.0 * b[1] + c[1]))
            .collect();
        let mut squares = vec![0.0; samples.len()];
        let mut cells = Vec::with_capacity(CELLS * CELLS);
        for row in 0..CELLS {
            let cy = lower[1] + (row as f64 + 0.5) * pitch[1];
            for column in 0..CELLS {
                let cx = lower[0] + (column as f64 + 0.5) * pitch[0];
                for (square, [x, y]) in squares.iter_mut().zip(samples) {
                    *square = (x - cx) * (x - cx) + (y - cy) * (y - cy);
                }
                cells.push(Starts::new(&squares, &bends, across_m, spacing_m));
            }
        }
        Self {
            lower,
            cells_per_m: pitch.map(|side| 1.0 / side),
            cells,
        }
    }

    /// The samples to start from, of the nearest cell for a point outside of the grid.
    pub(super) fn starts(&self, x_m: f64, y_m: f64) -> &[u16] {
        let index = |axis: usize, value: f64| {
            let place = (value - self.lower[axis]) * self.cells_per_m[axis];
            (place as usize).min(CELLS - 1)
        };
        let starts = &self.cells[index(1, y_m) * CELLS + index(0, x_m)];
        &starts.samples[..usize::from(starts.count)]
    }
}

impl Starts {
    /// From the squared distances of the samples to the centre of a cell, and the lengths of their second differences.
    ///
    /// Candidates are the samples that can be the nearest in the cell, which is `across_m` from corner to corner. Starts are
    /// their local minima and, if the squared distance to some point of the cell is not convex there, the ends of their runs.
    fn new(squares: &[f64], bends: &[f64], across_m: f64, spacing_m: f64) -> Self {
        let count = squares.len();
        let bound = (smallest(squares).sqrt() + across_m + spacing_m).powi(2);
        let candidates: Vec<(usize, [f64; 3])> = (0..count)
            .filter(|i| squares[*i] <= bound)
            .map(|i| {
                let before = if i > 0 { i - 1 } else { count - 1 };
                let after = if i + 1 < count { i + 1 } else { 0 };
                (i, [squares[before], squares[i], squares[after]])
            })
            .collect();
        let convex = candidates
            .iter()
            .all(|(i, [before, here, after])| before - 2.0 * here + after > across_m * bends[*i]);
        let mut starts = Self::default();
        for (i, [before, here, after]) in candidates {
            let minimum = here <= before && here < after;
            if minimum || !convex && before.max(after) > bound {
                starts.insert(i, squares);
            }
        }
        starts
    }

    fn insert(&mut self, sample: usize, squares: &[f64]) {
        let count = usize::from(self.count);
        let place = self.samples[..count]
            .iter()
            .position(|other| squares[sample] < squares[usize::from(*other)])
            .unwrap_or(count);
        if place < STARTS {
            self.samples[place..].rotate_right(1);
            self.samples[place] = sample as u16;
            self.count = (self.count + 1).min(STARTS as u8);
        }
    }
}

/// The least of some values, by lanes, which the compiler makes vectors of.
fn smallest(values: &[f64]) -> f64 {
    let (chunks, rest) = values.as_chunks::<16>();
    let mut lanes = [f64::INFINITY; 16];
    for chunk in chunks {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane = if value < lane { *value } else { *lane };
        }
    }
    lanes
        .iter()
        .chain(rest)
        .copied()
        .fold(f64::INFINITY, f64::min)
}
