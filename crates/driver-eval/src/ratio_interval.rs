//! Intervals of means over units.

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

/// The 97.5 % quantile of Student's t: exact for 1 and 2 degrees of freedom, else by the expansion in `1/ν` (Abramowitz and
/// Stegun 26.7.5), within 0.2 % from 3 on.
fn t_quantile_975(degrees: usize) -> f64 {
    let z: f64 = 1.959_963_984_540_054;
    match degrees {
        0 => f64::INFINITY,
        1 => 12.706_204_736_174_7,
        2 => 4.302_652_729_749_46,
        _ => {
            let nu = degrees as f64;
            let (z3, z5, z7, z9) = (z.powi(3), z.powi(5), z.powi(7), z.powi(9));
            z + (z3 + z) / (4.0 * nu)
                + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * nu.powi(2))
                + (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * nu.powi(3))
                + (79.0 * z9 + 776.0 * z7 + 1482.0 * z5 - 1920.0 * z3 - 945.0 * z)
                    / (92_160.0 * nu.powi(4))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (degrees, quantile) in [
            (1, 12.706),
            (2, 4.303),
            (3, 3.182),
            (4, 2.776),
            (10, 2.228),
            (30, 2.042),
        ] {
            let found = t_quantile_975(degrees);
            assert!((found / quantile - 1.0).abs() < 2e-3, "{degrees}: {found}");
        }
    }
}
