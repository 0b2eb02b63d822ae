use driver_model::following::Idm;
use driver_model::phase_model::{
    Constant, Exponential, GroupConstant, Inverse, Profile, RiseTime, SpeedGroup,
};
use driver_model::{DriverInput, ModelKind, Phase, PhaseModel};
use serde::Serialize;

use crate::Error;
use crate::error::check;
use crate::random::Random;

/// A driver whose every habit is known.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SimulatedDriver {
    /// How speed rises in an acceleration phase; the model that a fit should find.
    pub acceleration: PhaseModel,
    /// How long an acceleration phase takes, for models that do not tell: `profile`, `straight` and `smoothstep`.
    pub acceleration_pace: Pace,
    /// How long braking takes where nothing is in the way. Speed falls by `4s³ − 3s⁴` over the share `s` of that time,
    /// from lift-off at `s = 0` to no deceleration at `s = 1`, and the lower speed is reached at the sign.
    /// An acceleration before it fades out meanwhile.
    pub braking_pace: Pace,
    /// Speed on a free road.
    pub cruise: Cruise,
    /// Behind a vehicle.
    pub following: Idm,
}

/// Mean acceleration of a phase, `a = scale · (|v_end − v0|/(1 m/s))^gain_exponent · e^(−speed_decay · (v0 + v_end)/2)`.
///
/// Drivers take a large change of speed more briskly than a small one, and accelerate less at high speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Pace {
    /// Mean acceleration for a change of 1 m/s near standstill.
    pub scale_mps2: f64,
    /// Growth with the change of speed, 0 to 0.9.
    pub gain_exponent: f64,
    /// Decay with the mean speed of the phase.
    pub speed_decay_s_per_m: f64,
}

/// Speed on a free road: limit plus bias, with correlated deviations.
///
/// The deviation is a first-order autoregressive process, and speed follows limit, bias and deviation with a lag.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cruise {
    /// What the driver adds to every limit.
    pub bias_mps: f64,
    /// Standard deviation of the bias from one stretch to the next, at variation 1.
    pub bias_spread_mps: f64,
    /// Standard deviation of the process, at variation 1.
    pub deviation_mps: f64,
    /// Its correlation time.
    pub correlation_s: f64,
    /// Time constant with which speed follows.
    pub response_s: f64,
}

/// Spreads from one phase to the next at variation 1: logarithm of the pace, and the two terms of [`PhaseHabit::warp`].
/// They leave the mean shape about as many samples in a band of 3 km/h, three quarters, as recorded drives of an
/// electric car do.
const PACE_LOG_SPREAD: f64 = 0.2;
const EARLINESS_SPREAD: f64 = 0.26;
const HESITATION_SPREAD: f64 = 0.1;

/// Acceleration phases end here at the latest, such as those of models that never reach the speed aimed at.
const LONGEST_PHASE_S: f64 = 90.0;

impl Default for SimulatedDriver {
    /// Accelerates by `profile`.
    fn default() -> Self {
        Self::accelerating_by(PhaseModel::Profile(press_hold_release()))
    }
}

impl SimulatedDriver {
    /// Models by which a simulated driver may accelerate: those whose few parameters say all.
    pub const KINDS: [ModelKind; 8] = [
        ModelKind::Inverse,
        ModelKind::Exponential,
        ModelKind::ExponentialAmplitude,
        ModelKind::RiseTime,
        ModelKind::Profile,
        ModelKind::Constant,
        ModelKind::Straight,
        ModelKind::Smoothstep,
    ];

    /// A driver who accelerates by a model of this kind, with parameters of an ordinary driver; `None` for one that is not in
    /// [`SimulatedDriver::KINDS`].
    #[must_use]
    pub fn with(kind: ModelKind) -> Option<Self> {
        let acceleration = match kind {
            ModelKind::Inverse => PhaseModel::Inverse(Inverse { p1: 0.03, p2: 0.5 }),
            ModelKind::Exponential => PhaseModel::Exponential(Exponential {
                p0: 1.0,
                p1: 0.06,
                p2: 0.5,
            }),
            ModelKind::ExponentialAmplitude => PhaseModel::ExponentialAmplitude(Exponential {
                p0: 1.7,
                p1: 0.08,
                p2: 0.35,
            }),
            ModelKind::RiseTime => PhaseModel::RiseTime(rise_time()),
            ModelKind::Profile => PhaseModel::Profile(press_hold_release()),
            ModelKind::Constant => PhaseModel::Constant(Constant { accel_mps2: 1.2 }),
            ModelKind::Straight => PhaseModel::Straight,
            ModelKind::Smoothstep => PhaseModel::Smoothstep,
            _ => return None,
        };
        Some(Self::accelerating_by(acceleration))
    }

