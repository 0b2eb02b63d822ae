//! Disturbances that are larger than what controllers are set to expect.

use std::fmt::{Display, Formatter};

use unicycle_cbf::{Limits, settings::Hardening};

use crate::disturbances::Disturbances;

/// A kind of disturbance that controllers have a bound for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Bounded {
    /// Error of positions, in m
    PositionNoise,
    /// Error of headings, in rad
    HeadingNoise,
    /// Relative error of wheels
    WheelError,
    /// Time constant of motors, in s
    MotorTimeConstant,
}

/// A disturbance beyond its bound, both in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beyond {
    /// Of what
    pub what: Bounded,
    /// What comes
    pub comes: f64,
    /// What controllers are set to expect
    pub stated: f64,
}

impl Disturbances {
    /// Those of these that are larger than what settings state.
    #[must_use]
    pub fn beyond(&self, stated: &Hardening) -> Vec<Beyond> {
        let bounded = [
            (
                Bounded::PositionNoise,
                self.position_noise_m,
                stated.position_noise_m,
            ),
            (
                Bounded::HeadingNoise,
                self.heading_noise_rad,
                stated.heading_noise_rad,
            ),
            (Bounded::WheelError, self.wheel_error, stated.wheel_error),
            (
                Bounded::MotorTimeConstant,
                self.motor_time_constant_s,
                Limits::MOTORS_S,
            ),
        ];
        let all = bounded.map(|(what, comes, stated)| Beyond {
            what,
            comes,
            stated,
        });
        // Half a degree is not the same to the last digit everywhere.
        let is_beyond = |one: &Beyond| one.comes > one.stated * (1.0 + 1e-9);
        all.into_iter().filter(is_beyond).collect()
    }
}

impl Display for Beyond {
    fn fmt(&self, out: &mut Formatter<'_>) -> std::fmt::Result {
        let (what, factor, unit) = match self.what {
            Bounded::PositionNoise => ("noise of positions", 1e3, "mm"),
            Bounded::HeadingNoise => ("noise of headings", 1.0_f64.to_degrees(), "°"),
            Bounded::WheelError => ("error of wheels", 100.0, "%"),
            Bounded::MotorTimeConstant => ("time constant of motors", 1e3, "ms"),
        };
        let [comes, stated] = [self.comes, self.stated].map(|value| factor * value);
        write!(
            out,
            "{what} of {comes:.1} {unit} and not {stated:.1} {unit}"
        )
    }
}

#[cfg(test)]
mod tests {
    use unicycle_cbf::{Preset, Testbed};

    use super::*;

    #[test]
    fn only_what_is_larger_than_stated_is_named_with_both_numbers()
    -> Result<(), unicycle_cbf::Error> {
        let scenario = Testbed::Khepera.scenario("on-off", Preset::Hardened)?;
        let stated = scenario.controller.hardening;
        assert_eq!(Disturbances::HARD.beyond(&stated), []);
        let larger = Disturbances {
            position_noise_m: 0.01,
            wheel_error: 0.25,
            ..Disturbances::HARD
        };
        let texts: Vec<String> = larger
            .beyond(&stated)
            .iter()
            .map(ToString::to_string)
            .collect();
        assert_eq!(
            texts,
            [
                "noise of positions of 10.0 mm and not 3.0 mm",
                "error of wheels of 25.0 % and not 10.0 %"
            ]
        );
        Ok(())
    }
}
