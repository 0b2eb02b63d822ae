//! What is remembered of phases that began, and how alike two begins are.

use crate::motion::samples_in;
use crate::{BEGUN_S, DriverInput, Onset, Phase, PhaseCurve, PhaseMemory};

/// Seconds that are looked ahead at most.
pub(super) const SECONDS: usize = 10;

/// Start speed, early gain, the onset, and what the driver does.
const FEATURES: usize = 11;

/// How much a distance in each counts beside the others; chosen on the drives of `bmw-i3`.
const WEIGHTS: [f64; FEATURES] = [1.0, 2.0, 0.5, 0.5, 0.25, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5];

pub(super) type Features = [f64; FEATURES];

/// What is known of a phase that has lasted [`BEGUN_S`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beginning {
    /// Speed at its first sample.
    pub start_speed_mps: f64,
    /// Change since then.
    pub early_gain_mps: f64,
    /// How it was entered.
    pub onset: Option<Onset>,
    /// What the driver did as it began.
    pub input: DriverInput,
}

impl Beginning {
    /// Speed when it has lasted [`BEGUN_S`].
    pub(super) fn now_mps(&self) -> f64 {
        self.start_speed_mps + self.early_gain_mps
    }

    /// Of a recorded phase; `None` for one that ended sooner.
    #[must_use]
    pub fn of(curve: &PhaseCurve) -> Option<Self> {
        Some(Self::new(&curve.outline(), curve.early_gain_mps()?))
    }

    pub(super) fn new(outline: &Phase, early_gain_mps: f64) -> Self {
        Self {
            start_speed_mps: outline.start_speed_mps,
            early_gain_mps,
            onset: outline.onset,
            input: outline.input,
        }
    }

    pub(super) fn features(&self) -> Features {
        let onset = self.onset.map_or([f64::NAN; 3], Onset::values);
        let input = self.input.values().map(|value| value.unwrap_or(f64::NAN));
        let [accel, jerk, previous] = onset;
        let [pedal, change, slow_change, brake, torque, accelerometer] = input;
        [
            self.start_speed_mps,
            self.early_gain_mps,
            accel,
            jerk,
            previous,
            pedal,
            change,
            slow_change,
            brake,
            torque,
            accelerometer,
        ]
    }
}

/// A remembered phase.
#[derive(Debug, Clone)]
pub(super) struct Case {
    pub(super) drive: usize,
    pub(super) weight: f64,
    pub(super) counts: bool,
    pub(super) features: Features,
    pub(super) beginning: Beginning,
    pub(super) gain_mps: f64,
    pub(super) samples: usize,
    /// Change since the early gain, second by second, as long as it lasted.
    pub(super) later_gain_mps: Vec<f64>,
}

impl Case {
    pub(super) fn lasts(&self, second: usize) -> bool {
        self.later_gain_mps.len() >= second
    }
}

pub(super) fn cases(memory: &PhaseMemory) -> Vec<Case> {
    let (own_drives, _) = memory.drive_counts();
    let mut cases = Vec::new();
    for (drive, remembered) in memory.drives().enumerate() {
        let weight = if drive < own_drives {
            1.0
        } else {
            memory.prior_weight()
        };
        if weight <= 0.0 {
            continue;
        }
        let case = |beginning: Beginning, outline: &Phase, later_gain_mps, counts| Case {
            drive,
            weight,
            counts,
            features: beginning.features(),
            beginning,
            gain_mps: outline.gain_mps(),
            samples: outline.samples,
            later_gain_mps,
        };
        cases.extend(remembered.phases.iter().filter_map(|curve| {
            let later = later_gains_mps(curve.speed_mps(), curve.step_s());
            Some(case(Beginning::of(curve)?, &curve.outline(), later, true))
        }));
        cases.extend(remembered.short.iter().map(|short| {
            let outline = &short.outline;
            let beginning = Beginning::new(outline, short.early_gain_mps);
            // What is not remembered of it counts as a straight line.
            let begun = samples_in(BEGUN_S, outline.step_s);
            let rest = outline.samples.saturating_sub(begun + 1);
            let left_mps = outline.gain_mps() - short.early_gain_mps;
            let seconds = (1..=SECONDS).map(|s| samples_in(s as f64, outline.step_s));
            let line = seconds.take_while(|steps| *steps <= rest);
            let line = line.map(|steps| left_mps * steps as f64 / rest as f64);
            case(beginning, outline, line.collect(), false)
        }));
    }
    cases
}

/// Of a phase that lasted beyond its begin.
pub(super) fn later_gains_mps(speed_mps: &[f64], step_s: f64) -> Vec<f64> {
    let begun = samples_in(BEGUN_S, step_s);
    let seconds = (1..=SECONDS).map(|second| begun + samples_in(second as f64, step_s));
    let gains = seconds.map_while(|sample| Some(speed_mps.get(sample)? - speed_mps[begun]));
    gains.collect()
}

/// Standard deviation of every feature; 1 where it does not vary.
pub(super) fn scales(cases: &[Case]) -> Features {
    std::array::from_fn(|feature| {
        let known = cases
            .iter()
            .map(|case| (case.features[feature], case.weight));
        let known: Vec<(f64, f64)> = known.filter(|(value, _)| value.is_finite()).collect();
        let total: f64 = known.iter().map(|(_, weight)| weight).sum();
        let mean = known.iter().map(|(v, w)| w * v).sum::<f64>() / total;
        let variance = known
            .iter()
            .map(|(v, w)| w * (v - mean).powi(2))
            .sum::<f64>()
            / total;
        let deviation = variance.sqrt();
        if deviation > 1e-9 { deviation } else { 1.0 }
    })
}

/// Weighted sum of squares over the features that the beginning knows, in their deviations; one that a case does not know counts as one apart.
pub(super) fn distance(beginning: &Features, case: &Features, scales: &Features) -> f64 {
    let mut sum = 0.0;
    for feature in 0..FEATURES {
        let apart = (beginning[feature] - case[feature]) / scales[feature];
        if apart.is_finite() {
            sum += WEIGHTS[feature] * apart * apart;
        } else if beginning[feature].is_finite() {
            sum += WEIGHTS[feature];
        }
    }
    sum
}
