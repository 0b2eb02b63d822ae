//! Speeds that are not there for a moment: single rows, or up to two seconds, of a code or of nothing on the road.

use std::collections::BTreeMap;
use std::ops::Range;

use super::checked::Checked;
use super::motion::spans;
use super::runs::constant_runs;
use crate::statistics::quantile;
use crate::{Action, Channel, FindingKind};

/// Longer is no dropout, and samples further apart do not say whether there was a jump, s.
const LONGEST_S: f64 = 2.0;

/// A car that brakes does not speed up at once by as much. Of 70 recorded drives none turns around by more than 1.5 m/s² from one
/// row to the next, nor by more than 3.4 times what it exceeds for a quarter of its time: in units that are not known yet, the
/// second tells.
const TURN_MPS2: f64 = 4.0;
const TURNS: f64 = 6.0;
const ORDINARY_SHARE: f64 = 0.75;
const COARSE_STEP_MPS: f64 = 1.0;

/// Faster than this, m/s, it goes forward, and not backward a row later and forward again.
const FORWARD_MPS: f64 = 1.0;

/// Certain dropouts to one value that make it a code, their share of its runs where it is an extreme of the speed, and how many
/// of them make a standstill one.
const CERTAIN: usize = 2;
const CERTAIN_SHARE: f64 = 0.2;
const CERTAIN_STANDSTILLS: usize = 3;

/// Where standstill is a code, a stop that turns around by so much is one, m/s² and m/s.
const STOP_MPS2: f64 = 2.0;
const STOP_MPS: f64 = 0.5;

/// Rounds in which codes beside codes come to light.
const ROUNDS: usize = 8;

/// A run of one value whose neighbours are both higher, or both lower.
struct Dip {
    run: Range<usize>,
    value_mps: f64,
    before_mps: f64,
    /// How far the nearer of the neighbours is, m/s, and the time in which it must be reached, s.
    depth_mps: f64,
    step_s: f64,
    is_certain: bool,
}

/// Removes dropouts: every sample of a code, and of other values what no car does. Updates of the speed may be `interval_s` apart.
pub(super) fn remove_speed(checked: &mut Checked, interval_s: f64) {
    for _ in 0..ROUNDS {
        let dips = dips(checked, interval_s);
        let mut by_value: BTreeMap<u64, Vec<&Dip>> = BTreeMap::new();
        for dip in &dips {
            by_value
                .entry(dip.value_mps.to_bits())
                .or_default()
                .push(dip);
        }
        // beside a code, true speeds look like dropouts
        let most = by_value.values().max_by_key(|dips| certain(dips).count());
        match most.map_or(0, |dips| certain(dips).count()) {
            0 => return,
            1 => return by_value.values().for_each(|dips| remove(checked, dips)),
            _ => most.into_iter().for_each(|dips| remove(checked, dips)),
        }
    }
}

fn certain<'d>(dips: &[&'d Dip]) -> impl Iterator<Item = &'d Dip> {
    dips.iter().copied().filter(|dip| dip.is_certain)
}

/// Removes what is certain of the dips to one value.
fn remove(checked: &mut Checked, dips: &[&Dip]) {
    let certain: Vec<&Dip> = certain(dips).collect();
    let Some(first) = certain.first() else {
        return;
    };
    let samples: Vec<usize> = if first.value_mps == 0.0 {
        let is_code = certain.len() >= CERTAIN_STANDSTILLS;
        let gone = |dip: &&&Dip| dip.is_certain || is_code && dip.is_sudden_stop();
        dips.iter()
            .filter(gone)
            .flat_map(|dip| dip.run.clone())
            .collect()
    } else if is_code(checked, &certain) {
        samples_of(checked, first.value_mps)
    } else {
        certain.iter().flat_map(|dip| dip.run.clone()).collect()
    };
    report(checked, first, certain.len(), &samples);
    for i in samples {
        checked.remove(Channel::Speed, i..i + 1);
    }
}

