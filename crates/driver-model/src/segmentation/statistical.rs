use std::ops::ControlFlow;

use drive_log::DriveLog;
use tseg::{
    BottomUp, Certificate, Cost, Dynamic, Metrics, PenaltyPath, Progress, Refill, Scale,
    Segmentation, Series, Similarity, SlidingWindow, Stop, Swab, merge_similar,
};

use crate::grid::{above, below};
use crate::tally::Tally;
use crate::{Error, PhaseKind, Span, error};

/// How a drive is cut into segments by statistics, and how segments become phases (thesis 3.1.2 to 3.1.5, 3.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatisticalRules {
    /// Acceleration under this magnitude counts as 0; 0.4 m/s².
    pub accel_deadband_mps2: f64,
    /// Method; SWAB with a window of 100 samples and a threshold of 0.2.
    pub method: Method,
    /// Segment cost; (3.22).
    pub cost: Cost,
    /// Weights of speed and acceleration; 1.8 and 1.
    pub weights: [f64; 2],
    /// Scaling of both before segmentation, see [`StatisticalRules::default`].
    pub scaling: Scaling,
    /// When neighbours are merged afterwards; by percentiles. `None` merges nothing.
    pub similarity: Option<Similarity>,
    /// A cruise phase is longer than this; 3 s.
    pub cruise_min_duration_s: f64,
    /// A cruise phase is faster than this on average; 30 km/h.
    pub cruise_min_speed_mps: f64,
}

/// Statistical segmentation methods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Least total cost by dynamic programming.
    Dynamic {
        /// How many segments.
        segments: Segments,
        /// Least length of a segment in samples.
        min_length: usize,
    },
    /// Merge the cheapest neighbours until the stop rule holds.
    BottomUp {
        /// In units of the cost.
        threshold: f64,
        /// When to stop.
        stop: Stop,
    },
    /// Grow a segment until it would cost more than the threshold.
    SlidingWindow {
        /// In units of the cost.
        threshold: f64,
    },
    /// Bottom-up in a sliding window.
    Swab {
        /// In units of the cost.
        threshold: f64,
        /// Length in samples.
        window: usize,
        /// How the window is refilled.
        refill: Refill,
    },
}

/// How many segments dynamic programming makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Segments {
    /// So many.
    Exactly(usize),
    /// So many or fewer, whatever costs less.
    AtMost(usize),
    /// As many as pay: the knee of the curve of least cost over the number of segments.
    AtKnee,
}

/// What dynamic programming knows of its result.
#[derive(Debug, Clone, PartialEq)]
pub struct Optimality {
    /// No segmentation of the kind asked for costs less by more than this; 0 for a proved optimum.
    pub gap: f64,
    /// Number of segments and least cost, by rising number, where the number was to be chosen; else empty.
    pub curve: Vec<(usize, f64)>,
}

/// What speed and acceleration are divided by before segmentation, so that one threshold serves both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scaling {
    /// By what the log itself gives. Two logs are then not cut by the same physical threshold.
    PerLog(Scale),
    /// By fixed divisors, the same for every log and for a stream whose future is unknown.
    Fixed {
        /// Divisor of the speed in m/s.
        speed_mps: f64,
        /// Divisor of the acceleration in m/s².
        accel_mps2: f64,
    },
}

impl Scaling {
    /// Half the ranges of the WLTC (class 3b, 10 Hz, Hann window of 5 samples, dead band of 0.4 m/s²), rounded.
    pub const WLTC: Self = Self::Fixed {
        speed_mps: 18.0,
        accel_mps2: 1.6,
    };

    fn scaled(self, speed_mps: &[f64], accel_mps2: &[f64]) -> Result<[Vec<f64>; 2], Error> {
        match self {
            Self::PerLog(scale) => Ok([scale.scaled(speed_mps), scale.scaled(accel_mps2)]),
            Self::Fixed { .. } => {
                let [speed, accel] = self.divisors()?;
                let by = |divisor: f64| move |x: &f64| x / divisor;
                Ok([
                    speed_mps.iter().map(by(speed)).collect(),
                    accel_mps2.iter().map(by(accel)).collect(),
                ])
            }
        }
    }

