//! Every decision of a run log once more.

use serde::Serialize;
use unicycle_cbf::Scenario;

use crate::convoy::Convoy;
use crate::error::Error;
use crate::run_log::{DECIDED, LoggedTick, RunLog};
use crate::summary::Summarising;
use crate::tick::Tick;
use crate::verdict::{LeastDistance, Verdict};

/// What a replay found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Replay {
    /// Decisions compared
    pub decisions: usize,
    /// Decisions with a difference in some column
    pub different: usize,
    /// The first of them
    pub first: Option<Difference>,
    /// Whether the run was safe, by where the robots were at its steps
    pub verdict: Verdict,
    /// When it was not for the first time, in s
    pub first_unsafe_s: Option<f64>,
    /// Where two robots were nearest to each other
    pub least_distance: Option<LeastDistance>,
}

/// A column in which a decision differs from the log.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Index of the step
    pub tick: usize,
    /// Index of the robot
    pub robot: usize,
    /// Name of the column
    pub column: &'static str,
    /// As in the log
    pub logged: String,
    /// As computed now
    pub computed: String,
}

impl RunLog {
    /// Gives the poses of the log to fresh controllers and compares their decisions bit for bit.
    ///
    /// # Errors
    ///
    /// A scenario that cannot be, or ticks that are not complete and in order.
    pub fn replay(&self) -> Result<Replay, Error> {
        let scenario = Scenario::new(self.spec.scenario.clone())?;
        let mut convoy = Convoy::new(&scenario);
        let robots = convoy.robots();
        let mut replay = Replay {
            decisions: 0,
            different: 0,
            first: None,
            verdict: Verdict::NotKnown,
            first_unsafe_s: None,
            least_distance: None,
        };
        let mut summary = Summarising::new(&scenario);
        let mut time_s = 0.0;
        for (step, rows) in self.rows.chunks(robots).enumerate() {
            let order = rows.iter().map(|row| (row.tick, row.robot));
            let expected = (0..robots).rev().map(|robot| (step, robot));
            let own_s = rows.first().map_or(f64::NAN, |row| row.time_s);
            let at_once = rows
                .iter()
                .all(|row| row.time_s.to_bits() == own_s.to_bits())
                && own_s >= time_s;
            if !order.eq(expected.take(rows.len())) || !at_once {
                return Err(Error::Order { step });
            }
            time_s = own_s;
            if rows.len() < robots {
                break; // A log that ends within a step.
            }
            judge(&scenario, rows, &mut summary);
            for row in rows {
                if let Some(seen) = row.seen {
                    convoy.observe(row.robot, seen);
                }
            }
            for row in rows {
                let decision = convoy.decide(row.robot, row.time_s);
                let most_mps = row.allowed_mps.unwrap_or(f64::INFINITY);
                let decision = decision.limited(most_mps, scenario.controller().body());
                convoy.sent(row.robot, row.time_s, decision.speeds);
                let tick = Tick {
                    tick: step,
                    robot: row.robot,
                    time_s: row.time_s,
                    seen: row.seen,
                    decision,
                    truth: None,
                    watched: None,
                    step_us: 0.0,
                    late_us: f64::NAN,
                };
                replay.decisions += 1;
                if let Some(difference) = difference(&tick, &row.outcome, &row.decided) {
                    replay.different += 1;
                    replay.first.get_or_insert(difference);
                }
            }
        }
        let summary = summary.finished();
        replay.verdict = summary.verdict;
        replay.first_unsafe_s = summary.first_unsafe_s;
        replay.least_distance = summary.least_distance;
        Ok(replay)
    }
}

/// The rows of one step are from the back.
fn judge(scenario: &Scenario, rows: &[LoggedTick], summary: &mut Summarising) {
    let controller = scenario.controller();
    let places: Vec<_> = rows.iter().rev().map(|row| row.place).collect();
    let time_s = rows.first().map_or(f64::NAN, |row| row.time_s);
    for (robot, own) in places.iter().enumerate() {
        let Some(own) = own else { continue };
        let ahead = robot.checked_sub(1).and_then(|ahead| places[ahead]);
        summary.add_measured(time_s, &controller.safety_behind(own, ahead.as_ref()));
    }
    summary.add_places(time_s, &places);
}

fn difference(tick: &Tick, outcome: &str, logged: &[f64; DECIDED.len()]) -> Option<Difference> {
    let differs = |column, logged: String, computed: String| Difference {
        tick: tick.tick,
        robot: tick.robot,
        column,
        logged,
        computed,
    };
    let computed = tick.outcome_name();
    if computed != outcome {
        return Some(differs("outcome", outcome.to_owned(), computed));
    }
    DECIDED
        .iter()
        .zip(logged)
        .find_map(|((name, read), logged)| {
            let computed = read(tick);
            let same =
                computed.to_bits() == logged.to_bits() || (computed.is_nan() && logged.is_nan());
            (!same).then(|| differs(name, format!("{logged:?}"), format!("{computed:?}")))
        })
}
