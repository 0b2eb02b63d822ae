//! Units that headers and layouts may name, and their conversion to SI.

use std::fmt;

/// What a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quantity {
    Time,
    Speed,
    Acceleration,
    Slope,
    Length,
    Voltage,
    Current,
    Share,
    Torque,
    Power,
    Temperature,
    Position,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Conversion {
    /// `x · numerator / denominator`: a division keeps km/h exact to the last bit.
    Ratio(f64, f64),
    /// `atan(x / denominator)`: a gradient, rise over run.
    Gradient(f64),
    /// `(x − offset) · numerator / denominator`.
    Offset(f64, f64, f64),
}

/// A unit of one quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unit {
    quantity: Quantity,
    /// The suffix in canonical headers.
    suffix: &'static str,
    /// As people write it.
    symbol: &'static str,
    conversion: Conversion,
}

const fn ratio(
    quantity: Quantity,
    suffix: &'static str,
    symbol: &'static str,
    numerator: f64,
    denominator: f64,
) -> Unit {
    Unit {
        quantity,
        suffix,
        symbol,
        conversion: Conversion::Ratio(numerator, denominator),
    }
}

const fn gradient(suffix: &'static str, symbol: &'static str, denominator: f64) -> Unit {
    Unit {
        quantity: Quantity::Slope,
        suffix,
        symbol,
        conversion: Conversion::Gradient(denominator),
    }
}

const fn temperature(
    suffix: &'static str,
    symbol: &'static str,
    offset: f64,
    numerator: f64,
    denominator: f64,
) -> Unit {
    Unit {
        quantity: Quantity::Temperature,
        suffix,
        symbol,
        conversion: Conversion::Offset(offset, numerator, denominator),
    }
}

/// The first unit of each quantity is its SI unit, degrees Celsius for temperatures and degrees for positions. A mile is 1609.344 m and a foot 0.3048 m
/// (international yard and pound agreement, 1959), a nautical mile 1852 m (1929); standard gravity
/// is 9.80665 m/s² (3rd CGPM, 1901).
const UNITS: [Unit; 34] = [
    Unit::SECOND,
    Unit::MILLISECOND,
    Unit::MICROSECOND,
    Unit::NANOSECOND,
    ratio(Quantity::Time, "min", "min", 60.0, 1.0),
    ratio(Quantity::Time, "h", "h", 3600.0, 1.0),
    Unit::DAY,
    Unit::METRE_PER_SECOND,
    Unit::KILOMETRE_PER_HOUR,
    ratio(Quantity::Speed, "mph", "mph", 1609.344, 3600.0),
    ratio(Quantity::Speed, "kn", "kn", 1852.0, 3600.0),
    ratio(Quantity::Speed, "cmps", "cm/s", 1.0, 100.0),
    Unit::METRE_PER_SECOND_SQUARED,
    ratio(Quantity::Acceleration, "g", "g", 9.80665, 1.0),
    ratio(Quantity::Slope, "rad", "rad", 1.0, 1.0),
    ratio(Quantity::Slope, "deg", "deg", std::f64::consts::PI, 180.0),
    gradient("pct", "%", 100.0),
    gradient("fraction", "1", 1.0),
    Unit::METRE,
    ratio(Quantity::Length, "km", "km", 1e3, 1.0),
    ratio(Quantity::Length, "mi", "mi", 1609.344, 1.0),
    ratio(Quantity::Length, "ft", "ft", 0.3048, 1.0),
    Unit::VOLT,
    Unit::AMPERE,
    ratio(Quantity::Current, "ma", "mA", 1.0, 1e3),
    ratio(Quantity::Share, "pct", "%", 1.0, 1.0),
    ratio(Quantity::Share, "fraction", "1", 100.0, 1.0),
    ratio(Quantity::Torque, "nm", "Nm", 1.0, 1.0),
    ratio(Quantity::Power, "w", "W", 1.0, 1.0),
    ratio(Quantity::Power, "kw", "kW", 1e3, 1.0),
    temperature("degc", "°C", 0.0, 1.0, 1.0),
    temperature("k", "K", 273.15, 1.0, 1.0),
    temperature("degf", "°F", 32.0, 5.0, 9.0),
    ratio(Quantity::Position, "deg", "°", 1.0, 1.0),
];

/// Other words for a unit, by its suffix.
const ALIASES: [(Quantity, &str, &str); 14] = [
    (Quantity::Time, "sec", "s"),
    (Quantity::Time, "secs", "s"),
    (Quantity::Time, "seconds", "s"),
    (Quantity::Time, "msec", "ms"),
    (Quantity::Time, "days", "d"),
    (Quantity::Speed, "kph", "kmh"),
    (Quantity::Speed, "kmph", "kmh"),
    (Quantity::Speed, "kt", "kn"),
    (Quantity::Speed, "kts", "kn"),
    (Quantity::Speed, "knot", "kn"),
    (Quantity::Speed, "knots", "kn"),
    (Quantity::Length, "miles", "mi"),
    (Quantity::Acceleration, "m/s²", "mps2"),
    (Quantity::Acceleration, "m/s2", "mps2"),
];

