use crate::drive::Run;
use crate::outcome::Obstacle;

/// When a plan arrives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Demand {
    /// No later than a time after the start, s.
    Arrival(f64),
    /// When it pays, at a price of time in W: energy plus price times time is least.
    Price(f64),
}

/// How a plan is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Largest gap to the bound at which the search ends, %.
    pub max_gap_pct: f64,
    /// Time after which the search ends with the best plan there is, s; `None` lets it end by itself.
    pub budget_s: Option<f64>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            max_gap_pct: 0.01,
            budget_s: None,
        }
    }
}

/// What came of a problem.
#[derive(Debug, Clone)]
#[must_use]
pub enum Answer {
    /// It can be driven.
    Plan(Box<Plan>),
    /// It cannot.
    Obstacle(Obstacle),
}

impl Answer {
    /// The plan, where there is one.
    #[must_use]
    pub fn plan(&self) -> Option<&Plan> {
        match self {
            Self::Plan(plan) => Some(plan),
            Self::Obstacle(_) => None,
        }
    }
}

/// Whether the latest arrival was needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrival {
    /// The plan arrives when it was asked to, or at a price of time.
    AsAsked,
    /// The cheapest plan of all arrives before.
    Early,
}

/// How far a bound can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Proof {
    /// It was proven, but for rounding.
    Proven,
    /// Minima were searched numerically.
    Numerical,
    /// There is none: it is −∞.
    Missing,
}

/// A speed over the road, and how much less any other could take.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Whether it arrives before it had to.
    pub arrival: Arrival,
    /// The motion.
    pub run: Run,
    /// Earliest arrival of any plan within limits and accelerations, signals and leader aside, s.
    pub earliest_arrival_s: f64,
    /// Price of time at the end of the trip, W: energy falls by it per second of later arrival; `None` where it is not known.
    pub price_w: Option<f64>,
    /// No plan that arrives no later than this one takes less energy, or none that arrives by the time that was asked for, J.
    pub lower_bound_j: f64,
    /// Energy above the bound in % of the larger of |energy| and a tenth of the sum of the steps' |energy|.
    pub gap_pct: f64,
    /// How far the bound can be trusted.
    pub proof: Proof,
    /// Problems that were solved on the way.
    pub solved: usize,
}
