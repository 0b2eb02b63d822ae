use serde::Serialize;

use crate::GRAVITY_MPS2;
use crate::battery::Cells;
use crate::road_load::RoadLoad;
use crate::scalar::{larger, smaller};
use crate::vehicle::Vehicle;

/// Magnitude at which the inputs of [`Vehicle::operating_point`] saturate.
const INPUT_LIMIT: f64 = 1e6;

/// Forces, torques and powers of one instant. Positive propels or discharges, negative brakes or
/// charges.
///
/// The powers balance:
///
/// ```text
/// battery_power_w = (inertia_n + rolling_n + aero_n + grade_n) · v        to the wheels
///                 + gear_loss_w + motor_loss_w + auxiliary_power_w + battery_loss_w + friction_brake_w
///                 − undelivered_w
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OperatingPoint {
    /// Speed, m/s; negative in reverse.
    pub speed_mps: f64,
    /// Acceleration, m/s².
    pub accel_mps2: f64,
    /// Force on the effective mass, `m_eff a`, N.
    pub inertia_n: f64,
    /// Rolling resistance (thesis 2.3) or `A cos θ`, and that of a car that is cold, N.
    pub rolling_n: f64,
    /// Air drag (thesis 2.4) or `B v + C v²`, N.
    pub aero_n: f64,
    /// Grade force `m g sin θ` (thesis 2.5), N.
    pub grade_n: f64,
    /// Force that the motion needs at the wheels, the sum of the four above, N (thesis 2.2 and 2.6;
    /// corrected: inertia is counted once).
    pub wheel_force_n: f64,
    /// Motor speed `v i / r`, rad/s.
    pub motor_speed_rad_s: f64,
    /// Motor torque within its limits (thesis 2.10; corrected: clamped to the limits), N m.
    pub motor_torque_nm: f64,
    /// Force of the friction brakes, against the motion, N.
    pub friction_brake_n: f64,
    /// Heat in the friction brakes, W.
    pub friction_brake_w: f64,
    /// Loss in the gear, W (thesis 2.1; corrected: a loss opposes the flow in both directions).
    pub gear_loss_w: f64,
    /// Loss in motor and inverter, W.
    pub motor_loss_w: f64,
    /// Electric power of motor and inverter `T ω + P_loss`, W.
    pub motor_electric_w: f64,
    /// Power of the auxiliaries, W.
    pub auxiliary_power_w: f64,
    /// Electric power demand `P_el` (thesis 2.13), W.
    pub electric_power_w: f64,
    /// Power at the battery terminals, W: the demand as far as the battery can give it.
    pub terminal_power_w: f64,
    /// Battery current (thesis 2.11), A.
    pub battery_current_a: f64,
    /// Power inside the cells `I U0` (thesis 2.12), W.
    pub battery_power_w: f64,
    /// Ohmic loss of the battery, W.
    pub battery_loss_w: f64,
    /// Power that the motion needs and motor or battery cannot give, W, at least 0.
    pub undelivered_w: f64,
    /// Which limits of propulsion were hit.
    pub limited: Limited,
}

/// Limits of propulsion that were hit. Braking has none: the friction brakes take what the motor
/// cannot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Limited {
    /// The motor cannot give the torque.
    pub torque: bool,
    /// The battery cannot give the power.
    pub battery: bool,
}

impl Vehicle {
    /// The operating point at a speed in m/s, an acceleration in m/s² and a slope angle in rad
    /// (positive uphill), with the auxiliary power of the vehicle.
    ///
    /// The model is quasi-static: the motion is given, and what it needs follows from it (thesis
    /// 2.1.1). In reverse (`speed_mps < 0`) the mirrored motion is evaluated and the signs of
    /// forces, torque and motor speed are turned. At standstill the rolling resistance is 0, and
    /// what holds the car on a slope is the motor uphill and the brakes downhill.
    ///
    /// A grade is the tangent of the slope angle. Speeds and accelerations beyond ±10⁶ count as
    /// ±10⁶, so that every finite input has a finite result.
    #[must_use]
    pub fn operating_point(
        &self,
        speed_mps: f64,
        accel_mps2: f64,
        slope_rad: f64,
    ) -> OperatingPoint {
        let (sin_slope, cos_slope) = slope_rad.sin_cos();
        let motion = Motion {
            speed_mps: speed_mps.clamp(-INPUT_LIMIT, INPUT_LIMIT),
            accel_mps2: accel_mps2.clamp(-INPUT_LIMIT, INPUT_LIMIT),
            sin_slope,
            cos_slope,
            auxiliary_power_w: self.spec().auxiliary_power_w,
            warm_up_n: 0.0,
            cells_w: f64::INFINITY,
        };
        self.evaluate(&self.road_load, &self.battery.nominal(), &motion)
    }

