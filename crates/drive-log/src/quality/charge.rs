//! A constant offset of the battery current.
//!
//! The state of charge falls by what flows out of the battery: over pieces of a minute `−ΔSoC = (∫I dt − I₀ Δt)/C`, in which the
//! capacity and the offset are fitted by least squares.

use super::checked::Checked;
use super::motion::STANDSTILL_MPS;
use crate::statistics::quantile;
use crate::{Action, Channel, FindingKind};

/// Pieces over which charges are compared, s, how many there must be, and the share of the variance that they must explain.
const PIECE_S: f64 = 60.0;
const PIECES: usize = 8;
const EXPLAINED: f64 = 0.8;

/// Rows further apart do not say what flowed, s.
const LONGEST_STEP_S: f64 = 5.0;

/// An offset is one from this current on, A, at so many standard errors: 33 trips of a BMW i3 have up to 4.2 of them.
const OFFSET_A: f64 = 1.5;
const ERRORS: f64 = 6.0;

/// A car that stands takes power from its battery: over so long, s, the median is not below the last figure, W.
const STANDSTILL_S: f64 = 10.0;
const CHARGING_W: f64 = -100.0;

/// An offset is known where its standard error is at most this share of it, and the car takes no more at standstill without it than
/// auxiliaries may, W.
const KNOWN: f64 = 0.1;
const AUXILIARIES_W: f64 = 10_000.0;

/// Takes an offset off the current where the state of charge tells it for certain; reports one that it tells otherwise, or standstill.
pub(super) fn judge_offset(checked: &mut Checked) {
    if let Some((offset_a, error_a)) = offset_by_charge(checked) {
        return judge(checked, offset_a, error_a);
    }
    if let Some(power_w) = standstill_w(checked, 0.0).filter(|w| *w < CHARGING_W) {
        let detail = format!(
            "{power_w:.0} W at standstill (median): the battery is charged while the car stands; if it is not plugged in, the current has an offset"
        );
        report(checked, Action::Kept, detail);
    }
}

fn judge(checked: &mut Checked, offset_a: f64, error_a: f64) {
    let figures = format!(
        "{offset_a:.1} A more, to {error_a:.1} A (standard error), than the state of charge falls by, all along"
    );
    let standing = standstill_w(checked, 0.0).zip(standstill_w(checked, offset_a));
    let may_be = standing.is_none_or(|(_, w)| (CHARGING_W..=AUXILIARIES_W).contains(&w));
    if error_a <= KNOWN * offset_a.abs() && may_be {
        if let Some(values) = checked.log.channels.get_mut(&Channel::BatteryCurrent) {
            values.iter_mut().for_each(|a| *a -= offset_a);
        }
        return report(checked, Action::Shifted, format!("{figures}: taken off"));
    }
    let standing = standing.map_or_else(String::new, |(now_w, then_w)| {
        format!("; {now_w:.0} W at standstill (median), and {then_w:.0} W without")
    });
    let detail = format!(
        "{figures}{standing}: the current may have an offset, or the state of charge is wrong; not taken off"
    );
    report(checked, Action::Kept, detail);
}

/// What flows out of the battery in a piece, A s, how long it is, s, and by how much the charge falls, %.
struct Piece {
    charge_as: f64,
    duration_s: f64,
    fall_pct: f64,
}

/// The offset and its standard error, A, where it is one.
fn offset_by_charge(checked: &Checked) -> Option<(f64, f64)> {
    let pieces = pieces(checked)?;
    let sum = |of: &dyn Fn(&Piece) -> f64| pieces.iter().map(of).sum::<f64>();
    let (qq, qt, tt) = (
        sum(&|p| p.charge_as * p.charge_as),
        sum(&|p| p.charge_as * p.duration_s),
        sum(&|p| p.duration_s * p.duration_s),
    );
    let (qf, tf) = (
        sum(&|p| p.charge_as * p.fall_pct),
        sum(&|p| p.duration_s * p.fall_pct),
    );
    let determinant = qq * tt - qt * qt;
    // per cent for a coulomb, and for a second
    let (per_as, per_s) = (
        (qf * tt - tf * qt) / determinant,
        (tf * qq - qf * qt) / determinant,
    );
    let rest = sum(&|p| (p.fall_pct - per_as * p.charge_as - per_s * p.duration_s).powi(2));
    let n = pieces.len() as f64;
    let mean_pct = sum(&|p| p.fall_pct) / n;
    let total = sum(&|p| (p.fall_pct - mean_pct).powi(2));
    let offset_a = -per_s / per_as;
    let variance = rest / ((n - 2.0) * determinant * per_as * per_as);
    let error_a = (variance * (qq - 2.0 * offset_a * qt + offset_a * offset_a * tt)).sqrt();
    (pieces.len() >= PIECES
        && per_as > 0.0
        && rest <= (1.0 - EXPLAINED) * total
        && offset_a.abs() >= OFFSET_A.max(ERRORS * error_a))
    .then_some((offset_a, error_a))
}

/// The pieces of the drive without a gap.
fn pieces(checked: &Checked) -> Option<Vec<Piece>> {
    let (current_a, soc_pct) = (
        checked.values(Channel::BatteryCurrent)?,
        checked.values(Channel::StateOfCharge)?,
    );
    let time_s = checked.log.time_s();
    let mut pieces = Vec::new();
    let (mut start, mut charge_as) = (0, 0.0);
    for i in 1..time_s.len() {
        let step_s = time_s[i] - time_s[i - 1];
        charge_as += 0.5 * (current_a[i] + current_a[i - 1]) * step_s;
        let fall_pct = soc_pct[start] - soc_pct[i];
        if step_s > LONGEST_STEP_S || !charge_as.is_finite() || !soc_pct[start].is_finite() {
            (start, charge_as) = (i, 0.0);
        } else if time_s[i] - time_s[start] >= PIECE_S && fall_pct.is_finite() {
            pieces.push(Piece {
                charge_as,
                duration_s: time_s[i] - time_s[start],
                fall_pct,
            });
            (start, charge_as) = (i, 0.0);
        }
    }
    Some(pieces)
}

/// Median battery power at standstill without an offset of the current, W; `None` where the car hardly stands.
fn standstill_w(checked: &Checked, offset_a: f64) -> Option<f64> {
    let (voltage_v, current_a) = (
        checked.values(Channel::BatteryVoltage)?,
        checked.values(Channel::BatteryCurrent)?,
    );
    let speed_mps = checked.log.speed_mps();
    let standing = (0..speed_mps.len()).filter(|&i| speed_mps[i].abs() < STANDSTILL_MPS);
    let power_w = standing.map(|i| voltage_v[i] * (current_a[i] - offset_a));
    let mut power_w: Vec<f64> = power_w.filter(|w| w.is_finite()).collect();
    let all_s = checked.duration_s(&(0..speed_mps.len()));
    let standing_s = all_s * power_w.len() as f64 / speed_mps.len() as f64;
    (standing_s >= STANDSTILL_S)
        .then(|| quantile(&mut power_w, 0.5))
        .flatten()
}

fn report(checked: &mut Checked, action: Action, detail: String) {
    checked.report_all(
        FindingKind::CurrentOffset,
        Channel::BatteryCurrent,
        action,
        detail,
    );
}
