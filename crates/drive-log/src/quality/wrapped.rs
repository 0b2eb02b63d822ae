//! A current whose counter wraps around.

use std::collections::BTreeMap;

use super::checked::Checked;
use crate::statistics::{deviation, quantile, range};
use crate::{Action, Channel, FindingKind};

/// Jumps over this share of the largest one are turns of the counter if there are so many, and they deviate from their median by at most the
/// last share of it.
const LARGE: f64 = 0.7;
const WRAPS: usize = 4;
const UNLIKE: f64 = 0.05;

/// Between these shares of a turn there is hardly any other jump: so many for each turn.
const BETWEEN: (f64, f64) = (0.35, 0.7);
const OTHERS: f64 = 0.1;

/// A counter that wraps around has values all over its range, and hardly any beyond.
const RANGE: (f64, f64) = (0.7, 1.2);

/// Turns go forth and back; a counter of 128 A turns so often for a motor at full power and back to charging.
const TURNS: f64 = 6.0;

/// Without the turns the current has at most this share of its variation, and yet changes by so much, A: it is none that is
/// switched on and off.
const VARIATION: f64 = 0.75;
const CHANGE_A: f64 = 20.0;

/// Counters of 8, 10, 12 and 16 bits, their steps, A, and ranges in decimal figures, A.
const COUNTS: [f64; 4] = [256.0, 1024.0, 4096.0, 65_536.0];
const STEPS_A: [f64; 12] = [
    0.001, 0.01, 0.02, 0.025, 0.05, 0.1, 0.125, 0.2, 0.25, 0.4, 0.5, 1.0,
];
const DECIMAL_A: [f64; 2] = [1000.0, 2000.0];

/// A jump is a turn less what the current changes meanwhile. So a turn is more than the largest jump, by no more than this many times what
/// that is above the median, and this share of it for the rest; and by no more than the last.
const ABOVE: f64 = 2.0;
const REST: f64 = 0.002;
const MOST_ABOVE: f64 = 0.025;

/// Jumps that lead to one exact value in so large a share are to a code.
const CODE_SHARE: f64 = 0.4;

/// Takes the turns off a current whose counter wraps around; drops the current where no usual counter does.
pub(super) fn unwrap_current(checked: &mut Checked) {
    let channel = Channel::BatteryCurrent;
    let Some(wrap) = checked.values(channel).and_then(Wrap::of) else {
        return;
    };
    let Wrap { jumps, about_a, .. } = wrap;
    let (action, detail) = match wrap.usual_a {
        Some(wrap_a) => {
            checked.log.channels.insert(channel, wrap.unwrapped_a);
            let detail = format!(
                "{jumps} jumps by about {about_a:.0} A, forth and back: a counter wraps around after {wrap_a} A; turned back"
            );
            (Action::Converted, detail)
        }
        None => {
            checked.log.channels.remove(&channel);
            let detail = format!(
                "{jumps} jumps by about {about_a:.0} A, forth and back: a counter wraps around there, after none of the usual ranges; not used"
            );
            (Action::Dropped, detail)
        }
    };
    checked.report_all(FindingKind::CurrentSign, channel, action, detail);
}

/// A counter that wraps around.
struct Wrap {
    jumps: usize,
    /// The median jump, and the usual range that it is a turn of, A.
    about_a: f64,
    usual_a: Option<f64>,
    unwrapped_a: Vec<f64>,
}

impl Wrap {
    fn of(current_a: &[f64]) -> Option<Self> {
        let known: Vec<f64> = current_a
            .iter()
            .copied()
            .filter(|a| a.is_finite())
            .collect();
        let sizes_a: Vec<f64> = known
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).abs())
            .collect();
        let largest_a = sizes_a.iter().copied().fold(0.0, f64::max);
        let mut large_a: Vec<f64> = sizes_a
            .iter()
            .copied()
            .filter(|a| *a > LARGE * largest_a)
            .collect();
        let jumps = large_a.len();
        let about_a = quantile(&mut large_a, 0.5)?;
        let between = BETWEEN.0 * about_a..BETWEEN.1 * about_a;
        let others = sizes_a.iter().filter(|a| between.contains(*a)).count();
        let range = range(&known) / about_a;
        if jumps < WRAPS
            || deviation(large_a.iter().map(|a| a - about_a)) > UNLIKE * about_a
            || others as f64 > OTHERS * jumps as f64
            || !(RANGE.0..=RANGE.1).contains(&range)
            || are_to_a_code(&known, LARGE * largest_a)
        {
            return None;
        }
        let usual_a = usual(largest_a, about_a);
        let unwrapped_a = unwrapped(current_a, usual_a.unwrap_or(largest_a))?;
        Some(Self {
            jumps,
            about_a,
            usual_a,
            unwrapped_a,
        })
    }
}

/// The usual range of a counter that the largest and the median jump are turns of, A.
fn usual(largest_a: f64, median_a: f64) -> Option<f64> {
    let rest_a = REST * largest_a;
    let above_a = (ABOVE * (largest_a - median_a) + rest_a).min(MOST_ABOVE * largest_a);
    let counters = COUNTS
        .iter()
        .flat_map(|count| STEPS_A.map(|step_a| count * step_a));
    counters
        .chain(DECIMAL_A)
        .filter(|range_a| (largest_a - rest_a..=largest_a + above_a).contains(range_a))
        .min_by(f64::total_cmp)
}

/// Whether large jumps lead to, or from, one exact value.
fn are_to_a_code(known_a: &[f64], least_a: f64) -> bool {
    let jumps = known_a
        .windows(2)
        .filter(|pair| (pair[1] - pair[0]).abs() > least_a);
    let mut highest: BTreeMap<u64, usize> = BTreeMap::new();
    let mut count = 0_usize;
    for pair in jumps {
        *highest.entry(pair[0].max(pair[1]).to_bits()).or_default() += 1;
        count += 1;
    }
    let most = highest.values().max().copied().unwrap_or(0);
    most as f64 > CODE_SHARE * count as f64
}

/// A current without the turns; `None` if they are not forth and back, or leave no current of a car.
fn unwrapped(current_a: &[f64], wrap_a: f64) -> Option<Vec<f64>> {
    let (mut last_a, mut turns) = (f64::NAN, 0.0);
    let turned = current_a.iter().map(|&a| {
        let jump = (a - last_a) / wrap_a;
        if jump.abs() > 0.5 {
            turns -= jump.signum();
        }
        if a.is_finite() {
            last_a = a;
        }
        turns
    });
    let turned: Vec<f64> = turned.collect();
    if range(&turned) > TURNS {
        return None;
    }
    // whether the first sample was turned is told by the size of the rest
    let without = |first: f64| -> Vec<f64> {
        let pairs = current_a.iter().zip(&turned);
        pairs
            .map(|(a, turns)| a + (turns + first) * wrap_a)
            .collect()
    };
    let size = |a: &Vec<f64>| deviation(a.iter().copied().filter(|a| a.is_finite()));
    let smallest = [0.0, 1.0, -1.0]
        .map(without)
        .into_iter()
        .min_by(|a, b| size(a).total_cmp(&size(b)))?;
    (variation(&smallest) <= VARIATION * variation(current_a) && range(&smallest) >= CHANGE_A)
        .then_some(smallest)
}

/// All that values change by, forth and back.
fn variation(values: &[f64]) -> f64 {
    let mut known = values.iter().filter(|value| value.is_finite());
    let Some(first) = known.next() else {
        return 0.0;
    };
    known
        .fold((*first, 0.0), |(last, sum), value| {
            (*value, sum + (value - last).abs())
        })
        .1
}
