use std::ops::Range;

/// Keys `0..n` under a binary tree of minima: a change and the leftmost minimum cost `O(log n)` each.
#[derive(Debug, Default)]
pub(crate) struct Tournament {
    /// Node `k` has the children `2k` and `2k + 1`; the root is node 1, the leaves are the second half.
    nodes: Vec<f64>,
}

impl Tournament {
    /// Starts over with `n` keys, all infinite.
    pub(crate) fn reset(&mut self, n: usize) {
        self.nodes.clear();
        self.nodes.resize(2 * n.next_power_of_two(), f64::INFINITY);
    }

    /// Sets keys `first, first + 1, …` and rebuilds the minima.
    pub(crate) fn fill(&mut self, first: usize, keys: impl Iterator<Item = f64>) {
        let leaves = self.nodes.len() / 2;
        for (leaf, key) in self.nodes[leaves + first..].iter_mut().zip(keys) {
            *leaf = key;
        }
        for node in (1..leaves).rev() {
            self.nodes[node] = self.nodes[2 * node].min(self.nodes[2 * node + 1]);
        }
    }

    pub(crate) fn set(&mut self, key: usize, value: f64) {
        let mut node = self.nodes.len() / 2 + key;
        self.nodes[node] = value;
        while node > 1 {
            node /= 2;
            self.nodes[node] = self.nodes[2 * node].min(self.nodes[2 * node + 1]);
        }
    }

    pub(crate) fn all_finite(&self, keys: Range<usize>) -> bool {
        let leaves = self.nodes.len() / 2;
        keys.into_iter()
            .all(|key| self.nodes[leaves + key].is_finite())
    }

    /// The leftmost smallest key and its value, unless every key is infinite.
    pub(crate) fn leftmost_min(&self) -> Option<(usize, f64)> {
        let leaves = self.nodes.len() / 2;
        let mut node = 1;
        while node < leaves {
            node = 2 * node + usize::from(self.nodes[2 * node] > self.nodes[2 * node + 1]);
        }
        let value = self.nodes[node];
        value.is_finite().then_some((node - leaves, value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_go_to_the_left() {
        let mut keys = Tournament::default();
        keys.reset(5);
        assert_eq!(keys.leftmost_min(), None);
        keys.fill(1, [3.0, 2.0, 2.0, 7.0].into_iter());
        assert_eq!(keys.leftmost_min(), Some((2, 2.0)));
        keys.set(2, f64::INFINITY);
        assert_eq!(keys.leftmost_min(), Some((3, 2.0)));
        keys.set(1, 2.0);
        assert_eq!(keys.leftmost_min(), Some((1, 2.0)));
    }
}
