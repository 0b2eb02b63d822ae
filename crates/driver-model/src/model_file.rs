use serde::{Deserialize, Serialize, Serializer};
use serde_json::Value;

use crate::{Behaviour, DriverModel, Error, PhaseExtent};

/// Schema name and version of model files.
pub const MODEL_SCHEMA: &str = "drivekit/model/3";

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
    /// Phases, or stretches of cruising or following, or drives; those of other drivers included.
    pub phases: usize,
    /// Segments, or samples where the model was fitted to samples; those of other drivers included. 0 for stretches.
    pub points: usize,
    /// The driver's own logs.
    pub inputs: Vec<TrainingInput>,
    /// Logs of other drivers.
    pub prior_inputs: Vec<TrainingInput>,
    /// Weight of a phase of other drivers beside 1 for an own one; 0 without such logs.
    pub prior_weight: f64,
    /// How far those phases reach. Files that do not say it are of phases cut at the threshold.
    #[serde(default)]
    pub extent: PhaseExtent,
}

/// A fitted model with where it comes from, as JSON.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelFile {
    /// Version of the program that fitted it.
    pub version: String,
    /// The model.
    pub model: DriverModel,
    /// What it was fitted to.
    pub training: TrainingRecord,
    /// Configuration of the fit.
    pub config: Value,
}

/// The file as it stands on disk: what the model is, the behaviour says.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct OnDisk<S, M, T, C> {
    schema: S,
    units: S,
    version: S,
    behaviour: Behaviour,
    model: M,
    training: T,
    config: C,
}

impl Serialize for ModelFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let on_disk = OnDisk {
            schema: MODEL_SCHEMA,
            units: UNITS,
            version: &self.version,
            behaviour: self.model.behaviour(),
            model: &self.model,
            training: &self.training,
            config: &self.config,
        };
        on_disk.serialize(serializer)
    }
}

impl ModelFile {
    /// A file for a model fitted by this version of the program.
    #[must_use]
    pub fn new(model: DriverModel, training: TrainingRecord, config: Value) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
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
        let file: OnDisk<String, Value, TrainingRecord, Value> =
            serde_json::from_str(text).map_err(|e| refuse(e.to_string()))?;
        if file.units != UNITS {
            return Err(refuse(format!(
                "units are `{}`, this program reads `{UNITS}`",
                file.units
            )));
        }
        let model = DriverModel::from_value(file.behaviour, file.model)
            .map_err(|e| refuse(format!("the model: {e}")))?;
        model.check()?;
        Ok(Self {
            version: file.version,
            model,
            training: file.training,
            config: file.config,
        })
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
