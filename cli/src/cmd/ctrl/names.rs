//! Values of flags by the names that a library gives them.

use std::error::Error;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use strum::{EnumMessage, VariantArray};

/// One of the names of an enum; what its variants' documentation says is the help.
pub(super) fn named<T>() -> impl TypedValueParser<Value = T>
where
    T: Copy + EnumMessage + FromStr + Into<&'static str> + Send + Sync + VariantArray + 'static,
    T::Err: Error + Send + Sync,
{
    let value = |variant: &T| {
        let help = variant.get_documentation().unwrap_or_default();
        PossibleValue::new((*variant).into()).help(help)
    };
    PossibleValuesParser::new(T::VARIANTS.iter().map(value)).try_map(|name| T::from_str(&name))
}