    fn accelerating_by(acceleration: PhaseModel) -> Self {
        Self {
            acceleration,
            acceleration_pace: Pace {
                scale_mps2: 0.48,
                gain_exponent: 0.4,
                speed_decay_s_per_m: 0.009,
            },
            braking_pace: Pace {
                scale_mps2: 0.4,
                gain_exponent: 0.35,
                speed_decay_s_per_m: 0.0,
            },
            cruise: Cruise {
                bias_mps: 0.8,
                bias_spread_mps: 0.4,
                deviation_mps: 0.35,
                correlation_s: 8.0,
                response_s: 2.5,
            },
            following: Idm::default(),
        }
    }

    /// Speed at every sample of an acceleration phase, from the start speed to the last sample that the model reaches
    /// without exceeding `target_mps`. At least two samples.
    pub(super) fn acceleration_curve(
        &self,
        start_mps: f64,
        target_mps: f64,
        step_s: f64,
        habit: &PhaseHabit,
    ) -> Vec<f64> {
        let predict = |step_s: f64, duration_s: f64| {
            let steps = (duration_s.min(LONGEST_PHASE_S) / step_s).round().max(1.0);
            self.acceleration.predict(&Phase {
                start_speed_mps: start_mps,
                end_speed_mps: target_mps,
                step_s,
                samples: steps as usize + 1,
                onset: None,
                input: DriverInput::default(),
            })
        };
        // A brisk phase is the same curve on a faster clock.
        let hurried_s = step_s * habit.pace;
        let curve = match &self.acceleration {
            PhaseModel::Profile(_)
            | PhaseModel::ProfileConditioned(_)
            | PhaseModel::ProfileOnset(_)
            | PhaseModel::ProfilePedal(_)
            | PhaseModel::TransitionPoint(_)
            | PhaseModel::Straight
            | PhaseModel::Smoothstep => predict(
                hurried_s,
                self.acceleration_pace.duration_s(start_mps, target_mps),
            ),
            PhaseModel::RiseTime(m) | PhaseModel::RiseTimeExact(m) => {
                let (constant_s, _) = m.constant_for(SpeedGroup::of(start_mps, target_mps));
                predict(hurried_s, RiseTime::RISE_TIME_CONSTANTS * constant_s)
            }
            PhaseModel::Inverse(_)
            | PhaseModel::Exponential(_)
            | PhaseModel::ExponentialAmplitude(_)
            | PhaseModel::Constant(_) => {
                let mut curve = predict(hurried_s, LONGEST_PHASE_S);
                let reached = curve.partition_point(|&v| v <= target_mps);
                curve.truncate(reached.max(2));
                curve[1] = curve[1].min(target_mps);
                curve
            }
        };
        habit.warp(&curve)
    }

    pub(super) fn check(&self) -> Result<(), Error> {
        self.acceleration.check()?;
        for pace in [&self.acceleration_pace, &self.braking_pace] {
            check("pace.scale_mps2", pace.scale_mps2, 0.05..=5.0, "0.05 to 5")?;
            check(
                "pace.gain_exponent",
                pace.gain_exponent,
                0.0..=0.9,
                "0 to 0.9",
            )?;
            check(
                "pace.speed_decay_s_per_m",
                pace.speed_decay_s_per_m,
                0.0..=0.1,
                "0 to 0.1",
            )?;
        }
        let cruise = &self.cruise;
        check("cruise.bias_mps", cruise.bias_mps, -5.0..=15.0, "-5 to 15")?;
        check(
            "cruise.bias_spread_mps",
            cruise.bias_spread_mps,
            0.0..=1.0,
            "0 to 1",
        )?;
        check(
            "cruise.deviation_mps",
            cruise.deviation_mps,
            0.0..=3.0,
            "0 to 3",
        )?;
        check(
            "cruise.correlation_s",
            cruise.correlation_s,
            1.0..=1000.0,
            "1 to 1000",
        )?;
        check(
            "cruise.response_s",
            cruise.response_s,
            1.0..=60.0,
            "1 to 60",
        )?;
        check_following(&self.following)
    }
}

fn check_following(idm: &Idm) -> Result<(), Error> {
    check(
        "idm.max_accel_mps2",
        idm.max_accel_mps2,
        0.3..=5.0,
        "0.3 to 5",
    )?;
    check(
        "idm.comfortable_decel_mps2",
        idm.comfortable_decel_mps2,
        0.3..=5.0,
        "0.3 to 5",
    )?;
    check(
        "idm.time_headway_s",
        idm.time_headway_s,
        0.5..=10.0,
        "0.5 to 10",
    )?;
    check(
        "idm.standstill_gap_m",
        idm.standstill_gap_m,
        0.5..=20.0,
        "0.5 to 20",
    )
}

impl Pace {
    /// Duration of a phase in s; 0 without a change of speed.
    #[must_use]
    pub fn duration_s(&self, start_speed_mps: f64, end_speed_mps: f64) -> f64 {
        let change_mps = (end_speed_mps - start_speed_mps).abs();
        let mean_mps = 0.5 * (start_speed_mps + end_speed_mps);
        change_mps.powf(1.0 - self.gain_exponent) * (self.speed_decay_s_per_m * mean_mps).exp()
            / self.scale_mps2
    }
}

