use crate::association::association;
use crate::error::{Error, check_finite, check_length, check_threshold};
use crate::mean_comparison::means_alike;
use crate::multiset::Multiset;
use crate::percentile::percentile;
use crate::segmentation::Segmentation;
use crate::series::on_grid;

/// When two neighbouring segments are so alike that they become one: thesis section 3.1.5.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Similarity {
    /// Their means have the same sign, lie both at or below or both at or above `magnitude` in amount, and differ by
    /// `difference` at most: the text on thesis Algorithm 5.
    Mean {
        /// In units of the signal.
        magnitude: f64,
        /// In units of the signal.
        difference: f64,
    },
    /// The same with `magnitude` for the left and `difference` for the right segment's amount: Algorithm 5 to the letter.
    MeanLiteral {
        /// In units of the signal.
        magnitude: f64,
        /// In units of the signal.
        difference: f64,
    },
    /// Their [`association_similarity`](crate::association_similarity) is above the threshold.
    Association {
        /// Half the width of the intervals in standard deviations.
        l: f64,
        /// In `[0, 1]`.
        threshold: f64,
    },
    /// Their [`percentile_similarity`](crate::percentile_similarity) is above the threshold.
    Percentile {
        /// In `[0, 1]`.
        threshold: f64,
    },
}

impl Similarity {
    /// With the thesis's thresholds, 0.4 and 0.55 m/s².
    #[must_use]
    pub fn mean() -> Self {
        Self::Mean {
            magnitude: 0.4,
            difference: 0.55,
        }
    }

    /// With the thesis's thresholds, 0.4 and 0.55 m/s².
    #[must_use]
    pub fn mean_literal() -> Self {
        Self::MeanLiteral {
            magnitude: 0.4,
            difference: 0.55,
        }
    }

    /// With `l = 2` and the thesis's threshold, 0.005.
    #[must_use]
    pub fn association() -> Self {
        Self::Association {
            l: 2.0,
            threshold: 0.005,
        }
    }

    /// With the thesis's threshold, 0.64.
    #[must_use]
    pub fn percentile() -> Self {
        Self::Percentile { threshold: 0.64 }
    }

    fn parameters(self) -> [f64; 2] {
        match self {
            Self::Mean {
                magnitude,
                difference,
            }
            | Self::MeanLiteral {
                magnitude,
                difference,
            } => [magnitude, difference],
            Self::Association { l, threshold } => [l, threshold],
            Self::Percentile { threshold } => [threshold; 2],
        }
    }
}

/// Merging of segments that come one at a time, from left to right; [`merge_similar`] for a stream.
///
/// Memory holds the distinct values of the segment accumulated so far.
#[derive(Debug, Clone)]
pub struct Merging {
    similarity: Similarity,
    sum: f64,
    count: usize,
    /// Empty where only means are compared.
    samples: Multiset,
}

impl Merging {
    /// Nothing accumulated yet.
    ///
    /// # Errors
    ///
    /// [`Error::Threshold`] for a parameter of the similarity that is negative or not finite.
    pub fn new(similarity: Similarity) -> Result<Self, Error> {
        for parameter in similarity.parameters() {
            check_threshold(parameter)?;
        }
        Ok(Self {
            similarity,
            sum: 0.0,
            count: 0,
            samples: Multiset::default(),
        })
    }

    /// Takes the samples of the next segment, rounded to the grid of [`Series`](crate::Series). `true` where it joins the accumulated one; `false` where it starts a new one,
    /// as the first does.
    ///
    /// # Errors
    ///
    /// [`Error::NoSamples`], [`Error::NotFinite`]; nothing is taken then.
    pub fn joins(&mut self, next: &[f64]) -> Result<bool, Error> {
        if next.is_empty() {
            return Err(Error::NoSamples);
        }
        check_finite(0, next)?;
        let next: &[f64] = &next.iter().map(|&x| on_grid(x)).collect::<Vec<_>>();
        let samples = match self.similarity {
            Similarity::Mean { .. } | Similarity::MeanLiteral { .. } => Multiset::default(),
            Similarity::Association { .. } | Similarity::Percentile { .. } => Multiset::new(next),
        };
        let joins = self.count > 0 && self.is_similar(next, &samples);
        if joins {
            self.samples.add(&samples);
        } else {
            self.samples = samples;
            (self.sum, self.count) = (0.0, 0);
        }
        // In order, so that the mean is that of the union as a plain sum gives it.
        self.sum = next.iter().fold(self.sum, |sum, x| sum + x);
        self.count += next.len();
        Ok(joins)
    }

