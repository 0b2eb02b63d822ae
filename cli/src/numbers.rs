//! What the numbers of flags can be. NaN is in no range.

use std::ops::RangeInclusive;

use assistance::Style;

type Parsed<T> = Result<T, String>;

/// A number of a quantity within a range.
fn number(text: &str, what: &str, range: RangeInclusive<f64>) -> Parsed<f64> {
    match text.trim().parse() {
        Ok(value) if range.contains(&value) => Ok(value),
        _ => Err(format!(
            "expected {what}, {} to {}",
            range.start(),
            range.end()
        )),
    }
}

fn count(text: &str, what: &str, range: RangeInclusive<usize>) -> Parsed<usize> {
    match text.trim().parse() {
        Ok(value) if range.contains(&value) => Ok(value),
        _ => Err(format!(
            "expected a number of {what}, {} to {}",
            range.start(),
            range.end()
        )),
    }
}

/// Between two samples after resampling.
pub(crate) fn step_s(text: &str) -> Parsed<f64> {
    number(text, "an interval in s", 1e-4..=1e3)
}

/// Without speed.
pub(crate) fn gap_s(text: &str) -> Parsed<f64> {
    number(text, "a duration in s", 1e-3..=1e6)
}

/// From which on something counts.
pub(crate) fn least_duration_s(text: &str) -> Parsed<f64> {
    number(text, "a duration in s", 0.0..=1e6)
}

/// Of a run of robots, which have steps of their own.
pub(crate) fn run_duration_s(text: &str) -> Parsed<f64> {
    number(text, "a duration in s", 1e-3..=86_400.0)
}

/// Of a simulated drive.
pub(crate) fn drive_duration_s(text: &str) -> Parsed<f64> {
    number(text, "a duration in s", 10.0..=86_400.0)
}

/// Of a simulated drive.
pub(crate) fn drive_step_s(text: &str) -> Parsed<f64> {
    number(text, "an interval in s", 0.01..=1.0)
}

/// Ahead of now.
pub(crate) fn horizon_s(text: &str) -> Parsed<f64> {
    number(text, "seconds ahead", 1e-3..=3600.0)
}

/// To either side.
pub(crate) fn bandwidth_m(text: &str) -> Parsed<f64> {
    number(text, "a distance in m", 1.0..=1e5)
}

/// From which on a change of speed counts.
pub(crate) fn gain_kmh(text: &str) -> Parsed<f64> {
    number(text, "a change of speed in km/h", 0.0..=1e3)
}

/// The width of a band, which a prediction is in or not.
pub(crate) fn width_kmh(text: &str) -> Parsed<f64> {
    number(text, "a width in km/h", 0.0..=1e3)
}

/// Under which an acceleration counts as 0.
pub(crate) fn deadband_mps2(text: &str) -> Parsed<f64> {
    number(text, "a magnitude in m/s²", 0.0..=100.0)
}

/// Of a vehicle that drives forward.
pub(crate) fn speed_mps(text: &str) -> Parsed<f64> {
    number(text, "a speed in m/s", 0.0..=200.0)
}

/// Of a vehicle.
pub(crate) fn accel_mps2(text: &str) -> Parsed<f64> {
    number(text, "an acceleration in m/s²", -100.0..=100.0)
}

/// The tangent of a slope.
pub(crate) fn grade(text: &str) -> Parsed<f64> {
    number(text, "the tangent of a slope", -10.0..=10.0)
}

/// Beside 1.
pub(crate) fn weight(text: &str) -> Parsed<f64> {
    number(text, "a weight", 0.0..=1000.0)
}

/// Of segments, in their own units.
pub(crate) fn cost(text: &str) -> Parsed<f64> {
    number(text, "a cost", 0.0..=1e9)
}

/// Of neighbours, or of their means in m/s².
pub(crate) fn similarity(text: &str) -> Parsed<f64> {
    number(text, "a similarity or an acceleration in m/s²", 0.0..=100.0)
}

/// Of how much drives differ.
pub(crate) fn variation(text: &str) -> Parsed<f64> {
    number(text, "a share", 0.0..=2.0)
}

/// Of a log or a window.
pub(crate) fn samples(text: &str) -> Parsed<usize> {
    count(text, "samples", 1..=1_000_000_000)
}

/// To simulate.
pub(crate) fn drives(text: &str) -> Parsed<usize> {
    count(text, "drives", 1..=999)
}

/// Of what is held out.
pub(crate) fn folds(text: &str) -> Parsed<usize> {
    count(text, "folds", 2..=1_000_000)
}

/// After the start.
pub(crate) fn arrival_s(text: &str) -> Parsed<f64> {
    number(text, "a time in s", 0.1..=1e7)
}

/// What a second is worth in J.
pub(crate) fn price_w(text: &str) -> Parsed<f64> {
    number(text, "a price of time in W", 0.0..=1e7)
}

/// Braking and acceleration.
pub(crate) fn accels_mps2(text: &str) -> Parsed<[f64; 2]> {
    let Some((min, max)) = text.split_once(',') else {
        return Err("expected two accelerations in m/s², such as -2,1.5".to_owned());
    };
    Ok([
        number(min.trim(), "a deceleration in m/s²", -20.0..=-0.01)?,
        number(max.trim(), "an acceleration in m/s²", 0.01..=20.0)?,
    ])
}