fn report(checked: &mut Checked, first: &Dip, count: usize, samples: &[usize]) {
    let (Some(&from), Some(&to)) = (samples.first(), samples.last()) else {
        return;
    };
    let (kind, detail) = if count < CERTAIN {
        let Dip {
            before_mps,
            value_mps,
            step_s,
            ..
        } = first;
        let detail =
            format!("speed from {before_mps:.2} to {value_mps:.2} m/s in {step_s:.2} s and back");
        (FindingKind::Spike, detail)
    } else {
        let detail = format!(
            "{} samples of {:.4} m/s, {count} of them for a moment between others, by jumps that no car makes",
            samples.len(),
            first.value_mps
        );
        (FindingKind::Sentinel, detail)
    };
    checked.report(
        kind,
        Channel::Speed,
        &(from..to + 1),
        Action::Removed,
        detail,
    );
}

impl Dip {
    fn is_sudden_stop(&self) -> bool {
        self.depth_mps > STOP_MPS + STOP_MPS2 * self.step_s
    }
}

fn dips(checked: &Checked, interval_s: f64) -> Vec<Dip> {
    let turn_mps2 = TURN_MPS2.max(TURNS * ordinary_mps2(checked));
    let dip = |run| dip(checked, run, interval_s, turn_mps2);
    constant_runs(checked.log.speed_mps())
        .filter_map(dip)
        .collect()
}

fn dip(checked: &Checked, run: Range<usize>, interval_s: f64, turn_mps2: f64) -> Option<Dip> {
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let before = (0..run.start).rev().find(|&i| speed_mps[i].is_finite())?;
    let after = (run.end..speed_mps.len()).find(|&i| speed_mps[i].is_finite())?;
    let row_s = (time_s[run.start] - time_s[before]).max(time_s[after] - time_s[run.end - 1]);
    let value_mps = speed_mps[run.start];
    let away = [speed_mps[before] - value_mps, speed_mps[after] - value_mps];
    if row_s > LONGEST_S || checked.duration_s(&run) > LONGEST_S || away[0] * away[1] <= 0.0 {
        return None;
    }
    let depth_mps = away[0].abs().min(away[1].abs());
    let step_s = row_s + interval_s;
    let is_backward = value_mps < 0.0 && speed_mps[before].min(speed_mps[after]) > FORWARD_MPS;
    Some(Dip {
        value_mps,
        before_mps: speed_mps[before],
        depth_mps,
        step_s,
        is_certain: is_backward || depth_mps > COARSE_STEP_MPS + turn_mps2 * step_s,
        run,
    })
}

/// What the acceleration exceeds for a quarter of the time in motion, m/s².
fn ordinary_mps2(checked: &Checked) -> f64 {
    let moving = spans(&checked.log)
        .into_iter()
        .filter(|span| span.speed_mps > FORWARD_MPS);
    let mut accels: Vec<f64> = moving.map(|span| span.accel_mps2.abs()).collect();
    quantile(&mut accels, ORDINARY_SHARE).unwrap_or(0.0)
}

/// Whether an extreme value is one for nothing measured.
fn is_code(checked: &Checked, certain: &[&Dip]) -> bool {
    let value = certain[0].value_mps;
    let speed_mps = checked.log.speed_mps();
    let is_extreme = !speed_mps.iter().any(|v| *v < value) || !speed_mps.iter().any(|v| *v > value);
    let runs =
        constant_runs(speed_mps).filter(|run| speed_mps[run.start].to_bits() == value.to_bits());
    is_extreme
        && certain.len() >= CERTAIN
        && certain.len() as f64 >= CERTAIN_SHARE * runs.count() as f64
}

fn samples_of(checked: &Checked, value_mps: f64) -> Vec<usize> {
    let same = |v: &f64| v.to_bits() == value_mps.to_bits();
    let samples = checked.log.speed_mps().iter().enumerate();
    samples.filter(|(_, v)| same(v)).map(|(i, _)| i).collect()
}
