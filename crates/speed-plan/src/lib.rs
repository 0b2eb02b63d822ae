//! The speed over a road that takes the least energy, and a bound on what any other could save.
//!
//! Nodes `s_0 … s_N` lie along the road, the acceleration between two is constant, and the energy of a step is that of
//! [`ev_energy::StepModel`]. With the squared speeds `z = v²`:
//!
//! ```text
//! minimise   Σ E_k(z_k, z_{k+1}) + Σ P_stand · dwell
//! subject to lo ≤ v ≤ hi at every node,    b(v̄) ≤ a_k ≤ A(v̄),    motor and battery within their limits,
//!            t_N ≤ T,    t at every signal in a green window,    t_k ≥ t_leader(s_k + s0) + h
//! ```
//!
//! [`Road::columns`] lays the nodes, [`Problem::new`] checks them with a car and an [`Envelope`] of accelerations, and [`plan()`]
//! answers: a [`Plan`] or the [`Obstacle`] in its way. Limits, stops, accelerations and the arrival are kept exactly. Every plan
//! carries `lower_bound_j`: no motion on these nodes that arrives no later takes less energy (for a demanded arrival: by then). Where losses are a
//! formula it is proven, but for rounding.
//!
//! ```
//! use ev_energy::{StepModel, Vehicle};
//! use speed_plan::{Answer, Demand, Envelope, Problem, Road, Settings, plan};
//!
//! let car = Vehicle::builtin("b250e")?;
//! let road = Road { length_m: 2000.0, stops: vec![(1200.0, 10.0)], ..Road::default() };
//! let problem = Problem::new(StepModel::new(&car), Envelope::default(), road.columns()?)?;
//!
//! let Answer::Plan(plan) = plan(&problem, Demand::Arrival(200.0), &Settings::default())? else {
//!     return Err("nothing can be driven".into());
//! };
//! assert!((plan.run.time_s - 200.0).abs() < 1e-6);
//! assert!(plan.gap_pct < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # How
//!
//! - The reachable box: forward with the largest acceleration, backward with the strongest braking. Its upper edge is the fastest
//!   plan.
//! - A primal–dual interior point method in `z`: tridiagonal, one border per bound on a passing time.
//! - The bound: for any price of time and any potentials of the squared speeds, the sum of the least costs of the single steps. Its
//!   minima over two speeds are found by branch and bound; most steps are convex, and one tangent plane is the proof.
//! - Signals and leaders: branch and bound over passing before or after a red and standing or not; passing times behind a leader are
//!   bounded where they are violated.
//! - Losses by table: nested dynamic programming, with a bound whose minima are searched numerically.
//! - With the feature `convex`, `certify`: a convex relaxation by Clarabel, an independent lower bound without signals and leaders.
//!
//! # References
//!
//! - S. Wright: Primal-Dual Interior-Point Methods, SIAM 1997.
//! - A. Sciarretta, A. Vahidi: Energy-Efficient Driving of Road Vehicles, Springer 2020 (optimal speed over distance).
//! - R. E. Moore, R. B. Kearfott, M. J. Cloud: Introduction to Interval Analysis, SIAM 2009.
//! - R. Bellman: Dynamic Programming, Princeton 1957.

mod bound;
mod by_table;
mod case;
#[cfg(feature = "convex")]
mod convex;
mod drive;
mod dynamic;
mod envelope;
mod error;
mod interior_point;
mod outcome;
mod plan;
mod problem;
mod reachable;
mod road;
mod search;
mod timed;
mod tridiagonal;

pub use case::Case;
#[cfg(feature = "convex")]
pub use convex::{Certificate, Convergence, certify};
pub use drive::Run;
pub use envelope::{Envelope, EnvelopePoint};
pub use error::Error;
pub use outcome::Obstacle;
pub use problem::{Columns, NO_LEADER_S, Problem, Signal};

pub use plan::{Answer, Arrival, Demand, Plan, Proof, Settings};
pub use road::{Leader, Road};

/// The plan of least energy, with a bound on what any other could save.
///
/// # Errors
/// [`Error::Setting`] for a demand or a setting out of range, [`Error::TableInTraffic`] where losses are a table and there are signals
/// or a leader.
pub fn plan(problem: &Problem, demand: Demand, settings: &Settings) -> Result<Answer, Error> {
    plan_from(problem, demand, settings, None)
}

/// As [`plan()`], from speeds in m/s at the nodes that are expected to be nearly right, such as those of the plan before.
///
/// # Errors
/// As [`plan()`], and [`Error::Length`] for another number of speeds than nodes.
pub fn replan(
    problem: &Problem,
    demand: Demand,
    settings: &Settings,
    near_mps: &[f64],
) -> Result<Answer, Error> {
    if near_mps.len() != problem.nodes() {
        return Err(Error::Length {
            channel: "near_mps",
            found: near_mps.len(),
            expected: problem.nodes(),
        });
    }
    let near = near_mps.iter().map(|v| v * v).collect();
    plan_from(problem, demand, settings, Some(near))
}

/// Plans from nearly the fastest to the cheapest, at arrivals that are evenly apart. Arrivals that lights or a leader do not allow are
/// left out; without any plan, what is in the way.
///
/// # Errors
/// As [`plan()`].
pub fn frontier(
    problem: &Problem,
    points: usize,
    settings: &Settings,
) -> Result<Vec<Answer>, Error> {
    let cheapest = plan(problem, Demand::Price(0.0), settings)?;
    let fastest = plan(problem, Demand::Price(HURRY_W), settings)?;
    let (Some(slow), Some(fast)) = (cheapest.plan(), fastest.plan()) else {
        return Ok(vec![cheapest]);
    };
    let last = points.saturating_sub(1).max(1) as f64;
    let between = (1..points.saturating_sub(1))
        .map(|k| {
            Demand::Arrival(fast.run.time_s + k as f64 / last * (slow.run.time_s - fast.run.time_s))
        })
        .map(|demand| plan(problem, demand, settings))
        .collect::<Result<Vec<_>, Error>>()?;
    let between = between.into_iter().filter(|answer| answer.plan().is_some());
    let mut plans: Vec<Answer> = between.collect();
    plans.insert(0, fastest);
    plans.push(cheapest);
    Ok(plans)
}

/// A price of time in W that leaves little but time.
pub const HURRY_W: f64 = 1e5;

fn plan_from(
    problem: &Problem,
    demand: Demand,
    settings: &Settings,
    near: Option<Vec<f64>>,
) -> Result<Answer, Error> {
    let (name, value) = match demand {
        Demand::Arrival(latest_s) => ("latest_arrival_s", latest_s),
        Demand::Price(price_w) => ("price_w", price_w),
    };
    let within = |name, value: f64, max: f64, expected| {
        if (0.0..=max).contains(&value) {
            Ok(())
        } else {
            Err(Error::Setting {
                name,
                value,
                expected,
            })
        }
    };
    within(name, value, 1e9, "0 to 10⁹")?;
    within("max_gap_pct", settings.max_gap_pct, 100.0, "0 to 100 %")?;
    let mut answer = match problem.model().formula() {
        Some(formula) => search::Search::new(problem, formula, demand, *settings, near).run(),
        None => by_table::plan_by_table(problem, demand),
    }?;
    if let Answer::Plan(plan) = &mut answer
        && !plan.lower_bound_j.is_finite()
    {
        plan.proof = Proof::Missing;
    }
    Ok(answer)
}
