//! Times that count rows, or tenths of a second, and are read as seconds.

use super::checked::Checked;
use super::time_unit::{high, report};
use crate::statistics::{correlation, near, slope};
use crate::{Action, Channel, Finding};

/// Rows that tell, and over how many of them a change is looked at.
const ROWS: usize = 300;
const WINDOW: usize = 10;

/// Time between rows that may be meant, s.
const STEPS_S: [f64; 6] = [0.5, 0.2, 0.1, 0.05, 0.02, 0.01];

/// An accelerometer that follows the speed so well, and a way of so many metres, tell the step within a tolerance.
const FOLLOWS: f64 = 0.8;
const LEAST_M: f64 = 300.0;
const TOLERANCE: f64 = 0.08;

/// A car stops, or starts and reaches the second speed, m/s. Where the fastest of all starts and stops, and a hundredth of all
/// changes, are slower than this, m/s², the times are no seconds (it takes 23 s), or hardly so (14 s).
const STARTS_MPS: (f64, f64) = (1.0, 8.0);
const NO_CAR_MPS2: f64 = 0.3;
const NO_ORDINARY_MPS2: f64 = 0.5;

/// Whether the times are whole numbers, one after the other.
pub(super) fn counts_rows(time_s: &[f64]) -> bool {
    let ones = time_s
        .windows(2)
        .filter(|pair| (pair[1] - pair[0] - 1.0).abs() < 1e-9);
    time_s.len() >= ROWS
        && 100 * ones.count() >= 99 * (time_s.len() - 1)
        && time_s.iter().all(|t| (t - t.round()).abs() < 1e-9)
}

/// Scales times that count rows where another channel tells the step; refuses or reports them where only the motion says that they do.
pub(super) fn judge(checked: &mut Checked) {
    let is_refused = |f: &Finding| f.action == Action::Refused;
    if !counts_rows(checked.log.time_s()) || checked.findings.iter().any(is_refused) {
        return;
    }
    let told = by_accelerometer(checked).or_else(|| by_way(checked));
    let step = told.and_then(|(what, times)| {
        let step_s = STEPS_S.into_iter().find(|s| near(times, *s, TOLERANCE))?;
        Some((what, times, step_s))
    });
    if let Some((what, times, step_s)) = step {
        checked.log.time_s.iter_mut().for_each(|t| *t *= step_s);
        let detail = format!(
            "every row is 1 s after the one before, {what} by a factor of {times:.3}: rows are numbered, times multiplied by {step_s}"
        );
        return report(checked, Action::Scaled, detail);
    }
    let samples = checked.log.time_s().iter().zip(checked.log.speed_mps());
    let known = samples.filter(|(_, v)| v.is_finite());
    let speeds: Vec<(f64, f64)> = known.map(|(t, v)| (*t, *v)).collect();
    let changes_mps2 = high(&speeds, 1, 0.99);
    let Some((start_mps2, changes_mps2)) = fastest_mps2(&speeds).zip(changes_mps2) else {
        return;
    };
    let fastest_mps2 = start_mps2.max(changes_mps2);
    let action = match fastest_mps2 {
        a if a < NO_CAR_MPS2 => Action::Refused,
        a if a < NO_ORDINARY_MPS2 => Action::Kept,
        _ => return,
    };
    let detail = format!(
        "every row is 1 s after the one before, and the speed hardly ever changes by more than {fastest_mps2:.2} m/s²: perhaps the \
         column counts rows, or tenths of a second; give the times in seconds"
    );
    report(checked, action, detail);
}

/// Reports times that count rows where the battery power is that of a heavy vehicle.
pub(super) fn report_doubt(checked: &mut Checked, why: &str) {
    let detail = format!(
        "every row is 1 s after the one before, and {why}: if it is a lighter one, perhaps the column counts rows"
    );
    report(checked, Action::Kept, detail);
}

/// How many times `dv/dt` is what the accelerometer feels.
fn by_accelerometer(checked: &Checked) -> Option<(&'static str, f64)> {
    let felt = checked.values(Channel::Accelerometer)?;
    let speed_mps = checked.log.speed_mps();
    let pair = |i: usize| {
        let felt_mps2 = felt[i..i + WINDOW].iter().sum::<f64>() / WINDOW as f64;
        let rise_mps2 = (speed_mps[i + WINDOW] - speed_mps[i]) / WINDOW as f64;
        (felt_mps2 + rise_mps2)
            .is_finite()
            .then_some((felt_mps2, rise_mps2))
    };
    let starts = (0..speed_mps.len() - WINDOW).step_by(WINDOW);
    let pairs: Vec<(f64, f64)> = starts.filter_map(pair).collect();
    let r = correlation(&pairs);
    (r >= FOLLOWS).then(|| {
        // between the slopes of either upon the other
        let times = slope(&pairs) / r;
        ("and yet dv/dt is off the accelerometer", times)
    })
}

/// How many times the recorded way is the one that the speed makes.
fn by_way(checked: &Checked) -> Option<(&'static str, f64)> {
    let way_m = checked.values(Channel::Distance)?;
    let known = || way_m.iter().filter(|m| m.is_finite());
    let recorded_m = known().next_back()? - known().next()?;
    let driven_m = *checked.distance_m().last()?;
    (recorded_m >= LEAST_M).then(|| {
        let what = "and yet the recorded way is off the one that the speed makes";
        (what, recorded_m / driven_m)
    })
}

/// The fastest of all starts and stops.
fn fastest_mps2(speeds: &[(f64, f64)]) -> Option<f64> {
    let (mut below, mut above): (Option<f64>, Option<f64>) = (None, None);
    let mut shortest_s = f64::INFINITY;
    for (t_s, v_mps) in speeds {
        if *v_mps < STARTS_MPS.0 {
            shortest_s = above
                .take()
                .map_or(shortest_s, |from| shortest_s.min(t_s - from));
            below = Some(*t_s);
        } else if *v_mps > STARTS_MPS.1 {
            shortest_s = below
                .take()
                .map_or(shortest_s, |from| shortest_s.min(t_s - from));
            above = Some(*t_s);
        }
    }
    shortest_s
        .is_finite()
        .then(|| (STARTS_MPS.1 - STARTS_MPS.0) / shortest_s)
}
