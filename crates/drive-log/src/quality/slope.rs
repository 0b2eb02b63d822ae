//! Slopes and elevations that contradict each other, or any road.

use super::checked::Checked;
use super::motion::spans;
use crate::statistics::{correlation, near, slope};
use crate::{Action, Channel, FindingKind};

/// The steepest streets have 0.34 rad; more than this share of the samples over the first figure is no road.
const STEEPEST_RAD: f64 = 0.35;
const STEEP_SHARE: f64 = 0.01;

/// Stretches over which heights are compared, m; how many there must be, and how they must correlate.
const STRETCH_M: f64 = 150.0;
const STRETCHES: usize = 20;
const FOLLOWS: f64 = 0.8;

/// Slopes that are so many times what the elevation says are in another unit; feet, within a tolerance.
const TIMES: (f64, f64) = (0.1, 10.0);
const FOOT_M: f64 = 0.3048;
const TOLERANCE: f64 = 0.08;

/// Drops a slope that is turned around or in another unit, and an elevation in feet.
pub(super) fn judge(checked: &mut Checked) {
    let Some(slope_rad) = checked.values(Channel::Slope) else {
        return;
    };
    let known = slope_rad.iter().filter(|s| s.is_finite()).count();
    let steep = slope_rad.iter().filter(|s| s.abs() > STEEPEST_RAD).count();
    let times = times_elevation(checked, slope_rad);
    if steep as f64 > STEEP_SHARE * known as f64 {
        let detail = format!(
            "{steep} of {known} slopes are steeper than any street, 0.34 rad: in degrees or per cent, perhaps; name the unit in the header"
        );
        return report(checked, Channel::Slope, Action::Dropped, &detail);
    }
    let Some(times) = times else {
        return;
    };
    if times < 0.0 {
        let detail = format!("{times:.2} times what the elevation rises: turned around");
        report(checked, Channel::Slope, Action::Dropped, &detail);
    } else if times < TIMES.0 || times > TIMES.1 {
        let detail = format!("{times:.3} times what the elevation rises: in another unit");
        report(checked, Channel::Slope, Action::Dropped, &detail);
    } else if near(times, FOOT_M, TOLERANCE) {
        let detail = format!(
            "rises {:.2} times what the slope says: ft read as m, not used",
            1.0 / times
        );
        report(checked, Channel::Elevation, Action::Dropped, &detail);
    }
}

/// How many times the rise of the elevation a slope climbs.
fn times_elevation(checked: &Checked, slope_rad: &[f64]) -> Option<f64> {
    let elevation_m = checked.values(Channel::Elevation)?;
    let (mut pairs, mut rise_m, mut climb_m, mut way_m) = (Vec::new(), 0.0, 0.0, 0.0);
    for span in spans(&checked.log) {
        let rise = elevation_m[*span.samples.end()] - elevation_m[*span.samples.start()];
        let slope_mean = span.mean(slope_rad).filter(|_| rise.is_finite());
        let Some(climb) = slope_mean.map(|slope| slope * span.distance_m()) else {
            (rise_m, climb_m, way_m) = (0.0, 0.0, 0.0);
            continue;
        };
        (rise_m, climb_m, way_m) = (rise_m + rise, climb_m + climb, way_m + span.distance_m());
        if way_m >= STRETCH_M {
            pairs.push((rise_m, climb_m));
            (rise_m, climb_m, way_m) = (0.0, 0.0, 0.0);
        }
    }
    (pairs.len() >= STRETCHES && correlation(&pairs).abs() >= FOLLOWS).then(|| slope(&pairs))
}

fn report(checked: &mut Checked, channel: Channel, action: Action, detail: &str) {
    checked.report_all(FindingKind::Unit, channel, action, detail.to_owned());
    checked.log.channels.remove(&channel);
}
