/// What can go wrong when a vehicle is read or a trip is evaluated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The vehicle file could not be read.
    #[error("{file}: {source}; check that the file exists and is readable UTF-8")]
    Read {
        /// Path as it was given.
        file: String,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The text is no vehicle: no TOML, a missing field, an unknown key or a value of the wrong
    /// type.
    #[error("{file}: {source}")]
    Parse {
        /// File name as it was given.
        file: String,
        /// Line, column and key.
        source: Box<toml::de::Error>,
    },
    /// A vehicle could not be written as TOML.
    #[error("vehicle `{name}` cannot be written as TOML: {source}")]
    Write {
        /// Name of the vehicle.
        name: String,
        /// What the serialiser said.
        source: toml::ser::Error,
    },
    /// A vehicle parameter is outside its allowed range.
    #[error("{origin}: `{key}` is {value}, allowed is {min} to {max}")]
    Parameter {
        /// File, or name of the vehicle where there is no file.
        origin: String,
        /// Dotted key, as in the vehicle file.
        key: &'static str,
        /// The value found.
        value: f64,
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
    },
    /// Vehicle parameters that do not fit together.
    #[error("{origin}: `{key}` {problem}")]
    Inconsistent {
        /// File, or name of the vehicle where there is no file.
        origin: String,
        /// Dotted key, as in the vehicle file.
        key: String,
        /// What is wrong, and what is allowed.
        problem: String,
    },
    /// A loss table is no table.
    #[error("{file}, line {line}: {problem}")]
    LossTable {
        /// Path of the table.
        file: String,
        /// Line, 1-based.
        line: usize,
        /// What is wrong, and what is expected.
        problem: String,
    },
    /// Trips from which no parameter can be told.
    #[error("calibration: {problem}")]
    Calibration {
        /// What is wrong, and what is needed.
        problem: String,
    },
    /// `[sources]` documents a key that the vehicle does not have.
    #[error(
        "{origin}: `[sources]` names `{key}`, which is no key of the vehicle; use dotted keys such as `battery.resistance_ohm`"
    )]
    UnknownSourceKey {
        /// File, or name of the vehicle where there is no file.
        origin: String,
        /// The key found.
        key: String,
    },
    /// No built-in vehicle has this name.
    #[error("no built-in vehicle `{name}`; there are {known}")]
    UnknownVehicle {
        /// The name asked for.
        name: String,
        /// The names there are, comma separated.
        known: String,
    },
    /// Two channels of a trip differ in length.
    #[error(
        "`{channel}` has {found} samples, expected {expected}: all channels need one sample per time"
    )]
    Length {
        /// The channel that does not fit.
        channel: &'static str,
        /// Its length.
        found: usize,
        /// The length of the first channel.
        expected: usize,
    },
    /// A sample is not finite or outside the range the model covers.
    #[error(
        "`{channel}`[{index}] is {value}, allowed is {min} to {max}; repair or cut the recording there"
    )]
    Sample {
        /// The channel.
        channel: &'static str,
        /// Index of the sample, 0-based.
        index: usize,
        /// The value found.
        value: f64,
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
    },
    /// A scalar argument is not finite or outside its range.
    #[error("`{name}` is {value}, allowed is {min} to {max}")]
    Argument {
        /// Name of the argument.
        name: &'static str,
        /// The value found.
        value: f64,
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
    },
}
