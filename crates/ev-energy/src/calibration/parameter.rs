use super::bounds::Bounds;
use super::trip::CalibrationTrip;
use crate::cells::CellIntakeSpec;
use crate::road_load::RoadLoadSpec;
use crate::vehicle::VehicleSpec;
use crate::weather::SUMMER_DEGC;

/// A value of a vehicle file that power measurements may tell.
#[derive(Debug, Clone, Copy)]
struct Parameter {
    /// Dotted key.
    key: &'static str,
    unit: &'static str,
    /// The value, `None` where the vehicle has no such key.
    value: fn(&mut VehicleSpec) -> Option<&mut f64>,
    /// Bounds for a start value, wide enough for any other car of its kind.
    bounds: fn(f64) -> (f64, f64),
    needs: Needs,
}

/// Where a fit begins of what the vehicle does not have, as a share of the width of the bounds.
const BEGIN_SHARE: f64 = 0.25;

/// What trips must have beside power for a parameter to have an effect, or to be told from others.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Needs {
    Nothing,
    ColdAir,
    ColdStart,
    Cells,
    Torque,
}

impl Needs {
    fn are_met(self, trips: &[&CalibrationTrip]) -> bool {
        let any = |has: fn(&CalibrationTrip) -> bool| trips.iter().any(|trip| has(trip));
        match self {
            Self::Nothing => true,
            Self::ColdAir => any(|trip| trip.is_colder_than(SUMMER_DEGC)),
            Self::ColdStart => any(CalibrationTrip::has_cold_start),
            Self::Cells => any(CalibrationTrip::has_cells),
            Self::Torque => any(|trip| trip.torque_means() > 0),
        }
    }
}

fn cells(spec: &mut VehicleSpec) -> &mut CellIntakeSpec {
    spec.regeneration.cells.get_or_insert_default()
}

const PARAMETERS: [Parameter; 22] = [
    Parameter {
        key: "mass_kg",
        unit: "kg",
        value: |spec| Some(&mut spec.mass_kg),
        bounds: |start| (0.8 * start, 1.3 * start),
        needs: Needs::Nothing,
    },
    Parameter {
        key: "road_load.coefficients.rolling_coefficient",
        unit: "",
        value: |spec| match &mut spec.road_load {
            RoadLoadSpec::Coefficients {
                rolling_coefficient,
                ..
            } => Some(rolling_coefficient),
            RoadLoadSpec::CoastDown { .. } => None,
        },
        bounds: |start| (0.3 * start, 3.0 * start),
        needs: Needs::Nothing,
    },
    Parameter {
        key: "road_load.coefficients.drag_area_m2",
        unit: "m²",
        value: |spec| match &mut spec.road_load {
            RoadLoadSpec::Coefficients { drag_area_m2, .. } => Some(drag_area_m2),
            RoadLoadSpec::CoastDown { .. } => None,
        },
        bounds: |start| (0.5 * start, 2.0 * start),
        needs: Needs::Nothing,
    },
    Parameter {
        key: "road_load.coast_down.constant_n",
        unit: "N",
        value: |spec| match &mut spec.road_load {
            RoadLoadSpec::CoastDown { constant_n, .. } => Some(constant_n),
            RoadLoadSpec::Coefficients { .. } => None,
        },
        bounds: |start| (0.3 * start, 3.0 * start),
        needs: Needs::Nothing,
    },
    Parameter {
        key: "road_load.coast_down.quadratic_n_per_mps2",
        unit: "N/(m/s)²",
        value: |spec| match &mut spec.road_load {
            RoadLoadSpec::CoastDown {
                quadratic_n_per_mps2,
                ..
            } => Some(quadratic_n_per_mps2),
            RoadLoadSpec::Coefficients { .. } => None,
        },
        bounds: |start| (0.3 * start, 2.0 * start),
        needs: Needs::Nothing,
    },
    Parameter {
        key: "weather.winter_rolling_surcharge",
        unit: "",
        value: |spec| Some(&mut spec.weather.winter_rolling_surcharge),
        bounds: |_| (0.0, 1.5),
        needs: Needs::ColdAir,
    },
    Parameter {
        key: "auxiliary_power_w",
        unit: "W",
        value: |spec| Some(&mut spec.auxiliary_power_w),
        bounds: |_| (0.0, 2000.0),
        needs: Needs::Nothing,
    },
    Parameter {
        key: "warm_up.force_n",
        unit: "N",
        value: |spec| Some(&mut spec.warm_up.force_n),
        bounds: |_| (0.0, 500.0),
        needs: Needs::ColdStart,
    },
    Parameter {
        key: "warm_up.cold_rise_n",
        unit: "N",
        value: |spec| Some(&mut spec.warm_up.cold_rise_n),
        bounds: |_| (0.0, 500.0),
        needs: Needs::ColdStart,
    },
    // Volts times amps are torque times speed and losses.
    Parameter {
        key: "wheel_radius_m",
        unit: "m",
        value: |spec| Some(&mut spec.wheel_radius_m),
        bounds: |start| (0.93 * start, 1.07 * start),
        needs: Needs::Torque,
    },
    // One pair of gears and a differential.
    Parameter {
        key: "gear_efficiency",
        unit: "",
        value: |spec| Some(&mut spec.gear_efficiency),
        bounds: |_| (0.95, 0.99),
        needs: Needs::Nothing,
    },
    Parameter {
        key: "motor.loss.copper_w_per_nm2",
        unit: "W/(N m)²",
        value: |spec| Some(&mut spec.motor.loss.as_mut()?.copper_w_per_nm2),
        bounds: |start| (0.0, 4.0 * start + 0.01),
        needs: Needs::Nothing,
    },
    Parameter {
        key: "motor.loss.constant_w",
        unit: "W",
        value: |spec| Some(&mut spec.motor.loss.as_mut()?.constant_w),
        bounds: |_| (0.0, 1500.0),
        needs: Needs::Nothing,
    },
    Parameter {
        key: "motor.loss.weakening_w",
        unit: "W",
        value: |spec| Some(&mut spec.motor.loss.as_mut()?.weakening_w),
        bounds: |_| (0.0, 20e3),
        needs: Needs::Torque,
    },
    Parameter {
        key: "motor.loss.weakening_from_share",
        unit: "",
        value: |spec| Some(&mut spec.motor.loss.as_mut()?.weakening_from_share),
        bounds: |_| (0.25, 0.9),
        needs: Needs::Torque,
    },
    Parameter {
        key: "regeneration.max_decel_mps2",
        unit: "m/s²",
        value: |spec| Some(&mut spec.regeneration.max_decel_mps2),
        bounds: |_| (0.2, 4.0),
        needs: Needs::Nothing,
    },
    Parameter {
        key: "regeneration.max_power_w",
        unit: "W",
        value: |spec| Some(&mut spec.regeneration.max_power_w),
        bounds: |_| (5e3, 200e3),
        needs: Needs::Nothing,
    },
    Parameter {
        key: "regeneration.cells.power_w",
        unit: "W",
        value: |spec| Some(&mut cells(spec).power_w),
        bounds: |_| (1e3, 100e3),
        needs: Needs::Cells,
    },
    Parameter {
        key: "regeneration.cells.power_w_per_k",
        unit: "W/K",
        value: |spec| Some(&mut cells(spec).power_w_per_k),
        bounds: |_| (0.0, 15e3),
        needs: Needs::Cells,
    },
    Parameter {
        key: "regeneration.cells.power_w_per_soc_pct",
        unit: "W/%",
        value: |spec| Some(&mut cells(spec).power_w_per_soc_pct),
        bounds: |_| (0.0, 3e3),
        needs: Needs::Cells,
    },
    // Apart, so that no pair of values is in the wrong order.
    Parameter {
        key: "regeneration.fade_start_mps",
        unit: "m/s",
        value: |spec| Some(&mut spec.regeneration.fade_start_mps),
        bounds: |_| (0.0, 2.0),
        needs: Needs::Nothing,
    },
    Parameter {
        key: "regeneration.fade_end_mps",
        unit: "m/s",
        value: |spec| Some(&mut spec.regeneration.fade_end_mps),
        bounds: |_| (2.05, 6.0),
        needs: Needs::Nothing,
    },
];

