use std::fmt::Write as _;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use drive_log::{Channel, DriveLog};
use driver_model::{HeuristicRules, Method, PhaseKind, Segmented, StatisticalRules};
use rayon::prelude::*;
use serde::Serialize;

use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs::{self, Input};
use crate::output;
use crate::progress::Progress;
use crate::render::json::{Document, Logs};
use crate::render::svg::{self, SpeedPlot};
use crate::render::table::{Table, number};

/// Boundaries, phases and homogeneity figures
///
/// Cuts each drive into segments of like behaviour and says what the driver does in each. A drive with gaps counts as
/// one log per piece.
#[derive(Debug, Clone, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit segment drive.csv
  drivekit segment drive.csv --method heuristic --plot phases.svg
  drivekit segment logs/ --threshold 0.1 --window 150 --format json")]
pub(crate) struct SegmentArgs {
    #[command(flatten)]
    #[serde(flatten)]
    logs: LogArgs,
    /// Segmentation method
    #[arg(long, value_enum, default_value_t = MethodName::Swab, help_heading = "Segmentation")]
    method: MethodName,
    /// Cost of a segment
    #[arg(long, value_enum, default_value_t = CostName::MeanDeviation, help_heading = "Segmentation")]
    cost: CostName,
    /// Highest cost of a merged segment [default: 0.2 for mean-deviation; z-scale has no useful one]
    #[arg(
        long,
        required_if_eq("cost", "z-scale"),
        value_name = "COST",
        help_heading = "Segmentation"
    )]
    threshold: Option<f64>,
    /// Window of SWAB, in samples
    #[arg(
        long,
        default_value_t = 100,
        value_name = "SAMPLES",
        help_heading = "Segmentation"
    )]
    window: usize,
    /// Weights of speed and acceleration
    #[arg(long, value_delimiter = ',', num_args = 1, default_values_t = [1.8, 1.0], value_name = "V,A", help_heading = "Segmentation")]
    weights: Vec<f64>,
    /// Scaling of speed and acceleration before segmentation
    #[arg(long, value_enum, default_value_t = ScaleName::Zscore, help_heading = "Segmentation")]
    scale: ScaleName,
    /// How SWAB refills its window
    #[arg(long, value_enum, default_value_t = RefillName::Keogh, help_heading = "Segmentation")]
    refill: RefillName,
    /// Merging of similar neighbours afterwards
    #[arg(long, value_enum, default_value_t = MergeName::Percentile, help_heading = "Segmentation")]
    merge: MergeName,
    /// Neighbours above this similarity are merged
    #[arg(
        long,
        default_value_t = 0.64,
        value_name = "J",
        help_heading = "Segmentation"
    )]
    similarity: f64,
    /// Acceleration under this magnitude counts as 0, in m/s²
    #[arg(
        long,
        default_value_t = 0.4,
        value_name = "M/S2",
        help_heading = "Segmentation"
    )]
    accel_deadband: f64,
    /// Draw speed with coloured phases
    #[arg(long, value_name = "FILE.svg")]
    #[serde(skip)]
    plot: Option<PathBuf>,
}

