//! Times that run too fast or too slowly by a factor.

use super::checked::Checked;
use super::motion::moving_spans;
use super::power::{Load, loads};
use super::time_unit::report;
use crate::{Action, Channel};

/// The battery says that times are wrong where the car is more ordinary without, by so many usual factors.
const CLEARLY: f64 = 1.0;

/// What the battery says of times.
pub(super) enum Verdict {
    /// They are off, and why.
    Wrong(String),
    /// They are not.
    Right,
    /// It does not tell.
    Open,
}

/// Whether the car changes its speed `times` as fast as the times say: with the battery power it is an ordinary car then, and is none
/// as recorded.
pub(super) fn by_battery(checked: &Checked, times: f64) -> Verdict {
    let loads = loads(&checked.log, &moving_spans(&checked.log));
    let faster: Vec<Load> = loads.iter().map(|load| load.at_pace(times)).collect();
    let Some((as_said, then)) = Load::fit(&loads, 1.0).zip(Load::fit(&faster, 1.0)) else {
        return Verdict::Open;
    };
    let better = as_said.oddity() - then.oddity();
    if better >= CLEARLY {
        let why = format!(
            "speed and battery power are those of {as_said}, and of {then} if every second takes {:.2} s",
            1.0 / times
        );
        Verdict::Wrong(why)
    } else if better <= -CLEARLY {
        Verdict::Right
    } else {
        Verdict::Open
    }
}

/// Refuses the times.
pub(super) fn refuse(checked: &mut Checked, why: &str) {
    let detail = format!("{why}: check the times, and whether rows are missing");
    report(checked, Action::Refused, detail);
}

/// Refuses a log whose accelerometer follows the speed by another factor than one, where nothing tells what is off by it.
pub(super) fn refuse_either(checked: &mut Checked, figures: &str) {
    let detail = format!(
        "{figures}: the accelerometer, the times or the speeds are off by that factor; check whether rows are missing and the units of times and speeds, or leave {} out if its scale is wrong",
        Channel::Accelerometer
    );
    report(checked, Action::Refused, detail);
}
