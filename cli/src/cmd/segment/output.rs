//! What plain `segment` prints and draws.

use std::borrow::Cow;
use std::fmt::Write as _;

use drive_log::{Channel, DriveLog};
use driver_model::segmentation::{Optimality, Segmented, StreamedPhase};
use driver_model::{LeftOut, PhaseKind, Span};
use report::picture::{self, Behaviour, SpeedPlot, Stretch};
use report::terminal::{Table, number};
use serde::Serialize;

use crate::inputs::Input;

#[derive(Serialize)]
pub(super) struct Body<'a> {
    pub(super) logs: Vec<Entry<'a>>,
    /// Pieces that are too short for what was asked, with the reason.
    pub(super) left_out_drives: &'a [LeftOut],
}

#[derive(Serialize)]
pub(super) struct Entry<'a> {
    name: &'a str,
    boundaries: &'a [usize],
    cost: Option<f64>,
    optimality_gap: Option<f64>,
    curve: Option<Vec<CurvePoint>>,
    segments: Vec<SegmentEntry>,
    metrics: MetricsEntry,
}

/// The least cost of so many segments.
#[derive(Serialize)]
struct CurvePoint {
    segments: usize,
    cost: f64,
}

fn curve(optimality: &Optimality) -> Option<Vec<CurvePoint>> {
    let points = optimality.curve.iter();
    let curve: Vec<_> = points
        .map(|&(segments, cost)| CurvePoint { segments, cost })
        .collect();
    (!curve.is_empty()).then_some(curve)
}

#[derive(Serialize)]
pub(super) struct SegmentEntry {
    start: usize,
    end: usize,
    start_s: f64,
    end_s: f64,
    phase: PhaseKind,
    mean_speed_mps: f64,
    mean_accel_mps2: f64,
    lead_influenced: bool,
}

#[derive(Serialize)]
struct MetricsEntry {
    segments: usize,
    mean_length: f64,
    std_length: f64,
    positive_share_pct: Option<f64>,
    negative_share_pct: Option<f64>,
}

impl From<&StreamedPhase> for SegmentEntry {
    fn from(phase: &StreamedPhase) -> Self {
        Self {
            start: phase.start,
            end: phase.end,
            start_s: phase.start_s,
            end_s: phase.end_s,
            phase: phase.kind,
            mean_speed_mps: phase.mean_speed_mps,
            mean_accel_mps2: phase.mean_accel_mps2,
            lead_influenced: phase.lead_influenced,
        }
    }
}

impl<'a> Entry<'a> {
    pub(super) fn new(log: &'a DriveLog, segmented: &'a Segmented) -> Self {
        let metrics = &segmented.metrics;
        Self {
            name: log.name(),
            boundaries: segmented.segmentation.boundaries(),
            cost: segmented.cost,
            optimality_gap: segmented.optimality.as_ref().map(|o| o.gap),
            curve: segmented.optimality.as_ref().and_then(curve),
            segments: segmented
                .means(log)
                .map(|(phase, mean_speed_mps, mean_accel_mps2)| SegmentEntry {
                    start: phase.start,
                    end: phase.end,
                    start_s: log.time_s(phase.start),
                    end_s: log.time_s(phase.end),
                    phase: phase.kind,
                    mean_speed_mps,
                    mean_accel_mps2,
                    lead_influenced: phase.lead_influenced,
                })
                .collect(),
            metrics: MetricsEntry {
                segments: metrics.segments,
                mean_length: metrics.mean_length,
                std_length: metrics.std_length,
                positive_share_pct: metrics.positive_share_pct,
                negative_share_pct: metrics.negative_share_pct,
            },
        }
    }
}

