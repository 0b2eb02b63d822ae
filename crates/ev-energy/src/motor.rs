use serde::{Deserialize, Serialize};

use crate::cells::CellIntakeSpec;
use crate::check::Checker;
use crate::error::Error;
use crate::loss_table::{LossTable, LossTableSpec};
use crate::scalar::{larger, smaller};

/// Motor section of a vehicle file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotorSpec {
    /// Largest torque, N m.
    pub max_torque_nm: f64,
    /// Largest shaft power, W.
    pub max_power_w: f64,
    /// Largest speed, rad/s; above it the motor gives no torque.
    pub max_speed_rad_s: f64,
    /// Losses of motor and inverter by formula; this or the table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loss: Option<MotorLossSpec>,
    /// Losses of motor and inverter by table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loss_table: Option<LossTableSpec>,
}

/// `P_loss = k_c T² + (1 − s)(k_i |ω| + k_w |ω|³) + k_0 + k_f max(0, 1 − ω_f/|ω|)`, and 0 at `T = ω = 0`.
///
/// The last term is the current that weakens the field where the motor turns faster than its voltage allows: no coast-down has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotorLossSpec {
    /// Copper loss `k_c`, W/(N m)².
    pub copper_w_per_nm2: f64,
    /// Iron loss `k_i`, W/(rad/s).
    pub iron_w_per_rad_s: f64,
    /// Windage loss `k_w`, W/(rad/s)³.
    pub windage_w_per_rad3_s3: f64,
    /// Constant loss `k_0`, W.
    pub constant_w: f64,
    /// Share `s` of the spin loss (iron and windage) that the road load contains already, 0 to 1.
    /// A coast-down turns the motor along: with permanent magnets the share is near 1.
    pub spin_share_in_road_load: f64,
    /// Loss by field weakening `k_f`, W.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub weakening_w: f64,
    /// Where it begins: `ω_f` as a share of the highest speed of the motor, 1.
    #[serde(default = "half", skip_serializing_if = "is_half")]
    pub weakening_from_share: f64,
}

fn is_zero(value: &f64) -> bool {
    value.to_bits() == 0
}

fn half() -> f64 {
    0.5
}

fn is_half(value: &f64) -> bool {
    value.to_bits() == half().to_bits()
}

/// Regeneration section of a vehicle file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegenerationSpec {
    /// Largest regenerative torque as a fraction of the propelling one, 1.
    pub torque_fraction: f64,
    /// Largest regenerative shaft power, W.
    pub max_power_w: f64,
    /// Vehicle speed below which there is no regeneration, m/s.
    pub fade_start_mps: f64,
    /// Vehicle speed from which on regeneration is full, m/s.
    pub fade_end_mps: f64,
    /// Largest deceleration of the effective mass by regeneration, m/s².
    pub max_decel_mps2: f64,
    /// What the cells take; whatever comes without the section.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cells: Option<CellIntakeSpec>,
}

/// Electric motor with inverter: torque limits and losses.
#[derive(Debug, Clone, PartialEq)]
pub struct Motor {
    max_torque_nm: f64,
    max_power_w: f64,
    max_speed_rad_s: f64,
    loss: Loss,
    regen_torque_fraction: f64,
    regen_max_power_w: f64,
    regen_decel_torque_nm: f64,
    fade_start_mps: f64,
    fade_per_mps: f64,
}

#[derive(Debug, Clone, PartialEq)]
enum Loss {
    Formula(LossFormula),
    Table(LossTable),
}

/// The formula without what the road load contains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LossFormula {
    pub(crate) copper_w_per_nm2: f64,
    pub(crate) iron_w_per_rad_s: f64,
    pub(crate) windage_w_per_rad3_s3: f64,
    pub(crate) constant_w: f64,
    pub(crate) weakening_w: f64,
    pub(crate) weakening_from_rad_s: f64,
}

