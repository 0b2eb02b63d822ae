//! Robots that keep their lane and their distance to the one ahead, by a quadratic program with barrier and Lyapunov rows.
//!
//! The state is that of a point `a` ahead of the axle, `x = [x, y, v, ψ, ω]`; force and torque `u = [u_l, u_a]` move it (thesis
//! 2.21, with `s = ±1` the sign of the centripetal term):
//!
//! ```text
//! ẋ = v cos ψ − a ω sin ψ,   ẏ = v sin ψ + a ω cos ψ,   v̇ = u_l/m − s a ω²,   ψ̇ = ω,   ω̇ = u_a/I_z
//! ```
//!
//! In every period a program in `z = [u_l, u_a, δ1, δ2, δ3]` is solved (3.7, corrected):
//!
//! ```text
//! minimise    zᵀ diag(p1 … p5) z
//! subject to  L_f V_i + L_g V_i u ≤ −c_i V_i + δ_i    speed, turn rate, path: as far as the others allow
//!             L_f h + L_g h u ≥ −γ (h − margin)       headway and lane: always
//!             wheel speeds and turn rate of the next command within their limits
//! ```
//!
//! Force and torque are integrated over the period, and the robot is told the speeds.
//!
//! | | what |
//! |---|---|
//! | [`Controller::decide`] | a state, the robot ahead and objectives in; a [`Decision`] with its rows, optimum and multipliers out |
//! | [`Pilot`] | the same over time: predicts the state from late poses, and stops the robot when they are too old |
//! | [`clf`], [`cbf`] | the functions with their Lie derivatives, in closed form |
//! | [`qp`] | the solver: dual active set, exact, no heap |
//! | [`path`] | polar, straight and closed paths with the Frenet frame |
//! | [`Scenario`], [`Testbed`] | experiments: the five runs of the thesis, and others |
//!
//! Where the program has no solution, rows of the lane share a slack ([`Outcome::Relaxed`]), and where even that does not help
//! the robot stops ([`Outcome::Braking`]). A step neither allocates nor panics, and the same inputs give the same bits.
//!
//! ```
//! use unicycle_cbf::{Leader, Outcome, Preset, Scenario, State, Testbed};
//!
//! let spec = Testbed::Khepera.scenario("on-off", Preset::Hardened)?;
//! let scenario = Scenario::new(spec)?;
//! let controller = scenario.controller();
//! let own = State { x_m: 0.9, y_m: 0.0, speed_mps: 0.1, heading_rad: 0.94, turn_rate_rad_s: 0.0 };
//! let ahead = State { x_m: 0.0, y_m: 0.67, ..own };
//! let decision = controller.decide(&own, Some(&Leader::known(ahead)), &controller.objectives(0.2), 0.0);
//! assert_eq!(decision.outcome, Outcome::Optimal);
//! assert!(decision.speeds.speed_mps < 0.2);
//! # Ok::<(), unicycle_cbf::Error>(())
//! ```
//!
//! # References
//!
//! - Equation numbers are those of the thesis that drivekit implements, part 2, with its corrections.
//! - A. D. Ames, X. Xu, J. W. Grizzle, P. Tabuada: Control barrier function based quadratic programs for safety critical systems.
//!   IEEE Transactions on Automatic Control 62, 2017.
//! - A. D. Ames, K. Galloway, K. Sreenath, J. W. Grizzle: Rapidly exponentially stabilizing control Lyapunov functions and hybrid
//!   zero dynamics. IEEE Transactions on Automatic Control 59, 2014.
//! - Q. Nguyen, K. Sreenath: Exponential control barrier functions for enforcing high relative-degree safety-critical
//!   constraints. American Control Conference 2016.
//! - D. Goldfarb, A. Idnani: A numerically stable dual method for solving strictly convex quadratic programs. Mathematical
//!   Programming 27, 1983.

pub mod cbf;
pub mod clf;
mod controller;
mod crossing;
mod decision;
mod demands;
mod error;
mod guards;
mod ladder;
pub mod lateral;
mod library;
mod lie;
mod limits;
mod located;
mod margin;
mod others;
pub mod path;
pub mod pilot;
mod placing;
mod plausible;
mod pose;
mod predictor;
pub mod qp;
mod radii;
mod rows;
mod scenario;
pub mod settings;
mod starts;
mod terms;
mod track;
mod unicycle;

pub use controller::{Around, Controller, Leader, Objectives, Safety, Tracking};
pub use crossing::Crossing;
pub use decision::{Brake, Decision, Outcome, Terms};
pub use demands::Demands;
pub use error::Error;
pub use guards::MissingGuard;
pub use library::Testbed;
pub use lie::Lie;
pub use limits::Limits;
pub use located::Located;
pub use pilot::Pilot;
pub use pose::{Pose, Speeds, State};
pub use predictor::{Predictor, StampedPose};
pub use rows::{RowKind, Rows};
pub use scenario::{PathSpec, RobotSpec, Scenario, ScenarioSpec, Tracker};
pub use settings::{ControllerSettings, Preset};
pub use track::Tracks;
pub use unicycle::{Affine, Body, Centripetal, Input, WheelSpeeds};

/// The examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
