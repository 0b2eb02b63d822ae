//! A set of small numbers that finds neighbours fast.

/// Which of the distinct values of a variable occur, one bit each.
pub(crate) struct RankSet {
    words: Vec<u64>,
}

impl RankSet {
    /// An empty set of ranks below `count`.
    pub(crate) fn new(count: usize) -> Self {
        Self {
            words: vec![0; count.div_ceil(64)],
        }
    }

    #[inline(always)]
    pub(crate) fn insert(&mut self, rank: usize) {
        self.words[rank / 64] |= 1 << (rank % 64);
    }

    /// Removes a rank, and perhaps some near it.
    #[inline(always)]
    pub(crate) fn clear_near(&mut self, rank: usize) {
        self.words[rank / 64] = 0;
    }

    /// The smallest member above `rank`.
    #[inline(always)]
    pub(crate) fn next_above(&self, rank: usize) -> Option<usize> {
        let mut word = rank / 64;
        // Two shifts, as one by 64 is not defined.
        let mut bits = self.words[word] & (u64::MAX << (rank % 64) << 1);
        while bits == 0 {
            word += 1;
            bits = *self.words.get(word)?;
        }
        Some(64 * word + bits.trailing_zeros() as usize)
    }

    /// The largest member below `rank`.
    #[inline(always)]
    pub(crate) fn next_below(&self, rank: usize) -> Option<usize> {
        let mut word = rank / 64;
        let mut bits = self.words[word] & !(u64::MAX << (rank % 64));
        while bits == 0 {
            word = word.checked_sub(1)?;
            bits = self.words[word];
        }
        Some(64 * word + 63 - bits.leading_zeros() as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_those_of_a_sorted_list() {
        let members = [0, 1, 62, 63, 64, 190, 199];
        let mut set = RankSet::new(200);
        members.iter().for_each(|&rank| set.insert(rank));
        for rank in 0..200 {
            assert_eq!(
                set.next_above(rank),
                members.iter().copied().find(|&m| m > rank)
            );
            assert_eq!(
                set.next_below(rank),
                members.iter().copied().rfind(|&m| m < rank)
            );
        }
        set.clear_near(63);
        assert_eq!(set.next_above(0), Some(64));
    }
}
