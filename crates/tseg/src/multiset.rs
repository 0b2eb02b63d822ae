/// Samples without their order: distinct values, smallest first, each with how often it occurs.
///
/// A dead-banded signal at rest is one value, however long.
#[derive(Debug, Clone, Default)]
pub(crate) struct Multiset {
    values: Vec<(f64, usize)>,
    count: usize,
}

impl Multiset {
    pub(crate) fn new(samples: &[f64]) -> Self {
        let mut values: Vec<(f64, usize)> = samples.iter().map(|&x| (x, 1)).collect();
        values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut multiset = Self {
            values,
            count: samples.len(),
        };
        multiset.unite_equal();
        multiset
    }

    pub(crate) fn count(&self) -> usize {
        self.count
    }

    pub(crate) fn values(&self) -> &[(f64, usize)] {
        &self.values
    }

    /// Takes in the samples of another one.
    pub(crate) fn add(&mut self, other: &Self) {
        self.values.extend(&other.values);
        // Of two sorted runs one after the other, a stable sort makes a linear merge.
        self.values.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.count += other.count;
        self.unite_equal();
    }

    fn unite_equal(&mut self) {
        self.values.dedup_by(|next, kept| {
            let equal = next.0.total_cmp(&kept.0).is_eq();
            kept.1 += if equal { next.1 } else { 0 };
            equal
        });
    }
}
