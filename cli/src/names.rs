//! Names of models on the command line.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use drive_sim::SimulatedDriver;
use driver_model::{ModelKind, Subject};

/// Whatever can be fitted.
pub(crate) fn fitted_model() -> impl TypedValueParser<Value = ModelKind> {
    let subjects = [
        Subject::Phases,
        Subject::Cruise,
        Subject::Following,
        Subject::SpeedAhead,
        Subject::Trips,
    ];
    let all = subjects.into_iter().flat_map(ModelKind::of);
    one_of(all.filter(|kind| kind.subject() != Subject::SpeedAhead || kind.is_fitted()))
}

/// A model that `evaluate` compares.
pub(crate) fn evaluated_model() -> impl TypedValueParser<Value = ModelKind> {
    one_of(ModelKind::of(Subject::Phases).chain(ModelKind::of(Subject::SpeedAhead)))
}

/// A model that simulated drivers accelerate by.
pub(crate) fn simulated_model() -> impl TypedValueParser<Value = ModelKind> {
    one_of(SimulatedDriver::KINDS.into_iter())
}

fn one_of(kinds: impl Iterator<Item = ModelKind>) -> impl TypedValueParser<Value = ModelKind> {
    PossibleValuesParser::new(kinds.map(ModelKind::name)).try_map(|name| name.parse::<ModelKind>())
}
