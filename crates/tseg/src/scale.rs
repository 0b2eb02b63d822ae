/// How to bring a variable to a common scale before segmenting, so that one threshold serves several variables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Scale {
    /// Leave it as it is.
    None,
    /// `(x − x̄) / S`, `S` with divisor `n − 1`.
    ZScore,
    /// `2 (x − min) / (max − min) − 1`, in `[−1, 1]`.
    Range,
    /// `x / max|x|`.
    Max,
}

impl Scale {
    /// The scaled samples, as many as given.
    ///
    /// Where the divisor is 0, for a constant ([`ZScore`](Self::ZScore), [`Range`](Self::Range)) or all zeros
    /// ([`Max`](Self::Max)), every scaled sample is 0. NaN stays NaN, to be refused by
    /// [`Series::new`](crate::Series::new).
    #[must_use]
    pub fn scaled(self, samples: &[f64]) -> Vec<f64> {
        let min = samples.iter().copied().fold(f64::INFINITY, f64::min);
        let max = samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (offset, divisor) = match self {
            Self::None => return samples.to_vec(),
            // Exactly constant: the deviation would be rounding noise of the mean.
            Self::ZScore if max <= min => (min, 0.0),
            Self::ZScore => mean_and_deviation(samples),
            // Halves before the difference, which might overflow.
            Self::Range => (min / 2.0 + max / 2.0, max / 2.0 - min / 2.0),
            Self::Max => (0.0, max.max(-min)),
        };
        let scale = |&x: &f64| {
            if divisor > 0.0 {
                (x - offset) / divisor
            } else {
                0.0 * x
            }
        };
        samples.iter().map(scale).collect()
    }
}

fn mean_and_deviation(samples: &[f64]) -> (f64, f64) {
    let n = samples.len() as f64;
    let mean = samples.iter().fold(0.0, |sum, x| sum + x) / n;
    let squares = samples
        .iter()
        .fold(0.0, |sum, x| sum + (x - mean) * (x - mean));
    (mean, (squares / (n - 1.0)).sqrt())
}

#[cfg(test)]
#[allow(clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let samples = [1.0, 2.0, 3.0];
        assert_eq!(Scale::None.scaled(&samples), samples);
        assert_eq!(Scale::ZScore.scaled(&samples), [-1.0, 0.0, 1.0]);
        assert_eq!(Scale::Range.scaled(&samples), [-1.0, 0.0, 1.0]);
        assert_eq!(Scale::Max.scaled(&[-4.0, 2.0]), [-1.0, 0.5]);
    }

    #[test]
    fn constants_become_zero() {
        for scale in [Scale::ZScore, Scale::Range] {
            assert_eq!(scale.scaled(&[0.1; 3]), [0.0; 3]);
            assert!(scale.scaled(&[]).is_empty());
        }
        assert_eq!(Scale::Max.scaled(&[0.0; 3]), [0.0; 3]);
        assert_eq!(Scale::Max.scaled(&[0.1; 3]), [1.0; 3]);
    }
}
