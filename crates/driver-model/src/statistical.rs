use drive_log::DriveLog;
use tseg::{BottomUp, Cost, Metrics, Refill, Scale, Segmentation, Series, Swab, merge_percentile};

use crate::{Error, Phase, PhaseKind};

/// How a drive is cut into segments by statistics, and how segments become phases (thesis 3.1.3, 3.1.5, 3.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatisticalRules {
    /// Acceleration under this magnitude counts as 0; 0.4 m/s².
    pub accel_deadband_mps2: f64,
    /// Method; SWAB with a window of 100 samples.
    pub method: Method,
    /// Segment cost; (3.22).
    pub cost: Cost,
    /// Threshold of the cost; 0.2.
    pub threshold: f64,
    /// Weights of speed and acceleration; 1.8 and 1.
    pub weights: [f64; 2],
    /// Scaling of both before segmentation, see [`StatisticalRules::default`].
    pub scale: Scale,
    /// Neighbours above this percentile similarity are merged; 0.64. `None` merges nothing.
    pub merge_threshold: Option<f64>,
    /// A cruise phase is longer than this; 3 s.
    pub cruise_min_duration_s: f64,
    /// A cruise phase is faster than this on average; 30 km/h.
    pub cruise_min_speed_mps: f64,
}

/// Statistical segmentation methods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Merge the cheapest neighbours until the cheapest costs more than the threshold.
    BottomUp,
    /// The same in a sliding window.
    Swab {
        /// Length in samples.
        window: usize,
        /// How the window is refilled.
        refill: Refill,
    },
}

impl Default for StatisticalRules {
    /// The thesis's parameters. It does not say how its variables were scaled. Standardising them gives SWAB segments of
    /// 35 ± 51 samples on WLTC at 10 Hz, where its Table 3.5 has 36 ± 45; mapping them to [−1, 1] comes as near on the
    /// first 3,000 samples (39 ± 44), but leaves hardly any segment that is pure enough to be a cruise phase.
    fn default() -> Self {
        Self {
            accel_deadband_mps2: 0.4,
            method: Method::Swab {
                window: 100,
                refill: Refill::Keogh,
            },
            cost: Cost::MeanDeviation,
            threshold: 0.2,
            weights: [1.8, 1.0],
            scale: Scale::ZScore,
            merge_threshold: Some(0.64),
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
    /// One phase per segment.
    pub phases: Vec<Phase>,
    /// Homogeneity, on the dead-banded acceleration.
    pub metrics: Metrics,
}

impl Segmented {
    /// Every phase with its mean speed in m/s and mean acceleration in m/s² (raw, no dead band).
    pub fn means(&self, log: &DriveLog) -> impl Iterator<Item = (&Phase, f64, f64)> {
        let (speed, accel) = (log.speed_mps(), log.accel_mps2());
        self.phases.iter().map(move |phase| {
            let range = phase.start..phase.end;
            (phase, mean(&speed[range.clone()]), mean(&accel[range]))
        })
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

impl StatisticalRules {
    /// Segments a drive and classifies the segments.
    ///
    /// # Errors
    /// [`Error::Option`] and [`Error::Segmentation`] for parameters out of range.
    pub fn segment(&self, log: &DriveLog) -> Result<Segmented, Error> {
        let accel = dead_banded(&log.accel_mps2(), self.accel_deadband_mps2)?;
        let scaled_speed = self.scale.scaled(log.speed_mps());
        let scaled_accel = self.scale.scaled(&accel);
        let [speed_weight, accel_weight] = self.weights;
        let series = Series::new(&[(&scaled_speed, speed_weight), (&scaled_accel, accel_weight)])?;
        let mut segmentation = match self.method {
            Method::BottomUp => BottomUp::new(self.cost, self.threshold)?.segment(&series),
            Method::Swab { window, refill } => Swab::new(self.cost, self.threshold, window)?
                .with_refill(refill)
                .segment(&series),
        };
        if let Some(threshold) = self.merge_threshold {
            segmentation = merge_percentile(&accel, &segmentation, threshold)?;
        }
        let phases = segmentation
            .iter()
            .map(|range| {
                let (speed, accel) = (&log.speed_mps()[range.clone()], &accel[range.clone()]);
                Phase::of(log, range, self.classify(speed, accel, log.step_s()))
            })
            .collect();
        Ok(Segmented {
            cost: Some(self.cost.total(&series, &segmentation)?),
            metrics: Metrics::new(&accel, &segmentation)?,
            phases,
            segmentation,
        })
    }

    /// The rules of section 3.2; the dead band is the threshold `a_thresh`.
    fn classify(&self, speed_mps: &[f64], accel_mps2: &[f64], step_s: f64) -> PhaseKind {
        let n = accel_mps2.len() as f64;
        let threshold = self.accel_deadband_mps2;
        let share =
            |test: &dyn Fn(f64) -> bool| accel_mps2.iter().filter(|&&a| test(a)).count() as f64 / n;
        if share(&|a| a > threshold) >= 0.5 {
            PhaseKind::Acceleration
        } else if share(&|a| a < -threshold) >= 0.5 {
            PhaseKind::Braking
        } else if share(&|a| a.abs() > threshold) <= 0.1
            && n * step_s > self.cruise_min_duration_s
            && mean(speed_mps) > self.cruise_min_speed_mps
        {
            PhaseKind::Cruise
        } else {
            PhaseKind::Other
        }
    }
}

/// `a := 0` where `|a| < threshold` (strict).
///
/// # Errors
/// [`Error::Option`] for a threshold that is not at least 0.
pub fn dead_banded(accel_mps2: &[f64], threshold_mps2: f64) -> Result<Vec<f64>, Error> {
    Error::unless_at_least(
        "accel_deadband_mps2",
        threshold_mps2,
        0.0,
        "at least 0 m/s²",
    )?;
    let banded = |&a: &f64| if a.abs() < threshold_mps2 { 0.0 } else { a };
    Ok(accel_mps2.iter().map(banded).collect())
}
