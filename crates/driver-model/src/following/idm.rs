use serde::{Deserialize, Serialize};

use super::{FULL_BRAKING_MPS2, SMALLEST_GAP_M};

/// Intelligent driver model: how the driver follows a vehicle ahead (Treiber, Hennecke, Helbing 2000).
///
/// `a = a_max [1 − (v/v_desired)^4 − (s*/s)²]`, `s* = s0 + v T + v Δv/(2 √(a_max b))`, with gap `s` and closing speed `Δv`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Idm {
    /// Largest acceleration `a_max`.
    pub max_accel_mps2: f64,
    /// Comfortable deceleration `b`, above 0.
    pub comfortable_decel_mps2: f64,
    /// Time headway `T`.
    pub time_headway_s: f64,
    /// Gap at standstill `s0`.
    pub standstill_gap_m: f64,
}

impl Default for Idm {
    fn default() -> Self {
        Self {
            max_accel_mps2: 1.3,
            comfortable_decel_mps2: 1.7,
            time_headway_s: 1.4,
            standstill_gap_m: 2.0,
        }
    }
}

impl Idm {
    /// Acceleration in m/s² at a speed, the speed wanted on a free road, a gap to the vehicle ahead, and its speed.
    #[must_use]
    pub fn accel_mps2(
        &self,
        speed_mps: f64,
        desired_speed_mps: f64,
        gap_m: f64,
        lead_speed_mps: f64,
    ) -> f64 {
        let closing_mps = speed_mps - lead_speed_mps;
        let braking = 2.0 * (self.max_accel_mps2 * self.comfortable_decel_mps2).sqrt();
        let dynamic_m = speed_mps * self.time_headway_s + speed_mps * closing_mps / braking;
        let wanted_gap_m = self.standstill_gap_m + dynamic_m.max(0.0);
        let free = (speed_mps / desired_speed_mps).powi(4);
        let interaction = (wanted_gap_m / gap_m.max(SMALLEST_GAP_M)).powi(2);
        (self.max_accel_mps2 * (1.0 - free - interaction)).max(-FULL_BRAKING_MPS2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rests_at_the_equilibrium_gap() {
        let idm = Idm::default();
        let (v, desired): (f64, f64) = (10.0, 14.0);
        let gap_m = (2.0 + v * 1.4) / (1.0 - (v / desired).powi(4)).sqrt();
        assert!(idm.accel_mps2(v, desired, gap_m, v).abs() < 1e-12);
        assert!(idm.accel_mps2(v, desired, gap_m - 1.0, v) < 0.0);
        assert!(idm.accel_mps2(v, desired, gap_m, v - 1.0) < 0.0);
    }

    #[test]
    fn drives_freely_far_from_the_leader() {
        let idm = Idm::default();
        assert!((idm.accel_mps2(0.0, 14.0, 1e6, 14.0) - 1.3).abs() < 1e-9);
        assert!(idm.accel_mps2(14.0, 14.0, 1e6, 14.0).abs() < 1e-6);
    }
}
