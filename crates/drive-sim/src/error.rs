use std::ops::RangeInclusive;

/// Why nothing can be simulated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting is out of its range.
    #[error("{name} = {value} is not usable: {expected}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What is accepted, in words.
        expected: &'static str,
    },
    /// From the driver's acceleration model.
    #[error(transparent)]
    Model(#[from] driver_model::Error),
    /// From the drive log.
    #[error(transparent)]
    Log(#[from] drive_log::Error),
    /// From the vehicle model.
    #[error(transparent)]
    Energy(#[from] ev_energy::Error),
}

pub(crate) fn check(
    name: &'static str,
    value: f64,
    range: RangeInclusive<f64>,
    expected: &'static str,
) -> Result<(), Error> {
    if range.contains(&value) {
        return Ok(());
    }
    Err(Error::Setting {
        name,
        value,
        expected,
    })
}
