//! Every term of every step, as a table.

use std::fmt::Write as _;

use ev_energy::Vehicle;

use super::{EnergyStep, drive_energy};
use crate::{Error, Motion};

/// Every term of every step of a drive as CSV, in SI units.
///
/// # Errors
/// As [`drive_energy`].
pub fn trace_csv(motions: &[Motion], vehicle: &Vehicle) -> Result<String, Error> {
    let mut text = String::from("time_s");
    for (name, _) in COLUMNS {
        let _ = write!(text, ",{name}");
    }
    text.push_str(",measured_power_w\n");
    drive_energy(motions, vehicle, &mut |step| {
        let _ = write!(text, "{}", step.time_s);
        for (_, value) in COLUMNS {
            let _ = write!(text, ",{}", value(step));
        }
        match step.measured_power_w {
            Some(power_w) => {
                let _ = writeln!(text, ",{power_w}");
            }
            None => text.push_str(",\n"),
        }
    })?;
    Ok(text)
}

type Column = (&'static str, fn(&EnergyStep) -> f64);

const COLUMNS: [Column; 22] = [
    ("speed_mps", |s| s.point.speed_mps),
    ("accel_mps2", |s| s.point.accel_mps2),
    ("wheel_force_n", |s| s.point.wheel_force_n),
    ("inertia_n", |s| s.point.inertia_n),
    ("rolling_n", |s| s.point.rolling_n),
    ("aero_n", |s| s.point.aero_n),
    ("grade_n", |s| s.point.grade_n),
    ("motor_speed_rad_s", |s| s.point.motor_speed_rad_s),
    ("motor_torque_nm", |s| s.point.motor_torque_nm),
    ("friction_brake_n", |s| s.point.friction_brake_n),
    ("friction_brake_w", |s| s.point.friction_brake_w),
    ("gear_loss_w", |s| s.point.gear_loss_w),
    ("motor_loss_w", |s| s.point.motor_loss_w),
    ("motor_electric_w", |s| s.point.motor_electric_w),
    ("auxiliary_power_w", |s| s.point.auxiliary_power_w),
    ("electric_power_w", |s| s.point.electric_power_w),
    ("terminal_power_w", |s| s.point.terminal_power_w),
    ("battery_current_a", |s| s.point.battery_current_a),
    ("battery_power_w", |s| s.point.battery_power_w),
    ("battery_loss_w", |s| s.point.battery_loss_w),
    ("undelivered_w", |s| s.point.undelivered_w),
    ("limited", |s| {
        f64::from(u8::from(s.point.limited.torque || s.point.limited.battery))
    }),
];
