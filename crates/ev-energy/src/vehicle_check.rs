use std::collections::BTreeMap;

use serde::Serialize;

use crate::cycle::Cycle;
use crate::error::Error;
use crate::trip::Trip;
use crate::vehicle::{Confidence, ConsumptionUse, Vehicle};

/// What a vehicle file amounts to, from [`Vehicle::check`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VehicleCheck {
    /// Consumption of the model against what was published.
    pub consumption: Vec<ConsumptionCheck>,
    /// Best efficiency of motor and inverter, 1.
    pub peak_efficiency: f64,
    /// Motor torque there, N m.
    pub peak_torque_nm: f64,
    /// Motor speed there, rad/s.
    pub peak_speed_rad_s: f64,
    /// Highest speed that the motor holds on a level road, m/s.
    pub top_speed_mps: f64,
    /// How many sources have which confidence.
    pub confidence: BTreeMap<Confidence, usize>,
    /// Keys of values without a source.
    pub without_source: Vec<String>,
}

/// A published consumption and the model's.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConsumptionCheck {
    /// The cycle.
    pub cycle: Cycle,
    /// Published, at the wall.
    pub published_kwh_per_100km: f64,
    /// By the model, at the wall.
    pub model_kwh_per_100km: f64,
    /// Model minus published, %.
    pub error_pct: f64,
    /// Whether the vehicle was adjusted to it.
    #[serde(rename = "use")]
    pub purpose: ConsumptionUse,
    /// Where the published figure comes from.
    pub source: String,
}

/// Spacing of the search for the best efficiency.
const TORQUE_STEPS: u32 = 100;
const SPEED_STEPS: u32 = 100;

/// Spacing of the search for the highest speed, m/s.
const TOP_SPEED_STEP_MPS: f64 = 0.1;

impl Vehicle {
    /// Runs the standard cycles that the vehicle file has figures for, and finds what a person would compare with the brochure.
    ///
    /// # Errors
    /// [`Error::Write`] where the vehicle has no TOML form.
    pub fn check(&self) -> Result<VehicleCheck, Error> {
        let spec = self.spec();
        let consumption = spec
            .consumption
            .iter()
            .map(|figure| {
                let model = self.cycle_wall_kwh_per_100km(figure.cycle)?;
                let published = figure.wall_kwh_per_100km;
                Ok(ConsumptionCheck {
                    cycle: figure.cycle,
                    published_kwh_per_100km: published,
                    model_kwh_per_100km: model,
                    error_pct: 100.0 * (model - published) / published,
                    purpose: figure.purpose,
                    source: figure.source.clone(),
                })
            })
            .collect::<Result<_, Error>>()?;
        let (peak_efficiency, peak_torque_nm, peak_speed_rad_s) = self.peak_efficiency()?;
        let mut confidence = BTreeMap::new();
        for source in spec.sources.values() {
            *confidence.entry(source.confidence).or_default() += 1;
        }
        Ok(VehicleCheck {
            consumption,
            peak_efficiency,
            peak_torque_nm,
            peak_speed_rad_s,
            top_speed_mps: self.top_speed_mps(),
            confidence,
            without_source: self.without_source()?,
        })
    }

    /// Energy from the wall for a cycle, kWh per 100 km.
    fn cycle_wall_kwh_per_100km(&self, cycle: Cycle) -> Result<f64, Error> {
        let energy = self.trip_energy(&Trip {
            step_s: 1.0,
            speed_mps: &cycle.speed_mps(),
            ..Trip::default()
        })?;
        Ok(energy.wall_kwh_per_100km().unwrap_or(f64::NAN))
    }

    /// With the whole spin loss, also what the road load contains.
    fn peak_efficiency(&self) -> Result<(f64, f64, f64), Error> {
        let mut spec = self.spec().clone();
        if let Some(loss) = &mut spec.motor.loss {
            loss.spin_share_in_road_load = 0.0;
        }
        if let Some(table) = &mut spec.motor.loss_table {
            table.spin_share_in_road_load = 0.0;
        }
        let whole = Vehicle::new(spec)?.motor;
        let motor = &self.spec().motor;
        let mut best = (0.0, 0.0, 0.0);
        for row in 1..=SPEED_STEPS {
            let speed_rad_s = motor.max_speed_rad_s * f64::from(row) / f64::from(SPEED_STEPS);
            for column in 1..=TORQUE_STEPS {
                let torque_nm = motor.max_torque_nm * f64::from(column) / f64::from(TORQUE_STEPS);
                if torque_nm > whole.torque_limit_nm(speed_rad_s) {
                    break;
                }
                let shaft_w = torque_nm * speed_rad_s;
                let efficiency = shaft_w / (shaft_w + whole.loss_w(torque_nm, speed_rad_s));
                if efficiency > best.0 {
                    best = (efficiency, torque_nm, speed_rad_s);
                }
            }
        }
        Ok(best)
    }

    fn top_speed_mps(&self) -> f64 {
        let fastest_mps = self.spec().motor.max_speed_rad_s / self.motor_speed_per_mps;
        let steps = (fastest_mps / TOP_SPEED_STEP_MPS) as u32;
        (1..=steps)
            .map(|step| f64::from(step) * TOP_SPEED_STEP_MPS)
            .take_while(|&v| !self.operating_point(v, 0.0, 0.0).limited.torque)
            .last()
            .unwrap_or(0.0)
    }

    /// Dotted keys of values that neither they nor a section around them have a source for.
    fn without_source(&self) -> Result<Vec<String>, Error> {
        let spec = self.spec();
        let table = toml::Table::try_from(spec).map_err(|source| Error::Write {
            name: spec.name.clone(),
            source,
        })?;
        let mut missing = Vec::new();
        let mut open: Vec<(String, &toml::Value)> = table
            .iter()
            .filter(|(key, _)| {
                ![
                    "name",
                    "description",
                    "sources",
                    "consumption",
                    "calibration",
                ]
                .contains(&key.as_str())
            })
            .map(|(key, value)| (key.clone(), value))
            .collect();
        while let Some((path, value)) = open.pop() {
            if spec.sources.contains_key(&path) {
                continue;
            }
            match value.as_table() {
                Some(children) => {
                    open.extend(children.iter().map(|(key, v)| (format!("{path}.{key}"), v)));
                }
                None => missing.push(path),
            }
        }
        missing.sort();
        Ok(missing)
    }
}