pub(super) fn plot(logs: &[Cow<'_, DriveLog>], segmented: &[Segmented]) -> anyhow::Result<String> {
    let plots: Vec<SpeedPlot> = logs
        .iter()
        .zip(segmented)
        .map(|(log, segmented)| SpeedPlot {
            title: log.name(),
            t0_s: log.t0_s(),
            step_s: log.step_s(),
            speed_mps: log.speed_mps(),
            speed_limit_mps: log.channel(Channel::SpeedLimit),
            stretches: segmented.phases.iter().map(stretch).collect(),
        })
        .collect();
    Ok(picture::speed_with_phases(&plots)?)
}

fn stretch(phase: &Span) -> Stretch {
    Stretch {
        samples: phase.start..phase.end,
        behaviour: match phase.kind {
            _ if phase.lead_influenced => Behaviour::LeadInfluenced,
            PhaseKind::Acceleration => Behaviour::Acceleration,
            PhaseKind::Braking => Behaviour::Braking,
            PhaseKind::Cruise => Behaviour::Cruise,
            PhaseKind::Other => Behaviour::Other,
        },
    }
}

pub(super) fn text(
    inputs: &[Input],
    logs: &[Cow<'_, DriveLog>],
    segmented: &[Segmented],
) -> String {
    let mut table = Table::new([
        "log",
        "samples",
        "segments",
        "mean length",
        "std",
        "+ %",
        "- %",
        "cost",
        "acceleration",
        "braking",
        "cruise",
        "under a leader",
    ]);
    for (log, segmented) in logs.iter().zip(segmented) {
        let metrics = &segmented.metrics;
        let count = |kind| segmented.phases.iter().filter(|p| p.kind == kind).count();
        table.row([
            log.name().to_owned(),
            log.len().to_string(),
            metrics.segments.to_string(),
            number(metrics.mean_length, 1),
            number(metrics.std_length, 1),
            number(metrics.positive_share_pct, 1),
            number(metrics.negative_share_pct, 1),
            number(segmented.cost, 3),
            count(PhaseKind::Acceleration).to_string(),
            count(PhaseKind::Braking).to_string(),
            count(PhaseKind::Cruise).to_string(),
            segmented
                .phases
                .iter()
                .filter(|p| p.lead_influenced)
                .count()
                .to_string(),
        ]);
    }
    let mut text = table.render();
    if let ([_], [log], [segmented]) = (inputs, logs, segmented) {
        if let Some(optimality) = &segmented.optimality {
            text.push_str(&optimality_text(optimality, segmented.metrics.segments));
        }
        text.push('\n');
        text.push_str(&segment_table(log, segmented));
    } else {
        let _ = writeln!(
            text,
            "\nName one log to see its segments, or ask for --format json."
        );
    }
    text
}

/// Whether the cost is proved to be the least, and the curve from which the number of segments was chosen.
fn optimality_text(optimality: &Optimality, chosen: usize) -> String {
    let mut text = if optimality.gap > 0.0 {
        format!(
            "\nnot certified: another could cost less by up to {:.3}\n",
            optimality.gap
        )
    } else {
        "\ncertified optimal\n".to_owned()
    };
    if !optimality.curve.is_empty() {
        let mut table = Table::new(["segments", "least cost", ""]);
        for &(segments, cost) in &optimality.curve {
            let mark = if segments == chosen { "knee" } else { "" };
            table.row([segments.to_string(), number(cost, 3), mark.to_owned()]);
        }
        text.push('\n');
        text.push_str(&table.render());
    }
    text
}

fn segment_table(log: &DriveLog, segmented: &Segmented) -> String {
    let mut table = Table::new([
        "phase",
        "from s",
        "to s",
        "mean km/h",
        "mean m/s²",
        "leader",
    ]);
    for (phase, speed_mps, accel_mps2) in segmented.means(log) {
        table.row([
            phase.kind.name().to_owned(),
            number(log.time_s(phase.start), 1),
            number(log.time_s(phase.end), 1),
            number(speed_mps * 3.6, 1),
            number(accel_mps2, 2),
            if phase.lead_influenced { "yes" } else { "" }.to_owned(),
        ]);
    }
    table.render()
}