/// Largest regeneration without its fade: the smaller of what torque and deceleration allow, and the smaller of what powers allow.
pub(crate) struct RegenerationBounds {
    pub(crate) torque_nm: f64,
    pub(crate) power_w: f64,
}

impl Loss {
    fn new(spec: &MotorSpec, check: &Checker) -> Result<Self, Error> {
        match (&spec.loss, &spec.loss_table) {
            (Some(formula), None) => Ok(Self::Formula(LossFormula::new(
                formula,
                spec.max_speed_rad_s,
                check,
            )?)),
            (None, Some(LossTableSpec { table: None, .. })) => Err(check.problem(
                "motor.loss_table.file",
                "was not read; read the vehicle from its file",
            )),
            (
                None,
                Some(LossTableSpec {
                    table: Some(table),
                    spin_share_in_road_load,
                    ..
                }),
            ) => {
                let share = check.range(
                    "motor.loss_table.spin_share_in_road_load",
                    *spin_share_in_road_load,
                    0.0,
                    1.0,
                )?;
                Ok(Self::Table(table.without_spin(share)))
            }
            _ => Err(check.problem(
                "motor",
                "needs either `[motor.loss]` or `[motor.loss_table]`",
            )),
        }
    }
}

impl LossFormula {
    fn new(loss: &MotorLossSpec, max_speed_rad_s: f64, check: &Checker) -> Result<Self, Error> {
        let spin = 1.0
            - check.range(
                "motor.loss.spin_share_in_road_load",
                loss.spin_share_in_road_load,
                0.0,
                1.0,
            )?;
        let range = |key, value, max| check.range(key, value, 0.0, max);
        Ok(Self {
            copper_w_per_nm2: range("motor.loss.copper_w_per_nm2", loss.copper_w_per_nm2, 1e3)?,
            iron_w_per_rad_s: spin
                * range("motor.loss.iron_w_per_rad_s", loss.iron_w_per_rad_s, 1e3)?,
            windage_w_per_rad3_s3: spin
                * range(
                    "motor.loss.windage_w_per_rad3_s3",
                    loss.windage_w_per_rad3_s3,
                    1.0,
                )?,
            constant_w: range("motor.loss.constant_w", loss.constant_w, 1e5)?,
            weakening_w: range("motor.loss.weakening_w", loss.weakening_w, 1e6)?,
            weakening_from_rad_s: max_speed_rad_s
                * check.range(
                    "motor.loss.weakening_from_share",
                    loss.weakening_from_share,
                    0.05,
                    1.0,
                )?,
        })
    }

    #[inline(always)]
    fn loss_w(&self, torque_nm: f64, speed: f64) -> f64 {
        let constant_w = if torque_nm != 0.0 || speed > 0.0 {
            self.constant_w
        } else {
            0.0
        };
        self.copper_w_per_nm2 * torque_nm * torque_nm
            + (self.iron_w_per_rad_s + self.windage_w_per_rad3_s3 * speed * speed) * speed
            + constant_w
            + self.weakening_w * larger(1.0 - self.weakening_from_rad_s * (1.0 / speed), 0.0)
    }
}

impl Motor {
    /// `torque_per_decel` is the motor torque that decelerates the car by 1 m/s², in N m/(m/s²).
    pub(crate) fn new(
        spec: &MotorSpec,
        regen: &RegenerationSpec,
        torque_per_decel: f64,
        check: &Checker,
    ) -> Result<Self, Error> {
        let loss = Loss::new(spec, check)?;
        if let Some(cells) = &regen.cells {
            cells.check(check)?;
        }
        let fade_start_mps = check.range(
            "regeneration.fade_start_mps",
            regen.fade_start_mps,
            0.0,
            100.0,
        )?;
        let narrowest_mps = fade_start_mps + 0.01;
        let fade_end_mps = check.range(
            "regeneration.fade_end_mps",
            regen.fade_end_mps,
            narrowest_mps,
            200.0,
        )?;
        let decel_mps2 = check.range(
            "regeneration.max_decel_mps2",
            regen.max_decel_mps2,
            0.0,
            100.0,
        )?;
        Ok(Self {
            max_torque_nm: check.range("motor.max_torque_nm", spec.max_torque_nm, 1.0, 1e5)?,
            max_power_w: check.range("motor.max_power_w", spec.max_power_w, 1.0, 1e8)?,
            max_speed_rad_s: check.range(
                "motor.max_speed_rad_s",
                spec.max_speed_rad_s,
                1.0,
                1e5,
            )?,
            loss,
            regen_torque_fraction: check.range(
                "regeneration.torque_fraction",
                regen.torque_fraction,
                0.0,
                1.0,
            )?,
            regen_max_power_w: check.range(
                "regeneration.max_power_w",
                regen.max_power_w,
                0.0,
                1e8,
            )?,
            regen_decel_torque_nm: decel_mps2 * torque_per_decel,
            fade_start_mps,
            fade_per_mps: 1.0 / (fade_end_mps - fade_start_mps),
        })
    }

