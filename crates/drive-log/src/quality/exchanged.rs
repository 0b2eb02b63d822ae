//! Volts and amps in each other's column.

use super::checked::Checked;
use crate::statistics::mean;
use crate::{Action, Channel, FindingKind};

/// A voltage never varies by more than this share of its mean (standard deviation), and a current of over so many amps in the
/// mean not by as little as the second.
const VOLTAGE_VARIES: f64 = 0.5;
const CURRENT_VARIES: f64 = 0.15;
const LEAST: f64 = 20.0;

/// Samples that tell.
const SAMPLES: usize = 60;

/// Puts volts and amps that are exchanged into their places.
pub(super) fn put_right(checked: &mut Checked) {
    let of = |channel| checked.values(channel).and_then(varies);
    let both = of(Channel::BatteryVoltage).zip(of(Channel::BatteryCurrent));
    let Some(((volts, volts_vary), (amps, amps_vary))) = both else {
        return;
    };
    if volts_vary <= VOLTAGE_VARIES * volts.abs()
        || amps < LEAST
        || amps_vary >= CURRENT_VARIES * amps
    {
        return;
    }
    let channels = &mut checked.log.channels;
    let voltage = channels.remove(&Channel::BatteryVoltage);
    let current = channels.remove(&Channel::BatteryCurrent);
    channels.extend(voltage.map(|v| (Channel::BatteryCurrent, v)));
    channels.extend(current.map(|a| (Channel::BatteryVoltage, a)));
    let detail = format!(
        "a voltage of {volts:.0} ± {volts_vary:.0} V and a current of {amps:.0} ± {amps_vary:.0} A are in each other's column: exchanged"
    );
    checked.report_all(
        FindingKind::Unit,
        Channel::BatteryVoltage,
        Action::Replaced,
        detail,
    );
}

/// Mean and standard deviation.
fn varies(values: &[f64]) -> Option<(f64, f64)> {
    let known = values.iter().filter(|v| v.is_finite()).count();
    let middle = mean(values.iter().copied())?;
    let variance = mean(values.iter().map(|v| (v - middle).powi(2)))?;
    (known >= SAMPLES).then_some((middle, variance.sqrt()))
}
