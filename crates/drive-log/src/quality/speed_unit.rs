//! Speeds in another unit than their header says.

mod witnesses;

use super::checked::Checked;
use super::noise;
use super::pace;
use super::row_number;
use super::speed_mistake::Mistake;
use super::unit_change;
use crate::{Action, Channel, FindingKind};
pub(super) use witnesses::limit_share;
use witnesses::{Objection, Witness, Witnesses};

/// Beyond this not even racing cars come, m/s; nor tyres, for a hundredth of the time, m/s².
const RACING_MPS: f64 = 100.0;
const TYRES_MPS2: f64 = 8.0;

/// In usual factors: how far off the ordinary a drive may be in the likeliest unit, and how much farther it must be in the next one.
const ORDINARY: f64 = 2.0;
const CLEARLY: f64 = 1.0;

/// What a channel that alone speaks against a speed says of itself.
enum Verdict {
    /// The speed is in this unit.
    Speed(Mistake),
    /// The channel is wrong.
    Channel,
    /// Either may be.
    Open,
}

/// Converts a speed whose unit is another one beyond doubt; refuses one that is impossible where the
/// unit cannot be told; reports one that is doubtful. A channel that is at odds with all others is left out.
pub(super) fn convert(checked: &mut Checked) {
    let Some(mut witnesses) = hear(checked) else {
        return;
    };
    loop {
        let objections = witnesses.objections(1.0);
        if objections.is_empty() {
            let likely = likely(&witnesses, &witnesses.possible());
            report_odd(checked, &witnesses, likely);
            return report_no_car(checked, &witnesses);
        }
        if witnesses.is_a_jam(&objections) {
            return;
        }
        let [only] = objections.as_slice() else {
            return decide(checked, &witnesses, &objections);
        };
        let Witness::Measured(channel) = only.witness else {
            return decide(checked, &witnesses, &objections);
        };
        match verdict(&witnesses, channel) {
            Verdict::Speed(unit) if may_be_times(&witnesses, &objections, unit) => {
                return refuse_times(checked, &only.text, unit);
            }
            Verdict::Speed(unit) => return rescale(checked, &only.text, unit),
            Verdict::Open => return refuse_both(checked, &witnesses, channel, &only.text),
            Verdict::Channel => match times(checked, &witnesses, channel) {
                Some(why) => return pace::refuse(checked, &format!("{}; {why}", only.text)),
                None => drop_channel(checked, channel, &only.text),
            },
        }
        witnesses = witnesses.without(channel);
    }
}

/// Noise from row to row hides what a speed says.
fn hear(checked: &Checked) -> Option<Witnesses> {
    let Some((_, smooth_mps)) = noise::smoothed(checked) else {
        return Witnesses::hear(&checked.log);
    };
    let mut log = checked.log.clone();
    log.channels.insert(Channel::Speed, smooth_mps);
    Witnesses::hear(&log)
}

/// Whether all that says that a speed is in another unit are accelerations, and limit or battery make the drive as ordinary if the
/// times are off by that factor instead.
fn may_be_times(witnesses: &Witnesses, objections: &[Objection], unit: Mistake) -> bool {
    let of_times = |objection: &Objection| {
        matches!(
            objection.witness,
            Witness::Motion | Witness::Measured(Channel::Accelerometer | Channel::Accel)
        )
    };
    let is_felt = |objection: &Objection| objection.witness != Witness::Motion;
    objections.iter().all(of_times)
        && objections.iter().any(is_felt)
        && witnesses.are_rather_times(unit.0)
}

/// What says that neither speed nor acceleration are wrong, but the times.
fn times(checked: &Checked, witnesses: &Witnesses, channel: Channel) -> Option<String> {
    let is_acceleration = matches!(channel, Channel::Accelerometer | Channel::Accel);
    let factor = witnesses.factor(channel).filter(|_| is_acceleration)?;
    match pace::by_battery(checked, 1.0 / factor) {
        pace::Verdict::Wrong(why) => Some(why),
        pace::Verdict::Right | pace::Verdict::Open => None,
    }
}

/// Who is right if one channel alone speaks against the unit of the speed: the one that makes the drive as all others know
/// it an ordinary one.
fn verdict(witnesses: &Witnesses, channel: Channel) -> Verdict {
    let rest = witnesses.without(channel);
    let as_said = rest.oddity(1.0);
    let possible = witnesses.possible();
    let odd = |unit: &Mistake| rest.oddity(unit.0);
    let least = possible.iter().map(odd).fold(f64::INFINITY, f64::min);
    if least - as_said >= CLEARLY && (as_said <= ORDINARY || possible.is_empty()) {
        return Verdict::Channel;
    }
    match likely(witnesses, &possible) {
        Some(unit) if odd(&unit) <= ORDINARY && as_said - odd(&unit) >= CLEARLY => {
            Verdict::Speed(unit)
        }
        _ => Verdict::Open,
    }
}

/// The only possible unit, or the one in which the drive is clearly the most ordinary.
fn likely(witnesses: &Witnesses, possible: &[Mistake]) -> Option<Mistake> {
    let mut ranked: Vec<(f64, Mistake)> = possible
        .iter()
        .map(|unit| (witnesses.oddity(unit.0), *unit))
        .collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    match ranked.as_slice() {
        [(_, unit)] => Some(*unit),
        [(best, unit), (next, _), ..] => {
            (*best <= ORDINARY && next - best >= CLEARLY).then_some(*unit)
        }
        [] => None,
    }
}

