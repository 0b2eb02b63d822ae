mod lists;

use serde::{Deserialize, Serialize, Serializer};
use serde_json::Value;

use crate::{Behaviour, DriverModel, Error, PhaseExtent, PhaseKind, PhaseMemory};
use lists::ItemsOnALine;

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
    /// Every phase that a model of phases was fitted to; `None` for other models and in files of before.
    pub memory: Option<PhaseMemory>,
}

/// The file as it stands on disk: what the model is, the behaviour says.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct OnDisk<S, M, T, C, P> {
    schema: S,
    units: S,
    version: S,
    behaviour: Behaviour,
    model: M,
    training: T,
    config: C,
    #[serde(default = "Option::default", skip_serializing_if = "Option::is_none")]
    memory: Option<P>,
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
            memory: self.memory.as_ref(),
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
            memory: None,
        }
    }

    /// The same with what the model was fitted to.
    #[must_use]
    pub fn with_memory(self, memory: Option<PhaseMemory>) -> Self {
        Self { memory, ..self }
    }

    /// What the model was fitted to.
    ///
    /// # Errors
    /// [`Error::NoMemory`] for a model that is none of phases, and for a file that does not have it.
    pub fn remembered(&self) -> Result<&PhaseMemory, Error> {
        let model = self.model.kind();
        self.memory.as_ref().ok_or(Error::NoMemory { model })
    }

    /// What the configuration of the fit and another one say of the first of these keys in which they differ; such as "with --smooth none".
    #[must_use]
    pub fn configured_otherwise(&self, keys: &[&str], config: &Value) -> Option<[String; 2]> {
        let words = |key: &str, value: &Value| match value {
            Value::Bool(false) | Value::Null => format!("without --{}", flag_name(key)),
            value => {
                let flag = flag(key, value).unwrap_or_default();
                format!("with {}", flag.replacen('=', " ", 1))
            }
        };
        keys.iter().find_map(|key| {
            let (then, now) = (self.config.get(*key)?, config.get(*key)?);
            (!is_same(then, now)).then(|| [words(key, then), words(key, now)])
        })
    }

    /// The flags of a fit configured as before, but for these keys `of_new_logs`, which are as in the configuration `asked`.
    ///
    /// # Errors
    /// [`Error::Configured`] where a flag with one of the names `given` says otherwise, [`Error::ModelFile`] where the file has no such setting.
    pub fn flags_again(
        &self,
        asked: &Value,
        of_new_logs: &[&str],
        given: &[String],
    ) -> Result<Vec<String>, Error> {
        let mut flags = Vec::new();
        for (key, new) in asked.as_object().into_iter().flatten() {
            if of_new_logs.contains(&key.as_str()) {
                flags.extend(flag(key, new));
                continue;
            }
            let differs = self.configured_otherwise(&[key], asked);
            if let (Some([then, now]), true) = (differs, given.contains(&flag_name(key))) {
                return Err(Error::Configured { now, then });
            }
            let then = self.config.get(key).ok_or_else(|| Error::ModelFile {
                reason: format!("no `config.{key}`; fit the model anew"),
            })?;
            flags.extend(flag(key, then));
        }
        Ok(flags)
    }

    /// Parses and checks a model file.
    ///
    /// # Errors
    /// [`Error::ModelFile`] for text that is no model file or of another version, or whose memory is not of the model, [`Error::Parameter`] for
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
        let file: OnDisk<String, Value, TrainingRecord, Value, PhaseMemory> =
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
        if let Some(memory) = &file.memory {
            file.training
                .check(memory, file.behaviour)
                .map_err(|what| refuse(format!("its memory is not of the model: {what}")))?;
            file.training.check_hashes().map_err(refuse)?;
            memory
                .check_config(model.kind(), &file.config)
                .map_err(refuse)?;
        }
        Ok(Self {
            version: file.version,
            model,
            training: file.training,
            config: file.config,
            memory: file.memory,
        })
    }

    /// The file's text.
    ///
    /// # Errors
    /// [`Error::ModelFile`] where a parameter has no JSON form.
    pub fn to_json(&self) -> Result<String, Error> {
        let refuse = |reason: String| Error::ModelFile { reason };
        let mut text = Vec::new();
        self.serialize(&mut ItemsOnALine::serializer(&mut text))
            .map_err(|error| refuse(error.to_string()))?;
        text.push(b'\n');
        String::from_utf8(text).map_err(|error| refuse(error.to_string()))
    }
}

