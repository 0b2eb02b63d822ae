//! Predictions of a drive that is still going on, a line each.

use std::sync::mpsc::Receiver;

use anyhow::bail;
use driver_eval::{check_horizons, live_words};
use driver_model::live::{Event, LivePredictor, LiveSettings};
use driver_model::{DriverModel, ModelFile};

use super::{PredictArgs, with_flags};
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::listening::{self, Told, listen};
use crate::output::{Reader, note, print_to_reader};

pub(super) fn run(args: &PredictArgs, context: &Context) -> anyhow::Result<Outcome> {
    listening::check(&args.logs, "predict")?;
    let files = args.model.iter().map(|path| crate::cmd::model::read(path));
    let files: Vec<ModelFile> = files.collect::<Result<_, _>>()?;
    for file in &files {
        super::mention_reading(file, args, context)?;
    }
    let ahead = files.iter().find_map(|file| match &file.model {
        DriverModel::SpeedAhead(model) => Some(model),
        _ => None,
    });
    match ahead {
        Some(model) => check_horizons(model, &args.horizon).map_err(with_flags)?,
        None if !args.horizon.is_empty() => {
            bail!("--horizon: no model of the speed ahead is given")
        }
        None => {}
    }
    let settings = LiveSettings {
        step_s: args.logs.reading.step,
        smoothing: listening::smoothing(&args.logs),
        max_gap_s: args.logs.reading.max_gap,
        told: Vec::new(),
        horizons_s: args.horizon.clone(),
    };
    let told = listen(&args.logs, &LivePredictor::CHANNELS)?;
    let printed = follow(&told, files, settings, context)?;
    if printed.reader == Reader::Gone {
        return Ok(Outcome::Done);
    }
    printed.ended?;
    Ok(Outcome::Done)
}

/// Whatever ends it, what was read is predicted to its end.
fn follow(
    told: &Receiver<Told>,
    files: Vec<ModelFile>,
    settings: LiveSettings,
    context: &Context,
) -> anyhow::Result<Printed> {
    let mut printed = Printed {
        reader: Reader::There,
        has_header: context.format == Format::Json,
        ended: Ok(()),
    };
    let mut start = Some((files, settings));
    let mut predictor = None;
    for told in told {
        match told {
            Told::Columns(told) => {
                if let Some((files, settings)) = start.take() {
                    let settings = LiveSettings { told, ..settings };
                    predictor = Some(LivePredictor::new(files, &settings)?);
                }
            }
            Told::Remark(text) => note(context, &text),
            Told::End(ended) => {
                printed.ended = ended;
                break;
            }
            Told::Row(row) => {
                if let Some(predictor) = &mut predictor {
                    printed.events(predictor.push(&row)?, context)?;
                }
            }
        }
        if printed.reader == Reader::Gone {
            return Ok(printed);
        }
    }
    if let Some(predictor) = predictor {
        printed.events(predictor.finish(), context)?;
    }
    Ok(printed)
}

struct Printed {
    reader: Reader,
    has_header: bool,
    ended: Result<(), drive_log::Error>,
}

impl Printed {
    /// One line each, seen at once by whoever reads.
    fn events(&mut self, events: Vec<Event>, context: &Context) -> anyhow::Result<()> {
        if !std::mem::replace(&mut self.has_header, true) {
            self.reader = print_to_reader(&live_words::header())?;
        }
        for event in events {
            if let Event::Remark { text } = &event {
                note(context, text);
                continue;
            }
            self.reader = print_to_reader(&match context.format {
                Format::Json => serde_json::to_string(&event)? + "\n",
                Format::Text => live_words::line(&event),
            })?;
        }
        Ok(())
    }
}
