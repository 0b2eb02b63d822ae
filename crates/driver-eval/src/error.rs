/// Why nothing can be evaluated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Too few units to hold one out.
    #[error(
        "found {found} of at least {needed} drives, files or drivers with speed, of which one is held out at a time; add logs"
    )]
    TooFewUnits {
        /// How many there are.
        found: usize,
        /// How many there must be.
        needed: usize,
    },
    /// There is too little for every part of an evaluation.
    #[error("nothing to evaluate{parts}{contents}")]
    Nothing {
        /// Every part with the reason, a line each.
        parts: String,
        /// What every drive has, a line each.
        contents: String,
    },
    /// All drives that can be used are of one unit.
    #[error(
        "one drive, file or driver, `{unit}`, is all that can be used, and nothing is left when it is held out; add logs{left_out}"
    )]
    OneUnit {
        /// Its name.
        unit: String,
        /// Drives that cannot be used, a line each.
        left_out: String,
    },
    /// All drives are of one driver.
    #[error(
        "all logs are of one driver, by {taken_from}; keep each driver's logs in a folder of its own"
    )]
    OneDriver {
        /// What was taken for a driver, in words.
        taken_from: String,
    },
    /// A drive is in fewer folders than asked for.
    #[error(
        "{drive}: there is no folder {level} above it that could name a driver; choose a lower level"
    )]
    NoFolder {
        /// The drive.
        drive: String,
        /// Folders up from the file.
        level: usize,
    },
    /// A drive does not say who drove it.
    #[error(
        "{drive}: no column `{column}` that names a driver; there are: {}",
        if .known.is_empty() { "none".to_owned() } else { .known.join(", ") }
    )]
    NoDriver {
        /// The drive.
        drive: String,
        /// The column that was asked for.
        column: String,
        /// The columns that say anything of the whole drive.
        known: Vec<String>,
    },
    /// A model of the next seconds has no such horizon.
    #[error("the model was fitted for {} s, and not for {asked_s} s", .known_s.iter().map(f64::to_string).collect::<Vec<_>>().join(", "))]
    Horizon {
        /// What was asked for.
        asked_s: f64,
        /// What there is.
        known_s: Vec<f64>,
    },
    /// From a driver model.
    #[error(transparent)]
    Model(#[from] driver_model::Error),
}

pub(crate) fn too_few_stretches(found: usize, unit: &'static str) -> Error {
    Error::Model(driver_model::Error::TooFewStretches {
        found,
        needed: 2,
        unit,
    })
}
