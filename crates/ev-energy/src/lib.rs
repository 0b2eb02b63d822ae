//! Energy demand of an electric car: a motion in, power and energy out.
//!
//! The model is quasi-static. Speed `v`, acceleration `a` and slope `θ` are given, and the chain
//! runs backwards from the wheels to the cells:
//!
//! ```text
//! F     = m_eff a + F_roll + F_air + m g sin θ          m_eff = m + J/r²
//! F_roll + F_air = c_r m g cos θ + ½ ρ c_w A v²         or, from a coast-down,  A cos θ + B v + C v²
//! ω     = v i / r
//! T     = clamp(F r / (i η^±1), −T_regen(ω, v), T_max(ω))
//! P_el  = T ω + P_loss(T, ω) + P_aux
//! I     = 2 P_el / (U0 + sqrt(U0² − 4 R P_el)),         P_bat = I U0
//! ```
//!
//! What the motor cannot take goes to the friction brakes. What motor or battery cannot give is no
//! error: the result says so, in seconds and in joules.
//!
//! The principal type is [`Vehicle`]. It comes from the [`library`], from a TOML file or from a
//! [`VehicleSpec`], and answers [`Vehicle::operating_point`] for one instant and
//! [`Vehicle::trip_energy`] for a trip.
//!
//! ```
//! use ev_energy::{Trip, Vehicle};
//!
//! let vehicle = Vehicle::builtin("b250e")?;
//!
//! // From rest to 10 m/s in 10 s, then 50 s at that speed, one sample per second.
//! let speed_mps: Vec<f64> = (0..=60).map(|t| f64::from(t).min(10.0)).collect();
//! let trip = Trip { step_s: 1.0, speed_mps: &speed_mps, ..Trip::default() };
//! let energy = vehicle.trip_energy(&trip)?;
//!
//! assert_eq!(energy.distance_m, 550.0);
//! let sum = energy.budget.total_j() - energy.limited.undelivered_j;
//! assert!((energy.battery_energy_j - sum).abs() < 1e-6);
//! # Ok::<(), ev_energy::Error>(())
//! ```
//!
//! Signs: force, torque, power and current are positive when they propel or discharge, negative
//! when they brake or charge. Units are SI; the slope is an angle.
//!
//! # References
//!
//! - L. Guzzella, A. Sciarretta: Vehicle Propulsion Systems, 3rd edition, Springer 2013, chapters 2
//!   and 4 (quasi-static model, battery).
//! - J. Larminie, J. Lowry: Electric Vehicle Technology Explained, 2nd edition, Wiley 2012 (terms
//!   of the motor loss).
//! - C. Lanczos: Applied Analysis, Prentice Hall 1956, chapter 5 (derivative by integration).
//! - "Thesis" with an equation number is the driver-modelling thesis that this workspace
//!   implements; "corrected" marks an equation that is wrong as printed.

mod battery;
pub mod calibration;
mod cells;
mod check;
pub mod comparison;
mod cycle;
mod error;
mod formula;
mod grade;
mod jet;
pub mod library;
mod loss_table;
mod motor;
mod operating_point;
mod road_load;
mod scalar;
mod step;
mod trip;
mod trip_energy;
mod vehicle;
mod vehicle_check;
mod warm_up;
mod weather;

pub use battery::{Battery, BatteryDraw, BatterySpec, VoltageCurveSpec};
pub use cells::{CellIntakeSpec, CellState};
pub use cycle::Cycle;
pub use error::Error;
pub use formula::{KinkWidths, SmoothStep, StepFormula};
pub use grade::{DEFAULT_SLOPE_BANDWIDTH_M, slope_from_accelerometer, slope_from_elevation};
pub use loss_table::{LossTable, LossTableSpec};
pub use motor::{Motor, MotorLossSpec, MotorSpec, RegenerationSpec};
pub use operating_point::{Limited, OperatingPoint};
pub use road_load::RoadLoadSpec;
pub use step::{RoadStep, StepModel};
pub use trip::{Trip, TripPoints};
pub use trip_energy::{Budget, JOULES_PER_KWH, LimitedTotals, TripEnergy, WheelEnergy};
pub use vehicle::{
    CalibrationRecord, Confidence, Consumption, ConsumptionUse, Source, Vehicle, VehicleSpec,
};
pub use vehicle_check::{ConsumptionCheck, VehicleCheck};
pub use warm_up::WarmUpSpec;
pub use weather::{Weather, WeatherSpec};

/// Gravitational acceleration `g`, m/s², rounded; standard gravity, 9.80665 m/s², is 0.03 % less.
pub const GRAVITY_MPS2: f64 = 9.81;
