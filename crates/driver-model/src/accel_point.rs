/// Acceleration at a speed, of one sample or in the mean of a segment. Of braking it is the magnitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AccelPoint {
    /// Speed.
    pub speed_mps: f64,
    /// Acceleration in the direction of the phase.
    pub accel_mps2: f64,
    /// Above 0; 1 for the driver's own.
    pub weight: f64,
}

impl AccelPoint {
    /// With weight 1.
    #[must_use]
    pub fn new(speed_mps: f64, accel_mps2: f64) -> Self {
        Self {
            speed_mps,
            accel_mps2,
            weight: 1.0,
        }
    }
}