    /// The divisors of speed in m/s and acceleration in m/s².
    ///
    /// # Errors
    /// [`Error::ScaleOfStream`] where they depend on the log, [`Error::Option`] for one that is not above 0.
    pub(crate) fn divisors(self) -> Result<[f64; 2], Error> {
        match self {
            Self::PerLog(Scale::None) => Ok([1.0, 1.0]),
            Self::PerLog(_) => Err(Error::ScaleOfStream),
            Self::Fixed {
                speed_mps,
                accel_mps2,
            } => {
                for (name, value) in [
                    ("scale of speed", speed_mps),
                    ("scale of acceleration", accel_mps2),
                ] {
                    error::at_least(name, value, f64::MIN_POSITIVE, "above 0")?;
                }
                Ok([speed_mps, accel_mps2])
            }
        }
    }
}

impl Default for StatisticalRules {
    /// The thesis's parameters. It does not say how its variables were scaled; mapping both to [−1, 1] comes nearest to
    /// the lengths of its Table 3.5. Such segments are seldom pure enough to be cruise phases: see
    /// [`StatisticalRules::for_models`].
    fn default() -> Self {
        Self {
            accel_deadband_mps2: 0.4,
            method: Method::Swab {
                threshold: 0.2,
                window: 100,
                refill: Refill::Keogh,
            },
            cost: Cost::MeanDeviation,
            weights: [1.8, 1.0],
            scaling: Scaling::PerLog(Scale::Range),
            similarity: Some(Similarity::percentile()),
            cruise_min_duration_s: 3.0,
            cruise_min_speed_mps: 30.0 / 3.6,
        }
    }
}

/// A drive cut into segments.
#[derive(Debug, Clone, PartialEq)]
pub struct Segmented {
    /// The partition.
    pub segmentation: Segmentation,
    /// Sum of the segment costs, where the method has a cost.
    pub cost: Option<f64>,
    /// Of dynamic programming without merging.
    pub optimality: Option<Optimality>,
    /// One phase per segment.
    pub phases: Vec<Span>,
    /// Homogeneity, on the dead-banded acceleration.
    pub metrics: Metrics,
}

impl Segmented {
    /// Every phase with its mean speed in m/s and mean acceleration in m/s² (raw, no dead band).
    pub fn means(&self, log: &DriveLog) -> impl Iterator<Item = (&Span, f64, f64)> {
        let (speed, accel) = (log.speed_mps(), log.accel_mps2());
        self.phases.iter().map(move |phase| {
            let range = phase.start..phase.end;
            let tally = Tally::of(&speed[range.clone()], &accel[range], 0.0);
            (phase, tally.mean_speed_mps(), tally.mean_accel_mps2())
        })
    }
}

impl StatisticalRules {
    /// The same with standardised variables: shorter segments, from which models learn and cruise phases arise.
    #[must_use]
    pub fn for_models() -> Self {
        Self {
            scaling: Scaling::PerLog(Scale::ZScore),
            ..Self::default()
        }
    }

    /// Segments a drive and classifies the segments.
    ///
    /// # Errors
    /// [`Error::Option`] and [`Error::Segmentation`] for parameters out of range.
    pub fn segment(&self, log: &DriveLog) -> Result<Segmented, Error> {
        self.segment_with(log, &|_| ControlFlow::Continue(()))
    }

    /// The same, reporting how far a long computation is.
    ///
    /// # Errors
    /// As [`StatisticalRules::segment`], and [`tseg::Error::Cancelled`].
    pub fn segment_with(
        &self,
        log: &DriveLog,
        progress: &Progress<'_>,
    ) -> Result<Segmented, Error> {
        let prepared = self.prepare(log)?;
        let (mut segmentation, mut optimality) = self.cut(&prepared.series, progress)?;
        if let Some(similarity) = self.similarity {
            segmentation = merge_similar(&prepared.banded_mps2, &segmentation, similarity)?;
            optimality = None;
        }
        let phases = segmentation
            .iter()
            .map(|range| {
                let speed_mps = &log.speed_mps()[range.clone()];
                let accel_mps2 = &prepared.accel_mps2[range.clone()];
                let tally = Tally::of(speed_mps, accel_mps2, self.accel_deadband_mps2);
                Span::of(log, range, self.classify(&tally, log.step_s()))
            })
            .collect();
        Ok(Segmented {
            cost: Some(self.cost.total(&prepared.series, &segmentation)?),
            optimality,
            metrics: Metrics::new(&prepared.banded_mps2, &segmentation)?,
            phases,
            segmentation,
        })
    }

