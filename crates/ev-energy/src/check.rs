use crate::error::Error;

/// Refuses an argument outside `min..=max`.
pub(crate) fn argument(name: &'static str, value: f64, min: f64, max: f64) -> Result<(), Error> {
    if (min..=max).contains(&value) {
        return Ok(());
    }
    Err(Error::Argument {
        name,
        value,
        min,
        max,
    })
}

/// Range checks of vehicle parameters, with the file or vehicle to blame.
pub(crate) struct Checker<'a> {
    pub(crate) origin: &'a str,
}

impl Checker<'_> {
    /// The value, if it lies in `min..=max`.
    pub(crate) fn range(
        &self,
        key: &'static str,
        value: f64,
        min: f64,
        max: f64,
    ) -> Result<f64, Error> {
        if (min..=max).contains(&value) {
            Ok(value)
        } else {
            Err(Error::Parameter {
                origin: self.origin.to_owned(),
                key,
                value,
                min,
                max,
            })
        }
    }

    /// An error about a key, in words that continue "`key`".
    pub(crate) fn problem(&self, key: &str, problem: &str) -> Error {
        Error::Inconsistent {
            origin: self.origin.to_owned(),
            key: key.to_owned(),
            problem: problem.to_owned(),
        }
    }
}
