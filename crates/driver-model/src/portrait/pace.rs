use serde::Serialize;

use super::Distribution;
use crate::{DriveBehaviour, PhaseKind};

/// Acceleration or deceleration over speed, from the samples of segments without a leader.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AccelOverSpeed {
    /// Segments.
    pub segments: usize,
    /// Mean speed and mean acceleration of each segment.
    pub means: Vec<[f64; 2]>,
    /// By speed, those with too little time left out.
    pub bins: Vec<AccelBin>,
    /// Over all samples; `None` without a segment.
    pub accel_mps2: Option<Distribution>,
}

/// Samples of similar speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AccelBin {
    /// Speeds from here …
    pub from_mps: f64,
    /// … to here.
    pub to_mps: f64,
    /// Samples in it.
    pub samples: usize,
    /// Magnitude of the acceleration.
    pub accel_mps2: Distribution,
}

/// Width of a bin, 10 km/h.
const BIN_MPS: f64 = 10.0 / 3.6;

/// Bins with fewer samples say nothing of a driver: 3 s at 10 Hz.
const LEAST_SAMPLES: usize = 30;

impl AccelOverSpeed {
    pub(super) fn of(kind: PhaseKind, trips: &[DriveBehaviour]) -> Self {
        let segments = || trips.iter().flat_map(|trip| trip.segments_of(kind));
        let mut bins: Vec<Vec<f64>> = Vec::new();
        for point in segments().flat_map(|s| &s.samples) {
            let bin = (point.speed_mps / BIN_MPS).clamp(0.0, 99.0) as usize;
            if bins.len() <= bin {
                bins.resize(bin + 1, Vec::new());
            }
            bins[bin].push(point.accel_mps2);
        }
        let all = bins.concat();
        let bins = bins.into_iter().enumerate().filter_map(|(k, values)| {
            let samples = values.len();
            let accel_mps2 = Distribution::of(values)?;
            (samples >= LEAST_SAMPLES).then_some(AccelBin {
                from_mps: k as f64 * BIN_MPS,
                to_mps: (k + 1) as f64 * BIN_MPS,
                samples,
                accel_mps2,
            })
        });
        Self {
            segments: segments().count(),
            means: segments()
                .map(|s| [s.mean.speed_mps, s.mean.accel_mps2])
                .collect(),
            bins: bins.collect(),
            accel_mps2: Distribution::of(all),
        }
    }
}
