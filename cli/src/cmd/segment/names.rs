//! The values that the segmentation flags take.

use std::str::FromStr;

use anyhow::bail;
use clap::ValueEnum;
use driver_model::segmentation::Scaling;
use serde::Serialize;
use tseg::Similarity;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum MethodName {
    /// Runs of samples with the same label (Table 3.1)
    Heuristic,
    /// Least total cost
    Dynamic,
    /// Merge the cheapest neighbours first
    BottomUp,
    /// Grow a segment until it costs too much
    SlidingWindow,
    /// Bottom-up in a sliding window
    Swab,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum MergeName {
    /// Leave the segments as they are
    None,
    /// By sign, magnitude and difference of their means
    Mean,
    /// The same as printed in Algorithm 5
    MeanLiteral,
    /// By l-association intervals, l = 2
    Association,
    /// By percentile similarity
    Percentile,
}

/// A number of segments, or `auto`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum SegmentsArg {
    Number(usize),
    Auto,
}

impl FromStr for SegmentsArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.parse()) {
            ("auto", _) => Ok(Self::Auto),
            (_, Ok(number)) if number > 0 => Ok(Self::Number(number)),
            _ => Err("expected a number of segments, at least 1, or auto".to_owned()),
        }
    }
}

impl Serialize for SegmentsArg {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Number(number) => number.serialize(serializer),
            Self::Auto => "auto".serialize(serializer),
        }
    }
}

/// A scaling by name, or two divisors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ScaleArg(pub(crate) Scaling);

const SCALES: [(&str, tseg::Scale); 4] = [
    ("none", tseg::Scale::None),
    ("zscore", tseg::Scale::ZScore),
    ("range", tseg::Scale::Range),
    ("max", tseg::Scale::Max),
];

impl FromStr for ScaleArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some((_, scale)) = SCALES.into_iter().find(|(name, _)| *name == text) {
            return Ok(Self(Scaling::PerLog(scale)));
        }
        let divisors = text.split_once(',').and_then(|(speed, accel)| {
            let divisor = |text: &str| {
                text.trim()
                    .parse()
                    .ok()
                    .filter(|x: &f64| (1e-6..=1e6).contains(x))
            };
            Some((divisor(speed)?, divisor(accel)?))
        });
        let (speed_mps, accel_mps2) = divisors.ok_or(
            "expected none, zscore, range, max, or two numbers from 1e-6 to 1e6 such as 18,1.6 (m/s and m/s²)",
        )?;
        Ok(Self(Scaling::Fixed {
            speed_mps,
            accel_mps2,
        }))
    }
}

impl Serialize for ScaleArg {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            Scaling::Fixed {
                speed_mps,
                accel_mps2,
            } => [speed_mps, accel_mps2].serialize(serializer),
            Scaling::PerLog(scale) => {
                let named = SCALES.into_iter().find(|(_, known)| *known == scale);
                named.map(|(name, _)| name).serialize(serializer)
            }
        }
    }
}

impl MergeName {
    /// With the thesis's thresholds.
    fn by_default(self) -> Option<Similarity> {
        match self {
            Self::None => None,
            Self::Mean => Some(Similarity::mean()),
            Self::MeanLiteral => Some(Similarity::mean_literal()),
            Self::Association => Some(Similarity::association()),
            Self::Percentile => Some(Similarity::percentile()),
        }
    }

    /// The default of `--similarity`.
    pub(super) fn default_similarity(self) -> Option<Vec<f64>> {
        use Similarity::{Association, Mean, MeanLiteral, Percentile};
        Some(match self.by_default()? {
            Mean {
                magnitude,
                difference,
            }
            | MeanLiteral {
                magnitude,
                difference,
            } => vec![magnitude, difference],
            Association { threshold, .. } | Percentile { threshold } => vec![threshold],
        })
    }

    pub(super) fn similarity(self, given: Option<&[f64]>) -> anyhow::Result<Option<Similarity>> {
        use Similarity::{Association, Mean, MeanLiteral, Percentile};
        let mut similarity = self.by_default();
        if let (Some(similarity), Some(values)) = (&mut similarity, given) {
            match similarity {
                Mean {
                    magnitude,
                    difference,
                }
                | MeanLiteral {
                    magnitude,
                    difference,
                } => {
                    let what = "for the means, such as 0.4,0.55";
                    [*magnitude, *difference] = pair("--similarity", what, values)?;
                }
                Association { threshold, .. } | Percentile { threshold } => match values {
                    [value] => *threshold = *value,
                    _ => bail!("--similarity takes one number for this --merge, such as 0.64"),
                },
            }
        }
        Ok(similarity)
    }
}

pub(super) fn pair(flag: &str, what: &str, values: &[f64]) -> anyhow::Result<[f64; 2]> {
    match *values {
        [first, second] => Ok([first, second]),
        _ => bail!("{flag} takes two numbers {what}"),
    }
}