    /// Largest propelling torque in N m at a motor speed in rad/s:
    /// `min(T_max, P_max/|ω|)`, and 0 above the maximum speed.
    #[must_use]
    #[inline(always)]
    pub fn torque_limit_nm(&self, motor_speed_rad_s: f64) -> f64 {
        let speed = motor_speed_rad_s.abs();
        if speed > self.max_speed_rad_s {
            0.0
        } else {
            smaller(self.max_torque_nm, self.max_power_w * (1.0 / speed))
        }
    }

    /// Largest regenerative torque in N m, at least 0, at a motor speed in rad/s and a vehicle
    /// speed in m/s: `min(f_t T_max(ω), P_gen/|ω|, torque of the deceleration limit)`, faded in
    /// with the vehicle speed.
    #[must_use]
    #[inline(always)]
    pub fn regeneration_limit_nm(&self, motor_speed_rad_s: f64, speed_mps: f64) -> f64 {
        self.regeneration_within_nm(motor_speed_rad_s, speed_mps, f64::INFINITY)
    }

    /// As [`Self::regeneration_limit_nm`], where the cells take no more than a power in W.
    #[must_use]
    #[inline(always)]
    pub(crate) fn regeneration_within_nm(
        &self,
        motor_speed_rad_s: f64,
        speed_mps: f64,
        cells_w: f64,
    ) -> f64 {
        let fade = (speed_mps.abs() - self.fade_start_mps) * self.fade_per_mps;
        let by_torque = self.regen_torque_fraction * self.torque_limit_nm(motor_speed_rad_s);
        // A power limit of 0 at standstill is 0/0; `smaller` takes the other operand then.
        let by_power = smaller(self.regen_max_power_w, cells_w) * (1.0 / motor_speed_rad_s.abs());
        let limit = smaller(smaller(by_power, by_torque), self.regen_decel_torque_nm);
        larger(smaller(fade, 1.0), 0.0) * limit
    }

    pub(crate) fn regeneration_bounds(&self) -> RegenerationBounds {
        let share = self.regen_torque_fraction;
        RegenerationBounds {
            torque_nm: smaller(share * self.max_torque_nm, self.regen_decel_torque_nm),
            power_w: smaller(share * self.max_power_w, self.regen_max_power_w),
        }
    }

    /// The losses, where a formula gives them.
    pub(crate) fn loss_formula(&self) -> Option<LossFormula> {
        match &self.loss {
            Loss::Formula(formula) => Some(*formula),
            Loss::Table(_) => None,
        }
    }

