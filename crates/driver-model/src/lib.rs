//! How a driver accelerates, learnt from recorded drives, and how well that predicts drives it has not seen.
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
//! baselines          constant (v0, T), straight and smoothstep (v0, v_end, T)
//! ```
//!
//! Braking is acceleration in reversed time. The way there: a [`drive_log::Drive`] becomes a [`Trip`], its phases by labels
//! ([`HeuristicRules`]) and its segments by statistics ([`StatisticalRules`]), those under a leader's influence left out;
//! [`DriverModel::fit`] learns from a [`TrainingSet`], in which other drivers count less; [`leave_one_out`] holds every trip
//! or driver out once and sums up in an [`Evaluation`].
//!
//! [`CruiseModel`] says how the driver holds a speed, and [`portrait::Portrait`] what kind of driver this is.
//!
//! Behind a vehicle the gap decides: [`following_stretches`] cuts the stretches behind one leader out of a log,
//! [`FollowingModel::fit`] calibrates a model of car following by simulating them as a whole, and [`evaluate_following`]
//! holds every group of stretches out once.
//!
//! ```text
//! idm                 a = a_max [1 − (v/v_d)⁴ − (s*/s)²]            s* = s0 + max(0, v T + v Δv/(2 √(a_max b)))
//! constant-time-gap   a = (v_lead − v + λ (s − s0 − τ v))/τ         baseline
//! ```
//!
//! # Example
//!
//! ```
//! use driver_model::synth::{SynthSettings, simulate};
//! use driver_model::{EvaluationData, EvaluationSettings, PhaseKind, PhaseSettings, Trip, leave_one_out};
//! use drive_log::Drive;
//!
//! let vehicle = ev_energy::Vehicle::builtin("b250e")?;
//! let settings = SynthSettings { drives: 3, duration_s: 200.0, ..SynthSettings::default() };
//! let trips = simulate(&settings, &vehicle)?
//!     .into_iter()
//!     .map(|simulated| Trip::from_drive(&Drive::from(simulated.log), &PhaseSettings::default()))
//!     .collect::<Result<Vec<_>, _>>()?;
//!
//! let data = EvaluationData::by_trip(&trips);
//! let settings = EvaluationSettings::default();
//! let evaluation = leave_one_out(PhaseKind::Acceleration, &data, &vehicle, &settings, &|| {})?;
//! for (model, summary) in evaluation.models.iter().zip(&evaluation.summaries) {
//!     println!("{model:22} {:5.2} km/h  {:5.1} % in band", summary.figures.rmse_mps * 3.6, summary.figures.in_band_pct);
//! }
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

mod cruise;
mod energy;
mod error;
mod evaluate;
mod following;
mod free_run;
mod function_fit;
mod grid;
mod lead;
mod least_squares;
mod model;
mod model_file;
mod phase;
pub mod phase_model;
pub mod portrait;
mod prediction;
mod segmenter;
mod statistical;
mod statistics;
mod stream;
mod tally;
mod training;
pub mod trajectory;
mod trip;

pub use cruise::{
    Bias, CruiseErrors, CruiseEvaluation, CruiseFold, CruiseGroup, CruiseModel, CruiseSettings,
    CruiseStretch, CruiseSummary, cruise_stretches, evaluate_cruise,
};
pub use energy::{
    Auxiliaries, CalibrationReport, CalibrationScore, CalibrationTripScore, DriveEnergy,
    EnergyStep, EnergyTotals, Measured, PowerCurve, ResidualBin, Residuals, SlopeEffect,
    SlopeSource, calibrate_vehicle, drive_energy, slope_rad,
};
pub use error::{Error, LeftOut};
pub use evaluate::{
    BandCoverage, DEFAULT_PRIOR_WEIGHT, EnergyError, EvaluatedPhase, Evaluation, EvaluationData,
    EvaluationSettings, Figures, Fold, LearningPoint, PairedComparison, Summary, TrainingSource,
    Verdict, learning_curve, leave_one_out,
};
pub use following::{
    ConstantTimeGap, FollowingErrors, FollowingEvaluation, FollowingFit, FollowingFold,
    FollowingGroup, FollowingKind, FollowingModel, FollowingSettings, FollowingStretch,
    FollowingSummary, Idm, PairedDifference, PerFollowingModel, ScoredStretch, SimulatedFollowing,
    evaluate_following, following_stretches,
};
pub use free_run::{
    AccelerationLaw, BrakingLaw, FreeRun, FreeRunEvaluation, FreeRunFold, FreeRunGroup,
    FreeRunScore, FreeRunSettings, FreeRunSummary, FreeRunTrip, HabitLine, LimitFrom, LimitHabit,
    LimitSlowdowns, NODE_SPACING_M, PercentErrors, Road, RoadKnowledge, RoadMap, RoadStop, SlopeAt,
    SlowPoint, Slowdowns, TripDriver, WantedSpeed, evaluate_free_run,
};
pub use function_fit::{AccelDensity, FunctionFit, function_fits};
pub use lead::{INFLUENCE_GAP_S, lead_influenced};
pub use model::{DriverModel, ModelKind};
pub use model_file::{
    Behaviour, FittedModel, MODEL_SCHEMA, ModelFile, TrainingInput, TrainingRecord,
};
pub use phase::{HeuristicRules, Onset, Phase, PhaseCurve, PhaseKind, PhaseOutline, most_divided};
pub use phase_model::SpeedGroup;
pub use prediction::PhasePrediction;
pub use segmenter::{MethodFigures, Segmenter};
pub use statistical::{
    Method, Optimality, Scaling, Segmented, Segments, StatisticalRules, dead_banded,
};
pub use stream::{PhaseStream, Reading, StreamedPhase};
pub use training::{AccelPoint, PointsOf, TrainingPhase, TrainingSet};
pub use trip::{LeadInfluenced, PhaseSettings, Segment, Trip};
