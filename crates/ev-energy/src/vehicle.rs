use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::battery::{Battery, BatterySpec};
use crate::check::Checker;
use crate::cycle::Cycle;
use crate::error::Error;
use crate::library;
use crate::loss_table::LossTable;
use crate::motor::{Motor, MotorSpec, RegenerationSpec};
use crate::road_load::{RoadLoad, RoadLoadSpec};
use crate::warm_up::WarmUpSpec;
use crate::weather::WeatherSpec;

/// A vehicle as its TOML file gives it; unchecked until it becomes a [`Vehicle`].
///
/// The keys of the file are the names of the fields, and no others are accepted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VehicleSpec {
    /// Short name.
    pub name: String,
    /// One line about the car and its data.
    pub description: String,
    /// Mass `m` with load, kg.
    pub mass_kg: f64,
    /// Inertia of all rotating parts at the wheel axle, `J`, kg m².
    pub rotating_inertia_kg_m2: f64,
    /// Dynamic wheel radius `r`, m.
    pub wheel_radius_m: f64,
    /// Motor turns per wheel turn `i`, 1.
    pub gear_ratio: f64,
    /// Efficiency of the gear `η`, 1.
    pub gear_efficiency: f64,
    /// Power of the auxiliaries `P_aux`, W; a trip may bring its own.
    pub auxiliary_power_w: f64,
    /// Resistance of road and air.
    pub road_load: RoadLoadSpec,
    /// Motor and inverter.
    pub motor: MotorSpec,
    /// Limits of regenerative braking.
    pub regeneration: RegenerationSpec,
    /// Battery.
    pub battery: BatterySpec,
    /// What the weather does to the road load.
    #[serde(default, skip_serializing_if = "WeatherSpec::is_default")]
    pub weather: WeatherSpec,
    /// What the car resists more after a cold start.
    #[serde(default, skip_serializing_if = "WarmUpSpec::is_default")]
    pub warm_up: WarmUpSpec,
    /// How good the vehicle is, if it was calibrated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub calibration: Option<CalibrationRecord>,
    /// Published consumption to hold the model against.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub consumption: Vec<Consumption>,
    /// Where values come from, by dotted key of a value or of a whole section.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub sources: BTreeMap<String, Source>,
}

/// Where a value of a vehicle file comes from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Publication, data set or reasoning.
    pub source: String,
    /// How far the value can be trusted.
    pub confidence: Confidence,
}

/// How far a value can be trusted, the most first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Confidence {
    /// From the maker or an authority.
    Certain,
    /// From press or trade publications.
    Published,
    /// Adjusted so that the model meets measurements.
    Fitted,
    /// An educated guess.
    Assumed,
}

/// What a calibration says of its vehicle: every trip was predicted once by a fit to the others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CalibrationRecord {
    /// Number of trips.
    pub trips: usize,
    /// Mean over the trips of the magnitude of the error of their terminal energy, %.
    pub held_out_mean_abs_error_pct: f64,
    /// Error of the terminal energy of all trips together, %.
    pub held_out_total_error_pct: f64,
    /// Median over the trips of the root mean square of the power's error, W.
    pub held_out_median_power_rmse_w: f64,
}

/// A published consumption.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Consumption {
    /// The driving cycle.
    pub cycle: Cycle,
    /// Energy from the wall, kWh per 100 km.
    pub wall_kwh_per_100km: f64,
    /// Whether values of the file were adjusted to it.
    #[serde(rename = "use")]
    pub purpose: ConsumptionUse,
    /// Where the figure comes from.
    pub source: String,
}

/// What a published consumption was used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ConsumptionUse {
    /// Values of the file were adjusted to it.
    Fitted,
    /// It was never looked at.
    HoldOut,
}

impl Confidence {
    /// In a word, as vehicle files give it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Certain => "certain",
            Self::Published => "published",
            Self::Fitted => "fitted",
            Self::Assumed => "assumed",
        }
    }
}

