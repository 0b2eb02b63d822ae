//! The vehicle of commands that need one beside other things.

use clap::Args;
use ev_energy::Vehicle;
use serde::{Serialize, Serializer};

use super::phases::vehicle;
use crate::flags::Context;
use crate::output;

/// Taken where none is named.
const DEFAULT: &str = "b250e";

#[derive(Debug, Clone, Args, Serialize)]
pub(crate) struct VehicleArg {
    /// Vehicle for energies: a built-in name or a TOML file [default: b250e]
    #[arg(long, value_name = "NAME|FILE")]
    #[serde(serialize_with = "or_default")]
    vehicle: Option<String>,
}

fn or_default<S: Serializer>(vehicle: &Option<String>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(vehicle.as_deref().unwrap_or(DEFAULT))
}

impl VehicleArg {
    pub(crate) fn read(&self) -> anyhow::Result<Vehicle> {
        vehicle(self.name())
    }

    pub(crate) fn name(&self) -> &str {
        self.vehicle.as_deref().unwrap_or(DEFAULT)
    }

    /// The vehicle that was taken because none was named.
    pub(crate) fn by_default(&self) -> Option<&'static str> {
        self.vehicle.is_none().then_some(DEFAULT)
    }

    /// With its name, and that nobody asked for it.
    pub(crate) fn words(&self) -> String {
        match self.by_default() {
            Some(name) => format!("{name}, taken by default"),
            None => self.name().to_owned(),
        }
    }

    /// Says which vehicle is taken where none was named.
    pub(crate) fn mention(&self, context: &Context) {
        if let Some(name) = self.by_default() {
            output::note(
                context,
                &format!("no --vehicle: energies are those of the built-in `{name}`"),
            );
        }
    }
}
