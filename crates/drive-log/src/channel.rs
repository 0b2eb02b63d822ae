//! The channels that a recording can have.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::unit::Quantity;

/// A recorded quantity. Values are in SI units, percent for the state of charge, degrees for positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Channel {
    /// Vehicle speed, m/s.
    Speed,
    /// Recorded longitudinal acceleration, m/s².
    Accel,
    /// Speed limit of the road, m/s.
    SpeedLimit,
    /// What an accelerometer along the car feels, m/s²: `dv/dt + g sin θ` on a road of slope `θ`.
    Accelerometer,
    /// Slope of the road, rad, positive uphill.
    Slope,
    /// Elevation above sea level, m.
    Elevation,
    /// Way driven since some start, as an odometer counts it, m. It is a witness for the speed, and no part of a drive.
    Distance,
    /// Distance to the vehicle ahead, bumper to bumper, m.
    LeadGap,
    /// Speed of the vehicle ahead, m/s.
    LeadSpeed,
    /// Voltage at the battery terminals, V.
    BatteryVoltage,
    /// Battery current, A, positive while discharging.
    BatteryCurrent,
    /// State of charge, percent.
    StateOfCharge,
    /// Torque at the motor shaft, N·m.
    MotorTorque,
    /// How far the accelerator pedal is down, percent.
    AcceleratorPedal,
    /// How much the driver brakes, percent of the most; 0 or 100 where it is a switch.
    Brake,
    /// Electric power of the auxiliaries, air conditioning included, W.
    AuxPower,
    /// Electric power of the heater, W.
    HeatingPower,
    /// Electric power that the climate control asks of the heater, W.
    HeatingRequest,
    /// Temperature of the air outside, °C.
    AmbientTemperature,
    /// Temperature of the cells of the battery, °C.
    BatteryTemperature,
    /// Where the car is, degrees north (WGS 84).
    Latitude,
    /// Where the car is, degrees east (WGS 84).
    Longitude,
}

impl Channel {
    /// Every channel, in the order of the columns that [`crate::write_csv`] writes.
    pub const ALL: [Channel; 22] = [
        Channel::Speed,
        Channel::Accel,
        Channel::SpeedLimit,
        Channel::Accelerometer,
        Channel::Slope,
        Channel::Elevation,
        Channel::Distance,
        Channel::LeadGap,
        Channel::LeadSpeed,
        Channel::BatteryVoltage,
        Channel::BatteryCurrent,
        Channel::StateOfCharge,
        Channel::MotorTorque,
        Channel::AcceleratorPedal,
        Channel::Brake,
        Channel::AuxPower,
        Channel::HeatingPower,
        Channel::HeatingRequest,
        Channel::AmbientTemperature,
        Channel::BatteryTemperature,
        Channel::Latitude,
        Channel::Longitude,
    ];

    /// The canonical header: what the channel is and its unit, `speed_mps`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Channel::Speed => "speed_mps",
            Channel::Accel => "accel_mps2",
            Channel::SpeedLimit => "speed_limit_mps",
            Channel::Accelerometer => "accelerometer_mps2",
            Channel::Slope => "grade_rad",
            Channel::Elevation => "elevation_m",
            Channel::Distance => "distance_m",
            Channel::LeadGap => "lead_gap_m",
            Channel::LeadSpeed => "lead_speed_mps",
            Channel::BatteryVoltage => "battery_voltage_v",
            Channel::BatteryCurrent => "battery_current_a",
            Channel::StateOfCharge => "soc_pct",
            Channel::MotorTorque => "motor_torque_nm",
            Channel::AcceleratorPedal => "accelerator_pedal_pct",
            Channel::Brake => "brake_pct",
            Channel::AuxPower => "aux_power_w",
            Channel::HeatingPower => "heating_power_w",
            Channel::HeatingRequest => "heating_request_w",
            Channel::AmbientTemperature => "ambient_temperature_degc",
            Channel::BatteryTemperature => "battery_temperature_degc",
            Channel::Latitude => "latitude_deg",
            Channel::Longitude => "longitude_deg",
        }
    }

    /// The canonical header without its unit, as layout files name the channel.
    pub(crate) fn key(self) -> &'static str {
        let name = self.name();
        name.rsplit_once('_').map_or(name, |(key, _)| key)
    }

    pub(crate) fn from_key(key: &str) -> Option<Channel> {
        Channel::ALL.into_iter().find(|c| c.key() == key)
    }

    /// Whether it is a speed or an acceleration.
    pub(crate) fn is_motion(&self) -> bool {
        matches!(self.quantity(), Quantity::Speed | Quantity::Acceleration)
    }

    pub(crate) fn quantity(self) -> Quantity {
        match self {
            Channel::Speed | Channel::SpeedLimit | Channel::LeadSpeed => Quantity::Speed,
            Channel::Accel | Channel::Accelerometer => Quantity::Acceleration,
            Channel::Slope => Quantity::Slope,
            Channel::Elevation | Channel::Distance | Channel::LeadGap => Quantity::Length,
            Channel::BatteryVoltage => Quantity::Voltage,
            Channel::BatteryCurrent => Quantity::Current,
            Channel::StateOfCharge | Channel::AcceleratorPedal | Channel::Brake => Quantity::Share,
            Channel::MotorTorque => Quantity::Torque,
            Channel::AuxPower | Channel::HeatingPower | Channel::HeatingRequest => Quantity::Power,
            Channel::AmbientTemperature | Channel::BatteryTemperature => Quantity::Temperature,
            Channel::Latitude | Channel::Longitude => Quantity::Position,
        }
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for Channel {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}
