//! Intervals of means over units.

use statrs::distribution::{ContinuousCDF as _, StudentsT};

/// A ratio of sums over units, and its 95 % interval: with the sum `s_u` over `n_u` values of unit `u`, `D = Σs_u/Σn_u` has
/// the variance `k/(k−1) Σ(s_u − n_u D)²/(Σn_u)²` (W. G. Cochran, Sampling Techniques, 1977), and Student's t with `k − 1`
/// degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RatioInterval {
    pub(crate) ratio: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl RatioInterval {
    /// Of the sums and counts of units; `None` below two.
    pub(crate) fn of(units: impl Iterator<Item = (f64, f64)> + Clone) -> Option<Self> {
        let k = units.clone().count();
        if k < 2 {
            return None;
        }
        let count: f64 = units.clone().map(|u| u.1).sum();
        let ratio = units.clone().map(|u| u.0).sum::<f64>() / count;
        let squares: f64 = units.map(|(s, n)| (s - n * ratio).powi(2)).sum();
        let deviation = (k as f64 / (k - 1) as f64 * squares).sqrt() / count;
        let reach = t_quantile_975(k - 1) * deviation;
        Some(Self {
            ratio,
            low: ratio - reach,
            high: ratio + reach,
        })
    }
}

/// The 97.5 % quantile of Student's t.
fn t_quantile_975(degrees: usize) -> f64 {
    StudentsT::new(0.0, 1.0, degrees as f64).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (degrees, quantile) in [
            (1, 12.706_204_736),
            (2, 4.302_652_730),
            (4, 2.776_445_105),
            (30, 2.042_272_456),
            (1000, 1.962_339_081),
        ] {
            let found = t_quantile_975(degrees);
            assert!((found / quantile - 1.0).abs() < 1e-6, "{degrees}: {found}");
        }
        assert!(t_quantile_975(0).is_infinite());
    }
}