/// A parameter of one vehicle within its bounds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounded {
    parameter: Parameter,
    pub(crate) start: f64,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
}

impl Bounded {
    /// The parameters that a vehicle has and trips have what it takes for. A road load of 0 stays 0.
    pub(crate) fn of(spec: &VehicleSpec, trips: &[&CalibrationTrip]) -> Vec<Self> {
        let mut spec = spec.clone();
        PARAMETERS
            .into_iter()
            .filter(|parameter| parameter.needs.are_met(trips))
            .filter_map(|parameter| {
                let start = *(parameter.value)(&mut spec)?;
                let (lower, upper) = (parameter.bounds)(start);
                Some(Self {
                    parameter,
                    start,
                    lower,
                    upper,
                })
            })
            .filter(|bounded| bounded.width() > 0.0)
            .collect()
    }

    pub(crate) fn key(&self) -> &'static str {
        self.parameter.key
    }

    pub(crate) fn unit(&self) -> &'static str {
        self.parameter.unit
    }

    pub(crate) fn bounds(&self) -> Bounds {
        Bounds {
            lower: self.lower,
            upper: self.upper,
        }
    }

    /// Where a fit begins: well within the bounds, where the vehicle has a value that stands for none.
    pub(crate) fn begin(&self) -> f64 {
        if self.start > self.lower && self.start < self.upper {
            self.start
        } else {
            self.lower + BEGIN_SHARE * self.width()
        }
    }

    /// Width of the bounds.
    pub(crate) fn width(&self) -> f64 {
        self.bounds().width()
    }
}

/// A vehicle with other values of the parameters.
pub(crate) fn with_values(
    spec: &VehicleSpec,
    parameters: &[Bounded],
    values: &[f64],
) -> VehicleSpec {
    let wheel_radius_m = spec.wheel_radius_m;
    let mut spec = spec.clone();
    for (bounded, value) in parameters.iter().zip(values) {
        if let Some(place) = (bounded.parameter.value)(&mut spec) {
            *place = *value;
        }
    }
    // A motor that turns faster on a smaller wheel was not asked for a lower top speed.
    spec.motor.max_speed_rad_s *= wheel_radius_m / spec.wheel_radius_m;
    spec
}
