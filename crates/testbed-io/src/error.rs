//! What can go wrong between files and robots.

use std::path::PathBuf;

/// Why a file could not be read or written. Every message says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file could not be opened or read.
    #[error("{}: {source}; check the path and its permissions", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A scenario file that cannot be opened or read.
    #[error("cannot read the scenario `{}`", path.display())]
    ReadScenario {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A scenario file that holds no scenario.
    #[error("scenario `{}`", path.display())]
    ScenarioFile {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        source: Box<toml::de::Error>,
    },
    /// The output could not be written.
    #[error("the run log cannot be written: {source}; is there space left?")]
    Write {
        /// What the operating system or the encoder said.
        source: std::io::Error,
    },
    /// The content is larger than what is read into memory.
    #[error("{}: more than {limit_bytes} bytes; split the file", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The limit.
        limit_bytes: u64,
    },
    /// The extension names no format of run logs.
    #[error("{}: the format is not known; name the run log .csv, .parquet or .mcap", path.display())]
    LogFormat {
        /// The file.
        path: PathBuf,
    },
    /// The columns do not make a run log, or not one in the format asked for.
    #[error("run log: {problem}")]
    Table {
        /// What does not fit, and what would.
        problem: String,
    },
    /// A file does not hold what it should.
    #[error("{}{place}: {found}; {help}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Where in the file, as `, line 3, column x_m`; empty for the file as a whole.
        place: String,
        /// What was found.
        found: String,
        /// What to do.
        help: String,
    },
    /// There is nothing to read poses from.
    #[error("{}: no {expected}; name the files, or a folder that holds them", path.display())]
    NoRecording {
        /// The file or folder.
        path: PathBuf,
        /// What was looked for.
        expected: &'static str,
    },
    /// What cannot be run.
    #[error(transparent)]
    Run(#[from] testbed_sim::Error),
    /// The settings in a run log are none.
    #[error("the settings in the run log: {0}")]
    Meta(String),
    /// A run log lacks a column or has it with another type.
    #[error("the run log has no column `{name}` of {kind}")]
    MissingColumn {
        /// The column.
        name: &'static str,
        /// Its type.
        kind: &'static str,
    },
    /// A scenario for another number of robots.
    #[error(
        "the scenario has {scenario} robots and the recording {recording}; name as many files as robots, from the front"
    )]
    RobotCount {
        /// Robots of the scenario.
        scenario: usize,
        /// Robots of the recording.
        recording: usize,
    },
    /// A tracker or robot that cannot be reached, or not any more.
    #[error("{peer}: {problem}; {help}")]
    Link {
        /// Which, as in the settings of the link.
        peer: String,
        /// What went wrong.
        problem: String,
        /// What to do.
        help: String,
    },
    /// A recording without poses.
    #[error("the last robot of the recording has no poses")]
    NoPoses,
}

impl Error {
    /// A thread that the system does not give.
    pub(crate) fn no_thread(name: &str, source: &std::io::Error) -> Self {
        Self::Link {
            peer: name.to_owned(),
            problem: source.to_string(),
            help: "are there too many threads?".to_owned(),
        }
    }
}
