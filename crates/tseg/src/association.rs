use crate::error::{Error, check_finite, check_threshold};
use crate::multiset::Multiset;

/// Similarity of two samples by their `l`-association intervals `I = (x̄ − l·S, x̄ + l·S)`, in `[0, 1]`:
///
/// `J = #{z ∈ X ∪ Y : z ∈ I_X ∩ I_Y} / #(X ∪ Y) · 1 / (1 + √(Δc² + Δr²))`, `Δc = x̄ − ȳ`, `Δr = l (S_X − S_Y)`,
///
/// thesis (3.23) to (3.25) with `W` the identity, after Gavilan (the thesis's reference 18). `S` has the divisor
/// `n − 1`, the union counts every sample, and intervals are open: that of a constant or a single sample is empty, and
/// `J` is 0.
///
/// # Errors
///
/// [`Error::NoSamples`], [`Error::NotFinite`], where `x` is variable 0, `y` variable 1, and [`Error::Threshold`] for an
/// `l` that is negative or not finite.
pub fn association_similarity(x: &[f64], y: &[f64], l: f64) -> Result<f64, Error> {
    if x.is_empty() || y.is_empty() {
        return Err(Error::NoSamples);
    }
    check_finite(0, x)?;
    check_finite(1, y)?;
    let l = check_threshold(l)?;
    Ok(association(&Multiset::new(x), &Multiset::new(y), l))
}

/// The same for samples that are checked.
pub(crate) fn association(x: &Multiset, y: &Multiset, l: f64) -> f64 {
    let (x_mean, x_deviation) = mean_and_deviation(x);
    let (y_mean, y_deviation) = mean_and_deviation(y);
    let low = (x_mean - l * x_deviation).max(y_mean - l * y_deviation);
    let high = (x_mean + l * x_deviation).min(y_mean + l * y_deviation);
    let inside = |samples: &Multiset| {
        let values = samples.values();
        let start = values.partition_point(|&(value, _)| value <= low);
        let held = values[start..]
            .iter()
            .take_while(|&&(value, _)| value < high);
        held.map(|&(_, count)| count).sum::<usize>()
    };
    let share = (inside(x) + inside(y)) as f64 / (x.count() + y.count()) as f64;
    share / (1.0 + (x_mean - y_mean).hypot(l * (x_deviation - y_deviation)))
}

/// The deviation of a constant is exactly 0.
fn mean_and_deviation(samples: &Multiset) -> (f64, f64) {
    if let [(value, _)] = samples.values() {
        return (*value, 0.0);
    }
    let n = samples.count() as f64;
    let sum_of = |term: &dyn Fn(f64) -> f64| {
        let terms = samples.values().iter();
        terms.fold(0.0, |sum, &(value, count)| sum + count as f64 * term(value))
    };
    let mean = sum_of(&|x| x) / n;
    (
        mean,
        (sum_of(&|x| (x - mean) * (x - mean)) / (n - 1.0)).sqrt(),
    )
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        // Mean 2, S = 1, so (0, 4) for the first; mean 3, S = 1, so (1, 5) for the second: 2, 3 and 2, 3 lie in (1, 4).
        let j = association_similarity(&[1.0, 2.0, 3.0], &[2.0, 3.0, 4.0], 2.0).unwrap();
        assert_eq!(j, 4.0 / 6.0 / 2.0);
        assert_eq!(
            association_similarity(&[1.0, 2.0], &[1.0, 2.0], 2.0).unwrap(),
            1.0
        );
    }

    #[test]
    fn constants_and_single_samples_have_empty_intervals() {
        let varied = [0.0, 0.1, 0.2];
        for constant in [&[0.1][..], &[0.1; 3]] {
            assert_eq!(association_similarity(constant, &varied, 2.0).unwrap(), 0.0);
            assert_eq!(association_similarity(&varied, constant, 2.0).unwrap(), 0.0);
            assert_eq!(
                association_similarity(constant, constant, 2.0).unwrap(),
                0.0
            );
        }
        assert_eq!(association_similarity(&varied, &varied, 0.0).unwrap(), 0.0);
    }

    #[test]
    fn refuses_what_has_no_interval() {
        assert_eq!(
            association_similarity(&[], &[1.0], 2.0).unwrap_err(),
            Error::NoSamples
        );
        assert!(matches!(
            association_similarity(&[1.0], &[0.0, f64::NAN], 2.0),
            Err(Error::NotFinite {
                variable: 1,
                sample: 1,
                ..
            })
        ));
        assert!(association_similarity(&[1.0], &[1.0], f64::NAN).is_err());
    }
}
