//! What a run came to, in words.

use report::terminal::{Table, number};
use testbed_sim::{LeastDistance, Summary, Verdict};

use super::ended::Ended;
use super::live;
use super::scenario::Named;
use crate::words::plural;

/// Why the verdict is not known.
pub(super) fn why_not_known(doubts: &[String]) -> String {
    if doubts.is_empty() {
        return "no robot was seen".to_owned();
    }
    doubts.join("; ")
}

/// In words; `doubts` say why it is not known whether the run was safe.
pub(super) fn verdict(summary: &Summary, doubts: &[String]) -> String {
    match (summary.verdict, summary.first_unsafe_s) {
        (Verdict::Safe, _) => {
            "safe: no robot left its lane, touched another or came too close".to_owned()
        }
        (Verdict::Unsafe, Some(time_s)) => format!("UNSAFE from {time_s:.2} s on"),
        (Verdict::Unsafe, None) => "UNSAFE".to_owned(),
        (Verdict::NotKnown, _) => {
            format!("NOT KNOWN whether it was safe: {}", why_not_known(doubts))
        }
    }
}

fn nearest(least: &LeastDistance) -> String {
    let LeastDistance {
        robots: [a, b],
        at_s,
        centres_m,
        ..
    } = least;
    format!(
        "mm; robots {a} and {b} at {at_s:.2} s, {:.1} between centres",
        1e3 * centres_m
    )
}

/// The least distance as a line of its own, none of a single robot.
pub(super) fn nearest_line(least: Option<&LeastDistance>) -> String {
    least.map_or_else(String::new, |least| {
        let gap = number(1e3 * least.gap_m, 1);
        format!("least distance between bodies: {gap} {}\n", nearest(least))
    })
}

pub(super) fn text(named: &Named, ended: &Ended) -> String {
    let (summary, timing) = (&ended.summary, &ended.timing);
    let scenario = &named.spec.scenario;
    let mut table = Table::new(["figure", "value", "unit"]);
    let mut row = |name: &str, value: String, unit: &str| {
        table.row([name.to_owned(), value, unit.to_owned()]);
    };
    if let Some(least) = &summary.least_distance {
        let gap = number(1e3 * least.gap_m, 1);
        row("least distance between bodies", gap, &nearest(least));
    }
    row(
        "least headway barrier",
        number(summary.min_h_headway_m.map(|h| 1e3 * h), 1),
        "mm",
    );
    row("least lane barrier", number(summary.min_h_lane, 4), "");
    row(
        "distance to the edge of the lane",
        number(1e3 * summary.lane_clearance_m, 1),
        "mm",
    );
    row(
        "largest deviation from the path",
        number(1e3 * summary.max_abs_lateral_m, 1),
        "mm",
    );
    row("mean speed", number(summary.mean_speed_mps, 3), "m/s");
    row(
        "mean speed, last 5 s",
        number(summary.final_speed_mps, 3),
        "m/s",
    );
    row("steps, optimal", summary.outcomes.optimal.to_string(), "");
    row("steps, relaxed", summary.outcomes.relaxed.to_string(), "");
    row("steps, braking", summary.outcomes.braking.to_string(), "");
    for (name, count) in [
        (
            "of these giving way at a crossing",
            summary.outcomes.waiting,
        ),
        ("of these in a deadlock", summary.outcomes.deadlock),
    ] {
        if count > 0 {
            row(name, count.to_string(), "");
        }
    }
    row("median step", number(timing.median_us, 2), "µs");
    row("99 % of steps within", number(timing.p99_us, 2), "µs");
    if let Some(live) = &ended.live {
        live::rows(live, &mut row);
    }
    let verdict = verdict(summary, ended.doubts());
    let how = match &ended.live {
        Some(live) => live::ending_text(&live.ending),
        None => format!("seed {}", named.spec.seed),
    };
    format!(
        "{} on {}, {}, {} at {} Hz, {how}\n\n{}\n{verdict}\n",
        scenario.name,
        scenario.testbed,
        plural(scenario.robots.len(), "robot"),
        plural(summary.steps, "step"),
        scenario.rate_hz,
        table.render()
    )
}