macro_rules! names {
    ($(#[$doc:meta])* $name:ident for $target:ty { $($(#[$variant_doc:meta])* $variant:ident => $value:expr),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
        #[serde(rename_all = "kebab-case")]
        enum $name { $($(#[$variant_doc])* $variant),* }

        impl From<$name> for $target {
            fn from(name: $name) -> Self {
                match name { $($name::$variant => $value),* }
            }
        }
    };
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum MethodName {
    /// Runs of samples with the same label (Table 3.1)
    Heuristic,
    /// Merge the cheapest neighbours first
    BottomUp,
    /// The same in a sliding window
    Swab,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum MergeName {
    /// Leave the segments as they are
    None,
    /// By percentile similarity
    Percentile,
}

names! {
    CostName for tseg::Cost {
        /// Sum of deviations over the standard deviation (3.19)
        ZScale => tseg::Cost::ZScale,
        /// Mean deviation (3.22)
        MeanDeviation => tseg::Cost::MeanDeviation,
    }
}

names! {
    ScaleName for tseg::Scale {
        /// As they are
        None => tseg::Scale::None,
        /// Zero mean, unit deviation
        Zscore => tseg::Scale::ZScore,
        /// From -1 to 1
        Range => tseg::Scale::Range,
        /// Divided by the largest magnitude
        Max => tseg::Scale::Max,
    }
}

names! {
    RefillName for tseg::Refill {
        /// Sliding-window segments until the window is half full
        Keogh => tseg::Refill::Keogh,
        /// One segment including the crossing sample (Algorithm 4)
        Literal => tseg::Refill::Literal,
        /// Single samples up to the window length
        Fixed => tseg::Refill::Fixed,
    }
}

/// The thesis's, for the mean deviation.
const DEFAULT_THRESHOLD: f64 = 0.2;

pub(crate) fn run(args: &SegmentArgs, context: &Context) -> anyhow::Result<Outcome> {
    let args = &SegmentArgs {
        threshold: args.threshold.or(Some(DEFAULT_THRESHOLD)),
        ..args.clone()
    };
    let segmenter = args.segmenter()?;
    if let Some(path) = &args.plot {
        output::check_file_place(path)?;
    }
    let inputs = inputs::load(&args.logs, context)?;
    let logs: Vec<&DriveLog> = inputs.iter().flat_map(|i| &i.drive.pieces).collect();
    let progress = Progress::new(context, "segmenting", logs.len());
    let segmented = logs
        .par_iter()
        .map(|log| {
            let segmented = segmenter.segment(log)?;
            progress.step();
            Ok(segmented)
        })
        .collect::<anyhow::Result<Vec<Segmented>>>()?;
    drop(progress);
    if let Some(path) = &args.plot {
        let picture = plot(&logs, &segmented)?;
        output::write_file(path, |out| Ok(out.write_all(picture.as_bytes())?))?;
        output::note(context, &format!("picture written to {}", path.display()));
    }
    match context.format {
        Format::Json => {
            let logs = logs
                .iter()
                .zip(&segmented)
                .map(|(log, segmented)| Entry::new(log, segmented))
                .collect();
            output::print_json(&Document::new("segment", args, &inputs, Logs { logs }))?;
        }
        Format::Text => output::print_text(&text(&inputs, &logs, &segmented))?,
    }
    Ok(Outcome::Done)
}

enum Segmenter {
    Heuristic(HeuristicRules),
    Statistical(StatisticalRules),
}

impl Segmenter {
    fn segment(&self, log: &DriveLog) -> anyhow::Result<Segmented> {
        Ok(match self {
            Self::Heuristic(rules) => rules.segment(log)?,
            Self::Statistical(rules) => rules.segment(log)?,
        })
    }
}

impl SegmentArgs {
    fn segmenter(&self) -> anyhow::Result<Segmenter> {
        let method = match self.method {
            MethodName::Heuristic => {
                return Ok(Segmenter::Heuristic(HeuristicRules {
                    accel_deadband_mps2: self.accel_deadband,
                    ..HeuristicRules::default()
                }));
            }
            MethodName::BottomUp => Method::BottomUp,
            MethodName::Swab => Method::Swab {
                window: self.window,
                refill: self.refill.into(),
            },
        };
        let [speed_weight, accel_weight] = self.weights[..] else {
            anyhow::bail!("--weights takes two numbers, for speed and acceleration, such as 1.8,1");
        };
        Ok(Segmenter::Statistical(StatisticalRules {
            accel_deadband_mps2: self.accel_deadband,
            method,
            cost: self.cost.into(),
            threshold: self.threshold.unwrap_or(DEFAULT_THRESHOLD),
            weights: [speed_weight, accel_weight],
            scale: self.scale.into(),
            merge_threshold: (self.merge == MergeName::Percentile).then_some(self.similarity),
            ..StatisticalRules::default()
        }))
    }
}

#[derive(Serialize)]
struct Entry<'a> {
    name: &'a str,
    boundaries: &'a [usize],
    cost: Option<f64>,
    segments: Vec<SegmentEntry>,
    metrics: MetricsEntry,
}

#[derive(Serialize)]
struct SegmentEntry {
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

impl<'a> Entry<'a> {
    fn new(log: &'a DriveLog, segmented: &'a Segmented) -> Self {
        let metrics = &segmented.metrics;
        Self {
            name: log.name(),
            boundaries: segmented.segmentation.boundaries(),
            cost: segmented.cost,
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

fn plot(logs: &[&DriveLog], segmented: &[Segmented]) -> anyhow::Result<String> {
    let plots: Vec<SpeedPlot> = logs
        .iter()
        .zip(segmented)
        .map(|(log, segmented)| SpeedPlot {
            title: log.name(),
            t0_s: log.t0_s(),
            step_s: log.step_s(),
            speed_mps: log.speed_mps(),
            speed_limit_mps: log.channel(Channel::SpeedLimit),
            segments: &segmented.phases,
        })
        .collect();
    Ok(svg::speed_with_phases(&plots)?)
}

fn text(inputs: &[Input], logs: &[&DriveLog], segmented: &[Segmented]) -> String {
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
