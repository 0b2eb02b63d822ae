use std::collections::BTreeMap;

use drive_log::{Channel, DriveLog};
use ev_energy::Vehicle;

use super::drive::Motion;
use super::random::Random;
use super::route::Route;
use super::settings::SynthSettings;
use crate::error::Error;

/// Usable energy of the battery, from which the state of charge is counted: 28 kWh, the thesis's car.
const BATTERY_ENERGY_J: f64 = 28.0 * 3.6e6;

/// How a channel is recorded: standard deviation of the noise, and values per unit, with and without noise.
struct Sensor {
    noise: f64,
    per_unit_noisy: f64,
    per_unit: f64,
}

const fn sensor(noise: f64, per_unit_noisy: f64, per_unit: f64) -> Sensor {
    Sensor {
        noise,
        per_unit_noisy,
        per_unit,
    }
}

const SPEED: Sensor = sensor(0.015, 100.0, 1e4);
const SPEED_LIMIT: Sensor = sensor(0.0, 1e4, 1e4);
const SLOPE: Sensor = sensor(0.0, 1e4, 1e5);
const ELEVATION: Sensor = sensor(0.1, 10.0, 1e3);
const LEAD_GAP: Sensor = sensor(0.2, 10.0, 1e3);
const LEAD_SPEED: Sensor = sensor(0.1, 20.0, 1e4);
const VOLTAGE: Sensor = sensor(0.15, 10.0, 1e3);
const CURRENT: Sensor = sensor(0.4, 10.0, 1e3);
const STATE_OF_CHARGE: Sensor = sensor(0.0, 10.0, 1e3);

/// What the car's log says of a drive.
pub(super) fn record(
    name: &str,
    settings: &SynthSettings,
    vehicle: &Vehicle,
    route: &Route,
    motion: Motion,
    mut random: Random,
) -> Result<DriveLog, Error> {
    let position_m = &motion.position_m;
    let slope_rad: Vec<f64> = position_m.iter().map(|&s| route.slope_rad(s)).collect();
    let elevation_m = position_m.iter().map(|&s| route.elevation_m(s)).collect();
    let limit_mps = position_m.iter().map(|&s| route.limit_mps(s)).collect();
    let full_pct = random.between(60.0, 95.0);
    let battery = battery(
        vehicle,
        &motion.speed_mps,
        &slope_rad,
        settings.step_s,
        full_pct,
    );
    let mut channels = vec![
        (Channel::SpeedLimit, SPEED_LIMIT, limit_mps),
        (Channel::Slope, SLOPE, slope_rad),
        (Channel::Elevation, ELEVATION, elevation_m),
        (Channel::BatteryVoltage, VOLTAGE, battery.voltage_v),
        (Channel::BatteryCurrent, CURRENT, battery.current_a),
        (
            Channel::StateOfCharge,
            STATE_OF_CHARGE,
            battery.state_of_charge_pct,
        ),
        (Channel::Speed, SPEED, motion.speed_mps),
    ];
    if settings.leaders {
        channels.push((Channel::LeadGap, LEAD_GAP, motion.lead_gap_m));
        channels.push((Channel::LeadSpeed, LEAD_SPEED, motion.lead_speed_mps));
    }
    let channels: BTreeMap<Channel, Vec<f64>> = channels
        .into_iter()
        .map(|(channel, sensor, mut values)| {
            let unsigned = matches!(
                channel,
                Channel::Speed | Channel::LeadGap | Channel::LeadSpeed
            );
            for value in &mut values {
                *value = sensor.read(*value, unsigned, settings.sensor_noise, &mut random);
            }
            (channel, values)
        })
        .collect();
    Ok(DriveLog::new(name, 0.0, settings.step_s, channels)?)
}

impl Sensor {
    /// The value as recorded. `unsigned` sensors read exactly 0 at 0, as a wheel that stands, and never less.
    fn read(&self, value: f64, unsigned: bool, noisy: bool, random: &mut Random) -> f64 {
        if !value.is_finite() || (unsigned && value <= 0.0) {
            return value;
        }
        let (measured, per_unit) = if noisy {
            (value + self.noise * random.normal(), self.per_unit_noisy)
        } else {
            (value, self.per_unit)
        };
        // Dividing gives the double nearest to the decimal number, so that a log stays short. `+ 0` removes the sign of −0.
        let rounded = (measured * per_unit).round() / per_unit + 0.0;
        if unsigned { rounded.max(0.0) } else { rounded }
    }
}

struct BatteryChannels {
    voltage_v: Vec<f64>,
    current_a: Vec<f64>,
    state_of_charge_pct: Vec<f64>,
}

/// Battery at every sample, from the operating point with the central difference of speed (one-sided at the ends).
fn battery(
    vehicle: &Vehicle,
    speed_mps: &[f64],
    slope_rad: &[f64],
    step_s: f64,
    full_pct: f64,
) -> BatteryChannels {
    let spec = &vehicle.spec().battery;
    let last = speed_mps.len() - 1;
    let mut channels = BatteryChannels {
        voltage_v: Vec::with_capacity(speed_mps.len()),
        current_a: Vec::with_capacity(speed_mps.len()),
        state_of_charge_pct: Vec::with_capacity(speed_mps.len()),
    };
    let mut used_j = 0.0;
    for k in 0..=last {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
        let time_s = (after - before) as f64 * step_s;
        let accel_mps2 = (speed_mps[after] - speed_mps[before]) / time_s;
        let point = vehicle.operating_point(speed_mps[k], accel_mps2, slope_rad[k]);
        let current_a = point.battery_current_a;
        channels
            .voltage_v
            .push(spec.open_circuit_voltage_v - current_a * spec.resistance_ohm);
        channels.current_a.push(current_a);
        channels
            .state_of_charge_pct
            .push((full_pct - 100.0 * used_j / BATTERY_ENERGY_J).max(0.0));
        used_j += point.battery_power_w * step_s;
    }
    channels
}
