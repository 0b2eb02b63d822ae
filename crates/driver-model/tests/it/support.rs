//! What several themes need: logs, phases and training sets from plain numbers.

use std::f64::consts::TAU;
use std::path::Path;

use drive_log::{Channel, Drive, DriveLog};
use driver_model::{
    AccelPoint, DriveBehaviour, Motion, Phase, PhaseCurve, PhaseKind, PhaseSettings, Span,
    TrainingPhase, TrainingSet, phase_model,
};
use ev_energy::{DEFAULT_SLOPE_BANDWIDTH_M, Vehicle};

pub(crate) const STEP_S: f64 = 0.1;
/// Of [`steady`] drives.
pub(crate) const SAMPLES: usize = 3000;

pub(crate) fn log_of(speed_mps: Vec<f64>) -> DriveLog {
    let channels = [(Channel::Speed, speed_mps)].into_iter().collect();
    DriveLog::new("log", 0.0, STEP_S, channels).unwrap()
}

pub(crate) fn motion_of(log: &DriveLog) -> Motion {
    Motion::of_log(log, DEFAULT_SLOPE_BANDWIDTH_M).unwrap()
}

pub(crate) fn i3() -> Vehicle {
    Vehicle::builtin("bmw-i3-60ah").unwrap()
}

pub(crate) fn motions(drives: &[&Drive]) -> Vec<Motion> {
    let of_drive = |drive: &&Drive| Motion::of_drive(drive, DEFAULT_SLOPE_BANDWIDTH_M).unwrap();
    drives.iter().flat_map(of_drive).collect()
}

/// A log of its own name at a constant speed, with other channels.
pub(crate) fn steady(name: &str, speed_mps: f64, channels: &[(Channel, f64)]) -> Drive {
    let all = channels
        .iter()
        .copied()
        .chain([(Channel::Speed, speed_mps)]);
    let all = all.map(|(channel, value)| (channel, vec![value; SAMPLES]));
    Drive::from(DriveLog::new(name, 0.0, 0.1, all.collect()).unwrap())
}

/// Samples `start..` of a log as a phase.
pub(crate) fn curve_from(start: usize, speed_mps: Vec<f64>) -> PhaseCurve {
    let end = speed_mps.len();
    let phase = Span {
        start,
        end,
        kind: PhaseKind::Acceleration,
        lead_influenced: false,
    };
    PhaseCurve::cut(&motion_of(&log_of(speed_mps)), &phase).unwrap()
}

/// The whole log as a phase, without an onset.
pub(crate) fn curve_of(speed_mps: Vec<f64>) -> PhaseCurve {
    curve_from(0, speed_mps)
}

/// A phase from one speed to another by a shape over `t/T`.
pub(crate) fn shaped(
    from_mps: f64,
    to_mps: f64,
    samples: usize,
    shape: impl Fn(f64) -> f64,
) -> PhaseCurve {
    let last = (samples - 1) as f64;
    let speed = |k: usize| from_mps + (to_mps - from_mps) * shape(k as f64 / last);
    curve_of((0..samples).map(speed).collect())
}

/// A straight line with this outline.
pub(crate) fn line(outline: Phase) -> PhaseCurve {
    let (from_mps, to_mps) = (outline.start_speed_mps, outline.end_speed_mps);
    shaped(from_mps, to_mps, outline.samples, |s| s)
}

/// The same phase in reversed time.
pub(crate) fn mirrored(curve: &PhaseCurve) -> PhaseCurve {
    curve_of(curve.speed_mps().iter().rev().copied().collect())
}

pub(crate) fn set<'a>(
    phases: impl IntoIterator<Item = (&'a PhaseCurve, usize, f64)>,
) -> TrainingSet<'a> {
    let mut training = TrainingSet::default();
    let phase = |(curve, trip, weight)| TrainingPhase {
        curve,
        trip,
        weight,
    };
    training.phases.extend(phases.into_iter().map(phase));
    training
}

/// Weight 1, ten phases to a trip.
pub(crate) fn plain_set(curves: &[PhaseCurve]) -> TrainingSet<'_> {
    let number = |(k, curve)| (curve, k / 10, 1.0);
    set(curves.iter().enumerate().map(number))
}

pub(crate) fn trip_of(
    name: &str,
    phases: Vec<PhaseCurve>,
    points: &[AccelPoint],
) -> DriveBehaviour {
    let segment = |point: &AccelPoint| driver_model::Segment {
        kind: PhaseKind::Acceleration,
        mean: *point,
        samples: vec![*point],
    };
    DriveBehaviour {
        name: name.to_owned(),
        whole_phases: phases.clone(),
        phases,
        short_phases: Vec::new(),
        whole_short_phases: Vec::new(),
        segments: points.iter().map(segment).collect(),
        lead_influenced: driver_model::LeadInfluenced::default(),
        whole_lead_influenced: driver_model::LeadInfluenced::default(),
        following: Vec::new(),
        cruise: Vec::new(),
    }
}

/// Accelerations of different start, gain, pace and shape.
pub(crate) fn assorted(count: usize) -> Vec<PhaseCurve> {
    let part = |k: usize, stride: f64| (0.5 + k as f64 * stride).fract();
    (0..count)
        .map(|k| {
            let from = 25.0 * part(k, 0.618_034);
            let to = from + 3.0 + 9.0 * part(k, 0.754_878);
            let samples = 35 + (90.0 * part(k, 0.569_840)) as usize;
            let early = 0.2 * (from / 25.0 - 0.5) + 0.05 * (samples as f64 / 60.0 - 1.0);
            shaped(from, to, samples, |s| {
                phase_model::smoothstep(0.0, 1.0, s) + early * (TAU * 0.5 * s).sin()
            })
        })
        .collect()
}

/// Mean speed and mean acceleration of every phase.
pub(crate) fn points_of(curves: &[PhaseCurve]) -> Vec<AccelPoint> {
    let point = |curve: &PhaseCurve| {
        let outline = curve.outline();
        let mean_mps = 0.5 * (outline.start_speed_mps + outline.end_speed_mps);
        AccelPoint::new(mean_mps, outline.gain_mps().abs() / outline.duration_s())
    };
    curves.iter().map(point).collect()
}

/// The first of the simulated drives.
pub(crate) fn fixture_trips(most: usize) -> Vec<DriveBehaviour> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/drives");
    trips_in(&folder, "csv", most)
}

pub(crate) fn trips_in(folder: &Path, suffix: &str, most: usize) -> Vec<DriveBehaviour> {
    let mut files: Vec<_> = folder
        .read_dir()
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == suffix))
        .collect();
    files.sort();
    files
        .iter()
        .take(most)
        .flat_map(|path| {
            drive_log::read_file(path, &drive_log::LayoutChoice::Auto)
                .unwrap()
                .logs
        })
        .map(|log| {
            let drive = drive_log::prepare(log, &drive_log::Preparation::default()).unwrap();
            let motions = Motion::of_drive(&drive, DEFAULT_SLOPE_BANDWIDTH_M).unwrap();
            DriveBehaviour::of_drive(&motions, &PhaseSettings::default()).unwrap()
        })
        .collect()
}
