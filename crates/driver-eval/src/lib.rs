//! How well driver models predict drives that they have not seen.
//!
//! One engine holds out: [`HoldOut`] says which items belong to a unit (a drive, a file, a driver), runs the folds in parallel and in
//! order. Upon it stand [`phase`] for acceleration and braking, [`speed_ahead`] for the next seconds, [`trip_driver`] for whole
//! trips, [`following`] and [`cruise`]. Baselines are always among what is compared. [`segmentation`] compares methods that cut drives,
//! and [`calibration`] fits a vehicle to drives and judges it on each that it has not seen.
//!
//! # Example
//!
//! ```
//! use drive_sim::{SynthSettings, simulate};
//! use driver_eval::phase::{EvaluationData, EvaluationSettings, leave_one_out};
//! use driver_model::{Motion, PhaseKind, PhaseSettings, DriveBehaviour};
//!
//! let vehicle = ev_energy::Vehicle::builtin("b250e")?;
//! let settings = SynthSettings { drives: 3, duration_s: 200.0, ..SynthSettings::default() };
//! let trips = simulate(&settings, &vehicle)?
//!     .into_iter()
//!     .map(|simulated| DriveBehaviour::of_drive(&[Motion::of_log(&simulated.log, 100.0)?], &PhaseSettings::default()))
//!     .collect::<Result<Vec<_>, _>>()?;
//!
//! let data = EvaluationData::by_trip(&trips);
//! let settings = EvaluationSettings::default();
//! let evaluation = leave_one_out(PhaseKind::Acceleration, &data, &vehicle, &settings, &|| {})?;
//! for (model, summary) in evaluation.models.iter().zip(&evaluation.summaries) {
//!     println!("{model:22} {:5.2} km/h  {:5.1} % in band", summary.figures.rmse_mps * 3.6, summary.figures.in_band_pct);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # References
//!
//! - W. G. Cochran: Sampling Techniques. Wiley, 1977 (the ratio of sums over units and its interval).

pub mod begun;
pub mod behaviour;
pub mod calibration;
pub mod cruise;
mod error;
pub mod following;
mod hold_out;
mod limits;
pub mod live_words;
pub mod model_examples;
pub mod model_words;
pub mod new_driver;
pub mod phase;
pub mod portrait;
mod predictions;
mod ratio_interval;
pub mod segmentation;
pub mod speed_ahead;
pub mod trajectory;
pub mod trip_driver;
pub mod units;
pub mod words;

pub use error::Error;
pub use hold_out::{HoldOut, Split};
pub use limits::LimitsKnown;
pub use predictions::{
    Predicted, PredictedAhead, PredictedCruise, PredictedFollowing, PredictedPhase, PredictedTrip,
    PredictionSettings, Predictions, check_horizons, predict,
};
