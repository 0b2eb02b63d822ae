use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use drive_log::DriveLog;
use serde::Serialize;
use tseg::{Metrics, Progress};

use crate::Error;
use crate::segmentation::{HeuristicRules, Method, Segmented, Segments, StatisticalRules};

/// Either way to cut a drive into phases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Segmenter {
    /// By labels of single samples.
    Heuristic(HeuristicRules),
    /// By statistics of segments.
    Statistical(StatisticalRules),
}

/// What Table 3.5 of the thesis compares.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MethodFigures {
    /// Mean length of the segments, in samples.
    pub mean_length: f64,
    /// Standard deviation of the lengths, in samples.
    pub std_length: f64,
    /// Share of positive samples in positive segments, in per cent; `None` where there is no such segment.
    pub positive_share_pct: Option<f64>,
    /// The same for negative ones.
    pub negative_share_pct: Option<f64>,
    /// Wall time of the segmentation alone: no reading, no scaling, no figures.
    pub seconds: f64,
}

impl Segmenter {
    /// Segments a drive and classifies the segments, reporting how far a long computation is.
    ///
    /// # Errors
    /// Those of [`HeuristicRules::segment`] and [`StatisticalRules::segment`].
    pub fn segment(&self, log: &DriveLog, progress: &Progress<'_>) -> Result<Segmented, Error> {
        match self {
            Self::Heuristic(rules) => rules.segment(log),
            Self::Statistical(rules) => rules.segment_with(log, progress),
        }
    }

    /// How many samples a drive must have for as many and as long segments as were asked for.
    #[must_use]
    pub fn least_samples(&self) -> usize {
        let Self::Statistical(StatisticalRules {
            method:
                Method::Dynamic {
                    segments,
                    min_length,
                },
            ..
        }) = self
        else {
            return 1;
        };
        let segments = match segments {
            Segments::Exactly(segments) => *segments,
            Segments::AtMost(_) | Segments::AtKnee => 1,
        };
        segments.saturating_mul((*min_length).max(1))
    }

    /// Segments a drive for the figures alone, without merging. `None` where the drive is too short for so many segments.
    ///
    /// # Errors
    /// As [`Segmenter::segment`].
    pub fn figures(&self, log: &DriveLog) -> Result<Option<MethodFigures>, Error> {
        match self.timed(log) {
            Err(Error::Segmentation(tseg::Error::TooManySegments { .. })) => Ok(None),
            figures => figures.map(Some),
        }
    }

    fn timed(&self, log: &DriveLog) -> Result<MethodFigures, Error> {
        match self {
            Self::Heuristic(rules) => {
                let start = Instant::now();
                let (segmentation, _) = rules.cut(log.speed_mps(), &log.accel_mps2())?;
                let time = start.elapsed();
                let banded_mps2 = rules.banded(log)?;
                Ok(MethodFigures::new(
                    &Metrics::new(&banded_mps2, &segmentation)?,
                    time,
                ))
            }
            Self::Statistical(rules) => {
                let prepared = rules.prepare(log)?;
                let start = Instant::now();
                let (segmentation, _) =
                    rules.cut(&prepared.series, &|_| ControlFlow::Continue(()))?;
                let time = start.elapsed();
                Ok(MethodFigures::new(
                    &Metrics::new(&prepared.banded_mps2, &segmentation)?,
                    time,
                ))
            }
        }
    }
}

impl MethodFigures {
    fn new(metrics: &Metrics, time: Duration) -> Self {
        Self {
            mean_length: metrics.mean_length,
            std_length: metrics.std_length,
            positive_share_pct: metrics.positive_share_pct,
            negative_share_pct: metrics.negative_share_pct,
            seconds: time.as_secs_f64(),
        }
    }

    /// The mean of every figure over logs, those not defined left out; `None` for no log.
    #[must_use]
    pub fn mean(of_logs: &[Self]) -> Option<Self> {
        let mean = |figure: fn(&Self) -> Option<f64>| {
            let values: Vec<f64> = of_logs.iter().filter_map(figure).collect();
            (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
        };
        Some(Self {
            mean_length: mean(|f| Some(f.mean_length))?,
            std_length: mean(|f| Some(f.std_length))?,
            positive_share_pct: mean(|f| f.positive_share_pct),
            negative_share_pct: mean(|f| f.negative_share_pct),
            seconds: mean(|f| Some(f.seconds))?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_leaves_out_what_is_not_defined() {
        let figures = |mean_length, positive_share_pct| MethodFigures {
            mean_length,
            std_length: 2.0,
            positive_share_pct,
            negative_share_pct: None,
            seconds: 1.0,
        };
        assert_eq!(
            MethodFigures::mean(&[figures(10.0, Some(80.0)), figures(20.0, None)]),
            Some(figures(15.0, Some(80.0)))
        );
        assert_eq!(MethodFigures::mean(&[]), None);
    }
}
