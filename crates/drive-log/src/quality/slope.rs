//! Slopes and elevations that contradict each other, or any road.

use std::ops::Range;

use super::checked::Checked;
use super::jump::noise_m;
use super::pace::{self, Verdict};
use super::road::{STEEPEST, STRETCHES, Share, Stretch, felt_by_battery, pairs, stretches};
use super::runs::constant_runs;
use crate::statistics::{correlation, near, range, slope};
use crate::{Action, Channel, FindingKind};

/// More than this share of the samples steeper than the steepest streets is no road.
const STEEP_SHARE: f64 = 0.01;

/// How heights along stretches must correlate to have a factor.
const FOLLOWS: f64 = 0.8;

/// Slopes that are so many times what the elevation says are in another unit; feet, within a tolerance.
const TIMES: (f64, f64) = (0.1, 10.0);
const FOOT_M: f64 = 0.3048;
const TOLERANCE: f64 = 0.08;

/// Another factor is one where it is off by so much and three standard errors.
const FACTOR_TOLERANCE: f64 = 0.25;
const ERRORS: f64 = 3.0;

/// A slope climbs by so much too much all along, rad, and in all, m: satellites and barometers drift by less.
const OFFSET_RAD: f64 = 0.005;
const OFFSET_M: f64 = 30.0;

/// The two have nothing to do with each other where this share of the rises, beyond the noise, is not what the slope climbs, and
/// so many metres of a stretch (root mean square).
const UNEXPLAINED: f64 = 0.7;
const UNEXPLAINED_M: f64 = 2.0;

/// A slope that is one value over this way, m, is frozen where the elevation leaves it by so much, m.
const FROZEN_M: f64 = 1000.0;
const FROZEN_OFF_M: f64 = 10.0;

/// The accelerometer tells which of the two is the road: it follows one at least so well, and better by so much than the other.
const FELT: f64 = 0.6;
const FELT_BETTER: f64 = 0.2;

/// Or it feels one times so much (logarithm), and the other times so much.
const FELT_OFF: (f64, f64) = (0.2, 0.4);

/// A fall of a stretch that an elevation does not imagine, m, and the share of stretches with one of a road with hills.
const FALL_M: f64 = 2.0;
const FALLS: f64 = 0.2;

/// Drops a slope that is no road.
pub(super) fn drop_steep(checked: &mut Checked) {
    let Some(slope_rad) = checked.values(Channel::Slope) else {
        return;
    };
    let known = slope_rad.iter().filter(|s| s.is_finite()).count();
    let steep = slope_rad.iter().filter(|s| s.abs() > STEEPEST).count();
    if steep as f64 > STEEP_SHARE * known as f64 {
        let detail = format!(
            "{steep} of {known} slopes are steeper than any street, 0.34 rad: in degrees or per cent, perhaps; name the unit in the header"
        );
        drop(checked, Channel::Slope, detail);
    }
}

/// Drops a slope or an elevation that the other contradicts; reports them where either may be wrong.
pub(super) fn judge(checked: &mut Checked) {
    if checked.values(Channel::Slope).is_none() {
        return;
    }
    if checked.values(Channel::Elevation).is_none() {
        return judge_alone(checked);
    }
    let stretches = stretches(&checked.log);
    let heights = pairs(&stretches, |s| (s.rise_m, s.climb_m));
    if let Some(detail) = frozen(checked) {
        return report(checked, FindingKind::Frozen, Channel::Slope, detail);
    }
    if heights.len() < STRETCHES {
        return;
    }
    let times = (correlation(&heights).abs() >= FOLLOWS).then(|| slope(&heights));
    if let Some(detail) = times.and_then(of_unit) {
        drop(checked, Channel::Slope, detail);
    } else if let Some(times) = times.filter(|times| near(*times, FOOT_M, TOLERANCE)) {
        let detail = format!(
            "rises {:.2} times what the slope says: ft read as m, not used",
            1.0 / times
        );
        drop(checked, Channel::Elevation, detail);
    } else if let Some((times, detail)) = factor(&heights) {
        // an accelerometer that is still there has said that the times are right
        let is_felt = checked.values(Channel::Accelerometer).is_some();
        match pace::by_battery(checked, times) {
            Verdict::Wrong(why) if !is_felt => {
                pace::refuse(checked, &format!("{detail}; {why}"));
            }
            Verdict::Open if !is_felt => keep(
                checked,
                &format!("{detail}: one of the two, or the times, are wrong"),
            ),
            _ => settle(checked, &stretches, &detail),
        }
    } else if let Some(detail) = offset(&stretches) {
        drop(checked, Channel::Slope, detail);
    } else if let Some(detail) = unrelated(checked, &heights) {
        settle(checked, &stretches, &detail);
    }
}

