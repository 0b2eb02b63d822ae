use std::ops::Range;

use crate::error::Error;

/// A partition of the samples `0..n` into half-open segments, stored as boundaries `0 = b₀ < b₁ < … < b_m = n`.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
#[must_use]
pub struct Segmentation {
    boundaries: Vec<usize>,
}

impl Segmentation {
    /// Takes boundaries that start at 0 and increase strictly; the last is the number of samples.
    ///
    /// # Errors
    ///
    /// [`Error::NoSamples`] for fewer than two boundaries, [`Error::Boundaries`] where the order is broken.
    pub fn from_boundaries(boundaries: Vec<usize>) -> Result<Self, Error> {
        if let Some(&boundary) = boundaries.first().filter(|&&b| b != 0) {
            return Err(Error::Boundaries { index: 0, boundary });
        }
        if boundaries.len() < 2 {
            return Err(Error::NoSamples);
        }
        match boundaries.windows(2).position(|pair| pair[0] >= pair[1]) {
            Some(index) => Err(Error::Boundaries {
                index: index + 1,
                boundary: boundaries[index + 1],
            }),
            None => Ok(Self { boundaries }),
        }
    }

    /// For callers inside the crate whose boundaries hold the invariant by construction.
    pub(crate) fn from_ordered(boundaries: Vec<usize>) -> Self {
        debug_assert!(
            boundaries.len() > 1 && boundaries[0] == 0 && boundaries.is_sorted_by(|a, b| a < b)
        );
        Self { boundaries }
    }

    /// The boundaries, `segment_count() + 1` of them, first 0, last `sample_count()`.
    #[must_use]
    pub fn boundaries(&self) -> &[usize] {
        &self.boundaries
    }

    /// Number of segments, at least 1.
    #[must_use]
    pub fn segment_count(&self) -> usize {
        self.boundaries.len() - 1
    }

    /// Number of samples, at least 1.
    #[must_use]
    pub fn sample_count(&self) -> usize {
        self.boundaries[self.boundaries.len() - 1]
    }

    /// The segments from left to right, none of them empty.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Range<usize>> + DoubleEndedIterator + '_ {
        self.boundaries.windows(2).map(|pair| pair[0]..pair[1])
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::single_range_in_vec_init)]
mod tests {
    use super::*;

    #[test]
    fn keeps_a_partition_and_refuses_the_rest() {
        let segmentation = Segmentation::from_boundaries(vec![0, 2, 5]).unwrap();
        assert_eq!(segmentation.iter().collect::<Vec<_>>(), [0..2, 2..5]);
        assert_eq!(
            (segmentation.segment_count(), segmentation.sample_count()),
            (2, 5)
        );

        for (boundaries, index) in [
            (vec![1, 2], 0),
            (vec![0, 0], 1),
            (vec![0, 3, 3], 2),
            (vec![0, 3, 2, 4], 2),
        ] {
            let boundary = boundaries[index];
            assert_eq!(
                Segmentation::from_boundaries(boundaries).unwrap_err(),
                Error::Boundaries { index, boundary }
            );
        }
        for boundaries in [vec![], vec![0]] {
            assert_eq!(
                Segmentation::from_boundaries(boundaries).unwrap_err(),
                Error::NoSamples
            );
        }
    }
}
