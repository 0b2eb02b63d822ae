use serde::{Deserialize, Serialize};

use crate::check::Checker;
use crate::error::Error;
use crate::vehicle::{Confidence, Source, VehicleSpec};

/// Temperature to which the force refers, °C, and the one by which colder air is measured, K.
const REFERENCE_DEGC: f64 = 20.0;
const COLDER_K: f64 = 20.0;

/// What a section that gives a force and no decay has, s.
const DECAY_S: f64 = 150.0;

/// Warm-up section of a vehicle file: what gear, bearings and tyres resist more after a cold start, while the car moves.
///
/// ```text
/// max(0, force + cold rise · (20 °C − T)/20 K) · exp(−t / decay)       T of the air, t since the start
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WarmUpSpec {
    /// At the start at 20 °C, N.
    pub force_n: f64,
    /// More of it at 0 °C, N.
    pub cold_rise_n: f64,
    /// Time in which it falls to 37 %, s.
    pub decay_s: f64,
}

impl Default for WarmUpSpec {
    /// None.
    fn default() -> Self {
        Self {
            force_n: 0.0,
            cold_rise_n: 0.0,
            decay_s: DECAY_S,
        }
    }
}

impl WarmUpSpec {
    /// Whether it is that of a vehicle file without the section.
    #[must_use]
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    pub(crate) fn check(&self, check: &Checker) -> Result<(), Error> {
        check.range("warm_up.force_n", self.force_n, 0.0, 1e4)?;
        check.range("warm_up.cold_rise_n", self.cold_rise_n, 0.0, 1e4)?;
        check.range("warm_up.decay_s", self.decay_s, 1.0, 1e5)?;
        Ok(())
    }

    /// Force in N, so long after a cold start in air of this temperature.
    #[must_use]
    pub fn force_at_n(&self, since_start_s: f64, temperature_degc: f64) -> f64 {
        let colder = (REFERENCE_DEGC - temperature_degc) / COLDER_K;
        let start_n = (self.force_n + self.cold_rise_n * colder).max(0.0);
        start_n * (-since_start_s / self.decay_s).exp()
    }
}

impl VehicleSpec {
    /// Says where what is not fitted of a warm-up is from.
    pub(crate) fn add_warm_up_source(&mut self) {
        if !self.warm_up.is_default() {
            let source = || Source {
                source: "decay of 2.5 min, that of recorded trips of a BMW i3; not fitted here"
                    .to_owned(),
                confidence: Confidence::Assumed,
            };
            let key = "warm_up".to_owned();
            self.sources.entry(key).or_insert_with(source);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_force_is_larger_in_the_cold_and_falls_with_time() {
        let spec = WarmUpSpec {
            force_n: 160.0,
            cold_rise_n: 100.0,
            decay_s: 150.0,
        };
        for (since_start_s, temperature_degc, force_n) in [
            (0.0, 20.0, 160.0),
            (0.0, 0.0, 260.0),
            (0.0, 60.0, 0.0),
            (150.0, 20.0, 160.0 / std::f64::consts::E),
            (1e9, 0.0, 0.0),
        ] {
            let off = spec.force_at_n(since_start_s, temperature_degc) - force_n;
            assert!(off.abs() < 1e-9, "{since_start_s} {temperature_degc}");
        }
        assert!(WarmUpSpec::default().is_default());
        assert!(WarmUpSpec::default().force_at_n(0.0, -20.0).abs() < 1e-12);
    }
}