/// Reports a speed that two figures, or very slow starts, make unlikely, where another unit makes the drive ordinary.
fn report_odd(checked: &mut Checked, witnesses: &Witnesses, likely: Option<Mistake>) {
    let odd = witnesses.odd();
    let mut units: Vec<Mistake> = likely.into_iter().collect();
    if units.is_empty() && witnesses.is_sluggish() {
        units = witnesses.possible();
        units.retain(|unit| witnesses.oddity(unit.0) <= CLEARLY);
    }
    if !units.is_empty() && (odd.len() > 1 || witnesses.is_sluggish()) {
        let detail = format!("{}: {}", odd.join("; "), asked(&units));
        report(checked, Action::Kept, detail);
    }
}

/// Reports speed, volts and amps that together are those of no car, or of an odd one that is ordinary in another unit.
fn report_no_car(checked: &mut Checked, witnesses: &Witnesses) {
    if let Some((why, unit)) = witnesses.odd_car() {
        let rows = if row_number::counts_rows(checked.log.time_s()) {
            ", whether the times count rows,"
        } else {
            ""
        };
        let detail = format!(
            "{why}, and of an ordinary one if it is {unit}: check the unit of the speed{rows} and the scale of volts and amps"
        );
        return report(checked, Action::Kept, detail);
    }
    let counted = row_number::counts_rows(checked.log.time_s());
    if let Some(why) = witnesses.heavy().filter(|_| counted) {
        return row_number::report_doubt(checked, &why);
    }
    if let Some(why) = witnesses.no_car() {
        let detail = format!(
            "{why}: if it is a car, check the scale of volts and amps, and the unit of the speed"
        );
        checked.report_all(
            FindingKind::Unit,
            Channel::BatteryCurrent,
            Action::Kept,
            detail,
        );
    }
}

fn decide(checked: &mut Checked, witnesses: &Witnesses, objections: &[Objection]) {
    let possible = witnesses.possible();
    let texts: Vec<&str> = objections.iter().map(|o| o.text.as_str()).collect();
    let why = texts.join("; ");
    let measured = objections
        .iter()
        .any(|o| matches!(o.witness, Witness::Measured(_)));
    let motion = objections
        .iter()
        .filter(|o| o.witness == Witness::Motion)
        .count();
    let by_limit = motion > 0 && motion < objections.len();
    match likely(witnesses, &possible) {
        Some(unit) if may_be_times(witnesses, objections, unit) => {
            refuse_times(checked, &why, unit);
        }
        Some(unit) if measured || by_limit => rescale(checked, &why, unit),
        _ => {
            let is_impossible = measured
                || motion > 1
                || witnesses.top_mps > RACING_MPS
                || witnesses.pull_mps2 > TYRES_MPS2;
            let action = if is_impossible {
                Action::Refused
            } else {
                Action::Kept
            };
            report(checked, action, format!("{why}: {}", asked(&possible)));
        }
    }
}

/// What may be meant, and what to do.
fn asked(possible: &[Mistake]) -> String {
    let units: Vec<&str> = possible.iter().map(|(_, unit)| *unit).collect();
    if units.is_empty() {
        return "check the units of speed and time".to_owned();
    }
    format!(
        "perhaps {}; name the unit in the header or a layout",
        units.join(", or ")
    )
}

fn rescale(checked: &mut Checked, why: &str, (factor, unit): Mistake) {
    if let Some(at_s) = unit_change::jump_by(checked, factor) {
        let detail = format!(
            "{why}: perhaps {unit}, but the speed jumps by that factor at {at_s:.1} s: cut the log where its unit changes"
        );
        return report(checked, Action::Refused, detail);
    }
    if let Some(values) = checked.log.channels.get_mut(&Channel::Speed) {
        values.iter_mut().for_each(|v| *v *= 1.0 / factor);
    }
    if let Some(rounding) = checked.rounding.as_mut() {
        rounding.scale(1.0 / factor);
    }
    let detail = format!("{why}: {unit}, divided by {factor:.4}");
    report(checked, Action::Scaled, detail);
}

fn refuse_times(checked: &mut Checked, why: &str, (factor, unit): Mistake) {
    let pace = 1.0 / factor;
    let detail = format!(
        "{why}: the times are off by that factor, or the speed is {unit}; the drive is the more ordinary one if it changes its speed {pace:.2} times as fast: check the times and whether rows are missing, or name the unit in the header"
    );
    report(checked, Action::Refused, detail);
}

fn drop_channel(checked: &mut Checked, channel: Channel, why: &str) {
    let detail = format!(
        "{why}, and yet the drive is an ordinary one in the unit of the speed: in another unit or scale, and not used"
    );
    checked.report_all(FindingKind::Unit, channel, Action::Dropped, detail);
    checked.log.channels.remove(&channel);
}

fn refuse_both(checked: &mut Checked, witnesses: &Witnesses, channel: Channel, why: &str) {
    let detail = format!(
        "{why}: {}, or leave {channel} out if its scale is wrong, or check the times and whether rows are missing",
        asked(&witnesses.possible())
    );
    report(checked, Action::Refused, detail);
}

fn report(checked: &mut Checked, action: Action, detail: String) {
    checked.report_all(FindingKind::Unit, Channel::Speed, action, detail);
}
