use crate::error::{Error, check_finite, check_length};
use crate::segmentation::Segmentation;

/// How long the segments are and how purely they separate positive from negative samples: thesis Table 3.5.
#[derive(Debug, Clone, Copy, PartialEq)]
#[must_use]
pub struct Metrics {
    /// Number of segments.
    pub segments: usize,
    /// Mean length, in samples.
    pub mean_length: f64,
    /// Standard deviation of the lengths (divisor `m − 1`), in samples; 0 for one segment.
    pub std_length: f64,
    /// Share of samples above 0 among all samples of positive segments, in per cent; `None` if no segment is positive.
    ///
    /// A segment is positive if at least half of its samples are above 0.
    pub positive_share_pct: Option<f64>,
    /// The same for samples below 0.
    pub negative_share_pct: Option<f64>,
}

impl Metrics {
    /// Figures of a segmentation with respect to the sign of `signal` (in the thesis, acceleration), one value per
    /// sample.
    ///
    /// # Errors
    ///
    /// [`Error::Length`], [`Error::NotFinite`].
    pub fn new(signal: &[f64], segmentation: &Segmentation) -> Result<Self, Error> {
        check_length(0, signal.len(), segmentation.sample_count())?;
        check_finite(0, signal)?;
        let segments = segmentation.segment_count();
        let mean_length = signal.len() as f64 / segments as f64;
        let squares = segmentation.iter().fold(0.0, |sum, segment| {
            sum + (segment.len() as f64 - mean_length).powi(2)
        });
        Ok(Self {
            segments,
            mean_length,
            std_length: (squares / (segments - 1).max(1) as f64).sqrt(),
            positive_share_pct: share_pct(signal, segmentation, |x| x > 0.0),
            negative_share_pct: share_pct(signal, segmentation, |x| x < 0.0),
        })
    }
}

/// Per cent of samples that `counts`, pooled over the segments in which at least half do.
fn share_pct(signal: &[f64], segmentation: &Segmentation, counts: fn(f64) -> bool) -> Option<f64> {
    let (mut counted, mut total) = (0, 0);
    for segment in segmentation.iter() {
        let samples = &signal[segment];
        let count = samples.iter().filter(|&&x| counts(x)).count();
        if 2 * count >= samples.len() {
            counted += count;
            total += samples.len();
        }
    }
    (total > 0).then(|| 100.0 * counted as f64 / total as f64)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let signal = [1.0, 1.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0];
        let segmentation = Segmentation::from_boundaries(vec![0, 3, 5, 8]).unwrap();
        let metrics = Metrics::new(&signal, &segmentation).unwrap();
        assert_eq!(metrics.segments, 3);
        assert_eq!(metrics.mean_length, 8.0 / 3.0);
        assert!((metrics.std_length - (1.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        // Segments 0 and 1 are positive, segment 1 is negative too.
        assert_eq!(metrics.positive_share_pct, Some(60.0));
        assert_eq!(metrics.negative_share_pct, Some(50.0));
    }

    #[test]
    fn shares_are_none_where_there_is_no_such_segment() {
        let segmentation = Segmentation::from_boundaries(vec![0, 3]).unwrap();
        let metrics = Metrics::new(&[0.0; 3], &segmentation).unwrap();
        assert_eq!((metrics.mean_length, metrics.std_length), (3.0, 0.0));
        assert_eq!(
            (metrics.positive_share_pct, metrics.negative_share_pct),
            (None, None)
        );
        assert!(Metrics::new(&[0.0; 2], &segmentation).is_err());
    }
}
