use serde::{Deserialize, Serialize};

use super::FULL_BRAKING_MPS2;

/// Constant-time-gap law: the gap aimed at is `s0 + τ v`, at least 1 m, and its error decays with the rate `λ`.
///
/// `a = (v_lead − v + λ (s − s0 − τ v))/τ`, so that `e = s − s0 − τ v` obeys `ė = −λ e`, within −8 to 4 m/s².
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConstantTimeGap {
    /// Time gap `τ`, above 0.
    pub time_gap_s: f64,
    /// Gap at standstill `s0`, on the line of the gaps at the speeds that were driven: below 0 where they grow faster than the
    /// speed.
    pub standstill_gap_m: f64,
    /// Decay rate `λ` of an error of the gap.
    pub gap_gain_per_s: f64,
}

/// More than drivers of ordinary cars use; the law itself knows no limit.
const MAX_ACCEL_MPS2: f64 = 4.0;

/// Nobody aims at less, whatever line the gaps at higher speeds are on.
const SMALLEST_WANTED_GAP_M: f64 = 1.0;

impl ConstantTimeGap {
    /// The gap in m that is aimed at: `s0 + τ v`, at least 1 m.
    #[must_use]
    pub fn wanted_gap_m(&self, speed_mps: f64) -> f64 {
        (self.standstill_gap_m + self.time_gap_s * speed_mps).max(SMALLEST_WANTED_GAP_M)
    }

    /// Acceleration in m/s² at a speed, a gap to the vehicle ahead, and its speed.
    #[must_use]
    pub fn accel_mps2(&self, speed_mps: f64, gap_m: f64, lead_speed_mps: f64) -> f64 {
        let error_m = gap_m - self.wanted_gap_m(speed_mps);
        let wanted = (lead_speed_mps - speed_mps + self.gap_gain_per_s * error_m) / self.time_gap_s;
        wanted.clamp(-FULL_BRAKING_MPS2, MAX_ACCEL_MPS2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rests_at_its_gap_and_keeps_its_limits() {
        let law = ConstantTimeGap {
            time_gap_s: 1.5,
            standstill_gap_m: 2.0,
            gap_gain_per_s: 0.2,
        };
        assert!(law.accel_mps2(10.0, 17.0, 10.0).abs() < 1e-12);
        // ė = v_lead − v − τ a = −λ e
        let (error_m, speed, lead): (f64, f64, f64) = (3.0, 10.0, 11.0);
        let accel = law.accel_mps2(speed, 17.0 + error_m, lead);
        assert!((lead - speed - 1.5 * accel + 0.2 * error_m).abs() < 1e-12);
        assert!((law.accel_mps2(0.0, 1e6, 0.0) - MAX_ACCEL_MPS2).abs() < 1e-12);
        assert!((law.accel_mps2(40.0, 0.0, 0.0) + FULL_BRAKING_MPS2).abs() < 1e-12);
    }
}