    /// Loss of motor and inverter in W at a torque in N m and a motor speed in rad/s, see
    /// [`MotorLossSpec`].
    #[must_use]
    #[inline(always)]
    pub fn loss_w(&self, torque_nm: f64, motor_speed_rad_s: f64) -> f64 {
        let speed = motor_speed_rad_s.abs();
        match &self.loss {
            Loss::Formula(formula) => formula.loss_w(torque_nm, speed),
            Loss::Table(table) => table.loss_w(torque_nm, speed),
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

    fn motor(regen_max_power_w: f64, spin_share_in_road_load: f64) -> Motor {
        let spec = MotorSpec {
            max_torque_nm: 300.0,
            max_power_w: 90e3,
            max_speed_rad_s: 1000.0,
            loss: Some(MotorLossSpec {
                copper_w_per_nm2: 0.2,
                iron_w_per_rad_s: 2.0,
                windage_w_per_rad3_s3: 1e-6,
                constant_w: 100.0,
                spin_share_in_road_load,
                weakening_w: 0.0,
                weakening_from_share: 0.5,
            }),
            loss_table: None,
        };
        let regen = RegenerationSpec {
            torque_fraction: 0.5,
            max_power_w: regen_max_power_w,
            fade_start_mps: 1.0,
            fade_end_mps: 3.0,
            max_decel_mps2: 2.0,
            cells: None,
        };
        Motor::new(&spec, &regen, 60.0, &Checker { origin: "test" }).unwrap()
    }

    #[test]
    fn torque_is_limited_by_torque_power_and_speed() {
        let motor = motor(30e3, 0.0);
        let limits =
            [0.0, 300.0, -300.0, 600.0, 1000.0, 1000.1].map(|speed| motor.torque_limit_nm(speed));
        assert_eq!(limits, [300.0, 300.0, 300.0, 150.0, 90.0, 0.0]);
    }

    #[test]
    fn regeneration_is_limited_by_the_smallest_of_three_and_fades() {
        let motor = motor(30e3, 0.0);
        assert_eq!(
            motor.regeneration_limit_nm(100.0, 10.0),
            120.0,
            "deceleration"
        );
        assert_eq!(motor.regeneration_limit_nm(400.0, 10.0), 75.0, "power");
        assert_eq!(
            motor.regeneration_limit_nm(100.0, 2.0),
            60.0,
            "half faded in"
        );
        assert_eq!(
            motor.regeneration_limit_nm(100.0, 1.0),
            0.0,
            "below the fade"
        );
    }

    #[test]
    fn no_regeneration_power_is_no_regeneration() {
        let motor = motor(0.0, 0.0);
        assert_eq!(motor.regeneration_limit_nm(0.0, 0.0), 0.0);
        assert_eq!(motor.regeneration_limit_nm(100.0, 10.0), 0.0);
    }

    #[test]
    fn cells_that_take_less_limit_regeneration() {
        let motor = motor(30e3, 0.0);
        assert_eq!(motor.regeneration_within_nm(400.0, 10.0, 20e3), 50.0);
        assert_eq!(motor.regeneration_within_nm(400.0, 10.0, 0.0), 0.0);
        assert_eq!(motor.regeneration_within_nm(0.0, 0.0, 0.0), 0.0);
    }

    #[test]
    fn a_weakened_field_costs_from_its_speed_on() {
        let loss = MotorLossSpec {
            copper_w_per_nm2: 0.0,
            iron_w_per_rad_s: 0.0,
            windage_w_per_rad3_s3: 0.0,
            constant_w: 0.0,
            spin_share_in_road_load: 1.0,
            weakening_w: 4000.0,
            weakening_from_share: 0.5,
        };
        let formula = LossFormula::new(&loss, 1000.0, &Checker { origin: "test" }).unwrap();
        let losses = [0.0, 499.0, 500.0, 1000.0].map(|speed| formula.loss_w(10.0, speed));
        assert_eq!(losses, [0.0, 0.0, 0.0, 2000.0]);
    }

    #[test]
    fn loss_leaves_out_what_the_road_load_contains() {
        assert_eq!(motor(30e3, 0.0).loss_w(0.0, 0.0), 0.0);
        assert_eq!(
            motor(30e3, 0.0).loss_w(-10.0, 100.0),
            20.0 + 200.0 + 1.0 + 100.0
        );
        assert_eq!(motor(30e3, 1.0).loss_w(10.0, 100.0), 120.0);
    }
}