/// Reports a slope beside which there is no elevation, and that the battery does not feel.
fn judge_alone(checked: &mut Checked) {
    let share = felt_by_battery(checked, Channel::Slope).filter(Share::is_of_no_road);
    if let Some(Share { times, error }) = share {
        let detail = format!(
            "the battery feels {times:.2} times what it climbs, to {error:.2} (standard error)"
        );
        keep(checked, &detail);
    }
}

/// What a factor says of a slope that is turned around or in another unit.
fn of_unit(times: f64) -> Option<String> {
    if times < 0.0 {
        return Some(format!(
            "{times:.2} times what the elevation rises: turned around"
        ));
    }
    (times < TIMES.0 || times > TIMES.1)
        .then(|| format!("{times:.3} times what the elevation rises: in another unit"))
}

/// What says that a slope climbs another multiple of what the elevation rises. Noise of the elevation lowers the factor, noise of
/// the slope the inverse.
fn factor(heights: &[(f64, f64)]) -> Option<(f64, String)> {
    let (r, times) = (correlation(heights), slope(heights));
    let error = times * ((1.0 / (r * r) - 1.0) / heights.len() as f64).sqrt();
    let margin = FACTOR_TOLERANCE + ERRORS * error;
    let may_be_one = times <= 1.0 + margin && times / (r * r) >= 1.0 / (1.0 + margin);
    (r >= FOLLOWS && !may_be_one).then(|| {
        let detail = format!(
            "the slope climbs {times:.2} times what the elevation rises over the way that speeds and times make"
        );
        (times, detail)
    })
}

/// What says that a slope climbs too much, or too little, all along.
fn offset(stretches: &[Stretch]) -> Option<String> {
    let known = stretches.iter().filter(|s| s.climb_m.is_finite());
    let (off_m, way_m) = known.fold((0.0, 0.0), |(off_m, way_m), s| {
        (off_m + s.climb_m - s.rise_m, way_m + s.way_m)
    });
    let offset_rad: f64 = off_m / way_m;
    (offset_rad.abs() > OFFSET_RAD && off_m.abs() > OFFSET_M).then(|| {
        let km = way_m / 1e3;
        format!(
            "climbs {off_m:.0} m more than the elevation over {km:.1} km: off by {offset_rad:.3} rad all along; not used, as the elevation is there"
        )
    })
}

/// What says that a slope and an elevation are not of one road.
fn unrelated(checked: &Checked, heights: &[(f64, f64)]) -> Option<String> {
    let elevation_m = checked.values(Channel::Elevation)?;
    let noise_m2 = 2.0 * noise_m(checked.log.time_s(), elevation_m).powi(2);
    let n = heights.len() as f64;
    let off_m = heights.iter().map(|(rise_m, climb_m)| climb_m - rise_m);
    let mean_m = off_m.clone().sum::<f64>() / n;
    let off_m2 = off_m.map(|off_m| (off_m - mean_m).powi(2)).sum::<f64>() / n - noise_m2;
    let rise_m2 = heights
        .iter()
        .map(|(rise_m, _)| rise_m * rise_m)
        .sum::<f64>()
        / n
        - noise_m2;
    (off_m2 > UNEXPLAINED * rise_m2.max(0.0) && off_m2 > UNEXPLAINED_M.powi(2).max(noise_m2)).then(
        || {
            let (off_m, rise_m) = (off_m2.sqrt(), rise_m2.max(0.0).sqrt());
            format!(
                "stretches of 150 m rise by {rise_m:.1} m, and the slope climbs otherwise by {off_m:.1} m (root mean square)"
            )
        },
    )
}