impl VehicleSpec {
    /// Reads a vehicle from TOML text; `file` names the text in errors.
    ///
    /// # Errors
    /// [`Error::Parse`] for anything that is not a complete vehicle.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, Error> {
        toml::from_str(text).map_err(|source| Error::Parse {
            file: file.to_owned(),
            source: Box::new(source),
        })
    }

    /// The temperature coefficient is in the file as soon as another value of its section is; says where the built-in one is from.
    pub(crate) fn add_weather_source(&mut self) {
        let (built_in, own) = (WeatherSpec::default(), &self.weather);
        let is_built_in = own.rolling_temperature_coefficient_per_k.to_bits()
            == built_in.rolling_temperature_coefficient_per_k.to_bits();
        if is_built_in && !own.is_default() && !self.sources.contains_key("weather") {
            self.sources
                .entry("weather.rolling_temperature_coefficient_per_k".to_owned())
                .or_insert_with(|| Source {
                    source: "UN GTR No. 15, annex 4, correction to reference conditions".to_owned(),
                    confidence: Confidence::Certain,
                });
        }
    }

    /// Writes the vehicle as TOML text that [`VehicleSpec::from_toml`] reads back unchanged.
    ///
    /// # Errors
    /// [`Error::Write`] where a value has no TOML form.
    pub fn to_toml(&self) -> Result<String, Error> {
        toml::to_string(self).map_err(|source| Error::Write {
            name: self.name.clone(),
            source,
        })
    }
}

/// Refuses sources of keys that the vehicle does not have.
fn check_sources(spec: &VehicleSpec, origin: &str) -> Result<(), Error> {
    let keys = toml::Table::try_from(spec).map_err(|source| Error::Write {
        name: spec.name.clone(),
        source,
    })?;
    let known = |key: &str| {
        let mut parts = key.split('.');
        let first = parts.next().and_then(|part| keys.get(part));
        parts.fold(first, |value, part| value?.get(part)).is_some()
    };
    match spec.sources.keys().find(|key| !known(key)) {
        None => Ok(()),
        Some(key) => Err(Error::UnknownSourceKey {
            origin: origin.to_owned(),
            key: key.clone(),
        }),
    }
}

/// A vehicle whose every parameter is present, finite and within its range.
///
/// The ranges are wide; they keep nonsense and overflow out.
#[derive(Debug, Clone, PartialEq)]
pub struct Vehicle {
    spec: VehicleSpec,
    pub(crate) effective_mass_kg: f64,
    pub(crate) motor_speed_per_mps: f64,
    pub(crate) propelling_n_per_nm: f64,
    pub(crate) braking_n_per_nm: f64,
    pub(crate) propelling_nm_per_n: f64,
    pub(crate) braking_nm_per_n: f64,
    pub(crate) road_load: RoadLoad,
    pub(crate) motor: Motor,
    pub(crate) battery: Battery,
}

impl Vehicle {
    /// Checks a vehicle.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a value outside its range, [`Error::UnknownSourceKey`] for a source
    /// of nothing.
    pub fn new(spec: VehicleSpec) -> Result<Self, Error> {
        let origin = format!("vehicle `{}`", spec.name);
        Self::checked(spec, &origin)
    }

