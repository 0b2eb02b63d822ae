use crate::error::{Error, check_finite, check_length, check_threshold};
use crate::merge::merge;
use crate::segmentation::Segmentation;

/// The percentiles compared, as fractions.
const LEVELS: [f64; 5] = [0.10, 0.25, 0.50, 0.75, 0.90];

/// Similarity of two samples by their percentiles `p_1 … p_q` (10, 25, 50, 75, 90 %), in `[0, 1]`, 1 for equal ones:
///
/// `J = 1 / (1 + Σ_{i<q} d_i / (q − 1))`, `d_i = √(½ ((p_{i+1,X} − p_{i+1,Y})² + (p_{i,X} − p_{i,Y})²))`,
///
/// thesis (3.26), (3.27), after Gavilan (the thesis's reference 18). Percentiles follow Hazen: the `i`-th smallest of
/// `n` samples is the quantile `(i − ½) / n`, linear in between, constant outside.
///
/// # Errors
///
/// [`Error::NoSamples`] and [`Error::NotFinite`]; `x` is variable 0, `y` variable 1.
pub fn percentile_similarity(x: &[f64], y: &[f64]) -> Result<f64, Error> {
    if x.is_empty() || y.is_empty() {
        return Err(Error::NoSamples);
    }
    check_finite(0, x)?;
    check_finite(1, y)?;
    let percentiles = |samples: &[f64]| {
        let mut sorted = samples.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        hazen(&sorted)
    };
    Ok(similarity(&percentiles(x), &percentiles(y)))
}

/// Merges neighbours whose [`percentile_similarity`] on `signal`, one value per sample, exceeds the threshold.
///
/// One pass as in [`merge`]; percentiles of an accumulated segment are those of all its samples. The thesis applies it
/// to acceleration with the threshold 0.64.
///
/// # Errors
///
/// [`Error::Length`], [`Error::NotFinite`], [`Error::Threshold`].
pub fn merge_percentile(
    signal: &[f64],
    segmentation: &Segmentation,
    threshold: f64,
) -> Result<Segmentation, Error> {
    check_length(0, signal.len(), segmentation.sample_count())?;
    check_finite(0, signal)?;
    let threshold = check_threshold(threshold)?;
    // The accumulated samples in order. Sorting two sorted runs one after the other is a linear merge.
    let mut sorted: Vec<f64> = Vec::new();
    let mut next_sorted: Vec<f64> = Vec::new();
    Ok(merge(segmentation, |accumulated, next| {
        if sorted.is_empty() {
            sorted.extend(&signal[accumulated]);
            sorted.sort_unstable_by(f64::total_cmp);
        }
        next_sorted.clear();
        next_sorted.extend(&signal[next]);
        next_sorted.sort_unstable_by(f64::total_cmp);
        let similar = similarity(&hazen(&sorted), &hazen(&next_sorted)) > threshold;
        if !similar {
            sorted.clear();
        }
        sorted.extend(&next_sorted);
        sorted.sort_by(f64::total_cmp);
        similar
    }))
}

fn similarity(x: &[f64; 5], y: &[f64; 5]) -> f64 {
    let squared = |i: usize| (x[i] - y[i]) * (x[i] - y[i]);
    let intervals = LEVELS.len() - 1;
    let distance = (0..intervals).fold(0.0, |sum, i| {
        sum + (0.5 * (squared(i + 1) + squared(i))).sqrt()
    });
    1.0 / (1.0 + distance / intervals as f64)
}

/// Percentiles of sorted samples, at least one, by Hazen's rule.
fn hazen(sorted: &[f64]) -> [f64; 5] {
    let last = sorted.len() - 1;
    LEVELS.map(|level| {
        let position = (level * sorted.len() as f64 - 0.5).clamp(0.0, last as f64);
        let below = position.floor();
        let (low, high) = (
            sorted[below as usize],
            sorted[(below as usize + 1).min(last)],
        );
        low + (position - below) * (high - low)
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn hazen_by_hand() {
        assert_eq!(hazen(&[7.0]), [7.0; 5]);
        assert_eq!(hazen(&[1.0, 3.0]), [1.0, 1.0, 2.0, 3.0, 3.0]);
        let ten: Vec<f64> = (1..=10).map(f64::from).collect();
        for (p, expected) in hazen(&ten).iter().zip([1.5, 3.0, 5.5, 8.0, 9.5]) {
            assert!((p - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn shifted_samples_are_less_similar_the_further_they_are() {
        let x = [1.0, 2.0, 3.0];
        assert_eq!(percentile_similarity(&x, &[3.0, 1.0, 2.0]).unwrap(), 1.0);
        assert_eq!(percentile_similarity(&x, &x.map(|v| v + 1.0)).unwrap(), 0.5);
        assert_eq!(
            percentile_similarity(&x, &[]).unwrap_err(),
            Error::NoSamples
        );
        assert!(percentile_similarity(&x, &[f64::NAN]).is_err());
    }

    #[test]
    fn merges_levels_that_are_alike() {
        let signal = [1.0, 1.0, 1.2, 1.2, 5.0, 5.0];
        let segmentation = Segmentation::from_boundaries(vec![0, 2, 4, 6]).unwrap();
        let merged = merge_percentile(&signal, &segmentation, 0.64).unwrap();
        assert_eq!(merged.boundaries(), [0, 4, 6]);
        assert!(matches!(
            merge_percentile(&signal[1..], &segmentation, 0.64),
            Err(Error::Length { .. })
        ));
    }
}
