//! Stretches in which the battery feels another car than in the rest of the drive.

use std::ops::Range;

use super::checked::Checked;
use super::motion::{Span, moving_spans};
use super::power::NOT_BRAKING_MPS2;
use crate::statistics::{correlation, quantile, significance, slope};
use crate::{Action, Channel, FindingKind};

/// Seconds in motion without braking, with volts and amps, that are a piece, and pieces that a drive must have.
const SECONDS: usize = 60;
const PIECES: usize = 4;

/// Correlation of battery power and `v·dv/dt` from which a piece tells a car, and by chance does not.
const TELLS: f64 = 0.7;
const TURNED: f64 = -0.5;
const CERTAIN_DEVIATIONS: f64 = 4.0;

/// How many times the car of the other pieces one is at least off beside others, and alone: hills make it 1.9 in recorded drives.
const OFF: f64 = 1.7;
const OFF_ALONE: f64 = 2.5;

/// What one piece says: battery power over `v·dv/dt`, kg.
struct Piece {
    samples: Range<usize>,
    mass_kg: Option<f64>,
}

/// Drops a current that in two pieces on end belongs to another car than in most, or runs against the motion; reports it for one. Refuses
/// the log if its speed was converted before.
pub(super) fn judge(checked: &mut Checked) {
    let pieces = pieces(checked);
    let mut masses: Vec<f64> = pieces.iter().filter_map(|piece| piece.mass_kg).collect();
    if masses.len() < PIECES {
        return;
    }
    let Some(usual_kg) = quantile(&mut masses, 0.5).filter(|mass| *mass > 0.0) else {
        return;
    };
    let is_off_by = |piece: &Piece, off: f64| {
        let times = piece.mass_kg.map(|mass_kg| mass_kg / usual_kg);
        times.is_some_and(|times| !(1.0 / off..=off).contains(&times))
    };
    let runs: Vec<&[Piece]> = pieces
        .chunk_by(|a, b| is_off_by(a, OFF) == is_off_by(b, OFF))
        .filter(|run| match run {
            [alone] => is_off_by(alone, OFF_ALONE),
            [first, ..] => is_off_by(first, OFF),
            [] => false,
        })
        .collect();
    // once the whole speed is converted, a part of it may have been right
    let was_rescaled = checked.findings.iter().any(|finding| {
        let of_speed = finding.channel == Channel::Speed.name();
        of_speed && finding.kind == FindingKind::Unit && finding.action == Action::Scaled
    });
    let what = if was_rescaled {
        "speed, current or voltage is"
    } else {
        "current or voltage is"
    };
    let drops = runs.iter().any(|run| run.len() > 1);
    for run in runs {
        let (Some(first), Some(last)) = (run.first(), run.last()) else {
            continue;
        };
        let mean_kg = run.iter().filter_map(|piece| piece.mass_kg).sum::<f64>() / run.len() as f64;
        let detail = format!(
            "battery power follows v·dv/dt as that of a car of {mean_kg:.0} kg here, of {usual_kg:.0} kg in most of the drive: {what} in another scale here, or turned"
        );
        let samples = first.samples.start..last.samples.end;
        let action = match (drops, was_rescaled) {
            (true, true) => Action::Refused,
            (true, false) => Action::Dropped,
            (false, _) => Action::Kept,
        };
        let channel = if was_rescaled {
            Channel::Speed
        } else {
            Channel::BatteryCurrent
        };
        checked.report(FindingKind::Contradicted, channel, &samples, action, detail);
    }
    if drops {
        checked.log.channels.remove(&Channel::BatteryCurrent);
    }
}

fn pieces(checked: &Checked) -> Vec<Piece> {
    let log = &checked.log;
    if log.channel(Channel::BatteryVoltage).is_none() {
        return Vec::new();
    }
    let spans = moving_spans(log);
    let known: Vec<(&Span, f64)> = spans
        .iter()
        .filter(|span| span.accel_mps2 > NOT_BRAKING_MPS2)
        .filter_map(|span| Some((span, span.battery(log)?)))
        .collect();
    let piece = |spans: &[(&Span, f64)]| {
        let pairs: Vec<(f64, f64)> = spans.iter().map(|(span, w)| (span.inertia(), *w)).collect();
        let r = correlation(&pairs);
        let certain = significance(r, pairs.len());
        let tells = r >= TELLS || r <= TURNED && certain <= -CERTAIN_DEVIATIONS;
        let (first, last) = (spans.first()?, spans.last()?);
        Some(Piece {
            samples: *first.0.samples.start()..last.0.samples.end() + 1,
            mass_kg: tells.then(|| slope(&pairs)),
        })
    };
    known.chunks_exact(SECONDS).filter_map(piece).collect()
}
