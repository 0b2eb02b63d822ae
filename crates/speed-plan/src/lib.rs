//! Energy-optimal speed.

mod bound;
mod case;
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
mod tridiagonal;

pub use case::Case;
pub use envelope::{Envelope, EnvelopePoint};
pub use error::Error;
pub use outcome::Obstacle;
pub use problem::{Columns, NO_LEADER_S, Problem, Signal};

pub use road::{Leader, Road};
pub use plan::{Answer, Arrival, Demand, Plan, Proof, Settings};

/// Plans.
///
/// # Errors
/// None yet.
pub fn plan(problem: &Problem, demand: Demand, settings: &Settings) -> Result<Answer, Error> {
    let Some(formula) = problem.model().formula() else {
        return Err(Error::Setting { name: "vehicle", value: 0.0, expected: "losses by formula" });
    };
    search::Search::new(problem, formula, demand, *settings).run()
}