impl Unit {
    pub(crate) const SECOND: Unit = ratio(Quantity::Time, "s", "s", 1.0, 1.0);
    pub(crate) const MILLISECOND: Unit = ratio(Quantity::Time, "ms", "ms", 1.0, 1e3);
    pub(crate) const MICROSECOND: Unit = ratio(Quantity::Time, "us", "us", 1.0, 1e6);
    pub(crate) const NANOSECOND: Unit = ratio(Quantity::Time, "ns", "ns", 1.0, 1e9);
    pub(crate) const DAY: Unit = ratio(Quantity::Time, "d", "d", 86_400.0, 1.0);
    pub(crate) const METRE: Unit = ratio(Quantity::Length, "m", "m", 1.0, 1.0);
    pub(crate) const VOLT: Unit = ratio(Quantity::Voltage, "v", "V", 1.0, 1.0);
    pub(crate) const AMPERE: Unit = ratio(Quantity::Current, "a", "A", 1.0, 1.0);
    pub(crate) const METRE_PER_SECOND: Unit = ratio(Quantity::Speed, "mps", "m/s", 1.0, 1.0);
    pub(crate) const KILOMETRE_PER_HOUR: Unit = ratio(Quantity::Speed, "kmh", "km/h", 1.0, 3.6);
    pub(crate) const METRE_PER_SECOND_SQUARED: Unit =
        ratio(Quantity::Acceleration, "mps2", "m/s^2", 1.0, 1.0);

    /// The unit that a header's suffix or a layout's `unit` names, upper and lower case alike.
    pub(crate) fn parse(quantity: Quantity, text: &str) -> Option<Unit> {
        let text = ALIASES
            .iter()
            .find(|(of, alias, _)| *of == quantity && alias.eq_ignore_ascii_case(text))
            .map_or(text, |(_, _, suffix)| suffix);
        UNITS.into_iter().find(|unit| {
            unit.quantity == quantity
                && (unit.suffix.eq_ignore_ascii_case(text)
                    || unit.symbol.eq_ignore_ascii_case(text))
        })
    }

    pub(crate) fn quantity(self) -> Quantity {
        self.quantity
    }

    /// The units of a quantity, for messages: `m/s, km/h, mph`.
    pub(crate) fn symbols(quantity: Quantity) -> String {
        let symbols: Vec<&str> = UNITS
            .iter()
            .filter(|u| u.quantity == quantity)
            .map(|u| u.symbol)
            .collect();
        symbols.join(", ")
    }

    /// The header suffixes of a quantity, for messages: `_mps, _kmh, _mph`.
    pub(crate) fn suffixes(quantity: Quantity) -> String {
        let suffixes: Vec<String> = UNITS
            .iter()
            .filter(|u| u.quantity == quantity)
            .map(|u| format!("_{}", u.suffix))
            .collect();
        suffixes.join(", ")
    }

    /// Converts values to SI in place; `sign` is 1 or −1. What is not finite becomes missing (NaN).
    pub(crate) fn convert(self, values: &mut [f64], sign: f64) {
        for value in values {
            let si = match self.conversion {
                Conversion::Ratio(numerator, denominator) => *value * numerator / denominator,
                Conversion::Gradient(denominator) => (*value / denominator).atan(),
                Conversion::Offset(offset, numerator, denominator) => {
                    (*value - offset) * numerator / denominator
                }
            };
            *value = if value.is_finite() && si.is_finite() {
                sign * si
            } else {
                f64::NAN
            };
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

    fn si(quantity: Quantity, unit: &str, value: f64) -> f64 {
        let mut values = [value];
        Unit::parse(quantity, unit)
            .unwrap()
            .convert(&mut values, 1.0);
        values[0]
    }

    #[test]
    fn conversions_are_exact() {
        assert_eq!(si(Quantity::Speed, "km/h", 36.0), 10.0);
        assert_eq!(si(Quantity::Speed, "mph", 1.0), 0.44704);
        assert_eq!(si(Quantity::Speed, "kmh", 57.88), 57.88 / 3.6);
        assert_eq!(si(Quantity::Speed, "knots", 3600.0), 1852.0);
        assert_eq!(si(Quantity::Time, "d", 0.5), 43_200.0);
        assert_eq!(si(Quantity::Slope, "%", 100.0), std::f64::consts::FRAC_PI_4);
        assert_eq!(si(Quantity::Share, "1", 0.5), 50.0);
        assert_eq!(si(Quantity::Time, "ms", 100.0), 0.1);
        assert_eq!(si(Quantity::Temperature, "°F", 212.0), 100.0);
        assert_eq!(si(Quantity::Temperature, "K", 273.15), 0.0);
    }

    #[test]
    fn a_suffix_belongs_to_one_quantity() {
        assert!(Unit::parse(Quantity::Speed, "furlongs").is_none());
        assert!(Unit::parse(Quantity::Speed, "m").is_none());
        assert_eq!(
            Unit::suffixes(Quantity::Speed),
            "_mps, _kmh, _mph, _kn, _cmps"
        );
        for (quantity, alias, suffix) in ALIASES {
            let unit = Unit::parse(quantity, alias).unwrap();
            assert_eq!(unit.suffix, suffix);
        }
    }

    #[test]
    fn infinity_is_missing() {
        let mut values = [f64::INFINITY, f64::NAN, 1e308];
        Unit::parse(Quantity::Power, "kW")
            .unwrap()
            .convert(&mut values, 1.0);
        assert!(values.iter().all(|v| v.is_nan()));
    }
}
