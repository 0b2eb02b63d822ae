//! From paths, folders, globs and stdin to prepared drives.

pub(crate) mod files;
pub(crate) mod notes;

use anyhow::{anyhow, bail};
use drive_log::collection::Reading;
use drive_log::{Collection, Error};

use crate::drives::EMBEDDED;
use crate::exit::Outcome;
use crate::flags::{Context, LogArgs, OnError, ReadingArgs};
use crate::progress::Progress;

pub(crate) use drive_log::SourcedDrive as Input;
pub(crate) use drive_log::collection::{Beside, DriveEntry as InputEntry, files};

/// What was read, and what was not.
pub(crate) type Inputs = Collection;

/// The error, which says why only one drive is left where others are the same.
pub(crate) fn explained(inputs: &Inputs, error: anyhow::Error) -> anyhow::Error {
    match (&inputs[..], inputs.beside().twice.len()) {
        ([one], again @ 1..) => anyhow!(
            "{error:#}; the other {} the same drive as {} and counted once",
            if again == 1 {
                "log is".to_owned()
            } else {
                format!("{again} logs are")
            },
            one.label()
        ),
        _ => error,
    }
}

/// Negative where a log was skipped.
pub(crate) fn outcome(inputs: &Inputs) -> Outcome {
    if inputs.beside().skipped.is_empty() {
        Outcome::Done
    } else {
        Outcome::Negative
    }
}

/// As [`load_quietly`], with a note on how many findings there are.
pub(crate) fn load(args: &LogArgs, context: &Context) -> anyhow::Result<Inputs> {
    let inputs = load_quietly(args, context)?;
    notes::findings(&inputs, context);
    Ok(inputs)
}

/// As [`load`], for what learns: a drive that is there twice, under whatever name, counts once.
pub(crate) fn load_once(args: &LogArgs, context: &Context) -> anyhow::Result<Inputs> {
    let inputs = load(args, context)?;
    let before = inputs.beside().twice.len();
    let once = inputs.each_once();
    notes::twice(&once.beside().twice[before..], context);
    Ok(once)
}

/// As [`load_once`], without the drives that are among `own`.
pub(crate) fn load_others(
    args: &LogArgs,
    own: &[Input],
    context: &Context,
) -> anyhow::Result<Inputs> {
    let inputs = load_once(args, context)?;
    let before = inputs.beside().twice.len();
    let others = inputs.without(own);
    notes::twice(&others.beside().twice[before..], context);
    Ok(others)
}

/// Reads, checks and prepares all logs, in parallel over files; several logs of one file stay in its order.
pub(crate) fn load_quietly(args: &LogArgs, context: &Context) -> anyhow::Result<Inputs> {
    if args.logs.is_empty() {
        bail!("no logs given; name files, folders or globs, or `-` for stdin");
    }
    let reading = Reading {
        layout: args.reading.layout()?,
        preparation: args.reading.preparation(),
        limit_map: args.reading.limit_map.clone(),
        skip_broken: args.reading.on_error == OnError::Skip,
        threads: rayon::current_num_threads(),
    };
    let progress = Progress::new(context, "reading", args.logs.len());
    let inputs = Collection::read(
        &args.logs,
        &reading,
        |files| progress.set_steps(files),
        &|| progress.step(),
    );
    drop(progress);
    let inputs = inputs.map_err(|error| unusable(error, context))?;
    notes::left_out(&inputs.beside().left_out, context);
    notes::beside(inputs.beside(), context);
    notes::layouts(&inputs, context);
    Ok(inputs)
}

/// The drives inside the binary.
pub(crate) fn load_embedded(args: &ReadingArgs, context: &Context) -> anyhow::Result<Inputs> {
    let files = EMBEDDED.iter().map(|drive| (drive.path(), drive.bytes()));
    let inputs = Collection::of_bytes(files, &args.preparation())?;
    notes::findings(&inputs, context);
    Ok(inputs)
}

/// Says what flag goes on without the broken logs.
fn unusable(error: Error, context: &Context) -> anyhow::Error {
    match error {
        Error::Unusable {
            mut broken,
            usable,
            left_out,
        } => {
            notes::left_out(&left_out, context);
            let others = match usable {
                0 => String::new(),
                1 => "; --on-error skip goes on with the other log".to_owned(),
                n => format!("; --on-error skip goes on with the other {n} logs"),
            };
            match broken.len() {
                1 if others.is_empty() => broken.remove(0).into(),
                1 => anyhow!("{}{others}", broken[0]),
                n => {
                    let list = broken.iter().map(|error| format!("\n  {error}"));
                    anyhow!(
                        "{n} logs cannot be used{others}:{}",
                        list.collect::<String>()
                    )
                }
            }
        }
        Error::OnlyOtherFiles { left_out } => {
            notes::left_out(&left_out, context);
            anyhow!("no logs but {}", notes::listed(&left_out))
        }
        error => error.into(),
    }
}
