//! Gap and speed of the car ahead that do not go together.

use std::ops::Range;

use super::checked::Checked;
use super::motion::{Span, spans};
use super::runs::constant_runs;
use crate::statistics::quantile;
use crate::{Action, Channel, FindingKind};

/// What the speed of the car ahead, and the gap, may be instead: how many times the former is m/s, whether it is relative to
/// the own speed, how many times the gap is m.
const MISTAKES: [(f64, bool, f64, &str); 6] = [
    (3.6, false, 1.0, "speeds in km/h read as m/s"),
    (1.0 / 0.44704, false, 1.0, "speeds in mph read as m/s"),
    (1.0 / 3.6, false, 1.0, "speeds in m/s read as km/h"),
    (1.0, true, 1.0, "speeds relative to the own one"),
    (1.0, false, 1.0 / 0.3048, "gaps in ft read as m"),
    (1.0, false, 10.0, "gaps in 0.1 m read as m"),
];

/// Seconds that tell; how much nearer than what the headers say, and in relation to how much the gap changes, a mistake must come (medians).
const SECONDS: usize = 60;
const NEARER: f64 = 0.25;
const EXPLAINED: f64 = 0.3;

/// A gap that stays to the last bit for this long, s, while the two cars come closer or part by more than this, m, and two digits, is an
/// old one.
const STALE_S: f64 = 3.0;
const STALE_M: f64 = 3.0;

/// Puts a gap or a speed of the car ahead in another unit right, and removes those that are not renewed any more.
pub(super) fn mend(checked: &mut Checked) {
    remove_stale(checked);
    convert(checked);
}

fn convert(checked: &mut Checked) {
    let changes = changes(checked);
    let typical = |of: &dyn Fn(&Change) -> f64| {
        quantile(
            &mut changes.iter().map(|c| of(c).abs()).collect::<Vec<f64>>(),
            0.5,
        )
    };
    if changes.len() < SECONDS {
        return;
    }
    let Some((as_said, all)) = typical(&|c| c.off(1.0, false, 1.0)).zip(typical(&|c| c.gap_m))
    else {
        return;
    };
    let fits = |(times, relative, gap, _): &(f64, bool, f64, &str)| {
        // a gap in smaller units leaves more unexplained
        typical(&|c| c.off(*times, *relative, *gap) / gap)
            .is_some_and(|off| off < NEARER * as_said / gap && off < EXPLAINED * all / gap)
    };
    let possible: Vec<_> = MISTAKES.into_iter().filter(fits).collect();
    let [(times, relative, gap, words)] = possible.as_slice() else {
        return;
    };
    let speed_mps = checked.log.speed_mps().to_vec();
    let channel = if *gap > 1.0 {
        Channel::LeadGap
    } else {
        Channel::LeadSpeed
    };
    if let Some(values) = checked.log.channels.get_mut(&channel) {
        for (value, own) in values.iter_mut().zip(speed_mps) {
            *value = *value / (times * gap) + if *relative { own } else { 0.0 };
        }
    }
    let detail = format!(
        "the gap changes otherwise than the speeds of the two cars differ, but for {words}: put right"
    );
    checked.report_all(FindingKind::Unit, channel, Action::Scaled, detail);
}

/// What changes in a second.
struct Change {
    gap_m: f64,
    lead_m: f64,
    own_m: f64,
}

impl Change {
    /// What a reading of the two leaves of the change of the gap, m.
    fn off(&self, times: f64, relative: bool, gap: f64) -> f64 {
        let own_m = if relative { 0.0 } else { self.own_m };
        self.gap_m - gap * (self.lead_m / times - own_m)
    }
}

fn changes(checked: &Checked) -> Vec<Change> {
    let channels = checked
        .values(Channel::LeadGap)
        .zip(checked.values(Channel::LeadSpeed));
    let Some((gap_m, lead_mps)) = channels else {
        return Vec::new();
    };
    let change = |span: &Span| {
        let all = span.samples.clone();
        let is_known = all.clone().all(|i| gap_m[i].is_finite());
        let change = Change {
            gap_m: gap_m[*all.end()] - gap_m[*all.start()],
            lead_m: span.mean(lead_mps)? * span.duration_s,
            own_m: span.speed_mps * span.duration_s,
        };
        (is_known && change.gap_m != 0.0).then_some(change)
    };
    spans(&checked.log).iter().filter_map(change).collect()
}

fn remove_stale(checked: &mut Checked) {
    let stale = stale(checked);
    let (Some(first), Some(last)) = (stale.first(), stale.last()) else {
        return;
    };
    let range = first.start..last.end;
    let detail = format!(
        "{} times the last gap is kept, to the last bit, while the two cars come closer or part",
        stale.len()
    );
    for run in stale {
        checked.remove(Channel::LeadSpeed, run.clone());
        checked.remove(Channel::LeadGap, run);
    }
    checked.report(
        FindingKind::Frozen,
        Channel::LeadGap,
        &range,
        Action::Removed,
        detail,
    );
}

fn stale(checked: &Checked) -> Vec<Range<usize>> {
    let channels = checked
        .values(Channel::LeadGap)
        .zip(checked.values(Channel::LeadSpeed));
    let Some((gap_m, lead_mps)) = channels else {
        return Vec::new();
    };
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let steps = gap_m.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let mut steps: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
    let digit_m = quantile(&mut steps, 0.05).unwrap_or(0.0);
    let parts = |run: &Range<usize>| {
        let (mut apart_m, mut most_m) = (0.0, 0.0_f64);
        for i in run.start + 1..run.end {
            let apart_mps = lead_mps[i] - speed_mps[i];
            if apart_mps.is_finite() {
                apart_m += apart_mps * (time_s[i] - time_s[i - 1]);
            }
            most_m = most_m.max(f64::abs(apart_m));
        }
        most_m > STALE_M + 2.0 * digit_m
    };
    constant_runs(gap_m)
        .filter(|run| {
            let kept = lead_mps[run.start].to_bits();
            let both = run.clone().all(|i| lead_mps[i].to_bits() == kept);
            both && checked.duration_s(run) >= STALE_S && parts(run)
        })
        .collect()
}
