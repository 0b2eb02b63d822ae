use std::ops::Range;

/// Children of a node: a cache line of keys.
const ARITY: usize = 8;

type Node = [f64; ARITY];

/// Keys `0..n` under a tree of minima: a change and the leftmost minimum cost `O(log n)` each.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tournament {
    /// Level 0 holds the keys, each further one the minima of the nodes below it; the last has one node.
    levels: Vec<Vec<Node>>,
    /// How many levels are in use.
    height: usize,
}

impl Tournament {
    /// Starts over with `n` keys, all infinite.
    pub(crate) fn reset(&mut self, n: usize) {
        let mut nodes = n;
        self.height = 0;
        while nodes > 1 || self.height == 0 {
            nodes = nodes.div_ceil(ARITY).max(1);
            if self.levels.len() == self.height {
                self.levels.push(Vec::new());
            }
            let level = &mut self.levels[self.height];
            level.clear();
            level.resize(nodes, [f64::INFINITY; ARITY]);
            self.height += 1;
        }
    }

    /// Sets keys `first, first + 1, …` and rebuilds the minima.
    pub(crate) fn fill(&mut self, first: usize, keys: impl Iterator<Item = f64>) {
        let leaves = self.levels[0].as_flattened_mut();
        for (leaf, key) in leaves[first..].iter_mut().zip(keys) {
            *leaf = key;
        }
        for height in 1..self.height {
            let (below, level) = self.levels.split_at_mut(height);
            let minima = below[height - 1].iter().map(minimum);
            for (key, minimum) in level[0].as_flattened_mut().iter_mut().zip(minima) {
                *key = minimum;
            }
        }
    }

    /// Changes keys, given in ascending order.
    pub(crate) fn set<const N: usize>(&mut self, changes: [(usize, f64); N]) {
        let leaves = self.levels[0].as_flattened_mut();
        for (key, value) in changes {
            leaves[key] = value;
        }
        let mut places = changes.map(|(key, _)| key / ARITY);
        for height in 1..self.height {
            let (below, level) = self.levels.split_at_mut(height);
            let (below, level) = (&below[height - 1], level[0].as_flattened_mut());
            let mut done = usize::MAX;
            for place in &mut places {
                if *place != done {
                    done = *place;
                    level[done] = minimum(&below[done]);
                }
                *place /= ARITY;
            }
        }
    }

    /// The leftmost smallest key and its value, unless every key is infinite.
    pub(crate) fn leftmost_min(&self) -> Option<(usize, f64)> {
        let mut levels = self.levels[..self.height].iter().rev();
        let root = &levels.next()?[0];
        let value = minimum(root);
        let place = levels.fold(leftmost(root, value), |place, level| {
            place * ARITY + leftmost(&level[place], value)
        });
        value.is_finite().then_some((place, value))
    }

    pub(crate) fn all_finite(&self, mut keys: Range<usize>) -> bool {
        let leaves = self.levels[0].as_flattened();
        keys.all(|key| leaves[key].is_finite())
    }
}

/// Keys are never NaN, so a plain comparison does, which is one instruction.
fn less(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

fn minimum(node: &Node) -> f64 {
    let [a, b, c, d, e, f, g, h] = *node;
    let quads = [less(a, e), less(b, f), less(c, g), less(d, h)];
    less(less(quads[0], quads[2]), less(quads[1], quads[3]))
}

/// Place of the first key that is `value`, the minimum of the node, by halves and without a branch.
fn leftmost(node: &Node, value: f64) -> usize {
    let [a, b, c, d, ..] = *node;
    let above = |place: usize| usize::from(node[place % ARITY] > value);
    let half = 4 * usize::from(less(less(a, b), less(c, d)) > value);
    let pair = half + 2 * (above(half) & above(half + 1));
    pair + above(pair)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_go_to_the_left() {
        for n in [5, 8, 9, 64, 65, 700] {
            let mut keys = Tournament::default();
            keys.reset(n);
            assert_eq!(keys.leftmost_min(), None);
            keys.fill(1, [3.0, 2.0, 2.0, 7.0].into_iter());
            assert_eq!(keys.leftmost_min(), Some((2, 2.0)));
            keys.set([(2, f64::INFINITY)]);
            assert_eq!(keys.leftmost_min(), Some((3, 2.0)));
            keys.set([(1, 2.0), (3, 2.5)]);
            assert_eq!(keys.leftmost_min(), Some((1, 2.0)));
            keys.set([(1, 1.0), (n - 1, 0.5)]);
            assert_eq!(keys.leftmost_min(), Some((n - 1, 0.5)));
        }
    }
}