    /// Power in W of motor, losses and auxiliaries at a speed in m/s and a torque in N m at the motor shaft.
    pub(crate) fn power_of_torque_w(&self, speed_mps: f64, torque_nm: f64) -> f64 {
        let motor_speed_rad_s = speed_mps * self.motor_speed_per_mps;
        torque_nm * motor_speed_rad_s
            + self.motor.loss_w(torque_nm, motor_speed_rad_s)
            + self.spec().auxiliary_power_w
    }

    /// Evaluates the model for a motion that is known to be within range.
    // Always inlined: a trip then skips the terms that it does not sum, a fifth of the time.
    #[inline(always)]
    pub(crate) fn evaluate(
        &self,
        road_load: &RoadLoad,
        cells: &Cells,
        motion: &Motion,
    ) -> OperatingPoint {
        let direction = if motion.speed_mps < 0.0 { -1.0 } else { 1.0 };
        let v = motion.speed_mps.abs();
        let a = direction * motion.accel_mps2;

        let inertia_n = self.effective_mass_kg * a;
        let warm_up_n = if v > 0.0 { motion.warm_up_n } else { 0.0 };
        let rolling_n = road_load.rolling_n(v, motion.cos_slope) + warm_up_n;
        let aero_n = road_load.aero_n(v);
        let grade_n = self.spec().mass_kg * GRAVITY_MPS2 * direction * motion.sin_slope;
        let wheel_force_n = inertia_n + rolling_n + aero_n + grade_n;

        // The limits are applied at the wheel, where an unlimited force passes through unrounded.
        let motor_speed_rad_s = v * self.motor_speed_per_mps;
        let max_n = self.motor.torque_limit_nm(motor_speed_rad_s) * self.propelling_n_per_nm;
        let regen_nm = self
            .motor
            .regeneration_within_nm(motor_speed_rad_s, v, motion.cells_w);
        let regen_n = regen_nm * self.braking_n_per_nm;
        let motor_n = larger(smaller(wheel_force_n, max_n), 0.0 - regen_n);
        let friction_brake_n = smaller(wheel_force_n - motor_n, 0.0);
        let shortfall_n = larger(wheel_force_n - motor_n, 0.0);

        let nm_per_n = if motor_n >= 0.0 {
            self.propelling_nm_per_n
        } else {
            self.braking_nm_per_n
        };
        let motor_torque_nm = motor_n * nm_per_n;
        let shaft_power_w = motor_torque_nm * motor_speed_rad_s;
        let motor_loss_w = self.motor.loss_w(motor_torque_nm, motor_speed_rad_s);
        let motor_electric_w = shaft_power_w + motor_loss_w;
        let electric_power_w = motor_electric_w + motion.auxiliary_power_w;
        let draw = self.battery.draw_from(cells, electric_power_w);

        OperatingPoint {
            speed_mps: motion.speed_mps,
            accel_mps2: motion.accel_mps2,
            inertia_n: direction * inertia_n,
            rolling_n: direction * rolling_n,
            aero_n: direction * aero_n,
            grade_n: direction * grade_n,
            wheel_force_n: direction * wheel_force_n,
            motor_speed_rad_s: direction * motor_speed_rad_s,
            motor_torque_nm: direction * motor_torque_nm,
            friction_brake_n: direction * friction_brake_n,
            friction_brake_w: 0.0 - friction_brake_n * v,
            gear_loss_w: shaft_power_w - motor_n * v,
            motor_loss_w,
            motor_electric_w,
            auxiliary_power_w: motion.auxiliary_power_w,
            electric_power_w,
            terminal_power_w: draw.terminal_power_w,
            battery_current_a: draw.current_a,
            battery_power_w: draw.power_w,
            battery_loss_w: draw.loss_w,
            undelivered_w: shortfall_n * v + (electric_power_w - draw.terminal_power_w),
            limited: Limited {
                torque: shortfall_n > 0.0,
                battery: draw.limited,
            },
        }
    }
}

/// A motion within range, with the slope as sine and cosine.
pub(crate) struct Motion {
    pub(crate) speed_mps: f64,
    pub(crate) accel_mps2: f64,
    pub(crate) sin_slope: f64,
    pub(crate) cos_slope: f64,
    pub(crate) auxiliary_power_w: f64,
    /// Resistance of the car while it is cold, N.
    pub(crate) warm_up_n: f64,
    /// Largest shaft power of braking that the cells take, W.
    pub(crate) cells_w: f64,
}