/// What says that a slope does not change while the elevation leaves it.
fn frozen(checked: &Checked) -> Option<String> {
    let (slope_rad, elevation_m) = (
        checked.values(Channel::Slope)?,
        checked.values(Channel::Elevation)?,
    );
    let distance_m = checked.distance_m();
    let off_m = |run: &Range<usize>| {
        let climb = slope_rad[run.start].sin();
        let height = |i: usize| elevation_m[i] - climb * distance_m[i];
        range(&run.clone().map(height).collect::<Vec<f64>>())
    };
    let least_m = FROZEN_OFF_M + 6.0 * noise_m(checked.log.time_s(), elevation_m);
    let way_m = |run: &Range<usize>| distance_m[run.end - 1] - distance_m[run.start];
    let run = constant_runs(slope_rad)
        .filter(|run| way_m(run) >= FROZEN_M && off_m(run) > least_m)
        .max_by(|a, b| way_m(a).total_cmp(&way_m(b)))?;
    Some(format!(
        "constant for {:.1} km, over which the elevation leaves it by {:.0} m; not used, as the elevation is there",
        way_m(&run) / 1e3,
        off_m(&run)
    ))
}

/// Drops the one that accelerometer or battery do not feel, or that is a slope without a sign; else reports both.
fn settle(checked: &mut Checked, stretches: &[Stretch], why: &str) {
    let by_accelerometer = [
        Felt::of(&pairs(stretches, |s| (s.climb_m, s.felt_m))),
        Felt::of(&pairs(stretches, |s| (s.rise_m, s.felt_m))),
    ];
    let by_battery = [Channel::Slope, Channel::Elevation].map(|channel| Felt {
        correlation: 1.0,
        times: felt_by_battery(checked, channel)
            .filter(Share::is_certain)
            .map_or(f64::NAN, |share| share.times),
    });
    for (witness, [slope, elevation]) in
        [("accelerometer", by_accelerometer), ("battery", by_battery)]
    {
        let wrong = if elevation.is_right_beside(slope) {
            Channel::Slope
        } else if slope.is_right_beside(elevation) {
            Channel::Elevation
        } else {
            continue;
        };
        let (slope, elevation) = (slope.times, elevation.times);
        let detail = format!(
            "{why}; the {witness} feels {slope:.2} times the slope and {elevation:.2} times the elevation: not used"
        );
        return drop(checked, wrong, detail);
    }
    if has_no_sign(checked, stretches) {
        let detail = format!("{why}, and never falls: recorded without its sign; not used");
        return drop(checked, Channel::Slope, detail);
    }
    keep(checked, &format!("{why}: one of the two is wrong"));
}

fn keep(checked: &mut Checked, why: &str) {
    checked.report_all(
        FindingKind::Contradicted,
        Channel::Slope,
        Action::Kept,
        format!("{why}; check them, and leave out what is wrong"),
    );
}

/// How many times the heights of a channel a witness feels, and how well it follows them.
#[derive(Clone, Copy)]
struct Felt {
    correlation: f64,
    times: f64,
}

impl Felt {
    fn of(heights: &[(f64, f64)]) -> Self {
        let correlation = correlation(heights);
        Self {
            correlation: if correlation.is_nan() {
                0.0
            } else {
                correlation
            },
            times: slope(heights),
        }
    }

    fn is_right_beside(self, other: Self) -> bool {
        let off = |felt: Self| felt.times.ln().abs();
        let is_closer = off(self) <= FELT_OFF.0 && off(other) >= FELT_OFF.1;
        self.correlation >= FELT
            && (self.correlation - other.correlation >= FELT_BETTER || is_closer)
    }
}

/// Whether a slope never falls, and the road does.
fn has_no_sign(checked: &Checked, stretches: &[Stretch]) -> bool {
    let slope_rad = checked.values(Channel::Slope).unwrap_or_default();
    let falls = stretches.iter().filter(|s| s.rise_m < -FALL_M).count();
    falls as f64 > FALLS * stretches.len() as f64 && !slope_rad.iter().any(|s| *s < 0.0)
}

fn drop(checked: &mut Checked, channel: Channel, detail: String) {
    report(checked, FindingKind::Unit, channel, detail);
}

fn report(checked: &mut Checked, kind: FindingKind, channel: Channel, detail: String) {
    checked.report_all(kind, channel, Action::Dropped, detail);
    checked.log.channels.remove(&channel);
}
