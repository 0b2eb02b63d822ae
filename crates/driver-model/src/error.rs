//! What can go wrong, and what was left out.

use serde::Serialize;

use crate::{ModelKind, Subject};

/// What can go wrong between recorded drives and an evaluated model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is not enough to learn from.
    #[error(
        "cannot fit `{model}`: found {found} of at least {needed} {unit} to learn from; \
         add drives or allow shorter and smaller phases"
    )]
    TooFewPhases {
        /// Model name.
        model: &'static str,
        /// How many there are.
        found: usize,
        /// How many there must be.
        needed: usize,
        /// What is counted, in words.
        unit: &'static str,
    },
    /// There is too little cruising or car following to learn from.
    #[error("found {found} of at least {needed} {unit}; add drives")]
    TooFewStretches {
        /// How many there are.
        found: usize,
        /// How many there must be.
        needed: usize,
        /// What is counted, in words.
        unit: &'static str,
    },
    /// A rule or option is outside its range.
    #[error("{name} = {value} is not usable: {expected}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What is accepted, in words.
        expected: &'static str,
    },
    /// A model file holds a parameter that no fit can produce.
    #[error("model `{model}`: {name} = {value} is not usable: {expected}")]
    Parameter {
        /// Model name.
        model: &'static str,
        /// Parameter name.
        name: &'static str,
        /// What was found.
        value: f64,
        /// What is accepted, in words.
        expected: String,
    },
    /// A model file is not one of ours, or not of a version this program reads.
    #[error("not a usable model file: {reason}")]
    ModelFile {
        /// What was found, and what to do.
        reason: String,
    },
    /// A setting of an update is not that of the model.
    #[error("{now}: the model was fitted {then}; leave it out, also of a configuration file")]
    Configured {
        /// What is asked for, such as "with --max-gap 5".
        now: String,
        /// What the model was fitted with.
        then: String,
    },
    /// The optimiser stopped without a usable point.
    #[error("fitting `{model}` failed: {reason}")]
    Fit {
        /// Model name.
        model: &'static str,
        /// The optimiser's reason.
        reason: String,
    },
    /// A scaling that needs the whole log, asked of a stream.
    #[error(
        "a stream has no whole to take its scale from; \
         give fixed divisors in m/s and m/s², or none"
    )]
    ScaleOfStream,
    /// A method that needs the whole log, asked of a stream.
    #[error("only SWAB segments a stream; the other methods need the whole log")]
    MethodOfStream,
    /// There is not enough to learn the speed ahead from.
    #[error(
        "the speed ahead: {found} moments to learn from, at least {needed} needed; add drives, or ask for shorter horizons"
    )]
    TooFewMoments {
        /// How many there are.
        found: usize,
        /// How many there must be.
        needed: usize,
    },
    /// A model needs speed limits and the log has none.
    #[error(
        "{log}: no speed limits, or for less than half of the time, which this model needs; give logs with a column such as speed_limit_kmh"
    )]
    NoLimits {
        /// Name of the drive.
        log: String,
    },
    /// A recording with breaks where one without is needed.
    #[error("{log}: without speed for so long that it is {pieces} drives; give them one by one")]
    Broken {
        /// Name of the recording.
        log: String,
        /// How many there are.
        pieces: usize,
    },
    /// A model of another subject.
    #[error("`{model}` is a model of {}, not of {subject}", .model.subject())]
    Subject {
        /// The model.
        model: ModelKind,
        /// What a model is needed of.
        subject: Subject,
    },
    /// Drives of other drivers, for a model that cannot learn from them.
    #[error("`{model}` cannot learn from other drivers; only models of phases can")]
    NoPrior {
        /// The model.
        model: ModelKind,
    },
    /// Whole phases, for a model that learns from none.
    #[error(
        "`{model}` does not learn from the course of phases, whole or cut; rise-time, transition-point and the profiles do"
    )]
    NoPhases {
        /// The model.
        model: ModelKind,
    },
    /// More drives, for a model whose file does not hold those of before.
    #[error("{}", no_memory(*.model))]
    NoMemory {
        /// The model.
        model: ModelKind,
    },
    /// A model that says nothing while a drive goes on.
    #[error(
        "`{model}` predicts nothing of a drive that is still going on; only models of the speed ahead and of acceleration and braking phases do"
    )]
    NotLive {
        /// The model.
        model: ModelKind,
    },
    /// Two models that would say the same.
    #[error("two models of {behaviour}; give one")]
    TwoOf {
        /// What they are about.
        behaviour: &'static str,
    },
    /// Drives of different sampling intervals.
    #[error("{log}: sampled every {found_s} s where {expected_s} s were expected; resample it")]
    Steps {
        /// Name of the drive.
        log: String,
        /// Its sampling interval.
        found_s: f64,
        /// The one of the others, or of the model.
        expected_s: f64,
    },
    /// A value in a road file that no road has.
    #[error("{file}: {place} = {value}: {expected}")]
    RoadValue {
        /// The file.
        file: String,
        /// Key and index.
        place: String,
        /// What was found.
        value: f64,
        /// What would do, in words.
        expected: String,
    },
    /// A file that is no road, or that no road can be made of.
    #[error("{file}: {reason}")]
    Road {
        /// The file, or the drive.
        file: String,
        /// What was found, and what to do.
        reason: String,
    },
    /// Drives that are too different in length to be of one road.
    #[error(
        "not drives of one road: most are {} long, and more than 5 % off that are {}; leave these out, or cut the logs to the same stretch",
        kilometres(*.median_m),
        .others.iter().map(|(log, length_m)| format!("{log} ({})", kilometres(*length_m))).collect::<Vec<_>>().join(", ")
    )]
    NotOneRoad {
        /// Median length.
        median_m: f64,
        /// The others with their lengths.
        others: Vec<(String, f64)>,
    },
    /// What is wrong with one drive of several.
    #[error("{log}: {cause}")]
    InLog {
        /// Name of the drive, or of the piece of it.
        log: String,
        /// What is wrong.
        cause: Box<Error>,
    },
    /// None of the drives has what is asked for.
    #[error("{task}: {}", listed(.left_out))]
    NothingUsable {
        /// What was to be done, in words.
        task: &'static str,
        /// Every drive with what it lacks.
        left_out: Vec<LeftOut>,
    },
    /// From support vector regression.
    #[error(transparent)]
    Regression(#[from] svr::Error),
    /// From segmentation.
    #[error(transparent)]
    Segmentation(#[from] tseg::Error),
    /// From the drive log.
    #[error(transparent)]
    Log(#[from] drive_log::Error),
    /// From the vehicle model.
    #[error(transparent)]
    Energy(#[from] ev_energy::Error),
}

/// A drive that lacks what something needs, while others go on without it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// Name of the drive, or of the piece of it.
    pub log: String,
    /// What it lacks.
    pub reason: String,
}

impl LeftOut {
    /// With the reason in words.
    pub fn new(log: &str, reason: impl Into<String>) -> Self {
        Self {
            log: log.to_owned(),
            reason: reason.into(),
        }
    }
}

fn no_memory(model: ModelKind) -> String {
    let why = match model.subject() {
        Subject::Phases => {
            return format!(
                "the file of this `{model}` does not hold the phases that it was fitted to, as files of before do not; fit it anew"
            );
        }
        Subject::SpeedAhead => {
            "it thins the moments of all drives and judges itself on drives held back"
        }
        Subject::Cruise | Subject::Following | Subject::Trips => {
            "it is fitted to all drives at once and keeps none"
        }
    };
    format!(
        "`{model}` does not remember what it was fitted to: {why}; only models of acceleration and braking phases ({}) do; \
         fit it anew to all drives",
        ModelKind::of(Subject::Phases)
            .map(ModelKind::name)
            .collect::<Vec<_>>()
            .join(", ")
    )
}

fn kilometres(length_m: f64) -> String {
    format!("{:.2} km", length_m / 1e3)
}

fn listed(left_out: &[LeftOut]) -> String {
    let lines = left_out
        .iter()
        .map(|left_out| format!("\n  {}: {}", left_out.log, left_out.reason));
    format!("no drive can be used{}", lines.collect::<String>())
}

impl Error {
    pub(crate) fn not_of(subject: Subject, model: ModelKind) -> Self {
        Self::Subject { model, subject }
    }

    /// The same with the name of the drive that it is about, where it does not say so yet.
    #[must_use]
    pub fn in_log(self, log: &str) -> Self {
        let is_named = matches!(
            self,
            Self::InLog { .. }
                | Self::NoLimits { .. }
                | Self::Steps { .. }
                | Self::Broken { .. }
                | Self::Log(_)
                | Self::Option { .. }
        );
        if is_named {
            return self;
        }
        Self::InLog {
            log: log.to_owned(),
            cause: Box::new(self),
        }
    }
}

/// Refuses an option that is not finite or not at least `lowest`.
///
/// # Errors
/// [`Error::Option`].
pub fn at_least(
    name: &'static str,
    value: f64,
    lowest: f64,
    expected: &'static str,
) -> Result<(), Error> {
    if value.is_finite() && value >= lowest {
        return Ok(());
    }
    Err(Error::Option {
        name,
        value,
        expected,
    })
}