/// What sets one acceleration phase apart from the driver's others.
#[derive(Debug, Clone, Copy)]
pub(super) struct PhaseHabit {
    /// Over 1 is brisk.
    pace: f64,
    earliness: f64,
    hesitation: f64,
}

impl PhaseHabit {
    pub(super) fn draw(random: &mut Random, variation: f64) -> Self {
        Self {
            pace: random.habit(variation * PACE_LOG_SPREAD).exp(),
            earliness: random.habit(variation * EARLINESS_SPREAD).clamp(-0.5, 0.5),
            hesitation: random
                .habit(variation * HESITATION_SPREAD)
                .clamp(-0.25, 0.25),
        }
    }

    /// Runs through a curve with the share `s` of time replaced by `s + e s(1 − s) + h s(1 − s)(1 − 2s)`, which keeps
    /// both ends and never runs backward as `|e| + |h| < 1`. With `e = h = 0` the curve is untouched.
    fn warp(&self, curve: &[f64]) -> Vec<f64> {
        let last = curve.len() - 1;
        let at = |k: usize| {
            let s = k as f64 / last as f64;
            let ahead = s * (1.0 - s) * (self.earliness + self.hesitation * (1.0 - 2.0 * s));
            let position = (k as f64 + last as f64 * ahead).clamp(0.0, last as f64);
            let left = (position as usize).min(last - 1);
            let share = position - left as f64;
            curve[left] + (curve[left + 1] - curve[left]) * share
        };
        (0..=last).map(|k| at(k).max(0.0)).collect()
    }
}

/// The pedal is pressed over the first 15 % of the phase, held, and released over the last 35 %: acceleration is a
/// trapezoid, and the shape its integral.
fn press_hold_release() -> Profile {
    const PRESS: f64 = 0.15;
    const RELEASE: f64 = 0.35;
    const KNOTS: u32 = 101;
    let plateau = 1.0 / (1.0 - 0.5 * (PRESS + RELEASE));
    let shape = |s: f64| {
        let left = 1.0 - s;
        if s < PRESS {
            plateau * s * s / (2.0 * PRESS)
        } else if left > RELEASE {
            plateau * (s - 0.5 * PRESS)
        } else {
            1.0 - plateau * left * left / (2.0 * RELEASE)
        }
    };
    Profile {
        shape: (0..KNOTS)
            .map(|knot| shape(f64::from(knot) / f64::from(KNOTS - 1)))
            .collect(),
    }
}

/// A constant for every group with acceleration in it; five times each is a multiple of 0.1 s.
fn rise_time() -> RiseTime {
    let groups = [
        (0, 0, 1.6),
        (0, 1, 2.4),
        (0, 2, 3.8),
        (1, 1, 1.8),
        (1, 2, 2.6),
        (2, 2, 2.4),
    ];
    RiseTime {
        groups: groups
            .map(|(start_band, end_band, time_constant_s)| GroupConstant {
                group: SpeedGroup {
                    start_band,
                    end_band,
                },
                time_constant_s,
                phases: 1,
            })
            .to_vec(),
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, clippy::unwrap_used)]
mod tests {
    use super::super::random::Stream;
    use super::*;

    const ALIKE: PhaseHabit = PhaseHabit {
        pace: 1.0,
        earliness: 0.0,
        hesitation: 0.0,
    };

    #[test]
    fn curves_rise_from_start_to_target() {
        for kind in SimulatedDriver::KINDS {
            let driver = SimulatedDriver::with(kind).unwrap();
            assert!(driver.check().is_ok());
            for (start, target) in [(0.0, 14.7), (9.1, 14.7), (5.0, 34.0)] {
                let curve = driver.acceleration_curve(start, target, 0.1, &ALIKE);
                let seconds = 0.1 * (curve.len() - 1) as f64;
                assert!((3.0..=45.0).contains(&seconds), "{kind} {start} {seconds}");
                assert_eq!(curve[0], start);
                let short = target - curve[curve.len() - 1];
                // The rise-time model ends at 95.96 % of its step.
                let allowed = if kind == ModelKind::RiseTime {
                    0.0405
                } else {
                    0.02
                };
                assert!((0.0..=allowed * target).contains(&short), "{kind} {short}");
                assert!(curve.is_sorted());
            }
        }
    }

    #[test]
    fn a_warp_keeps_ends_and_order() {
        let curve: Vec<f64> = (0..80).map(|k| (f64::from(k) / 10.0).powi(2)).collect();
        assert_eq!(ALIKE.warp(&curve), curve);
        let mut random = Random::new(1, 0, Stream::Driver);
        for _ in 0..200 {
            let warped = PhaseHabit::draw(&mut random, 2.0).warp(&curve);
            assert!(warped.is_sorted());
            assert_eq!((warped[0], warped[79]), (curve[0], curve[79]));
        }
    }

    #[test]
    fn a_shape_starts_gently_and_ends_gently() {
        let shape = press_hold_release().shape;
        assert_eq!((shape[0], shape[100]), (0.0, 1.0));
        assert!(shape.is_sorted());
        assert!(shape[1] < 0.001 && shape[99] > 0.999);
    }
}
