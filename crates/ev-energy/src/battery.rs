use serde::{Deserialize, Serialize};

use crate::check::Checker;
use crate::error::Error;
use crate::scalar::{larger, smaller};

/// Battery section of a vehicle file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BatterySpec {
    /// Open-circuit voltage `U0`, V: of every trip without a state of charge, or without a curve.
    pub open_circuit_voltage_v: f64,
    /// Internal resistance `R`, Ω.
    pub resistance_ohm: f64,
    /// Energy into the cells per energy from the wall, 1.
    pub charging_efficiency: f64,
    /// Charge between empty and full, A h; with it the state of charge is tracked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capacity_ah: Option<f64>,
    /// `U0` over the state of charge; needs the capacity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub open_circuit_voltage_curve: Option<VoltageCurveSpec>,
}

/// Open-circuit voltage over the state of charge, linear between its points and constant beyond.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VoltageCurveSpec {
    /// States of charge, strictly increasing, 0 to 100, %.
    pub soc_pct: Vec<f64>,
    /// Voltages at these, never decreasing, V.
    pub voltage_v: Vec<f64>,
}

/// Battery as a voltage source behind a resistance (thesis figure 2.3).
#[derive(Debug, Clone, PartialEq)]
pub struct Battery {
    nominal: Cells,
    resistance_ohm: f64,
    /// State of charge per charge given, %/(A s).
    pct_per_as: Option<f64>,
    curve: Option<VoltageCurveSpec>,
}

/// The cells at one state of charge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cells {
    voltage_v: f64,
    max_power_w: f64,
}

/// A piece of the voltage curve, from one point to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct VoltagePiece {
    from_pct: f64,
    to_pct: f64,
    from_v: f64,
    v_per_pct: f64,
    /// `1/4R`.
    per_four_ohm: f64,
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
        if let Some(curve) = &spec.open_circuit_voltage_curve {
            curve.check(check)?;
        }
        let capacity_ah = spec
            .capacity_ah
            .map(|capacity_ah| check.range("battery.capacity_ah", capacity_ah, 0.1, 1e5))
            .transpose()?;
        if capacity_ah.is_none() && spec.open_circuit_voltage_curve.is_some() {
            return Err(check.problem(
                "battery.capacity_ah",
                "is missing; a voltage curve needs it to follow the state of charge",
            ));
        }
        Ok(Self {
            nominal: Cells::new(voltage_v, 0.25 / resistance_ohm),
            resistance_ohm,
            pct_per_as: capacity_ah.map(|capacity_ah| 100.0 / (3600.0 * capacity_ah)),
            curve: spec.open_circuit_voltage_curve.clone(),
        })
    }

    /// Largest power the battery can give at its terminals, `U0²/4R`, in W.
    #[must_use]
    pub fn max_power_w(&self) -> f64 {
        self.nominal.max_power_w
    }

    /// Current and power for a demand at the terminals in W, negative when charging.
    ///
    /// `I = 2P / (U0 + sqrt(U0² − 4 R P))` with `P ≤ U0²/4R` (thesis 2.11; corrected: the printed
    /// form cancels for small `P` and has no value above the limit).
    #[must_use]
    #[inline]
    pub fn draw(&self, electric_power_w: f64) -> BatteryDraw {
        self.draw_from(&self.nominal, electric_power_w)
    }

    #[inline(always)]
    pub(crate) fn draw_from(&self, cells: &Cells, electric_power_w: f64) -> BatteryDraw {
        let voltage_v = cells.voltage_v;
        let terminal_power_w = smaller(electric_power_w, cells.max_power_w);
        let discriminant = voltage_v * voltage_v - 4.0 * self.resistance_ohm * terminal_power_w;
        let current_a = terminal_power_w / (0.5 * (voltage_v + larger(discriminant, 0.0).sqrt()));
        BatteryDraw {
            current_a,
            power_w: current_a * voltage_v,
            terminal_power_w,
            loss_w: current_a * current_a * self.resistance_ohm,
            limited: electric_power_w > cells.max_power_w,
        }
    }

    /// The cells at nominal voltage.
    pub(crate) fn nominal(&self) -> Cells {
        self.nominal
    }

    /// The piece of the voltage curve at a state of charge in %; `None` without a curve.
    pub(crate) fn piece(&self, soc_pct: f64) -> Option<VoltagePiece> {
        let (from_pct, to_pct, from_v, v_per_pct) = self.curve.as_ref()?.piece(soc_pct)?;
        Some(VoltagePiece {
            from_pct,
            to_pct,
            from_v,
            v_per_pct,
            per_four_ohm: 0.25 / self.resistance_ohm,
        })
    }

    /// The state of charge in % after giving a charge in A s, within 0 to 100; `None` without a capacity.
    #[inline(always)]
    pub(crate) fn discharged_pct(&self, soc_pct: f64, charge_as: f64) -> Option<f64> {
        let soc_pct = soc_pct - self.pct_per_as? * charge_as;
        Some(smaller(larger(soc_pct, 0.0), 100.0))
    }
}

impl Cells {
    pub(crate) fn voltage_v(&self) -> f64 {
        self.voltage_v
    }

    #[inline(always)]
    fn new(voltage_v: f64, per_four_ohm: f64) -> Self {
        Self {
            voltage_v,
            // Infinite without resistance: such a battery is never limited.
            max_power_w: voltage_v * voltage_v * per_four_ohm,
        }
    }
}

