//! Flags that several subcommands share.

use std::path::PathBuf;

use anyhow::Context as _;
use clap::{Args, ValueEnum};
use drive_log::{LayoutChoice, Preparation, Smoothing};
use serde::Serialize;

use crate::numbers;

/// Flags that every subcommand takes.
#[derive(Debug, Args)]
pub(crate) struct Global {
    /// Output on stdout
    #[arg(long, global = true, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Worker threads; 0 takes one per core, at most four per core or 64
    #[arg(long, global = true, default_value_t = 0, value_parser = threads, value_name = "N")]
    threads: usize,
    /// No notes and no progress on stderr
    #[arg(long, short, global = true)]
    quiet: bool,
    /// More notes on stderr
    #[arg(long, short, global = true)]
    verbose: bool,
    /// Leave out how long things took and when they were: same input, same bytes
    #[arg(long, global = true)]
    no_times: bool,
    /// Colours
    #[arg(long, global = true, value_enum, default_value_t = Color::Auto)]
    color: Color,
    /// TOML file with defaults for flags; a flag wins
    #[arg(long, global = true, value_name = "FILE.toml")]
    config: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Tables for people
    Text,
    /// One JSON document in SI units
    Json,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Color {
    Auto,
    Always,
    Never,
}

/// A number of threads that this computer can use.
fn threads(text: &str) -> Result<usize, String> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let most = (4 * cores).max(64);
    match text.parse() {
        Ok(threads) if threads <= most => Ok(threads),
        _ => Err(format!(
            "expected a number of threads, 0 to {most} with the {cores} cores of this computer"
        )),
    }
}

/// What a subcommand needs to know of the global flags.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Context {
    pub(crate) format: Format,
    pub(crate) quiet: bool,
    pub(crate) verbose: bool,
    /// Without wall times, which differ from run to run
    pub(crate) no_times: bool,
}

impl Global {
    /// Sets up colours and threads.
    pub(crate) fn context(&self) -> anyhow::Result<Context> {
        match self.color {
            Color::Auto => {}
            Color::Always => anstream::ColorChoice::Always.write_global(),
            Color::Never => anstream::ColorChoice::Never.write_global(),
        }
        rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads)
            .build_global()
            .context("cannot start the worker threads; try a smaller --threads")?;
        Ok(Context {
            format: self.format,
            quiet: self.quiet,
            verbose: self.verbose,
            no_times: self.no_times,
        })
    }
}

/// Which logs, and how they are read and prepared.
#[derive(Debug, Clone, Args, Serialize)]
#[command(next_help_heading = "Logs")]
pub(crate) struct LogArgs {
    /// Logs: files, folders or globs (CSV or Parquet, also .gz or .zst); `-` is stdin
    #[arg(value_name = "LOG")]
    #[serde(skip)]
    pub(crate) logs: Vec<PathBuf>,
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) reading: ReadingArgs,
}

#[derive(Debug, Clone, Args, Serialize)]
#[command(next_help_heading = "Logs")]
pub(crate) struct ReadingArgs {
    /// Layout of the logs: auto, canonical, bmw-i3, rsk-twizy, nds-br, openacc, igdir, cycles, or a TOML file
    #[arg(long, default_value = "auto", value_name = "LAYOUT")]
    pub(crate) layout: String,
    /// Sampling interval after resampling, in s
    #[arg(long, default_value_t = 0.1, value_parser = numbers::step_s, value_name = "S")]
    pub(crate) step: f64,
    /// Smoothing of speed: hann:N or none
    #[arg(long, default_value = "hann:5", value_name = "FILTER")]
    pub(crate) smooth: Smoothing,
    /// A drive is split where speed is missing for longer than this, in s
    #[arg(long, default_value_t = 2.0, value_parser = numbers::gap_s, value_name = "S")]
    pub(crate) max_gap: f64,
    /// Take a uniform log as it is: no resampling, no smoothing
    #[arg(long)]
    pub(crate) raw: bool,
    /// Map with speed limits for drives with positions: GeoJSON lines with `maxspeed`, as OpenStreetMap's tools export them
    #[arg(long, value_name = "FILE.geojson")]
    pub(crate) limit_map: Option<PathBuf>,
    /// What a broken log does: stop the run, or be skipped and listed, with exit code 1 at the end
    #[arg(long, value_enum, default_value_t = OnError::Stop, value_name = "WHAT")]
    pub(crate) on_error: OnError,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum OnError {
    Stop,
    Skip,
}

/// The defaults of the flags.
impl Default for ReadingArgs {
    fn default() -> Self {
        let Preparation {
            step_s,
            smooth,
            max_gap_s,
            raw,
        } = Preparation::default();
        Self {
            layout: "auto".to_owned(),
            step: step_s,
            smooth,
            max_gap: max_gap_s,
            raw,
            limit_map: None,
            on_error: OnError::Stop,
        }
    }
}

impl ReadingArgs {
    pub(crate) fn preparation(&self) -> Preparation {
        Preparation {
            step_s: self.step,
            smooth: self.smooth,
            max_gap_s: self.max_gap,
            raw: self.raw,
        }
    }

    /// `auto`, the name of a built-in layout, or a TOML file that describes one.
    pub(crate) fn layout(&self) -> anyhow::Result<LayoutChoice> {
        if self.layout == "auto" {
            return Ok(LayoutChoice::Auto);
        }
        if !self.layout.ends_with(".toml") {
            return Ok(LayoutChoice::Named(self.layout.clone()));
        }
        let text = std::fs::read_to_string(&self.layout)
            .with_context(|| format!("cannot read the layout `{}`", self.layout))?;
        let layout = drive_log::Layout::from_toml_str(&self.layout, &text)?;
        Ok(LayoutChoice::Described(layout))
    }
}
