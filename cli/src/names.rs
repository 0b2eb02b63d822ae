//! Values of flags by the names that a library gives them.

use std::error::Error;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use drive_sim::SimulatedDriver;
use driver_model::{ModelKind, Subject};
use serde::Serializer;
use strum::{EnumMessage, VariantArray};

/// One of the names of an enum; its messages are the help, or else its documentation.
pub(crate) fn named<T>() -> impl TypedValueParser<Value = T>
where
    T: Copy + EnumMessage + FromStr + Into<&'static str> + Send + Sync + VariantArray + 'static,
    T::Err: Error + Send + Sync,
{
    one_of(T::VARIANTS.iter().copied())
}

/// Whatever can be fitted.
pub(crate) fn fitted_model() -> impl TypedValueParser<Value = ModelKind> {
    let all = ModelKind::VARIANTS.iter().copied();
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

fn one_of<T>(variants: impl Iterator<Item = T>) -> impl TypedValueParser<Value = T>
where
    T: Copy + EnumMessage + FromStr + Into<&'static str> + Send + Sync + 'static,
    T::Err: Error + Send + Sync,
{
    let value = |variant: T| {
        let help = variant
            .get_message()
            .or(variant.get_documentation())
            .unwrap_or_default();
        PossibleValue::new(variant.into()).help(help)
    };
    PossibleValuesParser::new(variants.map(value)).try_map(|name| T::from_str(&name))
}

/// The name of a variant in a document.
pub(crate) fn name<T, S>(variant: &T, serializer: S) -> Result<S::Ok, S::Error>
where
    T: Copy + Into<&'static str>,
    S: Serializer,
{
    serializer.serialize_str((*variant).into())
}

/// The same of one that may be missing.
pub(crate) fn optional_name<T, S>(variant: &Option<T>, serializer: S) -> Result<S::Ok, S::Error>
where
    T: Copy + Into<&'static str>,
    S: Serializer,
{
    match variant {
        Some(variant) => name(variant, serializer),
        None => serializer.serialize_none(),
    }
}
