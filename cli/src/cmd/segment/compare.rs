//! Table 3.5 of the thesis for any logs.

use std::borrow::Cow;
use std::collections::BTreeMap;

use anyhow::Context as _;
use drive_log::DriveLog;
use driver_eval::segmentation::Comparison;
use driver_model::segmentation::{MethodFigures, Segmenter};
use report::terminal::{Table, number};
use serde::Serialize;

use super::args::SegmentArgs;
use super::flags::DEFAULT_THRESHOLD;
use super::names::{ScaleArg, SegmentsArg};
use crate::exit::Outcome;
use crate::flags::{Context, Format, ReadingArgs};
use crate::inputs;
use crate::output::{self, note, print_json, print_text};
use crate::progress::Progress;
use crate::render::json::Document;
use crate::require::KnownFigures;

/// The thesis takes as many, "to preserve the accuracy of the timing measurement".
const FIRST_SAMPLES: usize = 3000;

/// Figures by method.
type Methods = BTreeMap<&'static str, Option<MethodFigures>>;

#[derive(Serialize)]
struct Body<'a> {
    logs: Vec<LogEntry<'a>>,
    mean: Methods,
}

#[derive(Serialize)]
struct LogEntry<'a> {
    name: &'a str,
    samples: usize,
    methods: Methods,
}

#[derive(Serialize)]
struct Config<'a> {
    #[serde(flatten)]
    reading: &'a ReadingArgs,
    first: Option<usize>,
    segments: Option<SegmentsArg>,
    min_length: usize,
    threshold: Option<f64>,
    window: usize,
    weights: &'a [f64],
    scale: Option<ScaleArg>,
    accel_deadband: f64,
}

pub(super) fn run(args: &SegmentArgs, context: &Context) -> anyhow::Result<Outcome> {
    let args = &SegmentArgs {
        first: args.first.or(Some(FIRST_SAMPLES)),
        method: args.method.with_segments(SegmentsArg::Number(80)),
        ..args.clone()
    };
    args.require.check(&KnownFigures::new(include_str!(
        "../../figures/segment-compare.txt"
    )))?;
    let comparison = comparison(args)?;
    let methods = comparison.methods();
    let inputs = inputs::load(&args.logs, context)?;
    let logs = args.pieces(&inputs);
    let body = compared(&logs, &methods, context)?;
    let text = text(&body, &methods);
    let config = config(args);
    let mut document = Document::new("segment-compare", &config, &inputs, body);
    let outcome = document.judged(&args.require)?;
    if let (Some(path), Some(log)) = (&args.report, logs.first()) {
        let mut report = serde_json::to_value(&document)?;
        report["figures"] = comparison.figures(log)?;
        let page = report::SEGMENTATION.filled(&report);
        output::write_page(path, &page, context)?;
    }
    match context.format {
        Format::Json => print_json(&document)?,
        Format::Text => print_text(&text)?,
    }
    Ok(inputs::outcome(&inputs).and(outcome))
}

fn config(args: &SegmentArgs) -> Config<'_> {
    let method = &args.method;
    Config {
        reading: &args.logs.reading,
        first: args.first,
        segments: method.segments,
        min_length: method.min_length,
        threshold: method.threshold,
        window: method.window,
        weights: &method.weights,
        scale: method.scale,
        accel_deadband: method.accel_deadband,
    }
}

fn comparison(args: &SegmentArgs) -> anyhow::Result<Comparison> {
    let method = &args.method;
    Ok(Comparison {
        heuristic: method.heuristic(),
        swab: method.unmerged_rules()?,
        threshold: method.threshold.unwrap_or(DEFAULT_THRESHOLD),
        segments: method.number_of_segments()?,
        min_length: method.min_length,
    })
}

/// One log after the other: side by side they would slow each other down.
fn compared<'a>(
    logs: &'a [Cow<'_, DriveLog>],
    methods: &[(&'static str, Segmenter)],
    context: &Context,
) -> anyhow::Result<Body<'a>> {
    let progress = Progress::new(context, "segmenting", logs.len() * methods.len());
    let mut entries = Vec::new();
    for log in logs {
        let mut figures = Methods::new();
        for (name, segmenter) in methods {
            let mut of_method = segmenter
                .figures(log)
                .with_context(|| format!("{}, {name}", log.name()))?;
            if let (Some(figures), true) = (&mut of_method, context.no_times) {
                figures.seconds = f64::NAN;
            }
            if of_method.is_none() {
                let samples = log.len();
                note(
                    context,
                    &format!(
                        "{}: {samples} samples are too few for so many segments",
                        log.name()
                    ),
                );
            }
            figures.insert(*name, of_method);
            progress.step();
        }
        entries.push(LogEntry {
            name: log.name(),
            samples: log.len(),
            methods: figures,
        });
    }
    let mean_of = |name: &'static str| {
        let of_logs: Vec<_> = entries.iter().filter_map(|log| log.methods[name]).collect();
        (name, MethodFigures::mean(&of_logs))
    };
    Ok(Body {
        mean: methods.iter().map(|(name, _)| mean_of(name)).collect(),
        logs: entries,
    })
}

fn text(body: &Body<'_>, methods: &[(&'static str, Segmenter)]) -> String {
    let mut table = Table::new(["log", "samples", "mean length", "std", "+ %", "- %", "ms"]);
    for (name, _) in methods {
        table.heading(name);
        for log in &body.logs {
            table.row(row(
                log.name,
                log.samples.to_string(),
                log.methods[name].as_ref(),
            ));
        }
        if body.logs.len() > 1 {
            table.row(row("mean", String::new(), body.mean[name].as_ref()));
        }
    }
    table.render()
        + "\nLengths in samples, before merging; ms: wall time of the segmentation alone.\n"
}

fn row(log: &str, samples: String, figures: Option<&MethodFigures>) -> [String; 7] {
    [
        log.to_owned(),
        samples,
        number(figures.map(|f| f.mean_length), 1),
        number(figures.map(|f| f.std_length), 1),
        number(figures.and_then(|f| f.positive_share_pct), 1),
        number(figures.and_then(|f| f.negative_share_pct), 1),
        number(figures.map(|f| f.seconds * 1e3), 2),
    ]
}
