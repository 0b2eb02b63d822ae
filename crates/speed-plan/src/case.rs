//! A problem as a JSON file states it: car, grid, bounds and windows given, `drivekit/planning-vector/1`.

use ev_energy::{
    BatterySpec, MotorLossSpec, MotorSpec, RegenerationSpec, RoadLoadSpec, Vehicle, VehicleSpec,
};
use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::envelope::{Envelope, EnvelopePoint};
use crate::error::Error;
use crate::problem::{Columns, Signal};

/// A case that was read: everything that a [`Problem`](crate::Problem) takes, and when to arrive.
#[derive(Debug, Clone)]
pub struct Case {
    /// Name.
    pub name: String,
    /// The car.
    pub vehicle: Vehicle,
    /// The road.
    pub columns: Columns,
    /// Accelerations that are allowed.
    pub envelope: Envelope,
    /// Latest arrival, s; `None` where time costs nothing.
    pub latest_arrival_s: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CaseSpec {
    schema: String,
    #[serde(default)]
    name: String,
    vehicle: CarSpec,
    position_m: Vec<f64>,
    slope_rad: Vec<f64>,
    speed_min_mps: Vec<f64>,
    speed_max_mps: Vec<f64>,
    accel_min_mps2: Option<f64>,
    accel_max_mps2: Option<f64>,
    #[serde(default)]
    accel_envelope: Vec<AccelSpec>,
    #[serde(default)]
    stops: Vec<StopSpec>,
    #[serde(default)]
    signals: Vec<SignalSpec>,
    #[serde(default)]
    earliest_passage_s: Vec<Option<f64>>,
    latest_arrival_s: Option<f64>,
    /// Where `earliest_passage_s` comes from; what it says by itself is not planned for.
    leader: Option<IgnoredAny>,
    /// What is expected of a plan, and words about it.
    #[serde(default, rename = "expect")]
    _expect: IgnoredAny,
    #[serde(default, rename = "notes")]
    _notes: IgnoredAny,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AccelSpec {
    speed_mps: f64,
    accel_min_mps2: f64,
    accel_max_mps2: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StopSpec {
    node: usize,
    dwell_s: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SignalSpec {
    node: usize,
    green: Vec<[f64; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CarSpec {
    mass_kg: f64,
    rotating_inertia_kg_m2: f64,
    wheel_radius_m: f64,
    gear_ratio: f64,
    gear_efficiency: f64,
    auxiliary_power_w: f64,
    road_load: CoastDownSpec,
    motor: CarMotorSpec,
    regeneration: RegenerationSpec,
    battery: CarBatterySpec,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CoastDownSpec {
    constant_n: f64,
    linear_n_per_mps: f64,
    quadratic_n_per_mps2: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CarMotorSpec {
    max_torque_nm: f64,
    max_power_w: f64,
    max_speed_rad_s: f64,
    copper_w_per_nm2: f64,
    iron_w_per_rad_s: f64,
    windage_w_per_rad3_s3: f64,
    constant_w: f64,
    #[serde(default)]
    spin_share_in_road_load: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CarBatterySpec {
    open_circuit_voltage_v: f64,
    resistance_ohm: f64,
}

impl Case {
    /// Reads a case from JSON text; `file` names it in errors.
    ///
    /// # Errors
    /// [`Error::Case`] for what is no case, and as [`Vehicle::new`], [`Envelope::new`] and [`Problem::new`](crate::Problem::new).
    pub fn from_json(text: &str, file: &str) -> Result<Self, Error> {
        let spec: CaseSpec = serde_json::from_str(text).map_err(|source| Error::Case {
            file: file.to_owned(),
            source,
        })?;
        let refused = |problem: String| Error::Case {
            file: file.to_owned(),
            source: serde::de::Error::custom(problem),
        };
        if spec.schema != "drivekit/planning-vector/1" {
            return Err(refused(format!(
                "the schema is `{}`, expected `drivekit/planning-vector/1`",
                spec.schema
            )));
        }
        if spec.leader.is_some() && spec.earliest_passage_s.is_empty() {
            return Err(refused(
                "a leader without `earliest_passage_s`; give when each node can be passed behind it"
                    .to_owned(),
            ));
        }
        let points = spec.accel_envelope.iter().map(|point| EnvelopePoint {
            speed_mps: point.speed_mps,
            min_mps2: point.accel_min_mps2,
            max_mps2: point.accel_max_mps2,
        });
        let envelope = if spec.accel_envelope.is_empty() {
            Envelope::constant(
                spec.accel_min_mps2.unwrap_or(-2.0),
                spec.accel_max_mps2.unwrap_or(1.5),
            )?
        } else {
            Envelope::new(points.collect())?
        };
        let nodes = spec.position_m.len();
        let mut dwell_s = vec![0.0; nodes];
        for (index, stop) in spec.stops.iter().enumerate() {
            let Some(dwell_s) = dwell_s.get_mut(stop.node) else {
                return Err(Error::Value {
                    channel: "stops",
                    index,
                    value: stop.node as f64,
                    problem: "no such node",
                });
            };
            *dwell_s += stop.dwell_s;
        }
        let signals = spec.signals.into_iter().map(|signal| Signal {
            node: signal.node,
            green_s: signal.green,
        });
        let free_s = crate::problem::NO_LEADER_S;
        let earliest_s = spec
            .earliest_passage_s
            .iter()
            .map(|time_s| time_s.unwrap_or(free_s));
        Ok(Self {
            vehicle: Vehicle::new(spec.vehicle.into_vehicle(&spec.name))?,
            columns: Columns {
                position_m: spec.position_m,
                slope_rad: spec.slope_rad,
                min_mps: spec.speed_min_mps,
                max_mps: spec.speed_max_mps,
                dwell_s,
                signals: signals.collect(),
                earliest_s: earliest_s.collect(),
            },
            name: spec.name,
            envelope,
            latest_arrival_s: spec.latest_arrival_s,
        })
    }
}

impl CarSpec {
    fn into_vehicle(self, name: &str) -> VehicleSpec {
        VehicleSpec {
            name: name.to_owned(),
            description: "car of a case".to_owned(),
            mass_kg: self.mass_kg,
            rotating_inertia_kg_m2: self.rotating_inertia_kg_m2,
            wheel_radius_m: self.wheel_radius_m,
            gear_ratio: self.gear_ratio,
            gear_efficiency: self.gear_efficiency,
            auxiliary_power_w: self.auxiliary_power_w,
            road_load: RoadLoadSpec::CoastDown {
                constant_n: self.road_load.constant_n,
                linear_n_per_mps: self.road_load.linear_n_per_mps,
                quadratic_n_per_mps2: self.road_load.quadratic_n_per_mps2,
            },
            motor: MotorSpec {
                max_torque_nm: self.motor.max_torque_nm,
                max_power_w: self.motor.max_power_w,
                max_speed_rad_s: self.motor.max_speed_rad_s,
                loss: Some(MotorLossSpec {
                    copper_w_per_nm2: self.motor.copper_w_per_nm2,
                    iron_w_per_rad_s: self.motor.iron_w_per_rad_s,
                    windage_w_per_rad3_s3: self.motor.windage_w_per_rad3_s3,
                    constant_w: self.motor.constant_w,
                    spin_share_in_road_load: self.motor.spin_share_in_road_load,
                    weakening_w: 0.0,
                    weakening_from_share: 0.5,
                }),
                loss_table: None,
            },
            regeneration: self.regeneration,
            battery: BatterySpec {
                open_circuit_voltage_v: self.battery.open_circuit_voltage_v,
                resistance_ohm: self.battery.resistance_ohm,
                charging_efficiency: 1.0,
                capacity_ah: None,
                open_circuit_voltage_curve: None,
            },
            weather: Default::default(),
            warm_up: Default::default(),
            calibration: None,
            consumption: Vec::new(),
            sources: Default::default(),
        }
    }
}
