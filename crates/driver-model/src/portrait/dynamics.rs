use drive_log::DriveLog;
use serde::Serialize;

use crate::statistics::quantile;

/// How lively the driving is; the first two figures are those of the European test of real driving emissions
/// (Regulation 2017/1151, annex IIIA, appendix 7a).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Dynamics {
    /// Relative positive acceleration, `∫ v a⁺ dt` over the distance, counting `a` over 0.1 m/s².
    pub relative_positive_accel_mps2: f64,
    /// 95th percentile of `v·a` where `a` is over 0.1 m/s².
    pub speed_times_accel_p95_m2ps3: f64,
    /// Root mean square of the acceleration in motion.
    pub accel_rms_mps2: f64,
    /// Root mean square of the jerk in motion, from acceleration in means of half a second.
    pub jerk_rms_mps3: f64,
    /// Standstills per km.
    pub stops_per_km: f64,
    /// Share of the time in motion with an acceleration under 0.1 m/s² in magnitude: at a steady speed or coasting.
    pub steady_pct: f64,
}

const MOVING_MPS: f64 = 1.0;
const NOTABLE_ACCEL_MPS2: f64 = 0.1;
const JERK_STEP_S: f64 = 0.5;

impl Dynamics {
    pub(super) fn of(logs: &[&DriveLog]) -> Self {
        let mut sums = Sums::default();
        for log in logs {
            sums.add(log);
        }
        sums.products.sort_by(f64::total_cmp);
        let moving = sums.moving_s;
        Self {
            relative_positive_accel_mps2: sums.positive_work / sums.distance_m,
            speed_times_accel_p95_m2ps3: quantile(&sums.products, 0.95).unwrap_or(f64::NAN),
            accel_rms_mps2: (sums.accel_squares / moving).sqrt(),
            jerk_rms_mps3: (sums.jerk_squares / sums.jerks).sqrt(),
            stops_per_km: 1e3 * sums.stops / sums.distance_m,
            steady_pct: 100.0 * sums.steady_s / moving,
        }
    }
}

#[derive(Default)]
struct Sums {
    distance_m: f64,
    positive_work: f64,
    products: Vec<f64>,
    moving_s: f64,
    steady_s: f64,
    accel_squares: f64,
    jerk_squares: f64,
    jerks: f64,
    stops: f64,
}

impl Sums {
    fn add(&mut self, log: &DriveLog) {
        let (speed_mps, accel_mps2, step_s) = (log.speed_mps(), log.accel_mps2(), log.step_s());
        let mut was_moving = false;
        for (&v, &a) in speed_mps.iter().zip(&accel_mps2) {
            self.distance_m += v.abs() * step_s;
            if a > NOTABLE_ACCEL_MPS2 {
                self.positive_work += v * a * step_s;
                self.products.push(v * a);
            }
            let moving = v >= MOVING_MPS;
            if moving {
                self.moving_s += step_s;
                self.accel_squares += a * a * step_s;
                self.steady_s += if a.abs() < NOTABLE_ACCEL_MPS2 {
                    step_s
                } else {
                    0.0
                };
            }
            self.stops += f64::from(u8::from(was_moving && !moving));
            was_moving = moving;
        }
        let every = (JERK_STEP_S / step_s).round().max(1.0) as usize;
        let means: Vec<f64> = accel_mps2
            .chunks_exact(every)
            .map(|chunk| chunk.iter().sum::<f64>() / every as f64)
            .collect();
        let starts = speed_mps.iter().step_by(every);
        for (pair, &v) in means.windows(2).zip(starts) {
            if v >= MOVING_MPS {
                self.jerk_squares += ((pair[1] - pair[0]) / (every as f64 * step_s)).powi(2);
                self.jerks += 1.0;
            }
        }
    }
}
