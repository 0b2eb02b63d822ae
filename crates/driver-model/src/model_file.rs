use serde::{Deserialize, Serialize};

use crate::{DriverModel, Error, PhaseKind};

/// Schema name and version of model files.
pub const MODEL_SCHEMA: &str = "drivekit/model/2";

/// Units of everything in a model file.
const UNITS: &str = "SI: m, s, m/s, m/s²";

/// A log that a model was fitted to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingInput {
    /// Path as it was given.
    pub path: String,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: String,
}

/// What a model was fitted to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingRecord {
    /// Phases, those of other drivers included.
    pub phases: usize,
    /// Segments, or samples where the model was fitted to samples; those of other drivers included.
    pub points: usize,
    /// The driver's own logs.
    pub inputs: Vec<TrainingInput>,
    /// Logs of other drivers.
    pub prior_inputs: Vec<TrainingInput>,
    /// Weight of a phase of other drivers beside 1 for an own one.
    pub prior_weight: f64,
}

/// A fitted model with where it comes from, as JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelFile {
    schema: String,
    units: String,
    /// Version of the program that fitted it.
    pub version: String,
    /// Acceleration or braking.
    pub phase: PhaseKind,
    /// The model.
    pub model: DriverModel,
    /// What it was fitted to.
    pub training: TrainingRecord,
    /// Configuration of the fit.
    pub config: serde_json::Value,
}

impl ModelFile {
    /// A file for a model fitted by this version of the program.
    #[must_use]
    pub fn new(
        phase: PhaseKind,
        model: DriverModel,
        training: TrainingRecord,
        config: serde_json::Value,
    ) -> Self {
        Self {
            schema: MODEL_SCHEMA.to_owned(),
            units: UNITS.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            phase,
            model,
            training,
            config,
        }
    }

    /// Parses and checks a model file.
    ///
    /// # Errors
    /// [`Error::ModelFile`] for text that is no model file or of another version, [`Error::Parameter`] for
    /// parameters that no fit can produce.
    pub fn from_json(text: &str) -> Result<Self, Error> {
        #[derive(Deserialize)]
        struct Header {
            schema: Option<String>,
        }
        let refuse = |reason: String| Error::ModelFile { reason };
        let header: Header =
            serde_json::from_str(text).map_err(|e| refuse(format!("not JSON of a model: {e}")))?;
        match header.schema.as_deref() {
            Some(MODEL_SCHEMA) => {}
            Some(old) if old.starts_with("drivekit/model/") => {
                return Err(refuse(format!(
                    "schema is `{old}`, this program reads `{MODEL_SCHEMA}`; fit the model anew with `drivekit fit`"
                )));
            }
            Some(other) => {
                return Err(refuse(format!(
                    "schema is `{other}`, which is no model; `drivekit fit` writes `{MODEL_SCHEMA}`"
                )));
            }
            None => {
                return Err(refuse(format!(
                    "no key `schema`; a model file written by `drivekit fit` has `{MODEL_SCHEMA}`"
                )));
            }
        }
        let file: Self = serde_json::from_str(text).map_err(|e| refuse(e.to_string()))?;
        if file.units != UNITS {
            return Err(refuse(format!(
                "units are `{}`, this program reads `{UNITS}`",
                file.units
            )));
        }
        if !matches!(file.phase, PhaseKind::Acceleration | PhaseKind::Braking) {
            return Err(refuse(format!(
                "no model of the phase `{}`",
                file.phase.name()
            )));
        }
        file.model.check()?;
        Ok(file)
    }

    /// The file's text.
    ///
    /// # Errors
    /// [`Error::ModelFile`] where a parameter has no JSON form.
    pub fn to_json(&self) -> Result<String, Error> {
        serde_json::to_string_pretty(self)
            .map(|text| text + "\n")
            .map_err(|e| Error::ModelFile {
                reason: e.to_string(),
            })
    }
}
