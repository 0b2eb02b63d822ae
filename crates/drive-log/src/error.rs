//! What can go wrong between a file and a drive.

mod no_log;
mod table;

use std::path::PathBuf;

use crate::Channel;
use crate::head::names_a_speed;

pub use no_log::NoLog;
pub use table::TableError;

/// Why a recording could not be read, prepared or written. Every message says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file could not be opened or read.
    #[error("{}: {problem}; check the path and its permissions", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        problem: std::io::Error,
    },
    /// The output could not be written.
    #[error("{log}: cannot be written: {problem}")]
    Write {
        /// The log.
        log: String,
        /// What the operating system said.
        problem: std::io::Error,
    },
    /// A folder cannot be listed.
    #[error("cannot list the folder `{}`: {problem}", folder.display())]
    List {
        /// The folder.
        folder: PathBuf,
        /// What the operating system said.
        problem: std::io::Error,
    },
    /// Neither a path nor a pattern.
    #[error("`{pattern}` is neither a file nor a glob: {problem}")]
    Glob {
        /// What was given.
        pattern: String,
        /// What is wrong with it.
        problem: String,
    },
    /// No file has this name.
    #[error("no such file, folder or match: `{pattern}`")]
    NoMatch {
        /// What was given.
        pattern: String,
    },
    /// No file of a folder is called like a log.
    #[error(
        "no logs in the folder `{}`; looked to the bottom for files ending in .{suffixes}, also with .gz or .zst",
        folder.display()
    )]
    NoLogsInFolder {
        /// The folder.
        folder: PathBuf,
        /// How logs end.
        suffixes: String,
    },
    /// No thread to read with.
    #[error("cannot start a thread to read with: {problem}; try fewer threads")]
    Thread {
        /// What the operating system said.
        problem: std::io::Error,
    },
    /// What is wrong with a log of a file.
    #[error("`{path}`: {cause}")]
    InFile {
        /// The file.
        path: String,
        /// What is wrong.
        cause: Box<Error>,
    },
    /// Logs that cannot be used among others.
    #[error("{} cannot be used:{}", logs(.broken.len()), .broken.iter().map(|e| format!("\n  {e}")).collect::<String>())]
    Unusable {
        /// What is wrong with each.
        broken: Vec<Error>,
        /// How many others can be used.
        usable: usize,
        /// Files of folders that are no logs.
        left_out: Vec<NoLog>,
    },
    /// No file is a log.
    #[error("no logs but {} that are none", files(.left_out.len()))]
    OnlyOtherFiles {
        /// The files.
        left_out: Vec<NoLog>,
    },
    /// A gzip or zstd stream is damaged or cut short.
    #[error("{}: damaged {codec} stream: {problem}; copy or compress the file again", path.display())]
    Compressed {
        /// The file.
        path: PathBuf,
        /// `gzip` or `zstd`.
        codec: &'static str,
        /// What the decoder said.
        problem: std::io::Error,
    },
    /// The content is larger than what is read into memory.
    #[error("{}: more than {limit_bytes} bytes; split the file", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The limit.
        limit_bytes: u64,
    },
    /// Another file than a log, or nothing.
    #[error("{}: {found}, no log; a log is CSV or Parquet, with a header and a row per sample", path.display())]
    NotALog {
        /// The file.
        path: PathBuf,
        /// What it is instead.
        found: &'static str,
    },
    /// The content is not text that can be read.
    #[error("{}: {found} at byte {byte}; save the log as CSV in UTF-8 or Latin-1, or as Parquet", path.display())]
    NotText {
        /// The file.
        path: PathBuf,
        /// What was found instead.
        found: &'static str,
        /// Where, after decompression.
        byte: usize,
    },
    /// There is no row of data.
    #[error("{}: {found}; a log needs a header and at least one row", path.display())]
    NoData {
        /// The file.
        path: PathBuf,
        /// What is there instead.
        found: &'static str,
    },
    /// More columns than any log has.
    #[error("{}: {columns} columns, at most {limit} are read; is this one log with a row per sample?", path.display())]
    TooManyColumns {
        /// The file.
        path: PathBuf,
        /// Columns of the first line.
        columns: usize,
        /// The limit.
        limit: usize,
    },
    /// A row or a cell of a table that cannot be read.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A line that does not end.
    #[error("{}, line {line}: longer than {limit_bytes} bytes; a log has columns for channels and a row per sample", path.display())]
    LongLine {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The limit.
        limit_bytes: u64,
    },
    /// Numbers as time without a unit.
    #[error(
        "{}: column {header:?} does not say in which unit its times are ({from} to {to}); \
         name it time_s or time_ms, or give the unit in a layout: time = {{ header = {header:?}, unit = \"s\" }}",
        path.display()
    )]
    TimeUnit {
        /// The file.
        path: PathBuf,
        /// Header of the column.
        header: String,
        /// Its least value.
        from: f64,
        /// Its greatest value.
        to: f64,
    },
    /// A header that names a speed and not its unit.
    #[error(
        "{}: the header {header:?} does not say in which unit the speed is; name it speed_kmh, speed_mps or speed_mph \
         (a row of units under the header is not read), \
         or give the unit in a layout: time = {{ header = \"…\", unit = \"s\" }} and, under [channels], \
         speed = {{ header = {header:?}, unit = \"km/h\" }}",
        path.display()
    )]
    UnstatedUnit {
        /// The file.
        path: PathBuf,
        /// The header.
        header: String,
    },
    /// Columns without headers, or with the headers `v` and `a`, that do not belong together.
    #[error(
        "{}: {speed} and {accel} are no speed in {unit} and its acceleration in m/s^2: {found}; \
         give the columns headers with units (time_s, speed_kmh, accel_mps2), or name them in a layout",
        path.display()
    )]
    NoDerivative {
        /// The file.
        path: PathBuf,
        /// Header of the speed.
        speed: String,
        /// Header of the acceleration.
        accel: String,
        /// Unit of the speed.
        unit: String,
        /// How the two go together.
        found: String,
    },
    /// No layout knows these headers.
    #[error(
        "{}: no known layout has these headers: {found}; use the canonical headers (time_s, speed_mps, …), \
         or write a layout file (with skip_lines where other lines come before the header): time = {{ header = \"…\", unit = \"s\" }} and, under [channels], \
         speed = {{ header = \"…\", unit = \"km/h\" }}",
        path.display()
    )]
    UnknownLayout {
        /// The file.
        path: PathBuf,
        /// The headers, the first twenty.
        found: String,
        /// Whether one of the headers names a speed, or there are none.
        may_be_a_log: bool,
    },
    /// No built-in layout has this name.
    #[error("there is no layout {name:?}; known layouts: {known}")]
    UnknownLayoutName {
        /// The name.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A column that the layout needs is not there.
    #[error("{}: no column for {channel} ({wanted}) among {found}; add or rename a column, or choose another layout", path.display())]
    MissingColumn {
        /// The file.
        path: PathBuf,
        /// The channel, or `time`.
        channel: &'static str,
        /// Headers that would do.
        wanted: String,
        /// The headers, the first twenty.
        found: String,
    },
    /// Two columns could be the same channel.
    #[error("{}: the columns {first:?} and {second:?} are both {channel}; rename or delete one, or choose one in a layout by its number: column = {} or {}", path.display(), columns.0, columns.1)]
    DuplicateColumn {
        /// The file.
        path: PathBuf,
        /// The channel, or `time`.
        channel: &'static str,
        /// One column.
        first: String,
        /// The other.
        second: String,
        /// Their numbers, from 1.
        columns: (usize, usize),
    },
    /// A canonical header with a unit that is not known.
    #[error("{}: the unit of column {header:?} is not known; known suffixes for {channel}: {known}", path.display())]
    UnknownUnit {
        /// The file.
        path: PathBuf,
        /// The header.
        header: String,
        /// The channel without its unit, or `time`.
        channel: &'static str,
        /// Suffixes that would do.
        known: String,
    },
    /// A layout file that does not describe a layout.
    #[error("layout {name}: {problem}")]
    Layout {
        /// Name of the layout.
        name: String,
        /// What is wrong and what to write instead.
        problem: String,
    },
    /// A Parquet file that cannot be read.
    #[error("{}: damaged or unsupported Parquet file: {problem}; write the file again", path.display())]
    Parquet {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        problem: String,
    },
    /// A Parquet column that does not hold numbers.
    #[error("{}: column {header:?} holds {found}, not numbers; store it as a float or an integer", path.display())]
    ColumnType {
        /// The file.
        path: PathBuf,
        /// Name of the column.
        header: String,
        /// Its type.
        found: String,
    },
    /// Most of the time column runs backward.
    #[error(
        "{}: time runs backward in {backward} of {samples} steps, first at {at_s} s; is {header:?} the right time column, and does the header stand over its own columns? Correct it, or name the column of time in a layout",
        path.display()
    )]
    BackwardTime {
        /// The file.
        path: PathBuf,
        /// Header of the time column.
        header: String,
        /// Steps that run backward.
        backward: usize,
        /// Samples of the log.
        samples: usize,
        /// Time of the first such step.
        at_s: f64,
    },
    /// There is no speed at all.
    #[error("{log}: {channel} is missing in all {samples} samples; a drive needs a recorded speed")]
    NoSpeed {
        /// The log, or the file.
        log: String,
        /// The channel.
        channel: &'static str,
        /// Samples of the log.
        samples: usize,
    },
    /// A channel does not have as many samples as time.
    #[error("{log}: {channel} has {found} samples where {expected} are expected")]
    Length {
        /// The log.
        log: String,
        /// The channel, or `time`.
        channel: &'static str,
        /// Samples of the channel.
        found: usize,
        /// Samples of the log.
        expected: usize,
    },
    /// A file that is no map with speed limits.
    #[error(
        "{map}: no map with speed limits: {reason}; give GeoJSON with lines that have `maxspeed`, as OpenStreetMap's tools export it"
    )]
    LimitMap {
        /// The file.
        map: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A file without lines that a road could be made of.
    #[error("{file}: {reason}; give GeoJSON with a line, as OpenStreetMap's tools export it")]
    Lines {
        /// The file.
        file: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A value that must be finite is not.
    #[error("{log}: {channel} is {value} at sample {index}; it must be finite")]
    NotFinite {
        /// The log.
        log: String,
        /// The channel, or `time`.
        channel: &'static str,
        /// Sample, from 0.
        index: usize,
        /// The value.
        value: f64,
    },
    /// An option without meaning.
    #[error("{option} = {value}: {expected}")]
    Option {
        /// The option.
        option: &'static str,
        /// Its value.
        value: String,
        /// What would do.
        expected: &'static str,
    },
    /// `raw` was asked of a log that is not uniform.
    #[error(
        "{log}: not uniform: {found} at {at_s} s (sample {index}), where the step is {step_s} s; leave out the raw option to have it resampled"
    )]
    NotUniform {
        /// The log.
        log: String,
        /// Sample, from 0.
        index: usize,
        /// Its time.
        at_s: f64,
        /// The step of the log.
        step_s: f64,
        /// What was found there.
        found: String,
    },
    /// No two valid samples are close enough to make a drive.
    #[error(
        "{log}: {samples} samples, but no two with a valid speed within {max_gap_s} s of each other; allow longer gaps, or check the log and the unit of its times"
    )]
    NoPiece {
        /// The log.
        log: String,
        /// Samples of the log.
        samples: usize,
        /// Longest gap that is bridged.
        max_gap_s: f64,
    },
    /// What the recording says cannot be, and what it means cannot be told.
    #[error("{log}: {channel}: {found}")]
    Refused {
        /// The log.
        log: String,
        /// The channel.
        channel: String,
        /// What is impossible, and what to do.
        found: String,
    },
    /// The grid would have too many samples.
    #[error(
        "{log}: {duration_s} s in steps of {step_s} s are more than {limit} samples; choose a longer step, or check the time column"
    )]
    TooManySamples {
        /// The log.
        log: String,
        /// Duration.
        duration_s: f64,
        /// The step.
        step_s: f64,
        /// The limit.
        limit: usize,
    },
    /// A log could not be encoded as Parquet.
    #[error("{log}: cannot be encoded as Parquet: {problem}")]
    Encode {
        /// The log.
        log: String,
        /// What the encoder said.
        problem: String,
    },
}

impl Error {
    /// Whether it is another file than a log, and not a log that is broken: a picture, a page, a text, a table of something
    /// else. A folder may hold such.
    #[must_use]
    pub fn is_no_log(&self) -> bool {
        matches!(
            self,
            Error::NotALog { .. }
                | Error::UnknownLayout {
                    may_be_a_log: false,
                    ..
                }
        ) || matches!(
            self,
            Error::MissingColumn { channel, found, .. }
                if *channel == Channel::Speed.name() && !names_a_speed(found)
        )
    }
}

fn logs(count: usize) -> String {
    match count {
        1 => "a log".to_owned(),
        n => format!("{n} logs"),
    }
}

fn files(count: usize) -> String {
    match count {
        1 => "a file".to_owned(),
        n => format!("{n} files"),
    }
}
