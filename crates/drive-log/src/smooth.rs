//! Smoothing of the speed.

use std::collections::VecDeque;
use std::fmt;
use std::str::FromStr;

use crate::Error;

/// How the speed is smoothed before it is differentiated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Smoothing {
    /// As recorded.
    None,
    /// Hann window of this many samples, see [`hann`].
    Hann(usize),
}

impl FromStr for Smoothing {
    type Err = Error;

    /// Reads `none` or `hann:LENGTH`.
    fn from_str(text: &str) -> Result<Smoothing, Error> {
        let length = text
            .strip_prefix("hann:")
            .and_then(|length| length.parse().ok());
        match (text, length) {
            ("none", _) => Ok(Smoothing::None),
            (_, Some(length)) if length % 2 == 1 && length <= MAX_LENGTH => {
                Ok(Smoothing::Hann(length))
            }
            _ => Err(Error::Option {
                option: "smooth",
                value: text.to_owned(),
                expected: "give none, or hann:LENGTH with an odd LENGTH up to 9999, such as hann:5",
            }),
        }
    }
}

impl fmt::Display for Smoothing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Smoothing::None => f.write_str("none"),
            Smoothing::Hann(length) => write!(f, "hann:{length}"),
        }
    }
}

/// Longest window, samples: more than any sensor at any rate needs, and it fits into memory.
const MAX_LENGTH: usize = 9999;

impl serde::Serialize for Smoothing {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Smooths with a Hann window of `length` samples (thesis section 3.4: 5 samples at 10 Hz).
///
/// Weights are `½(1 − cos(2πj/(length + 1)))` for `j = 1..=length`, divided by their sum and
/// centred on the sample (the left one of the two middle weights for an even length); the ends of
/// the signal are replicated. Lengths over 9999 count as 9999. As many values as `signal`.
#[must_use]
pub fn hann(signal: &[f64], length: usize) -> Vec<f64> {
    let (Some(&first), Some(&last)) = (signal.first(), signal.last()) else {
        return Vec::new();
    };
    let weights = weights(length);
    let before = before(&weights);
    let mut padded = vec![first; before];
    padded.extend_from_slice(signal);
    padded.extend(std::iter::repeat_n(last, weights.len() - 1 - before));
    padded
        .windows(weights.len())
        .map(|window| weighted(window.iter(), &weights))
        .collect()
}

/// Normalised weights, at least one.
fn weights(length: usize) -> Vec<f64> {
    let length = length.clamp(1, MAX_LENGTH);
    let mut weights: Vec<f64> = (1..=length)
        .map(|j| 0.5 * (1.0 - (std::f64::consts::TAU * j as f64 / (length as f64 + 1.0)).cos()))
        .collect();
    let sum: f64 = weights.iter().sum();
    for weight in &mut weights {
        *weight /= sum;
    }
    weights
}

/// Weights before the centre.
fn before(weights: &[f64]) -> usize {
    (weights.len() - 1) / 2
}

fn weighted<'a>(window: impl Iterator<Item = &'a f64>, weights: &[f64]) -> f64 {
    window.zip(weights).map(|(x, w)| x * w).sum()
}

/// Smooths sample by sample, each as [`hann`] would, so many samples later as the window reaches ahead.
#[derive(Debug, Clone)]
pub struct SmoothingStream {
    weights: Vec<f64>,
    window: VecDeque<f64>,
}

impl SmoothingStream {
    /// Before the first sample.
    #[must_use]
    pub fn new(smoothing: Smoothing) -> SmoothingStream {
        SmoothingStream {
            weights: weights(match smoothing {
                Smoothing::None => 1,
                Smoothing::Hann(length) => length,
            }),
            window: VecDeque::new(),
        }
    }

    /// Takes the next sample; the smoothed value of an earlier one, or of this one, once it is known. Values come in order.
    pub fn push(&mut self, value: f64) -> Option<f64> {
        if self.window.is_empty() {
            let first = std::iter::repeat_n(value, before(&self.weights));
            self.window.extend(first);
        }
        self.window.push_back(value);
        if self.window.len() < self.weights.len() {
            return None;
        }
        let smoothed = weighted(self.window.iter(), &self.weights);
        self.window.pop_front();
        Some(smoothed)
    }

    /// The values still due.
    #[must_use]
    pub fn finish(mut self) -> Vec<f64> {
        let Some(&last) = self.window.back() else {
            return Vec::new();
        };
        let ahead = self.weights.len() - 1 - before(&self.weights);
        (0..ahead).filter_map(|_| self.push(last)).collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn five_samples_weigh_as_the_definition_says() {
        let smooth = hann(&[0.0, 0.0, 0.0, 12.0, 0.0, 0.0, 0.0], 5);
        // ½(1 − cos 60°), ½(1 − cos 120°), 1 over their sum 3: 1/12, 1/4, 1/3, 1/4, 1/12
        for (found, expected) in smooth.iter().zip([0.0, 1.0, 3.0, 4.0, 3.0, 1.0, 0.0]) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    }

    #[test]
    fn ends_are_replicated() {
        let smooth = hann(&[12.0, 0.0, 0.0, 0.0], 5);
        assert!((smooth[0] - 8.0).abs() < 1e-14);
        assert!(hann(&[], 5).is_empty());
    }

    #[test]
    fn a_stream_gives_the_same_values() {
        let signal: Vec<f64> = (0..30).map(|i| f64::from(i * i % 11) * 0.1).collect();
        for smoothing in [
            Smoothing::None,
            Smoothing::Hann(1),
            Smoothing::Hann(5),
            Smoothing::Hann(9),
        ] {
            for len in 0..signal.len() {
                let whole = match smoothing {
                    Smoothing::None => signal[..len].to_vec(),
                    Smoothing::Hann(length) => hann(&signal[..len], length),
                };
                let mut stream = SmoothingStream::new(smoothing);
                let mut values: Vec<f64> = signal[..len]
                    .iter()
                    .filter_map(|&x| stream.push(x))
                    .collect();
                values.extend(stream.finish());
                assert_eq!(values, whole, "{smoothing} {len}");
            }
        }
    }

    #[test]
    fn text_round_trip() {
        for text in ["none", "hann:5", "hann:1"] {
            assert_eq!(text.parse::<Smoothing>().unwrap().to_string(), text);
        }
        for text in [
            "hann",
            "hann:0",
            "hann:4",
            "hann:10001",
            "hann:x",
            "median:5",
            "",
        ] {
            assert!(text.parse::<Smoothing>().is_err(), "{text}");
        }
    }
}
