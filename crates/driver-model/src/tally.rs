use crate::grid::above;

/// What classifying a segment takes of its samples. Adds up sample by sample, so that a stream need not keep them.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Tally {
    pub(crate) samples: usize,
    /// Samples above the threshold.
    pub(crate) accelerating: usize,
    /// Samples below the negative threshold.
    pub(crate) braking: usize,
    speed_sum_mps: f64,
    accel_sum_mps2: f64,
}

impl Tally {
    pub(crate) fn of(speed_mps: &[f64], accel_mps2: &[f64], threshold_mps2: f64) -> Self {
        let mut tally = Self::default();
        for (&speed, &accel) in speed_mps.iter().zip(accel_mps2) {
            tally.add(speed, accel, threshold_mps2);
        }
        tally
    }

    pub(crate) fn add(&mut self, speed_mps: f64, accel_mps2: f64, threshold_mps2: f64) {
        self.samples += 1;
        self.accelerating += usize::from(above(accel_mps2, threshold_mps2));
        self.braking += usize::from(above(-accel_mps2, threshold_mps2));
        self.speed_sum_mps += speed_mps;
        self.accel_sum_mps2 += accel_mps2;
    }

    pub(crate) fn mean_speed_mps(&self) -> f64 {
        self.speed_sum_mps / self.samples as f64
    }

    /// Without a dead band.
    pub(crate) fn mean_accel_mps2(&self) -> f64 {
        self.accel_sum_mps2 / self.samples as f64
    }
}