/// Where a car does not stand.
pub(crate) fn slowest_kmh(text: &str) -> Parsed<f64> {
    number(text, "a speed in km/h", 0.4..=300.0)
}

/// Of heating, lights and whatever else is on.
pub(crate) fn aux_power_w(text: &str) -> Parsed<f64> {
    number(text, "a power in W", 0.0..=1e5)
}

/// Of the air.
pub(crate) fn temperature_degc(text: &str) -> Parsed<f64> {
    number(text, "a temperature in °C", -90.0..=70.0)
}

/// Between a plan and its bound.
pub(crate) fn gap_pct(text: &str) -> Parsed<f64> {
    number(text, "a gap in %", 1e-5..=100.0)
}

/// How closely a plan keeps to the driver's own way.
pub(crate) fn style(text: &str) -> Parsed<Style> {
    if text == "free" {
        return Ok(Style::Free);
    }
    let half_widths = number(
        text,
        "half-widths of the driver's band, or free",
        0.0..=100.0,
    );
    half_widths.map(Style::Within)
}

/// Time for the search of a plan.
pub(crate) fn budget_s(text: &str) -> Parsed<f64> {
    number(text, "a time in s", 1e-3..=1e6)
}

/// Points of energy over time.
pub(crate) fn frontier(text: &str) -> Parsed<usize> {
    count(text, "plans", 2..=1_000)
}

/// Of a campaign.
pub(crate) fn runs(text: &str) -> Parsed<usize> {
    count(text, "runs", 1..=1_000_000_000)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::any::TypeId;

    use clap::{Arg, Command, CommandFactory as _};

    use crate::cli::Cli;

    /// Flags that take text of any kind.
    fn is_text(arg: &Arg) -> bool {
        let texts = [
            TypeId::of::<String>(),
            TypeId::of::<std::path::PathBuf>(),
            TypeId::of::<std::ffi::OsString>(),
        ];
        let taken = arg.get_value_parser().type_id();
        texts.iter().any(|text| taken == *text)
    }

    /// What the flag says to a value on its own.
    fn given(arg: &Arg, value: &str) -> Result<(), String> {
        let alone = Arg::new("alone")
            .long("alone")
            .value_parser(arg.get_value_parser().clone());
        Command::new("x")
            .arg(alone)
            .try_get_matches_from(["x", &format!("--alone={value}")])
            .map(|_| ())
            .map_err(|error| error.to_string())
    }

    fn of_all(command: &Command, see: &mut dyn FnMut(&str, &Arg)) {
        for arg in command.get_arguments() {
            if arg.get_action().takes_values() && !is_text(arg) {
                see(command.get_name(), arg);
            }
        }
        for below in command.get_subcommands() {
            of_all(below, see);
        }
    }

    #[test]
    fn no_flag_takes_a_number_that_is_none() {
        let mut numbers = 0;
        of_all(&Cli::command(), &mut |command, arg| {
            for value in [
                "nan", "NaN", "-nan", "inf", "-inf", "infinity", "1e400", "-1e400", "1e300",
                "-1e300",
            ] {
                assert!(given(arg, value).is_err(), "{command} {arg} takes {value}");
            }
            numbers += usize::from(arg.get_value_parser().type_id() == TypeId::of::<f64>());
        });
        assert!(numbers > 20, "{numbers} numeric flags were looked at");
    }

    #[test]
    fn only_quantities_with_a_sign_may_be_negative() {
        of_all(&Cli::command(), &mut |command, arg| {
            let flag = arg.get_id().as_str();
            if (command, flag) == ("plan", "accel") {
                // Braking and acceleration at once.
                assert!(given(arg, "-2,1.5").is_ok() && given(arg, "2,1.5").is_err());
                return;
            }
            let has_sign = ["accel", "grade", "temperature"].contains(&flag);
            assert_eq!(given(arg, "-1").is_ok(), has_sign, "{command} {flag}");
        });
    }

    #[test]
    fn what_divides_or_counts_is_above_zero() {
        let above_zero = [
            "step",
            "max_gap",
            "slope_bandwidth",
            "horizons",
            "horizon",
            "folds",
            "max_samples",
            "duration",
            "drives",
            "runs",
            "min_length",
            "window",
            "first",
            "segments",
        ];
        of_all(&Cli::command(), &mut |command, arg| {
            if above_zero.contains(&arg.get_id().as_str()) {
                assert!(given(arg, "0").is_err(), "{command} {arg}");
            }
        });
    }

    #[test]
    fn a_refusal_says_what_is_expected() {
        of_all(&Cli::command(), &mut |command, arg| {
            if arg.get_value_parser().type_id() == TypeId::of::<f64>() {
                let error = given(arg, "nan").unwrap_err();
                assert!(
                    error.contains("expected") && error.contains(" to "),
                    "{command} {arg}: {error}"
                );
            }
        });
    }

    #[test]
    fn defaults_are_taken() {
        of_all(&Cli::command(), &mut |command, arg| {
            for value in arg.get_default_values() {
                let value = value.to_str().unwrap();
                assert_eq!(given(arg, value), Ok(()), "{command} {arg} {value}");
            }
        });
    }
}
