//! Elevations that are none of a road, where no slope tells.

use super::checked::Checked;
use super::jump::noise_m;
use super::road::{STEEPEST, STRETCHES, Share, Stretch, TRUE, felt_by_battery, stretches};
use crate::statistics::{deviation, quantile, range};
use crate::{Action, Channel, FindingKind};

/// More than this share of the stretches steeper than the steepest streets is no road.
const STEEP_SHARE: f64 = 0.05;

/// The accelerometer feels no less than the road: an elevation that deviates by so many times what is felt (root mean square) is none. In 33
/// trips of a BMW i3 it is 1.7 times at most.
const FELT_TIMES: f64 = 3.0;

/// An elevation that varies by less than the first figure, m, over so long a way, m, is hardly one in metres.
const FLAT_M: f64 = 0.5;
const FLAT_WAY_M: f64 = 5000.0;

/// Fewer than a hundred roads are as high, m.
const HIGH_M: f64 = 4500.0;

/// Drops an elevation that no road has, or that is another than the one the car feels; reports one that hardly any road has.
pub(super) fn judge(checked: &mut Checked) {
    let Some(elevation_m) = checked.values(Channel::Elevation) else {
        return;
    };
    let noise_m = noise_m(checked.log.time_s(), elevation_m);
    let stretches = stretches(&checked.log);
    let wrong = too_steep(&stretches, noise_m)
        .or_else(|| too_hilly(&stretches, noise_m))
        .or_else(|| by_battery(checked));
    if let Some(detail) = wrong {
        let cause = "in ft, dm or cm, perhaps (name the unit in the header), or that of a height model at bridges and tunnels, or of a sensor that drifts";
        report(checked, Action::Dropped, format!("{detail}: {cause}"));
        checked.log.channels.remove(&Channel::Elevation);
    } else if let Some(detail) = unlikely(checked, elevation_m) {
        report(checked, Action::Kept, detail);
    }
}

/// What is odd of an elevation that may be.
fn unlikely(checked: &Checked, elevation_m: &[f64]) -> Option<String> {
    let mut known: Vec<f64> = elevation_m
        .iter()
        .copied()
        .filter(|z| z.is_finite())
        .collect();
    let median_m = quantile(&mut known, 0.5)?;
    if median_m > HIGH_M {
        return Some(format!(
            "{median_m:.0} m (median) is higher than nearly all roads: if it is in ft, name the unit in the header"
        ));
    }
    let range_m = range(&known);
    let way_m = checked.distance_m().last().copied()?;
    (range_m > 0.0 && range_m < FLAT_M && way_m > FLAT_WAY_M).then(|| {
        let km = way_m / 1e3;
        format!(
            "varies by {range_m:.3} m over {km:.1} km: if it is in km, name the unit in the header"
        )
    })
}

fn by_battery(checked: &Checked) -> Option<String> {
    let share = felt_by_battery(checked, Channel::Elevation).filter(Share::is_certain)?;
    let times = share.times;
    (!TRUE.contains(&times)).then(|| format!("the battery feels {times:.2} times what it rises"))
}

fn too_steep(stretches: &[Stretch], noise_m: f64) -> Option<String> {
    let is_steep = |s: &&Stretch| s.rise_m.abs() - 3.0 * noise_m > STEEPEST * s.way_m;
    let steep = stretches.iter().filter(is_steep).count();
    let is_steep =
        stretches.len() >= STRETCHES && steep as f64 > STEEP_SHARE * stretches.len() as f64;
    is_steep.then(|| {
        let all = stretches.len();
        format!("{steep} of {all} stretches of 150 m are steeper than any street, 0.34")
    })
}

fn too_hilly(stretches: &[Stretch], noise_m: f64) -> Option<String> {
    let felt: Vec<&Stretch> = stretches.iter().filter(|s| s.felt_m.is_finite()).collect();
    let squares = felt.iter().map(|s| s.felt_m * s.felt_m);
    let felt_m = (squares.sum::<f64>() / felt.len() as f64).sqrt();
    let rise_m = deviation(felt.iter().map(|s| s.rise_m));
    let rise_m = (rise_m.powi(2) - 2.0 * noise_m.powi(2)).max(0.0).sqrt();
    (felt.len() >= STRETCHES && rise_m > FELT_TIMES * felt_m).then(|| {
        let times = rise_m / felt_m;
        format!("rises {times:.1} times what the accelerometer feels over stretches of 150 m")
    })
}

fn report(checked: &mut Checked, action: Action, detail: String) {
    checked.report_all(FindingKind::Unit, Channel::Elevation, action, detail);
}
