use serde::{Deserialize, Serialize};

use crate::check::{Checker, argument};
use crate::error::Error;

/// Temperature to which road loads refer, °C.
const REFERENCE_DEGC: f64 = 20.0;

/// From here down a road is fully wintry, °C: below 7 °C winter tyres are recommended.
const WINTER_DEGC: f64 = 7.0;

/// From here up it is not wintry at all, °C.
pub(crate) const SUMMER_DEGC: f64 = 15.0;

/// Weather section of a vehicle file: what rolling resistance does with the temperature.
///
/// ```text
/// rolling resistance · (1 + k (20 °C − T)) · (1 + w · winter(T))       winter: 1 below 7 °C, 0 above 15 °C, linear between
/// ```
///
/// The first factor is that of type approval (UN GTR No. 15, annex 4, 4.5.2). The second is for what comes with
/// the season rather than with the temperature, winter tyres and wet roads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WeatherSpec {
    /// `k`, 1/K.
    pub rolling_temperature_coefficient_per_k: f64,
    /// `w`, 1.
    pub winter_rolling_surcharge: f64,
}

impl Default for WeatherSpec {
    /// The coefficient of type approval and no surcharge.
    fn default() -> Self {
        Self {
            rolling_temperature_coefficient_per_k: 8.6e-3,
            winter_rolling_surcharge: 0.0,
        }
    }
}

impl WeatherSpec {
    pub(crate) fn is_default(&self) -> bool {
        *self == Self::default()
    }

    pub(crate) fn check(&self, check: &Checker) -> Result<(), Error> {
        check.range(
            "weather.rolling_temperature_coefficient_per_k",
            self.rolling_temperature_coefficient_per_k,
            0.0,
            0.02,
        )?;
        check.range(
            "weather.winter_rolling_surcharge",
            self.winter_rolling_surcharge,
            0.0,
            3.0,
        )?;
        Ok(())
    }

    pub(crate) fn rolling_factor(&self, temperature_degc: f64) -> f64 {
        let winter =
            ((SUMMER_DEGC - temperature_degc) / (SUMMER_DEGC - WINTER_DEGC)).clamp(0.0, 1.0);
        let cooler_k = REFERENCE_DEGC - temperature_degc;
        (1.0 + self.rolling_temperature_coefficient_per_k * cooler_k).max(0.0)
            * (1.0 + self.winter_rolling_surcharge * winter)
    }
}

/// Weather of a trip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Weather {
    /// Temperature of the air, −90 to 70 °C.
    pub temperature_degc: f64,
    /// Elevation above sea level, −500 to 10,000 m.
    pub elevation_m: f64,
}

impl Weather {
    pub(crate) fn check(&self) -> Result<(), Error> {
        argument("temperature_degc", self.temperature_degc, -90.0, 70.0)?;
        argument("elevation_m", self.elevation_m, -500.0, 1e4)
    }

    /// Density of dry air at the pressure of the standard atmosphere (ISO 2533), kg/m³.
    #[must_use]
    pub fn air_density_kg_per_m3(&self) -> f64 {
        let pressure_pa = 101_325.0 * (1.0 - 2.255_77e-5 * self.elevation_m).powf(5.255_88);
        pressure_pa / (287.05 * (self.temperature_degc + 273.15))
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn air_has_the_density_of_the_standard_atmosphere() {
        for (temperature_degc, elevation_m, density) in [
            (15.0, 0.0, 1.2250),
            (8.501, 1000.0, 1.1117),
            (2.004, 2000.0, 1.0066),
        ] {
            let weather = Weather {
                temperature_degc,
                elevation_m,
            };
            assert!((weather.air_density_kg_per_m3() - density).abs() < 2e-4);
        }
    }

    #[test]
    fn cold_roads_resist_more() {
        let spec = WeatherSpec {
            winter_rolling_surcharge: 0.5,
            ..WeatherSpec::default()
        };
        assert_eq!(spec.rolling_factor(20.0), 1.0);
        assert!((spec.rolling_factor(10.0) - 1.086 * 1.3125).abs() < 1e-12);
        assert!((spec.rolling_factor(0.0) - 1.172 * 1.5).abs() < 1e-12);
        assert!(spec.rolling_factor(30.0) < 1.0);
    }
}
