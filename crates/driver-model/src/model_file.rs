use serde::{Deserialize, Serialize};

use crate::{DriverModel, Error};

/// Schema name and version of model files.
pub const MODEL_SCHEMA: &str = "drivekit/model/1";

/// A log that a model was fitted to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingInput {
    /// Path as it was given.
    pub path: String,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: String,
}

/// A fitted model with where it comes from, as JSON. Units are SI and part of the parameters' names or documentation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelFile {
    /// [`MODEL_SCHEMA`].
    pub schema: String,
    /// Version of the program that fitted it.
    pub version: String,
    /// The model.
    pub model: DriverModel,
    /// Phases it was fitted to.
    pub training_phases: usize,
    /// Segments it was fitted to.
    pub training_segments: usize,
    /// Logs it was fitted to.
    pub inputs: Vec<TrainingInput>,
    /// Configuration of the fit.
    pub config: serde_json::Value,
}

impl ModelFile {
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
            Some(other) => {
                return Err(refuse(format!(
                    "schema is `{other}`, this program reads `{MODEL_SCHEMA}`; fit the model anew"
                )));
            }
            None => {
                return Err(refuse(format!(
                    "no key `schema`; a model file written by `drivekit fit` has `{MODEL_SCHEMA}`"
                )));
            }
        }
        let file: Self = serde_json::from_str(text).map_err(|e| refuse(e.to_string()))?;
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