    /// Reads and checks a vehicle from TOML text; `file` names the text in errors, and a loss table lies beside it.
    ///
    /// # Errors
    /// As [`VehicleSpec::from_toml`] and [`Vehicle::new`]; [`Error::Read`] and [`Error::LossTable`] for a loss table.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, Error> {
        let mut spec = VehicleSpec::from_toml(text, file)?;
        if let Some(losses) = &mut spec.motor.loss_table {
            let beside = Path::new(file).parent().unwrap_or(Path::new(""));
            let path = beside.join(&losses.file);
            losses.table = Some(LossTable::read(&path)?);
            // A vehicle that is written to another place still finds it.
            if let Ok(absolute) = std::path::absolute(&path) {
                losses.file = absolute.display().to_string();
            }
        }
        Self::checked(spec, file)
    }

    /// Reads and checks a vehicle file.
    ///
    /// # Errors
    /// [`Error::Read`], and as [`Vehicle::from_toml`].
    pub fn read(path: &Path) -> Result<Self, Error> {
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|source| Error::Read {
            file: file.clone(),
            source,
        })?;
        Self::from_toml(&text, &file)
    }

    /// A vehicle of the [`crate::library`], by name.
    ///
    /// # Errors
    /// [`Error::UnknownVehicle`], which lists the names there are.
    pub fn builtin(name: &str) -> Result<Self, Error> {
        Self::from_toml(library::text(name)?, name)
    }

    fn checked(spec: VehicleSpec, origin: &str) -> Result<Self, Error> {
        let check = Checker { origin };
        check_sources(&spec, origin)?;
        let mass_kg = check.range("mass_kg", spec.mass_kg, 1.0, 1e6)?;
        let inertia_kg_m2 = check.range(
            "rotating_inertia_kg_m2",
            spec.rotating_inertia_kg_m2,
            0.0,
            1e5,
        )?;
        let radius_m = check.range("wheel_radius_m", spec.wheel_radius_m, 0.05, 5.0)?;
        let ratio = check.range("gear_ratio", spec.gear_ratio, 0.1, 1000.0)?;
        let efficiency = check.range("gear_efficiency", spec.gear_efficiency, 0.1, 1.0)?;
        check.range("auxiliary_power_w", spec.auxiliary_power_w, 0.0, 1e6)?;
        spec.weather.check(&check)?;
        spec.warm_up.check(&check)?;
        if let Some(record) = &spec.calibration {
            for (key, value, min, max) in [
                (
                    "calibration.held_out_mean_abs_error_pct",
                    record.held_out_mean_abs_error_pct,
                    0.0,
                    1e6,
                ),
                (
                    "calibration.held_out_total_error_pct",
                    record.held_out_total_error_pct,
                    -1e6,
                    1e6,
                ),
                (
                    "calibration.held_out_median_power_rmse_w",
                    record.held_out_median_power_rmse_w,
                    0.0,
                    1e9,
                ),
            ] {
                check.range(key, value, min, max)?;
            }
        }
        for figure in &spec.consumption {
            check.range(
                "consumption.wall_kwh_per_100km",
                figure.wall_kwh_per_100km,
                0.1,
                1e4,
            )?;
        }
        // Thesis 2.7.
        let effective_mass_kg = mass_kg + inertia_kg_m2 / (radius_m * radius_m);
        let braking_n_per_nm = ratio / (radius_m * efficiency);
        Ok(Self {
            effective_mass_kg,
            motor_speed_per_mps: ratio / radius_m,
            propelling_n_per_nm: ratio * efficiency / radius_m,
            braking_n_per_nm,
            propelling_nm_per_n: radius_m / (ratio * efficiency),
            braking_nm_per_n: 1.0 / braking_n_per_nm,
            road_load: RoadLoad::new(&spec.road_load, mass_kg, &check)?,
            motor: Motor::new(
                &spec.motor,
                &spec.regeneration,
                effective_mass_kg / braking_n_per_nm,
                &check,
            )?,
            battery: Battery::new(&spec.battery, &check)?,
            spec,
        })
    }

    /// The same car, without a warm-up where it is `warm` at every start.
    #[must_use]
    pub fn started(mut self, warm: bool) -> Self {
        if warm {
            self.spec.warm_up = WarmUpSpec::default();
        }
        self
    }

    /// Whether it resists more after a cold start.
    #[must_use]
    pub fn warms_up(&self) -> bool {
        !self.spec.warm_up.is_default()
    }

    /// The same car with mass and road load of another vehicle.
    ///
    /// # Errors
    /// As [`Vehicle::new`].
    pub fn with_load_of(&self, other: &Self) -> Result<Self, Error> {
        Self::new(VehicleSpec {
            mass_kg: other.spec.mass_kg,
            road_load: other.spec.road_load.clone(),
            ..self.spec.clone()
        })
    }

    /// The parameters, as a file gives them.
    #[must_use]
    pub fn spec(&self) -> &VehicleSpec {
        &self.spec
    }

    /// Mass with the share of the rotating parts, `m_eff = m + J/r²` (thesis 2.7), in kg.
    #[must_use]
    pub fn effective_mass_kg(&self) -> f64 {
        self.effective_mass_kg
    }

    /// The motor.
    #[must_use]
    pub fn motor(&self) -> &Motor {
        &self.motor
    }

    /// The battery.
    #[must_use]
    pub fn battery(&self) -> &Battery {
        &self.battery
    }
}
