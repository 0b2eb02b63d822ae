use serde::Serialize;

use super::{FollowingModel, FollowingStretch, SMALLEST_GAP_M};
use crate::statistics::mean;

/// What a model makes of a stretch.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedFollowing {
    /// Speed at every sample of the stretch, at least 0.
    pub speed_mps: Vec<f64>,
    /// Gap at the same samples, at least 0.1 m.
    pub gap_m: Vec<f64>,
    /// How often the model ran into the leader. It goes on at 0.1 m.
    pub collisions: usize,
}

/// How far a model is off on one stretch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FollowingErrors {
    /// Root mean square error of the gap.
    pub gap_rmse_m: f64,
    /// Root mean square error of the speed.
    pub speed_rmse_mps: f64,
    /// Root mean square error of the gap over the root mean square of the measured gap.
    pub gap_rmse_relative: f64,
    /// How often the model ran into the leader.
    pub collisions: usize,
}

impl FollowingModel {
    /// Drives a whole stretch behind the recorded leader, from the measured speed and gap of its first sample.
    ///
    /// The step is that of the log: `v' = max(0, v + a Δt)`, the gap by the trapezoidal rule (ballistic update).
    #[must_use]
    pub fn simulate(&self, stretch: &FollowingStretch) -> SimulatedFollowing {
        let samples = stretch.speed_mps().len();
        let mut simulated = SimulatedFollowing {
            speed_mps: Vec::with_capacity(samples),
            gap_m: Vec::with_capacity(samples),
            collisions: 0,
        };
        let (speeds, gaps) = (&mut simulated.speed_mps, &mut simulated.gap_m);
        simulated.collisions = self.drive(stretch, |speed_mps, gap_m| {
            speeds.push(speed_mps);
            gaps.push(gap_m);
        });
        simulated
    }

    /// Simulates a stretch and compares.
    #[must_use]
    pub fn errors(&self, stretch: &FollowingStretch) -> FollowingErrors {
        let simulated = self.simulate(stretch);
        let gap_rmse_m = rmse(&simulated.gap_m, stretch.gap_m());
        FollowingErrors {
            gap_rmse_m,
            speed_rmse_mps: rmse(&simulated.speed_mps, stretch.speed_mps()),
            gap_rmse_relative: gap_rmse_m / root_mean_square(stretch.gap_m()),
            collisions: simulated.collisions,
        }
    }

    /// Calls `visit` with speed and gap at every sample; the number of collisions.
    pub(super) fn drive(&self, stretch: &FollowingStretch, visit: impl FnMut(f64, f64)) -> usize {
        // One loop per law: what depends on parameters alone is computed once.
        match self {
            Self::Idm {
                idm,
                desired_speed_mps,
            } => drive(stretch, visit, |speed_mps, gap_m, lead_mps| {
                idm.accel_mps2(speed_mps, *desired_speed_mps, gap_m, lead_mps)
            }),
            Self::ConstantTimeGap(law) => drive(stretch, visit, |speed_mps, gap_m, lead_mps| {
                law.accel_mps2(speed_mps, gap_m, lead_mps)
            }),
        }
    }
}

fn drive(
    stretch: &FollowingStretch,
    mut visit: impl FnMut(f64, f64),
    accel_mps2: impl Fn(f64, f64, f64) -> f64,
) -> usize {
    let lead_mps = stretch.lead_speed_mps();
    let half_step_s = 0.5 * stretch.step_s();
    let (mut speed_mps, mut gap_m) = (stretch.speed_mps()[0].max(0.0), stretch.gap_m()[0]);
    let (mut collisions, mut collided) = (0, false);
    visit(speed_mps, gap_m);
    for pair in lead_mps.windows(2) {
        let accel_mps2 = accel_mps2(speed_mps, gap_m, pair[0]);
        let next_mps = (speed_mps + accel_mps2 * stretch.step_s()).max(0.0);
        gap_m += half_step_s * (pair[0] + pair[1] - speed_mps - next_mps);
        speed_mps = next_mps;
        let ran_into = gap_m <= 0.0;
        collisions += usize::from(ran_into && !collided);
        collided = ran_into || (collided && gap_m <= SMALLEST_GAP_M);
        gap_m = gap_m.max(SMALLEST_GAP_M);
        visit(speed_mps, gap_m);
    }
    collisions
}

fn rmse(found: &[f64], measured: &[f64]) -> f64 {
    let squares: f64 = found
        .iter()
        .zip(measured)
        .map(|(f, m)| (f - m).powi(2))
        .sum();
    (squares / measured.len() as f64).sqrt()
}

pub(super) fn root_mean_square<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    let squares = values.into_iter().map(|value| value * value);
    mean(squares).unwrap_or(0.0).sqrt()
}
