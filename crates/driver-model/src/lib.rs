//! How a driver accelerates, brakes, holds a speed and follows, learnt from recorded drives.
//!
//! Of an acceleration or braking phase a model may know the speed `v0` at its start, its duration `T` and, some, the speed
//! `v_end` at its end; it answers with the speed `v(t)`, `0 ≤ t ≤ T`:
//!
//! ```text
//! inverse            v̇ = 1/(p1 v + p2)                        knows v0, T           function fit on segment means
//! exponential        v̇ = p0·e^(−p1 v) + p2                    knows v0, T           the same; p0 = 1 as printed
//! rise-time          v = v0 + K(1 − (1 + t/T_c)e^(−t/T_c))     knows v0, v_end, T    K = v_end − v0, T_c per speed group
//! transition-point   v = v0 + K·h(t)                          knows v0, v_end, T    h of order 2 to 10 per speed group
//! profile            v = v0 + K·s(t/T)                        knows v0, v_end, T    s is the driver's mean shape
//! profile-onset      v = v0 + K·s(t/T; v0, T, K, onset)       knows also the onset  with a predictive band
//! profile-pedal      the same, also of what the driver does    knows also the pedal  and for logs without as profile-onset
//! baselines          constant (v0, T), straight and smoothstep (v0, v_end, T)
//! ```
//!
//! Braking is acceleration in reversed time. The way there: a [`drive_log::Drive`] becomes a [`DriveBehaviour`], its phases by labels
//! ([`segmentation::HeuristicRules`]) and its segments by statistics ([`segmentation::StatisticalRules`]), those under a leader's influence left out;
//! [`PhaseModel::fit`] learns from a [`TrainingSet`], in which other drivers count less.
//!
//! By module: [`cruise`] says how the driver holds a speed, [`following`] how he keeps the distance to a vehicle ahead,
//! [`speed_ahead`] what speed the next seconds bring, [`trip_driver`] how a whole trip over a [`road`] goes, [`energy`] what it
//! costs, and [`portrait`] what kind of driver this is. [`live`] predicts while a drive goes on.
//!
//! # Example
//!
//! ```
//! use drive_log::{Channel, DriveLog};
//! use driver_model::{PhaseModel, ModelKind, Motion, PhaseKind, PhaseSettings, TrainingSet, DriveBehaviour};
//!
//! // Ten times from rest to 50 km/h and back, a sample every 0.1 s.
//! let rise = |k: usize| 13.9 * (1.0 - (std::f64::consts::PI * k as f64 / 100.0).cos()) / 2.0;
//! let speed_mps: Vec<f64> = (0..2000).map(|k| rise(k % 200)).collect();
//! let log = DriveLog::new("anna", 0.0, 0.1, [(Channel::Speed, speed_mps)].into_iter().collect())?;
//!
//! let motion = Motion::of_log(&log, 100.0)?;
//! let trip = DriveBehaviour::of_drive(&[motion], &PhaseSettings::default())?;
//! let set = TrainingSet::from_trips(PhaseKind::Acceleration, [&trip]);
//! let model = PhaseModel::fit(ModelKind::Profile, &set)?;
//! let outline = trip.phases[0].outline();
//! assert_eq!(model.predict(&outline).len(), outline.samples);
//! # Ok::<(), driver_model::Error>(())
//! ```
//!
//! # References
//!
//! - Equation, table and figure numbers are those of the thesis that drivekit implements, chapters 3.2 to 3.4, with its
//!   corrections.
//! - A. R. Conn, N. I. M. Gould, P. L. Toint: Trust-Region Methods. SIAM, 2000.
//! - M. Treiber, A. Hennecke, D. Helbing: Congested traffic states in empirical observations and microscopic
//!   simulations. Physical Review E 62, 2000. The simulated drivers follow by it.
//! - A. Kesting, M. Treiber: Calibrating car-following models by using trajectory data. Transportation Research Record
//!   2088, 2008.

mod accel_point;
pub mod cruise;
mod drive_behaviour;
mod driver_channel;
mod driver_input;
mod driver_model;
pub mod energy;
pub mod error;
mod fit;
pub mod following;
mod function_fit;
mod grid;
mod kind;
mod least_squares;
pub mod live;
mod memory;
mod model;
mod model_file;
pub mod motion;
mod phase;
pub mod phase_model;
pub mod portrait;
pub mod road;
pub mod segmentation;
mod span;
pub mod speed_ahead;
mod speed_group;
pub mod statistics;
mod tally;
mod training;
pub mod trip_driver;

pub use accel_point::AccelPoint;
pub use drive_behaviour::{BEGUN_S, DriveBehaviour, LeadInfluenced, PhaseSettings, Segment};
pub use driver_channel::DriverChannel;
pub use driver_input::DriverInput;
pub use driver_model::{Behaviour, DriverModel, Situation};
pub use error::{Error, LeftOut};
pub use fit::{
    FitSettings, Fitted, Manoeuvre, Prior, find_behaviour, fit, fit_with, update, without,
};
pub use function_fit::{AccelDensity, FunctionFit, function_fits};
pub use kind::{ModelKind, Subject};
pub use memory::PhaseMemory;
pub use model::PhaseModel;
pub use model_file::{MODEL_SCHEMA, ModelFile, TrainingInput, TrainingRecord};
pub use motion::{LimitCover, Motion, SlopeSource};
pub use phase::{Onset, Phase, PhaseCurve, PhaseSpeeds};
pub use segmentation::PhaseExtent;
pub use span::{PhaseKind, Span};
pub use speed_group::SpeedGroup;
pub use training::{PointsOf, TrainingPhase, TrainingSet};
