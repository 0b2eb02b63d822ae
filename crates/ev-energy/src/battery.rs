use serde::{Deserialize, Serialize};

use crate::check::Checker;
use crate::error::Error;

/// Battery section of a vehicle file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BatterySpec {
    /// Open-circuit voltage `U0`, V.
    pub open_circuit_voltage_v: f64,
    /// Internal resistance `R`, Ω.
    pub resistance_ohm: f64,
    /// Energy into the cells per energy from the wall, 1.
    pub charging_efficiency: f64,
}

/// Battery as a voltage source behind a resistance (thesis figure 2.3).
#[derive(Debug, Clone, PartialEq)]
pub struct Battery {
    open_circuit_voltage_v: f64,
    resistance_ohm: f64,
    max_power_w: f64,
}

/// What a battery does under an electric power demand. Discharging is positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BatteryDraw {
    /// Current `I`, A.
    pub current_a: f64,
    /// Power inside the cells, `I U0` (thesis 2.12), W.
    pub power_w: f64,
    /// Power at the terminals, W: the demand, or `U0²/4R` where the demand is more.
    pub terminal_power_w: f64,
    /// Ohmic loss `I² R = power_w − terminal_power_w`, W.
    pub loss_w: f64,
    /// Whether the demand exceeds `U0²/4R`.
    pub limited: bool,
}

impl Battery {
    pub(crate) fn new(spec: &BatterySpec, check: &Checker) -> Result<Self, Error> {
        let voltage_v = check.range(
            "battery.open_circuit_voltage_v",
            spec.open_circuit_voltage_v,
            1.0,
            1e4,
        )?;
        let resistance_ohm =
            check.range("battery.resistance_ohm", spec.resistance_ohm, 0.0, 100.0)?;
        check.range(
            "battery.charging_efficiency",
            spec.charging_efficiency,
            0.1,
            1.0,
        )?;
        Ok(Self {
            open_circuit_voltage_v: voltage_v,
            resistance_ohm,
            // Infinite without resistance: such a battery is never limited.
            max_power_w: voltage_v * voltage_v / (4.0 * resistance_ohm),
        })
    }

    /// Largest power the battery can give at its terminals, `U0²/4R`, in W.
    #[must_use]
    pub fn max_power_w(&self) -> f64 {
        self.max_power_w
    }

    /// Current and power for a demand at the terminals in W, negative when charging.
    ///
    /// `I = 2P / (U0 + sqrt(U0² − 4 R P))` with `P ≤ U0²/4R` (thesis 2.11; corrected: the printed
    /// form cancels for small `P` and has no value above the limit).
    #[must_use]
    #[inline]
    pub fn draw(&self, electric_power_w: f64) -> BatteryDraw {
        let voltage_v = self.open_circuit_voltage_v;
        let terminal_power_w = electric_power_w.min(self.max_power_w);
        let discriminant = voltage_v * voltage_v - 4.0 * self.resistance_ohm * terminal_power_w;
        let current_a = terminal_power_w / (0.5 * (voltage_v + discriminant.max(0.0).sqrt()));
        BatteryDraw {
            current_a,
            power_w: current_a * voltage_v,
            terminal_power_w,
            loss_w: current_a * current_a * self.resistance_ohm,
            limited: electric_power_w > self.max_power_w,
        }
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

    fn battery(resistance_ohm: f64) -> Battery {
        let spec = BatterySpec {
            open_circuit_voltage_v: 300.0,
            resistance_ohm,
            charging_efficiency: 0.9,
        };
        Battery::new(&spec, &Checker { origin: "test" }).unwrap()
    }

    #[test]
    fn without_resistance_nothing_is_lost_or_limited() {
        let draw = battery(0.0).draw(1e6);
        assert_eq!((draw.power_w, draw.loss_w, draw.limited), (1e6, 0.0, false));
    }

    #[test]
    fn charging_stores_less_than_it_takes() {
        let draw = battery(0.1).draw(-50e3);
        assert!(draw.current_a < 0.0 && draw.power_w > -50e3 && draw.loss_w > 0.0);
        assert!((draw.power_w - draw.terminal_power_w - draw.loss_w).abs() < 1e-9);
    }

    #[test]
    fn at_the_limit_half_of_the_power_is_lost() {
        let battery = battery(0.1);
        assert_eq!(battery.max_power_w(), 225e3);
        let (at, beyond) = (battery.draw(225e3), battery.draw(300e3));
        assert!(!at.limited && beyond.limited);
        assert_eq!(at.power_w, beyond.power_w);
        assert!((at.loss_w - 225e3).abs() < 1e-6);
    }
}
