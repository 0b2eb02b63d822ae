//! Figures 3.3 to 3.10 of the thesis for one log, as data that the report page draws.

use std::ops::ControlFlow;

use drive_log::DriveLog;
use driver_model::{
    Method, Segmented, Segmenter, Segments, StatisticalRules, dead_banded, most_divided,
};
use serde_json::{Value, json};
use tseg::{Cost, Similarity, Stop};

use super::SegmentArgs;

/// Thresholds of the figures and of Table 3.5; the thesis has both.
const FIGURE_THRESHOLD: f64 = 0.4;

/// The figure whose first panel is SWAB before merging.
const UNMERGED: &str = "3.10";

/// One panel: figure, title, and how its segments come about.
type Panel = (&'static str, String, Segmenter);

pub(super) fn of(log: &DriveLog, args: &SegmentArgs) -> anyhow::Result<Value> {
    let accel_mps2 = log.accel_mps2();
    let banded_mps2 = dead_banded(&accel_mps2, args.method.accel_deadband)?;
    let mut panels = Vec::new();
    for (figure, title, segmenter) in panels_of(args)? {
        match segmenter.segment(log, &|_| ControlFlow::Continue(())) {
            Err(driver_model::Error::Segmentation(tseg::Error::TooManySegments { .. })) => {}
            segmented => panels.push((figure, title, segmented?)),
        }
    }
    let first = |figure| panels.iter().find(|panel| panel.0 == figure);
    // Figure 3.9: the acceleration of the heuristic that unmerged SWAB cuts most.
    let acceleration = first("3.3")
        .zip(first(UNMERGED))
        .and_then(|(heuristic, swab)| most_divided(&heuristic.2.phases, &swab.2.segmentation))
        .map(|phase| [phase.start, phase.end]);
    let panel = |(figure, title, segmented): &(&str, String, Segmented)| {
        json!({
            "figure": figure,
            "title": title,
            "boundaries": segmented.segmentation.boundaries(),
            "phases": segmented.phases.iter().map(|phase| phase.kind).collect::<Vec<_>>(),
        })
    };
    Ok(json!({
        "log": log.name(),
        "t0_s": log.t0_s(),
        "step_s": log.step_s(),
        "speed_mps": rounded(log.speed_mps()),
        "accel_mps2": rounded(&accel_mps2),
        "banded_mps2": rounded(&banded_mps2),
        "accel_deadband_mps2": args.method.accel_deadband,
        "acceleration": acceleration,
        "panels": panels.iter().map(panel).collect::<Vec<_>>(),
    }))
}

fn panels_of(args: &SegmentArgs) -> anyhow::Result<Vec<Panel>> {
    let rules = args.method.unmerged_rules()?;
    let statistical = Segmenter::Statistical;
    let dynamic = |segments| {
        let method = Method::Dynamic {
            segments: Segments::Exactly(segments),
            min_length: args.method.min_length,
        };
        let cost = Cost::ZScale;
        let rules = StatisticalRules {
            method,
            cost,
            ..rules
        };
        (
            format!("Dynamic programming, k = {segments}"),
            statistical(rules),
        )
    };
    let at_threshold = |method| statistical(StatisticalRules { method, ..rules });
    let swab = |threshold| match rules.method {
        Method::Swab { window, refill, .. } => Method::Swab {
            threshold,
            window,
            refill,
        },
        other => other,
    };
    let bottom_up = Method::BottomUp {
        threshold: FIGURE_THRESHOLD,
        stop: Stop::Keogh,
    };
    let merged = |similarity| {
        statistical(StatisticalRules {
            similarity,
            ..rules
        })
    };
    let (k20, k40) = (dynamic(20), dynamic(40));
    let heuristic = args.method.heuristic();
    let swab_title = format!(
        "SWAB, threshold {FIGURE_THRESHOLD}, window {}",
        args.method.window
    );
    let bottom_up_title = format!("Bottom-up, threshold {FIGURE_THRESHOLD}");
    Ok(vec![
        (
            "3.3",
            "Heuristic classes".to_owned(),
            Segmenter::Heuristic(heuristic),
        ),
        ("3.5", k20.0, k20.1),
        ("3.6", k40.0, k40.1),
        ("3.7", bottom_up_title, at_threshold(bottom_up)),
        ("3.8", swab_title, at_threshold(swab(FIGURE_THRESHOLD))),
        (UNMERGED, "Not merged".to_owned(), merged(None)),
        (
            "3.10",
            "Mean comparison".to_owned(),
            merged(Some(Similarity::mean())),
        ),
        (
            "3.10",
            "l-association interval".to_owned(),
            merged(Some(Similarity::association())),
        ),
        (
            "3.10",
            "Percentile".to_owned(),
            merged(Some(Similarity::percentile())),
        ),
    ])
}

/// Four decimals: more than any picture shows.
fn rounded(values: &[f64]) -> Vec<f64> {
    values.iter().map(|x| (x * 1e4).round() / 1e4).collect()
}
