use serde::{Deserialize, Serialize};

use crate::GRAVITY_MPS2;
use crate::check::Checker;
use crate::error::Error;
use crate::weather::{Weather, WeatherSpec};

/// Road load as a vehicle file gives it: by coefficients or by coast-down.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum RoadLoadSpec {
    /// `F_roll = c_r m g cos θ`, `F_air = ½ ρ c_w A v²` (thesis 2.3 and 2.4; corrected: forces, not
    /// torques).
    Coefficients {
        /// Rolling resistance coefficient `c_r`, 1.
        rolling_coefficient: f64,
        /// Drag area `c_w A`, m².
        drag_area_m2: f64,
        /// Air density `ρ`, kg/m³.
        air_density_kg_per_m3: f64,
    },
    /// `F_roll + F_air = A cos θ + B v + C v²`, the coast-down form of type approval.
    CoastDown {
        /// `A`, N.
        constant_n: f64,
        /// `B`, N/(m/s); may be negative.
        linear_n_per_mps: f64,
        /// `C`, N/(m/s)².
        quadratic_n_per_mps2: f64,
    },
}

/// Air density of coast-down figures: 20 °C and 98.21 kPa, to which SAE J1263 corrects them, kg/m³.
const COAST_DOWN_AIR_DENSITY_KG_PER_M3: f64 = 1.1671;

/// Checked road load, `A cos θ + B v + C v²` in either form.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RoadLoad {
    pub(crate) constant_n: f64,
    pub(crate) linear_n_per_mps: f64,
    pub(crate) quadratic_n_per_mps2: f64,
    /// Density of the air for which the quadratic term holds.
    air_density_kg_per_m3: f64,
}

impl RoadLoad {
    pub(crate) fn new(spec: &RoadLoadSpec, mass_kg: f64, check: &Checker) -> Result<Self, Error> {
        match *spec {
            RoadLoadSpec::Coefficients {
                rolling_coefficient,
                drag_area_m2,
                air_density_kg_per_m3,
            } => {
                check.range(
                    "road_load.coefficients.rolling_coefficient",
                    rolling_coefficient,
                    0.0,
                    1.0,
                )?;
                check.range(
                    "road_load.coefficients.drag_area_m2",
                    drag_area_m2,
                    0.0,
                    100.0,
                )?;
                check.range(
                    "road_load.coefficients.air_density_kg_per_m3",
                    air_density_kg_per_m3,
                    0.1,
                    10.0,
                )?;
                Ok(Self {
                    constant_n: rolling_coefficient * mass_kg * GRAVITY_MPS2,
                    linear_n_per_mps: 0.0,
                    quadratic_n_per_mps2: 0.5 * air_density_kg_per_m3 * drag_area_m2,
                    air_density_kg_per_m3,
                })
            }
            RoadLoadSpec::CoastDown {
                constant_n,
                linear_n_per_mps,
                quadratic_n_per_mps2,
            } => {
                check.range("road_load.coast_down.constant_n", constant_n, 0.0, 1e5)?;
                check.range(
                    "road_load.coast_down.linear_n_per_mps",
                    linear_n_per_mps,
                    -1e4,
                    1e4,
                )?;
                check.range(
                    "road_load.coast_down.quadratic_n_per_mps2",
                    quadratic_n_per_mps2,
                    0.0,
                    1e3,
                )?;
                Ok(Self {
                    constant_n,
                    linear_n_per_mps,
                    quadratic_n_per_mps2,
                    air_density_kg_per_m3: COAST_DOWN_AIR_DENSITY_KG_PER_M3,
                })
            }
        }
    }

    /// The road load in other weather: `A` and `B` times the factor of rolling resistance, `C` with the density of the air.
    pub(crate) fn under(&self, weather: &Weather, spec: &WeatherSpec) -> Self {
        let rolling = spec.rolling_factor(weather.temperature_degc);
        Self {
            constant_n: rolling * self.constant_n,
            linear_n_per_mps: rolling * self.linear_n_per_mps,
            quadratic_n_per_mps2: self.quadratic_n_per_mps2
                * (weather.air_density_kg_per_m3() / self.air_density_kg_per_m3),
            air_density_kg_per_m3: weather.air_density_kg_per_m3(),
        }
    }

    /// Rolling resistance in N at a speed of at least 0: `A cos θ`, and 0 at standstill.
    #[inline]
    pub(crate) fn rolling_n(&self, speed_mps: f64, cos_slope: f64) -> f64 {
        if speed_mps > 0.0 {
            self.constant_n * cos_slope
        } else {
            0.0
        }
    }

    /// Speed-dependent resistance in N at a speed of at least 0: `B v + C v²`.
    #[inline]
    pub(crate) fn aero_n(&self, speed_mps: f64) -> f64 {
        (self.linear_n_per_mps + self.quadratic_n_per_mps2 * speed_mps) * speed_mps
    }
}

#[cfg(test)]
#[allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp
)]
mod tests {
    use super::*;

    const CHECK: Checker = Checker { origin: "test" };

    #[test]
    fn both_forms_agree_where_they_say_the_same() {
        let (mass_kg, density, area) = (1500.0, 1.2, 0.7);
        let coefficients = RoadLoadSpec::Coefficients {
            rolling_coefficient: 0.01,
            drag_area_m2: area,
            air_density_kg_per_m3: density,
        };
        let coast_down = RoadLoadSpec::CoastDown {
            constant_n: 0.01 * mass_kg * GRAVITY_MPS2,
            linear_n_per_mps: 0.0,
            quadratic_n_per_mps2: 0.5 * density * area,
        };
        let road_load = |spec| RoadLoad::new(spec, mass_kg, &CHECK).unwrap();
        let (by_coefficients, by_coast_down) = (road_load(&coefficients), road_load(&coast_down));
        for v in [1.0, 13.0, 40.0] {
            assert_eq!(
                by_coefficients.rolling_n(v, 0.9),
                by_coast_down.rolling_n(v, 0.9)
            );
            assert_eq!(by_coefficients.aero_n(v), by_coast_down.aero_n(v));
        }
    }

    #[test]
    fn nothing_rolls_at_standstill() {
        let spec = RoadLoadSpec::CoastDown {
            constant_n: 140.0,
            linear_n_per_mps: -1.0,
            quadratic_n_per_mps2: 0.4,
        };
        let road_load = RoadLoad::new(&spec, 1500.0, &CHECK).unwrap();
        assert_eq!(
            (road_load.rolling_n(0.0, 1.0), road_load.aero_n(0.0)),
            (0.0, 0.0)
        );
        assert_eq!(
            (road_load.rolling_n(10.0, 0.5), road_load.aero_n(10.0)),
            (70.0, 30.0)
        );
    }
}
