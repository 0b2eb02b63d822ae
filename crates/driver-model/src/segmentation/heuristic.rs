use drive_log::DriveLog;
use tseg::{Metrics, Segmentation};

use crate::grid::{above, at_least};
use crate::segmentation::{Segmented, dead_banded};
use crate::{Error, PhaseKind, Span};

/// Thresholds of Table 3.1, by which every sample is labelled alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeuristicRules {
    /// At least this accelerates, at most its negative brakes; 0.3 m/s².
    pub accel_threshold_mps2: f64,
    /// A whole phase ends where its acceleration falls below this magnitude, above 0; 0.05 m/s².
    pub end_accel_mps2: f64,
    /// Cruising is faster than this; 30 km/h.
    pub cruise_speed_mps: f64,
    /// Acceleration under this magnitude counts as 0 in the homogeneity figures, and only there; 0.4 m/s².
    pub accel_deadband_mps2: f64,
}

impl Default for HeuristicRules {
    fn default() -> Self {
        Self {
            accel_threshold_mps2: 0.3,
            end_accel_mps2: 0.05,
            cruise_speed_mps: 30.0 / 3.6,
            accel_deadband_mps2: 0.4,
        }
    }
}

impl HeuristicRules {
    pub(crate) fn label(&self, speed_mps: f64, accel_mps2: f64) -> PhaseKind {
        if at_least(accel_mps2, self.accel_threshold_mps2) {
            PhaseKind::Acceleration
        } else if at_least(-accel_mps2, self.accel_threshold_mps2) {
            PhaseKind::Braking
        } else if above(speed_mps, self.cruise_speed_mps) {
            PhaseKind::Cruise
        } else {
            PhaseKind::Other
        }
    }

    /// Runs of samples with the same label (Algorithm 1), from speed and raw acceleration.
    ///
    /// # Errors
    /// [`Error::Option`] for a dead band that is not at least 0.
    pub fn segment(&self, log: &DriveLog) -> Result<Segmented, Error> {
        let (segmentation, kinds) = self.cut(log.speed_mps(), &log.accel_mps2())?;
        let phases = segmentation
            .iter()
            .zip(kinds)
            .map(|(range, kind)| Span::of(log, range, kind))
            .collect();
        Ok(Segmented {
            metrics: Metrics::new(&self.banded(log)?, &segmentation)?,
            cost: None,
            optimality: None,
            phases,
            segmentation,
        })
    }

    pub(crate) fn cut(
        &self,
        speed_mps: &[f64],
        accel_mps2: &[f64],
    ) -> Result<(Segmentation, Vec<PhaseKind>), Error> {
        let samples = speed_mps.iter().zip(accel_mps2);
        let labels: Vec<PhaseKind> = samples.map(|(&v, &a)| self.label(v, a)).collect();
        Ok(tseg::runs(&labels)?)
    }

    /// The acceleration that the homogeneity figures are about.
    pub(crate) fn banded(&self, log: &DriveLog) -> Result<Vec<f64>, Error> {
        dead_banded(&log.accel_mps2(), self.accel_deadband_mps2)
    }
}
