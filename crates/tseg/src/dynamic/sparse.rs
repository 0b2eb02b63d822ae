//! Exact segmentation into `k` segments where only some segments are allowed.

use std::ops::Range;

/// One allowed segment with its cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cell {
    pub(crate) start: u32,
    pub(crate) end: u32,
    pub(crate) cost: f64,
}

/// Allowed segments, ordered by end and start, each once.
pub(crate) struct Cells {
    cells: Vec<Cell>,
    /// Starts and ends in order; the recurrence has a row for each.
    nodes: Vec<u32>,
    /// Per node, the cells that end there.
    into: Vec<Range<usize>>,
}

impl Cells {
    pub(crate) fn new(mut cells: Vec<Cell>) -> Self {
        cells.sort_unstable_by_key(|cell| (cell.end, cell.start));
        cells.dedup_by_key(|cell| (cell.end, cell.start));
        let mut nodes: Vec<u32> = cells
            .iter()
            .flat_map(|cell| [cell.start, cell.end])
            .collect();
        nodes.sort_unstable();
        nodes.dedup();
        let into = nodes
            .iter()
            .map(|node| {
                cells.partition_point(|cell| cell.end < *node)
                    ..cells.partition_point(|cell| cell.end <= *node)
            })
            .collect();
        Self { cells, nodes, into }
    }

    /// Number of values that [`Self::best`] holds.
    pub(crate) fn size(&self, segments: usize) -> usize {
        self.nodes.len().saturating_mul(segments + 1)
    }

    /// The cheapest segmentation from the first node to the last with exactly the given number of segments, or with at
    /// most that: cost and boundaries. Of several the fewest segments, then the smallest start of the last, recursively.
    pub(crate) fn best(&self, segments: usize, at_most: bool) -> Option<(f64, Vec<usize>)> {
        let width = segments + 1;
        let mut values = vec![f64::INFINITY; self.nodes.len() * width];
        *values.first_mut()? = 0.0;
        for node in 1..self.nodes.len() {
            let (before, row) = values.split_at_mut(node * width);
            for cell in &self.cells[self.into[node].clone()] {
                let start = self.node(cell.start) * width;
                // One segment more than at the start of this one.
                for (value, before) in row[1..width]
                    .iter_mut()
                    .zip(&before[start..start + segments])
                {
                    let through = before + cell.cost;
                    *value = if through < *value { through } else { *value };
                }
            }
        }
        let last = &values[(self.nodes.len() - 1) * width..];
        let fewest = if at_most { 1 } else { segments };
        let count = (fewest..=segments).min_by(|&a, &b| last[a].total_cmp(&last[b]))?;
        let cost = last[count];
        cost.is_finite()
            .then(|| (cost, self.trace(&values, width, count)))
    }

    fn trace(&self, values: &[f64], width: usize, mut count: usize) -> Vec<usize> {
        let mut node = self.nodes.len() - 1;
        let mut boundaries = vec![self.nodes[node] as usize];
        while count > 0 {
            let through =
                |cell: &&Cell| values[self.node(cell.start) * width + count - 1] + cell.cost;
            let best = self.cells[self.into[node].clone()]
                .iter()
                .min_by(|a, b| through(a).total_cmp(&through(b)));
            let Some(best) = best else { break };
            boundaries.push(best.start as usize);
            node = self.node(best.start);
            count -= 1;
        }
        boundaries.reverse();
        boundaries
    }

    /// Index of the node at a sample that is one.
    fn node(&self, sample: u32) -> usize {
        self.nodes.partition_point(|&node| node < sample)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

    fn cells(list: &[(u32, u32, f64)]) -> Cells {
        Cells::new(
            list.iter()
                .map(|&(start, end, cost)| Cell { start, end, cost })
                .collect(),
        )
    }

    #[test]
    fn takes_the_cheapest_path_of_the_length_asked() {
        let cells = cells(&[
            (0, 4, 9.0),
            (2, 4, 1.0),
            (0, 2, 3.0),
            (0, 1, 1.0),
            (1, 2, 4.0),
            (0, 2, 3.0),
            (1, 4, 8.0),
        ]);
        assert_eq!(cells.best(1, false), Some((9.0, vec![0, 4])));
        assert_eq!(cells.best(2, false), Some((4.0, vec![0, 2, 4])));
        assert_eq!(cells.best(3, false), Some((6.0, vec![0, 1, 2, 4])));
        assert_eq!(cells.best(4, false), None);
        assert_eq!(cells.best(4, true), Some((4.0, vec![0, 2, 4])));
    }

    #[test]
    fn of_equals_the_last_segment_starts_first() {
        let cells = cells(&[(0, 1, 1.0), (0, 2, 1.0), (1, 3, 1.0), (2, 3, 1.0)]);
        assert_eq!(cells.best(2, false), Some((2.0, vec![0, 1, 3])));
        assert_eq!(Cells::new(Vec::new()).best(1, false), None);
    }
}
