//! The memory as it stands in a model file; whatever is there has been anywhere in between, and is checked.

use serde::{Deserialize, Serialize};

use super::{PhaseMemory, PhaseRules, RememberedDrive, ShortPhase};
use crate::{AccelPoint, DriverInput, Manoeuvre, Onset, Phase, PhaseCurve, PhaseKind, PointsOf};

/// No car is faster, and none has a sensor that says so, m/s.
const MOST_SPEED_MPS: f64 = 200.0;

/// Beyond every acceleration, jerk, percentage and torque of a car.
const MOST: f64 = 1e6;

const STEP_S: std::ops::RangeInclusive<f64> = 1e-3..=60.0;

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
            return Err("a rule by which phases are found is out of range".to_owned());
        }
        if !(0.0..=MOST).contains(&file.prior_weight) {
            return Err(format!("prior_weight = {} is no weight", file.prior_weight));
        }
        let kind = PhaseKind::from(file.manoeuvre);
        let drives = |whose: &str, drives: Vec<DriveOnDisk>| {
            let numbered = drives.into_iter().enumerate();
            numbered
                .map(|(k, drive)| {
                    let place = |what| format!("{whose}, number {k}: {what}");
                    drive.checked(kind).map_err(place)
                })
                .collect::<Result<Vec<_>, String>>()
        };
        Ok(Self {
            rules,
            manoeuvre: file.manoeuvre,
            points_of: file.points_of,
            prior_weight: file.prior_weight,
            own: drives("own_drives", file.own_drives)?,
            others: drives("other_drives", file.other_drives)?,
        })
    }
}

impl DriveOnDisk {
    fn checked(self, kind: PhaseKind) -> Result<RememberedDrive, String> {
        let phases = self.phases.into_iter().map(|phase| {
            let curve = phase.curve().filter(|curve| curve.kind() == kind);
            curve.ok_or_else(|| format!("a phase that is no {} of a car", kind.name()))
        });
        let short = self.short_phases.iter().map(|short| {
            let short = short.phase(kind);
            short.ok_or_else(|| format!("a short phase that is no {} of a car", kind.name()))
        });
        let points = self.points.iter().map(|&[speed_mps, accel_mps2]| {
            let usable = is_speed(speed_mps) && accel_mps2.abs() <= MOST;
            usable
                .then(|| AccelPoint::new(speed_mps, accel_mps2))
                .ok_or_else(|| "a point of acceleration that no car has".to_owned())
        });
        Ok(RememberedDrive {
            phases: phases.collect::<Result<_, _>>()?,
            short: short.collect::<Result<_, _>>()?,
            points: points.collect::<Result<_, _>>()?,
        })
    }
}

impl CurveOnDisk {
    fn curve(self) -> Option<PhaseCurve> {
        let usable = self.start_s.is_finite()
            && STEP_S.contains(&self.step_s)
            && self.speed_mps.iter().copied().all(is_speed);
        let (onset, input) = begin(self.onset, self.input)?;
        let curve = PhaseCurve::of_parts(self.start_s, self.step_s, self.speed_mps, onset, input);
        curve.filter(|_| usable)
    }
}

impl ShortOnDisk {
    fn phase(&self, kind: PhaseKind) -> Option<ShortPhase> {
        let [start_speed_mps, end_speed_mps] = self.speed_mps;
        let (onset, input) = begin(self.onset, self.input)?;
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
        usable.then_some(ShortPhase {
            outline,
            early_gain_mps: self.early_gain_mps,
        })
    }
}

/// How a phase begins, where every number is one of a car.
fn begin(onset: Option<[f64; 3]>, input: [Option<f64>; 6]) -> Option<(Option<Onset>, DriverInput)> {
    let mut numbers = onset.iter().flatten().chain(input.iter().flatten());
    let usable = numbers.all(|value| value.abs() <= MOST);
    usable.then(|| (onset.map(Onset::of_values), DriverInput::of_values(input)))
}

fn is_speed(speed_mps: f64) -> bool {
    speed_mps.abs() <= MOST_SPEED_MPS
}
