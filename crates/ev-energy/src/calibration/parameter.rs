use super::bounds::Bounds;
use crate::road_load::RoadLoadSpec;
use crate::vehicle::VehicleSpec;

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
}

const PARAMETERS: [Parameter; 14] = [
    Parameter {
        key: "mass_kg",
        unit: "kg",
        value: |spec| Some(&mut spec.mass_kg),
        bounds: |start| (0.8 * start, 1.3 * start),
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
    },
    Parameter {
        key: "road_load.coefficients.drag_area_m2",
        unit: "m²",
        value: |spec| match &mut spec.road_load {
            RoadLoadSpec::Coefficients { drag_area_m2, .. } => Some(drag_area_m2),
            RoadLoadSpec::CoastDown { .. } => None,
        },
        bounds: |start| (0.5 * start, 2.0 * start),
    },
    Parameter {
        key: "road_load.coast_down.constant_n",
        unit: "N",
        value: |spec| match &mut spec.road_load {
            RoadLoadSpec::CoastDown { constant_n, .. } => Some(constant_n),
            RoadLoadSpec::Coefficients { .. } => None,
        },
        bounds: |start| (0.3 * start, 3.0 * start),
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
        bounds: |start| (0.5 * start, 2.0 * start),
    },
    Parameter {
        key: "weather.winter_rolling_surcharge",
        unit: "",
        value: |spec| Some(&mut spec.weather.winter_rolling_surcharge),
        bounds: |_| (0.0, 1.5),
    },
    Parameter {
        key: "auxiliary_power_w",
        unit: "W",
        value: |spec| Some(&mut spec.auxiliary_power_w),
        bounds: |_| (0.0, 2000.0),
    },
    Parameter {
        key: "gear_efficiency",
        unit: "",
        value: |spec| Some(&mut spec.gear_efficiency),
        bounds: |_| (0.85, 0.995),
    },
    Parameter {
        key: "motor.loss.copper_w_per_nm2",
        unit: "W/(N m)²",
        value: |spec| Some(&mut spec.motor.loss.as_mut()?.copper_w_per_nm2),
        bounds: |start| (0.0, 4.0 * start + 0.01),
    },
    Parameter {
        key: "motor.loss.constant_w",
        unit: "W",
        value: |spec| Some(&mut spec.motor.loss.as_mut()?.constant_w),
        bounds: |_| (0.0, 1500.0),
    },
    Parameter {
        key: "regeneration.max_decel_mps2",
        unit: "m/s²",
        value: |spec| Some(&mut spec.regeneration.max_decel_mps2),
        bounds: |_| (0.2, 4.0),
    },
    Parameter {
        key: "regeneration.max_power_w",
        unit: "W",
        value: |spec| Some(&mut spec.regeneration.max_power_w),
        bounds: |_| (5e3, 200e3),
    },
    // Apart, so that no pair of values is in the wrong order.
    Parameter {
        key: "regeneration.fade_start_mps",
        unit: "m/s",
        value: |spec| Some(&mut spec.regeneration.fade_start_mps),
        bounds: |_| (0.0, 2.0),
    },
    Parameter {
        key: "regeneration.fade_end_mps",
        unit: "m/s",
        value: |spec| Some(&mut spec.regeneration.fade_end_mps),
        bounds: |_| (2.05, 6.0),
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
    /// The parameters that a vehicle has. A road load of 0 stays 0; without cold trips the winter surcharge has no effect and is
    /// left out.
    pub(crate) fn of(spec: &VehicleSpec, with_winter: bool) -> Vec<Self> {
        let mut spec = spec.clone();
        PARAMETERS
            .into_iter()
            .filter(|p| with_winter || p.key != "weather.winter_rolling_surcharge")
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
    let mut spec = spec.clone();
    for (bounded, value) in parameters.iter().zip(values) {
        if let Some(place) = (bounded.parameter.value)(&mut spec) {
            *place = *value;
        }
    }
    spec
}
