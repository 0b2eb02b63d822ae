//! Speed limits in another unit than their header says.

use super::checked::Checked;
use super::motion::spans;
use super::sentinel::HIGHEST_LIMIT_MPS;
use super::speed_mistake::MISTAKES;
use super::speed_unit::limit_share;
use crate::{Action, Channel, FindingKind};

/// Limits come in steps of this, in km/h and in mph; no more than the second figure.
const STEP: f64 = 5.0;
const HIGHEST: f64 = 160.0;

/// What the fastest tenth of the time reaches of a limit in the right unit.
const SHARE: (f64, f64) = (0.7, 1.4);

/// Converts limits of whole fives in m/s some of which no country has: they are km/h or mph. Drops
/// them where the speed does not tell which.
pub(super) fn convert(checked: &mut Checked) {
    let Some(limits) = checked.values(Channel::SpeedLimit) else {
        return;
    };
    let mut given = limits
        .iter()
        .filter(|limit| **limit > 0.0 && **limit <= HIGHEST);
    let highest = given.clone().copied().fold(0.0, f64::max);
    if highest <= HIGHEST_LIMIT_MPS || !given.all(|limit| limit % STEP == 0.0) {
        return;
    }
    let share = limit_share(&checked.log, &spans(&checked.log));
    let fits = |factor: f64| share.is_some_and(|s| (SHARE.0..=SHARE.1).contains(&(s * factor)));
    // the first two are what is read as m/s
    let possible: Vec<(f64, &str)> = MISTAKES[..2]
        .iter()
        .copied()
        .filter(|(f, _)| fits(*f))
        .collect();
    let why = format!("limits in steps of 5 m/s, up to {highest} m/s");
    let (action, detail) = if let [(factor, unit)] = possible.as_slice() {
        if let Some(values) = checked.log.channels.get_mut(&Channel::SpeedLimit) {
            values.iter_mut().for_each(|limit| *limit /= factor);
        }
        (
            Action::Scaled,
            format!("{why}: {unit}, divided by {factor:.4}"),
        )
    } else {
        checked.log.channels.remove(&Channel::SpeedLimit);
        let detail =
            format!("{why}, which no country has; name the unit in the header or a layout");
        (Action::Dropped, detail)
    };
    checked.report_all(FindingKind::Unit, Channel::SpeedLimit, action, detail);
}
