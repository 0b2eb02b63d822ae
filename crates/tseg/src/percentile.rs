use crate::error::{Error, check_finite};
use crate::multiset::Multiset;

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
    Ok(percentile(&Multiset::new(x), &Multiset::new(y)))
}

/// The same for samples that are checked.
pub(crate) fn percentile(x: &Multiset, y: &Multiset) -> f64 {
    similarity(&hazen(x), &hazen(y))
}

fn similarity(x: &[f64; 5], y: &[f64; 5]) -> f64 {
    let squared = |i: usize| (x[i] - y[i]) * (x[i] - y[i]);
    let intervals = LEVELS.len() - 1;
    let distance = (0..intervals).fold(0.0, |sum, i| {
        sum + (0.5 * (squared(i + 1) + squared(i))).sqrt()
    });
    1.0 / (1.0 + distance / intervals as f64)
}

/// Percentiles of at least one sample, by Hazen's rule.
fn hazen(samples: &Multiset) -> [f64; 5] {
    let n = samples.count();
    let (mut rest, mut passed) = (samples.values(), 0);
    LEVELS.map(|level| {
        let position = (level * n as f64 - 0.5).clamp(0.0, n as f64 - 1.0);
        let below = position as usize;
        while passed + rest[0].1 <= below {
            passed += rest[0].1;
            rest = &rest[1..];
        }
        let (low, count) = rest[0];
        let is_last = passed + count <= below + 1;
        let high = rest.get(usize::from(is_last)).map_or(low, |next| next.0);
        low + (position - below as f64) * (high - low)
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn hazen_by_hand() {
        assert_eq!(hazen(&Multiset::new(&[7.0])), [7.0; 5]);
        assert_eq!(
            hazen(&Multiset::new(&[3.0, 1.0])),
            [1.0, 1.0, 2.0, 3.0, 3.0]
        );
        let ten: Vec<f64> = (1..=10).map(f64::from).collect();
        for (p, expected) in hazen(&Multiset::new(&ten))
            .iter()
            .zip([1.5, 3.0, 5.5, 8.0, 9.5])
        {
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
}