    fn is_similar(&self, next: &[f64], samples: &Multiset) -> bool {
        let next_sum = next.iter().fold(0.0, |sum, x| sum + x);
        let means = [self.sum / self.count as f64, next_sum / next.len() as f64];
        match self.similarity {
            Similarity::Mean {
                magnitude,
                difference,
            } => means_alike(means, [magnitude, magnitude], difference),
            Similarity::MeanLiteral {
                magnitude,
                difference,
            } => means_alike(means, [magnitude, difference], difference),
            Similarity::Association { l, threshold } => {
                on_grid(association(&self.samples, samples, l)) > on_grid(threshold)
            }
            Similarity::Percentile { threshold } => {
                on_grid(percentile(&self.samples, samples)) > on_grid(threshold)
            }
        }
    }
}

/// Merges similar neighbours in one pass from left to right: the segment accumulated so far, with all its samples of
/// `signal` (one value per sample), against the next. Samples and similarities compare on the grid of
/// [`Series`](crate::Series). The thesis applies it to acceleration.
///
/// # Errors
///
/// [`Error::Length`], [`Error::NotFinite`], [`Error::Threshold`].
pub fn merge_similar(
    signal: &[f64],
    segmentation: &Segmentation,
    similarity: Similarity,
) -> Result<Segmentation, Error> {
    check_length(0, signal.len(), segmentation.sample_count())?;
    check_finite(0, signal)?;
    let mut merging = Merging::new(similarity)?;
    let mut boundaries = Vec::new();
    for segment in segmentation.iter() {
        let start = segment.start;
        if !merging.joins(&signal[segment])? {
            boundaries.push(start);
        }
    }
    boundaries.push(segmentation.sample_count());
    Ok(Segmentation::from_ordered(boundaries))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn compares_the_accumulated_segment_with_the_next() {
        // Means 1, 1.5, 2: neighbours are alike, the third differs too much from the first two together.
        let signal = [1.0, 1.0, 1.5, 1.5, 2.0, 2.0];
        let segmentation = Segmentation::from_boundaries(vec![0, 2, 4, 6]).unwrap();
        let merged = merge_similar(&signal, &segmentation, Similarity::mean()).unwrap();
        assert_eq!(merged.boundaries(), [0, 4, 6]);
        let merged = merge_similar(&signal, &segmentation, Similarity::percentile()).unwrap();
        assert_eq!(merged.boundaries(), [0, 4, 6]);
        // Constants have no association interval.
        let merged = merge_similar(&signal, &segmentation, Similarity::association()).unwrap();
        assert_eq!(merged, segmentation);
    }

    #[test]
    fn refuses_what_does_not_fit() {
        let halves = Segmentation::from_boundaries(vec![0, 1, 2]).unwrap();
        assert!(matches!(
            merge_similar(&[1.0], &halves, Similarity::mean()),
            Err(Error::Length { .. })
        ));
        assert!(matches!(
            merge_similar(&[1.0, f64::NAN], &halves, Similarity::association()),
            Err(Error::NotFinite { sample: 1, .. })
        ));
        let threshold = -0.1;
        assert_eq!(
            merge_similar(&[1.0; 2], &halves, Similarity::Percentile { threshold }).unwrap_err(),
            Error::Threshold { value: threshold }
        );
        let mut merging = Merging::new(Similarity::percentile()).unwrap();
        assert_eq!(merging.joins(&[]).unwrap_err(), Error::NoSamples);
        assert!(!merging.joins(&[1.0]).unwrap());
        assert!(merging.joins(&[f64::INFINITY]).is_err());
        assert!(merging.joins(&[1.0]).unwrap());
    }
}