fn flag_name(key: &str) -> String {
    key.replace('_', "-")
}

/// A setting as a flag; none for one that is off.
fn flag(key: &str, value: &Value) -> Option<String> {
    let text = |value: &Value| {
        let text = value.as_str().map(str::to_owned);
        text.unwrap_or_else(|| value.to_string())
    };
    let name = flag_name(key);
    Some(match value {
        Value::Null | Value::Bool(false) => return None,
        Value::Bool(true) => format!("--{name}"),
        Value::Array(items) => {
            let items: Vec<String> = items.iter().map(text).collect();
            format!("--{name}={}", items.join(","))
        }
        value => format!("--{name}={}", text(value)),
    })
}

/// Whether two settings are equal, numbers but for the rounding of a change of unit.
pub(crate) fn is_same(a: &Value, b: &Value) -> bool {
    match (a.as_f64(), b.as_f64()) {
        (Some(a), Some(b)) => (a - b).abs() < 1e-9,
        _ => a == b,
    }
}

impl TrainingRecord {
    /// Whether a log with this SHA-256 is among the driver's own.
    #[must_use]
    pub fn has_learnt(&self, sha256: &str) -> bool {
        self.inputs.iter().any(|input| input.sha256 == sha256)
    }

    /// Whether it is among those of other drivers.
    #[must_use]
    pub fn has_as_prior(&self, sha256: &str) -> bool {
        self.prior_inputs.iter().any(|input| input.sha256 == sha256)
    }

    /// The record of a model that went on learning: the logs of both, with the other drivers of this one.
    #[must_use]
    pub fn extended(&self, by: Self) -> Self {
        Self {
            inputs: [self.inputs.clone(), by.inputs].concat(),
            prior_inputs: self.prior_inputs.clone(),
            prior_weight: self.prior_weight,
            ..by
        }
    }

    /// Which of the logs has a SHA-256 that is none, or is not written as [`drive_log::sha256`] does.
    fn check_hashes(&self) -> Result<(), String> {
        let is_digit = |b: u8| b.is_ascii_digit() || (b'a'..=b'f').contains(&b);
        for (field, inputs) in [
            ("inputs", &self.inputs),
            ("prior_inputs", &self.prior_inputs),
        ] {
            let is_none = |input: &TrainingInput| {
                input.sha256.len() != 64 || !input.sha256.bytes().all(is_digit)
            };
            if let Some(k) = inputs.iter().position(is_none) {
                return Err(format!(
                    "training.{field}[{k}].sha256 is not 64 digits of 0-9 and a-f"
                ));
            }
        }
        Ok(())
    }

    /// What of a memory is not what this says that the model was fitted to.
    fn check(&self, memory: &PhaseMemory, behaviour: Behaviour) -> Result<(), &'static str> {
        let is_of = match behaviour {
            Behaviour::Acceleration => memory.kind() == PhaseKind::Acceleration,
            Behaviour::Braking => memory.kind() == PhaseKind::Braking,
            _ => false,
        };
        let has_weight = self.prior_inputs.is_empty()
            || (memory.prior_weight() - self.prior_weight).abs() < f64::EPSILON;
        let agreements = [
            (is_of, "it is of another behaviour"),
            (
                memory.settings().extent == self.extent,
                "its phases reach as far as others",
            ),
            (
                memory.counts() == (self.phases, self.points),
                "it has another number of phases or points",
            ),
            (
                memory.drive_counts() == (self.inputs.len(), self.prior_inputs.len()),
                "it has another number of drives",
            ),
            (has_weight, "other drivers have another weight"),
        ];
        let wrong = agreements.into_iter().find(|(agrees, _)| !agrees);
        wrong.map_or(Ok(()), |(_, what)| Err(what))
    }
}
