//! Energy-optimal speed.

mod bound;
mod by_table;
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

/// As [`plan`], from speeds in m/s at the nodes that are expected to be nearly right, such as those of the plan before.
///
/// # Errors
/// As [`plan`], and [`Error::Length`] for another number of speeds than nodes.
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

/// Plans from the fastest to the cheapest, at arrivals that are evenly apart.
///
/// # Errors
/// As [`plan`].
pub fn frontier(
    problem: &Problem,
    points: usize,
    settings: &Settings,
) -> Result<Vec<Answer>, Error> {
    let cheapest = plan(problem, Demand::Price(0.0), settings)?;
    let Some(slowest) = cheapest.plan() else {
        return Ok(vec![cheapest]);
    };
    let (first_s, last_s) = (slowest.earliest_arrival_s, slowest.time_s);
    let arrivals = (0..points.saturating_sub(1)).map(|k| {
        let share = (k as f64 + FASTEST_SHARE) / (points as f64 - 1.0 + FASTEST_SHARE);
        Demand::Arrival(first_s + share * (last_s - first_s))
    });
    let mut plans = arrivals
        .map(|demand| plan(problem, demand, settings))
        .collect::<Result<Vec<_>, Error>>()?;
    plans.push(cheapest);
    Ok(plans)
}

/// Where the first point of a frontier lies after the earliest arrival, in spacings: the fastest plan of all has no freedom and no price.
const FASTEST_SHARE: f64 = 0.25;

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
    match problem.model().formula() {
        Some(formula) => search::Search::new(problem, formula, demand, *settings, near).run(),
        None => by_table::plan_by_table(problem, demand),
    }
}
