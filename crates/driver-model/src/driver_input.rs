use drive_log::Channel;
use serde::Serialize;

use crate::motion::samples_in;
use crate::{DriverChannel, Motion};

/// What the driver does at the first sample of a phase, and what the car feels there; `None` where the log does not say.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct DriverInput {
    /// How far the accelerator pedal is down.
    pub accelerator_pedal_pct: Option<f64>,
    /// How much further than 0.2 s before.
    pub accelerator_pedal_change_pct: Option<f64>,
    /// How much further than 1 s before.
    pub accelerator_pedal_slow_change_pct: Option<f64>,
    /// How much the driver brakes.
    pub brake_pct: Option<f64>,
    /// At the motor shaft.
    pub motor_torque_nm: Option<f64>,
    /// Along the car.
    pub accelerometer_mps2: Option<f64>,
}

const CHANGE_S: f64 = 0.2;
const SLOW_CHANGE_S: f64 = 1.0;

impl DriverInput {
    /// Of a log that says nothing of it.
    pub const NONE: Self = Self {
        accelerator_pedal_pct: None,
        accelerator_pedal_change_pct: None,
        accelerator_pedal_slow_change_pct: None,
        brake_pct: None,
        motor_torque_nm: None,
        accelerometer_mps2: None,
    };

    pub(crate) fn at(motion: &Motion, sample: usize) -> Self {
        Self::of(sample, motion.step_s(), |channel, sample| {
            let value = *motion.log().channel(channel)?.get(sample)?;
            value.is_finite().then_some(value)
        })
    }

    /// At a sample, of the values of channels at samples.
    pub(crate) fn of(
        sample: usize,
        step_s: f64,
        value: impl Fn(Channel, usize) -> Option<f64>,
    ) -> Self {
        let before = |of: DriverChannel, lag: usize| value(of.channel(), sample.checked_sub(lag)?);
        let now = |of| before(of, 0);
        let pedal_pct = now(DriverChannel::AcceleratorPedal);
        let change_pct = |lag_s| {
            let lag = samples_in(lag_s, step_s);
            Some(pedal_pct? - before(DriverChannel::AcceleratorPedal, lag)?)
        };
        Self {
            accelerator_pedal_pct: pedal_pct,
            accelerator_pedal_change_pct: change_pct(CHANGE_S),
            accelerator_pedal_slow_change_pct: change_pct(SLOW_CHANGE_S),
            brake_pct: now(DriverChannel::Brake),
            motor_torque_nm: now(DriverChannel::MotorTorque),
            accelerometer_mps2: now(DriverChannel::Accelerometer),
        }
    }

    /// In the order of the fields.
    pub(crate) fn values(self) -> [Option<f64>; 6] {
        [
            self.accelerator_pedal_pct,
            self.accelerator_pedal_change_pct,
            self.accelerator_pedal_slow_change_pct,
            self.brake_pct,
            self.motor_torque_nm,
            self.accelerometer_mps2,
        ]
    }

    pub(crate) fn of_values(values: [Option<f64>; 6]) -> Self {
        let [
            accelerator_pedal_pct,
            accelerator_pedal_change_pct,
            accelerator_pedal_slow_change_pct,
            brake_pct,
            motor_torque_nm,
            accelerometer_mps2,
        ] = values;
        Self {
            accelerator_pedal_pct,
            accelerator_pedal_change_pct,
            accelerator_pedal_slow_change_pct,
            brake_pct,
            motor_torque_nm,
            accelerometer_mps2,
        }
    }

    /// Whether this channel is among what is known.
    #[must_use]
    pub fn knows(&self, channel: DriverChannel) -> bool {
        let value = match channel {
            DriverChannel::AcceleratorPedal => self.accelerator_pedal_pct,
            DriverChannel::Brake => self.brake_pct,
            DriverChannel::MotorTorque => self.motor_torque_nm,
            DriverChannel::Accelerometer => self.accelerometer_mps2,
        };
        value.is_some()
    }
}