impl VoltagePiece {
    /// Whether the piece goes on to a state of charge in %.
    #[inline(always)]
    pub(crate) fn covers(&self, soc_pct: f64) -> bool {
        self.from_pct <= soc_pct && soc_pct <= self.to_pct
    }

    /// The cells at a state of charge in % that the piece covers.
    #[inline(always)]
    pub(crate) fn cells(&self, soc_pct: f64) -> Cells {
        let voltage_v = self.from_v + self.v_per_pct * (soc_pct - self.from_pct);
        Cells::new(voltage_v, self.per_four_ohm)
    }
}

impl VoltageCurveSpec {
    const SOC_KEY: &str = "battery.open_circuit_voltage_curve.soc_pct";
    const VOLTAGE_KEY: &str = "battery.open_circuit_voltage_curve.voltage_v";

    fn check(&self, check: &Checker) -> Result<(), Error> {
        if self.soc_pct.len() < 2 || self.soc_pct.len() != self.voltage_v.len() {
            let problem = format!(
                "has {} points and `voltage_v` has {}; give two or more, and as many of each",
                self.soc_pct.len(),
                self.voltage_v.len()
            );
            return Err(check.problem(Self::SOC_KEY, &problem));
        }
        for (&soc_pct, &voltage_v) in self.soc_pct.iter().zip(&self.voltage_v) {
            check.range(Self::SOC_KEY, soc_pct, 0.0, 100.0)?;
            check.range(Self::VOLTAGE_KEY, voltage_v, 1.0, 1e4)?;
        }
        if !self.soc_pct.is_sorted_by(|a, b| a < b) {
            return Err(check.problem(Self::SOC_KEY, "must increase from point to point"));
        }
        if !self.voltage_v.is_sorted() {
            return Err(check.problem(Self::VOLTAGE_KEY, "must not fall from point to point"));
        }
        Ok(())
    }

    /// The piece at a state of charge within 0 to 100 %: from where, to where, voltage at its start, its slope. Constant before the
    /// first point and after the last.
    fn piece(&self, soc_pct: f64) -> Option<(f64, f64, f64, f64)> {
        let end = self.soc_pct.partition_point(|soc| *soc <= soc_pct);
        let point = |k: usize| Some((*self.soc_pct.get(k)?, *self.voltage_v.get(k)?));
        match (end.checked_sub(1).and_then(point), point(end)) {
            (Some((from, from_v)), Some((to, to_v))) => {
                Some((from, to, from_v, (to_v - from_v) / (to - from)))
            }
            (None, Some((first, first_v))) => Some((0.0, first, first_v, 0.0)),
            (Some((last, last_v)), None) => Some((last, 100.0, last_v, 0.0)),
            (None, None) => None,
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
            capacity_ah: None,
            open_circuit_voltage_curve: None,
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

    fn with_curve(soc_pct: &[f64], voltage_v: &[f64]) -> Result<Battery, Error> {
        let spec = BatterySpec {
            open_circuit_voltage_v: 300.0,
            resistance_ohm: 0.1,
            charging_efficiency: 0.9,
            capacity_ah: Some(50.0),
            open_circuit_voltage_curve: Some(VoltageCurveSpec {
                soc_pct: soc_pct.to_vec(),
                voltage_v: voltage_v.to_vec(),
            }),
        };
        Battery::new(&spec, &Checker { origin: "test" })
    }

    #[test]
    fn voltage_follows_the_curve_and_stays_at_its_ends() {
        let battery = with_curve(&[10.0, 50.0, 90.0], &[300.0, 340.0, 360.0]).unwrap();
        let voltage = |soc| battery.piece(soc).unwrap().cells(soc).voltage_v;
        assert_eq!(
            [0.0, 10.0, 30.0, 50.0, 70.0, 90.0, 100.0].map(voltage),
            [300.0, 300.0, 320.0, 340.0, 350.0, 360.0, 360.0]
        );
        assert_eq!(battery.nominal().voltage_v, 300.0);
        assert!((0..=100).all(|soc| {
            let soc = f64::from(soc);
            battery.piece(soc).unwrap().covers(soc)
        }));
    }

    #[test]
    fn charge_is_counted_and_bounded() {
        let battery = with_curve(&[0.0, 100.0], &[300.0, 400.0]).unwrap();
        assert_eq!(battery.discharged_pct(50.0, 50.0 * 360.0), Some(40.0));
        assert_eq!(battery.discharged_pct(0.5, 1e6), Some(0.0));
        assert_eq!(battery.discharged_pct(99.0, -1e6), Some(100.0));
    }

    #[test]
    fn bad_curves_name_their_key() {
        for (soc, voltage, key) in [
            (&[0.0][..], &[300.0][..], "soc_pct"),
            (&[0.0, 100.0], &[300.0], "soc_pct"),
            (&[50.0, 50.0], &[300.0, 310.0], "soc_pct"),
            (&[0.0, 120.0], &[300.0, 310.0], "soc_pct"),
            (&[0.0, 100.0], &[310.0, 300.0], "voltage_v"),
            (&[0.0, 100.0], &[310.0, f64::NAN], "voltage_v"),
        ] {
            let error = with_curve(soc, voltage).unwrap_err().to_string();
            assert!(error.contains(key), "{error}");
        }
    }
}
