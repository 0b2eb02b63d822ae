//! The memory as it stands in a model file; whatever is there has been anywhere in between, and is checked.

use serde::{Deserialize, Serialize};

use super::{PhaseMemory, PhaseRules, RememberedDrive, ShortPhase};
use crate::motion::samples_in;
use crate::{
    AccelPoint, BEGUN_S, DriverInput, Manoeuvre, Onset, Phase, PhaseCurve, PhaseExtent, PhaseKind,
    PhaseSettings, PointsOf,
};

/// No car is faster, backward or forward, and none has a sensor that says so, m/s.
const SPEED_MPS: std::ops::RangeInclusive<f64> = -20.0..=200.0;

/// Beyond every acceleration, jerk, percentage and torque of a car.
const MOST: f64 = 1e6;

pub(super) const STEP_S: std::ops::RangeInclusive<f64> = 1e-3..=60.0;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OnDisk {
    rules: PhaseRules,
    manoeuvre: Manoeuvre,
    points_of: PointsOf,
    prior_weight: f64,
    own_drives: Vec<DriveOnDisk>,
    other_drives: Vec<DriveOnDisk>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct DriveOnDisk {
    phases: Vec<CurveOnDisk>,
    /// Phases that began and do not count.
    short_phases: Vec<ShortOnDisk>,
    /// Speed and acceleration.
    points: Vec<[f64; 2]>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CurveOnDisk {
    start_s: f64,
    step_s: f64,
    onset: Option<[f64; 3]>,
    input: [Option<f64>; 6],
    speed_mps: Vec<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ShortOnDisk {
    step_s: f64,
    samples: usize,
    /// At the first and at the last sample.
    speed_mps: [f64; 2],
    early_gain_mps: f64,
    onset: Option<[f64; 3]>,
    input: [Option<f64>; 6],
}

impl From<PhaseMemory> for OnDisk {
    fn from(memory: PhaseMemory) -> Self {
        let drives = |drives: Vec<RememberedDrive>| drives.into_iter().map(Into::into).collect();
        Self {
            rules: memory.rules,
            manoeuvre: memory.manoeuvre,
            points_of: memory.points_of,
            prior_weight: memory.prior_weight,
            own_drives: drives(memory.own),
            other_drives: drives(memory.others),
        }
    }
}

impl From<RememberedDrive> for DriveOnDisk {
    fn from(drive: RememberedDrive) -> Self {
        let pair = |point: &AccelPoint| [point.speed_mps, point.accel_mps2];
        Self {
            phases: drive.phases.iter().map(CurveOnDisk::of).collect(),
            short_phases: drive.short.iter().map(ShortOnDisk::of).collect(),
            points: drive.points.iter().map(pair).collect(),
        }
    }
}

impl CurveOnDisk {
    fn of(curve: &PhaseCurve) -> Self {
        let outline = curve.outline();
        Self {
            start_s: curve.start_s(),
            step_s: outline.step_s,
            onset: outline.onset.map(Onset::values),
            input: outline.input.values(),
            speed_mps: curve.speed_mps().to_vec(),
        }
    }
}

impl ShortOnDisk {
    fn of(short: &ShortPhase) -> Self {
        let outline = &short.outline;
        Self {
            step_s: outline.step_s,
            samples: outline.samples,
            speed_mps: [outline.start_speed_mps, outline.end_speed_mps],
            early_gain_mps: short.early_gain_mps,
            onset: outline.onset.map(Onset::values),
            input: outline.input.values(),
        }
    }
}

impl TryFrom<OnDisk> for PhaseMemory {
    type Error = String;

    fn try_from(file: OnDisk) -> Result<Self, String> {
        let rules = file.rules;
        if !rules.are_usable() {
            return Err("memory.rules: a number is out of range".to_owned());
        }
        if !(0.0..=MOST).contains(&file.prior_weight) {
            return Err(format!(
                "memory.prior_weight = {} is no weight",
                file.prior_weight
            ));
        }
        let kind = PhaseKind::from(file.manoeuvre);
        let settings = rules.settings();
        let drives = |whose, drives| {
            checked(whose, ".", drives, |d: DriveOnDisk| {
                d.checked(&settings, kind)
            })
        };
        Ok(Self {
            rules,
            manoeuvre: file.manoeuvre,
            points_of: file.points_of,
            prior_weight: file.prior_weight,
            own: drives("memory.own_drives", file.own_drives)?,
            others: drives("memory.other_drives", file.other_drives)?,
        })
    }
}

/// All items of a list, or the place of the first that is none, and why.
fn checked<A, B>(
    field: &str,
    link: &str,
    items: Vec<A>,
    check: impl Fn(A) -> Result<B, String>,
) -> Result<Vec<B>, String> {
    let numbered = items.into_iter().enumerate();
    numbered
        .map(|(k, item)| check(item).map_err(|what| format!("{field}[{k}]{link}{what}")))
        .collect()
}

impl DriveOnDisk {
    fn checked(self, settings: &PhaseSettings, kind: PhaseKind) -> Result<RememberedDrive, String> {
        let point = |[speed_mps, accel_mps2]: [f64; 2]| {
            let usable = is_speed(speed_mps) && accel_mps2.abs() <= MOST;
            usable
                .then(|| AccelPoint::new(speed_mps, accel_mps2))
                .ok_or_else(|| "an acceleration that no car has".to_owned())
        };
        Ok(RememberedDrive {
            phases: checked("phases", ": ", self.phases, |phase| {
                phase.curve(settings, kind)
            })?,
            short: checked("short_phases", ": ", self.short_phases, |short| {
                short.phase(settings, kind)
            })?,
            points: checked("points", ": ", self.points, point)?,
        })
    }
}

impl CurveOnDisk {
    fn curve(self, settings: &PhaseSettings, kind: PhaseKind) -> Result<PhaseCurve, String> {
        let usable = self.start_s.is_finite()
            && STEP_S.contains(&self.step_s)
            && self.speed_mps.iter().copied().all(is_speed);
        let curve = begin(self.onset, self.input).and_then(|(onset, input)| {
            PhaseCurve::of_parts(self.start_s, self.step_s, self.speed_mps, onset, input)
        });
        let curve = curve
            .filter(|curve| usable && curve.kind() == kind)
            .ok_or_else(|| no_car(kind))?;
        if !settings.counts(&curve.outline()) {
            return Err(
                "too short or too small for min_duration_s and min_gain_mps of the rules"
                    .to_owned(),
            );
        }
        Ok(curve)
    }
}

impl ShortOnDisk {
    fn phase(&self, settings: &PhaseSettings, kind: PhaseKind) -> Result<ShortPhase, String> {
        let [start_speed_mps, end_speed_mps] = self.speed_mps;
        let (onset, input) = begin(self.onset, self.input).ok_or_else(|| no_car(kind))?;
        let outline = Phase {
            start_speed_mps,
            end_speed_mps,
            step_s: self.step_s,
            samples: self.samples,
            onset,
            input,
        };
        let usable = STEP_S.contains(&self.step_s)
            && (2..=usize::from(u16::MAX)).contains(&self.samples)
            && is_speed(start_speed_mps)
            && is_speed(end_speed_mps)
            && outline.gain_mps() != 0.0
            && outline.is_braking() == (kind == PhaseKind::Braking)
            && self.early_gain_mps.abs() <= MOST;
        if !usable {
            return Err(no_car(kind));
        }
        if self.samples <= samples_in(BEGUN_S, self.step_s) {
            return Err(format!("shorter than {BEGUN_S} s"));
        }
        // A whole phase may be longer than what counts of it.
        if settings.extent == PhaseExtent::Threshold && settings.counts(&outline) {
            return Err("long and large enough to count by the rules".to_owned());
        }
        Ok(ShortPhase {
            outline,
            early_gain_mps: self.early_gain_mps,
        })
    }
}

fn no_car(kind: PhaseKind) -> String {
    format!("no {} of a car", kind.name())
}

/// How a phase begins, where every number is one of a car.
fn begin(onset: Option<[f64; 3]>, input: [Option<f64>; 6]) -> Option<(Option<Onset>, DriverInput)> {
    let mut numbers = onset.iter().flatten().chain(input.iter().flatten());
    let usable = numbers.all(|value| value.abs() <= MOST);
    usable.then(|| (onset.map(Onset::of_values), DriverInput::of_values(input)))
}

fn is_speed(speed_mps: f64) -> bool {
    SPEED_MPS.contains(&speed_mps)
}
