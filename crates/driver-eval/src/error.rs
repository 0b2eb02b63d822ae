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
