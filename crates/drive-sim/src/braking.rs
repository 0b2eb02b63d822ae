/// Braking over a given distance. Speed at the share `s` of the duration `T`:
///
/// `v = v0 − (v0 − v_end) (4s³ − 3s⁴) + a0 T s (1 − s)⁴`
///
/// The last term carries on with the acceleration `a0` before the braking and lets it fade.
#[derive(Debug, Clone, Copy)]
pub(super) struct Braking {
    from_mps: f64,
    to_mps: f64,
    accel_mps2: f64,
    pub(super) duration_s: f64,
}

/// Means over `s` of `4s³ − 3s⁴` and of `s (1 − s)⁴`.
const MEAN_FALL: f64 = 0.4;
const MEAN_FADING: f64 = 1.0 / 30.0;

impl Braking {
    /// From a speed and an acceleration to a lower speed over a distance, which is the mean speed times `T`.
    pub(super) fn over(from_mps: f64, accel_mps2: f64, to_mps: f64, distance_m: f64) -> Self {
        let mean_mps = from_mps - MEAN_FALL * (from_mps - to_mps);
        let square = mean_mps * mean_mps + 4.0 * MEAN_FADING * accel_mps2 * distance_m;
        Self {
            from_mps,
            to_mps,
            accel_mps2,
            duration_s: 2.0 * distance_m / (mean_mps + square.max(0.0).sqrt()),
        }
    }

    pub(super) fn speed_mps(&self, time_s: f64) -> f64 {
        if time_s >= self.duration_s {
            return self.to_mps;
        }
        let s = time_s / self.duration_s;
        let fall = s * s * s * (4.0 - 3.0 * s);
        let fading_s = time_s * (1.0 - s).powi(4);
        (self.from_mps - (self.from_mps - self.to_mps) * fall + self.accel_mps2 * fading_s).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn braking_covers_its_distance_and_starts_as_it_was() {
        for (from, accel, to) in [(14.0, 0.0, 0.0), (28.0, 1.5, 14.0), (9.0, -0.8, 4.0)] {
            let braking = Braking::over(from, accel, to, 150.0);
            let steps = 10_000;
            let step_s = braking.duration_s / f64::from(steps);
            let midpoints = (0..steps).map(|k| braking.speed_mps((f64::from(k) + 0.5) * step_s));
            let distance_m: f64 = midpoints.map(|v| v * step_s).sum();
            assert!((distance_m - 150.0).abs() < 1e-4, "{distance_m}");
            assert!((braking.speed_mps(0.0) - from).abs() < 1e-12);
            assert!((braking.speed_mps(braking.duration_s) - to).abs() < 1e-12);
            assert!((braking.speed_mps(1e-6) - from - accel * 1e-6).abs() < 1e-9);
        }
    }
}
