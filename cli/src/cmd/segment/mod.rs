//! `drivekit segment`: plain, compared (`--compare`) and live (`--follow`).

mod args;
mod compare;
mod flags;
mod follow;
mod names;
mod output;

use std::borrow::Cow;
use std::ops::ControlFlow;

use anyhow::Context as _;
use drive_log::DriveLog;
use driver_model::segmentation::{Segmented, Segmenter, StatisticalRules};
use driver_model::{Error, LeftOut};
use rayon::prelude::*;

use crate::cmd::left_out;
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::inputs;
use crate::output::{note, print_json, print_text, write_file};
use crate::progress::Progress;
use crate::render::json::Document;
use crate::require::KnownFigures;
use args::Pieces;

pub(crate) use args::SegmentArgs;
pub(crate) use flags::refuse_idle;

pub(crate) fn run(args: &SegmentArgs, context: &Context) -> anyhow::Result<Outcome> {
    if args.follow {
        return follow::run(args, context);
    }
    let args = &SegmentArgs {
        method: args.method.resolved(StatisticalRules::default().scaling)?,
        ..args.clone()
    };
    if args.compare {
        return compare::run(args, context);
    }
    args.require.check(&KnownFigures::new(include_str!(
        "../../figures/segment.txt"
    )))?;
    let segmenter = args.method.segmenter()?;
    let inputs = inputs::load(&args.logs, context)?;
    let (logs, left_out) = long_enough(args.pieces(&inputs), &segmenter)?;
    left_out::mention(&left_out, context);
    let progress = Progress::new(context, "segmenting", logs.len());
    let segmented = logs
        .par_iter()
        .map(|log| {
            let part = progress.part();
            let segmented = segmenter
                .segment(log, &|share| {
                    part.at(share);
                    ControlFlow::Continue(())
                })
                .with_context(|| log.name().to_owned())?;
            part.at(1.0);
            Ok(segmented)
        })
        .collect::<anyhow::Result<Vec<Segmented>>>()?;
    drop(progress);
    if let Some(path) = &args.plot {
        let picture = output::plot(&logs, &segmented)?;
        write_file(path, |out| Ok(out.write_all(picture.as_bytes())?))?;
        note(context, &format!("picture written to {}", path.display()));
    }
    let entries = logs.iter().zip(&segmented);
    let body = output::Body {
        logs: entries.map(|(log, s)| output::Entry::new(log, s)).collect(),
        left_out_drives: &left_out,
    };
    let mut document = Document::new("segment", args, &inputs, body);
    let outcome = document.judged(&args.require)?;
    match context.format {
        Format::Json => print_json(&document)?,
        Format::Text => print_text(&output::text(&inputs, &logs, &segmented))?,
    }
    Ok(inputs::outcome(&inputs).and(outcome))
}

/// The pieces that have room for what was asked, and the others with the reason.
fn long_enough<'a>(
    pieces: Pieces<'a>,
    segmenter: &Segmenter,
) -> anyhow::Result<(Pieces<'a>, Vec<LeftOut>)> {
    let least = segmenter.least_samples();
    let (logs, short): (Vec<_>, Vec<_>) = pieces.into_iter().partition(|log| log.len() >= least);
    let left_out = |log: &Cow<'_, DriveLog>| LeftOut {
        log: log.name().to_owned(),
        reason: format!("less than {least} samples; ask for fewer or shorter segments"),
    };
    let left_out: Vec<LeftOut> = short.iter().map(left_out).collect();
    if logs.is_empty() {
        let task = "so many segments of this length";
        return Err(Error::NothingUsable { task, left_out }.into());
    }
    Ok((logs, left_out))
}