    pub(crate) fn prepare(&self, log: &DriveLog) -> Result<Prepared, Error> {
        let accel_mps2 = log.accel_mps2();
        let banded_mps2 = dead_banded(&accel_mps2, self.accel_deadband_mps2)?;
        let [speed, accel] = self.scaling.scaled(log.speed_mps(), &banded_mps2)?;
        let [speed_weight, accel_weight] = self.weights;
        let series = Series::new(&[(&speed, speed_weight), (&accel, accel_weight)])?;
        Ok(Prepared {
            accel_mps2,
            banded_mps2,
            series,
        })
    }

    /// The method alone, without merging.
    pub(crate) fn cut(
        &self,
        series: &Series,
        progress: &Progress<'_>,
    ) -> Result<(Segmentation, Option<Optimality>), Error> {
        let segmentation = match self.method {
            Method::Dynamic {
                segments,
                min_length,
            } => {
                let (best, optimality) =
                    optimum(self.cost, segments, min_length, series, progress)?;
                return Ok((best, Some(optimality)));
            }
            Method::BottomUp { threshold, stop } => BottomUp::new(self.cost, threshold)?
                .with_stop(stop)
                .segment(series),
            Method::SlidingWindow { threshold } => {
                SlidingWindow::new(self.cost, threshold)?.segment(series)
            }
            Method::Swab {
                threshold,
                window,
                refill,
            } => Swab::new(self.cost, threshold, window)?
                .with_refill(refill)
                .segment(series),
        };
        Ok((segmentation, None))
    }

    /// The rules of section 3.2; the dead band is the threshold `a_thresh`.
    pub(crate) fn classify(&self, tally: &Tally, step_s: f64) -> PhaseKind {
        let n = tally.samples as f64;
        if tally.accelerating as f64 / n >= 0.5 {
            PhaseKind::Acceleration
        } else if tally.braking as f64 / n >= 0.5 {
            PhaseKind::Braking
        } else if (tally.accelerating + tally.braking) as f64 / n <= 0.1
            && above(n * step_s, self.cruise_min_duration_s)
            && above(tally.mean_speed_mps(), self.cruise_min_speed_mps)
        {
            PhaseKind::Cruise
        } else {
            PhaseKind::Other
        }
    }
}

fn optimum(
    cost: Cost,
    segments: Segments,
    min_length: usize,
    series: &Series,
    progress: &Progress<'_>,
) -> Result<(Segmentation, Optimality), Error> {
    let dynamic = match segments {
        Segments::Exactly(most) => Dynamic::new(cost, most)?,
        Segments::AtMost(most) => Dynamic::new(cost, most)?.at_most(),
        Segments::AtKnee => {
            let path = PenaltyPath::new(cost, min_length, series, progress)?;
            let points = path.points.iter();
            let curve = points
                .map(|p| (p.segmentation.segment_count(), p.cost))
                .collect();
            let chosen = path.at_knee().segmentation.clone();
            return Ok((chosen, Optimality { gap: 0.0, curve }));
        }
    };
    let best = dynamic
        .with_min_length(min_length)
        .segment_with(series, progress)?;
    let gap = match best.certificate {
        Certificate::Optimal => 0.0,
        Certificate::Gap(gap) => gap,
    };
    let curve = Vec::new();
    Ok((best.segmentation, Optimality { gap, curve }))
}

/// What the segmentation of a drive needs of it.
pub(crate) struct Prepared {
    accel_mps2: Vec<f64>,
    pub(crate) banded_mps2: Vec<f64>,
    /// Speed and dead-banded acceleration, scaled.
    pub(crate) series: Series,
}

/// `a := 0` where `|a| < threshold` (strict), compared on a grid of 2⁻¹⁴ m/s².
///
/// # Errors
/// [`Error::Option`] for a threshold that is not at least 0.
pub fn dead_banded(accel_mps2: &[f64], threshold_mps2: f64) -> Result<Vec<f64>, Error> {
    check_deadband(threshold_mps2)?;
    let banded = |&a: &f64| banded(a, threshold_mps2);
    Ok(accel_mps2.iter().map(banded).collect())
}

pub(crate) fn check_deadband(threshold_mps2: f64) -> Result<(), Error> {
    error::at_least(
        "accel_deadband_mps2",
        threshold_mps2,
        0.0,
        "at least 0 m/s²",
    )
}

pub(crate) fn banded(accel_mps2: f64, threshold_mps2: f64) -> f64 {
    if below(accel_mps2.abs(), threshold_mps2) {
        0.0
    } else {
        accel_mps2
    }
}
