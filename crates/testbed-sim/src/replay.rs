//! Every decision of a run log once more.

use serde::Serialize;
use unicycle_cbf::{Decision, Scenario, ScenarioSpec, Tracks};

use crate::columns::DECIDED;
use crate::commanded::Commanded;
use crate::convoy::Convoy;
use crate::error::Error;
use crate::measured::Measured;
use crate::run_log::{LoggedTick, RealRobots, RunLog};
use crate::sight::Doubt;
use crate::summary::{Summarising, Summary};
use crate::tick::Tick;
use crate::verdict::{LeastDistance, Verdict, safeties};

/// The last step of a session that went on to its end begins so many steps before it at most.
const END_STEPS: f64 = 1.5;

/// What a replay found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Replay {
    /// Decisions compared
    pub decisions: usize,
    /// Decisions with a difference in some column
    pub different: usize,
    /// The first of them
    pub first: Option<Difference>,
    /// Whether steps are missing at the end of the log
    pub truncated: bool,
    /// Whether the run was safe, by where the robots were at its steps
    pub verdict: Verdict,
    /// Why it is not known whether the run was safe, unless it was unsafe
    pub doubts: Vec<String>,
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
        let scenario = Scenario::new(self.scenario.clone())?;
        let mut replaying = Replaying::new(&scenario, self);
        for (step, rows) in self.rows.chunks(scenario.starts().len()).enumerate() {
            replaying.step(step, rows)?;
        }
        Ok(replaying.finished(self.is_cut(&scenario)))
    }

    /// Whether rows are missing at its end: of a simulation those of steps that its scenario has, of a session all up to its duration unless
    /// the file says where it ends.
    fn is_cut(&self, scenario: &Scenario) -> bool {
        let robots = scenario.starts().len();
        let ScenarioSpec {
            duration_s,
            rate_hz,
            ..
        } = scenario.spec();
        let last_s = self.rows.last().map_or(0.0, |row| row.time_s);
        let is_over = match self.session {
            None => self.rows.len() >= scenario.steps() * robots,
            Some(_) => self.states_its_end || last_s >= duration_s - END_STEPS / rate_hz,
        };
        self.truncated || !is_over || !self.rows.len().is_multiple_of(robots)
    }
}

/// A replay under way.
struct Replaying<'a> {
    scenario: &'a Scenario,
    convoy: Convoy<'a>,
    judge: Judging<'a>,
    time_s: f64,
    decisions: usize,
    different: usize,
    first: Option<Difference>,
}

impl<'a> Replaying<'a> {
    fn new(scenario: &'a Scenario, log: &'a RunLog) -> Self {
        Self {
            scenario,
            convoy: Convoy::new(scenario),
            judge: Judging::new(scenario, log.session.as_ref()),
            time_s: 0.0,
            decisions: 0,
            different: 0,
            first: None,
        }
    }

    fn step(&mut self, step: usize, rows: &[LoggedTick]) -> Result<(), Error> {
        let robots = self.convoy.robots();
        let order = rows.iter().map(|row| (row.tick, row.robot));
        let expected = (0..robots).rev().map(|robot| (step, robot));
        let own_s = rows.first().map_or(f64::NAN, |row| row.time_s);
        let mut times_s = rows.iter().map(|row| row.time_s);
        let at_once = times_s.all(|time_s| time_s.to_bits() == own_s.to_bits());
        if !order.eq(expected.take(rows.len())) || !at_once || own_s < self.time_s {
            return Err(Error::Order { step });
        }
        if rows.len() < robots {
            return Ok(()); // A log that ends within a step.
        }
        self.time_s = own_s;
        self.judge.step(rows);
        for row in rows {
            if let Some(seen) = row.seen {
                self.convoy.observe(row.robot, seen);
            }
        }
        for row in rows {
            self.decide(row);
        }
        Ok(())
    }

    fn decide(&mut self, row: &LoggedTick) {
        let decision = self.convoy.decide(row.robot, row.time_s);
        let most_mps = row.allowed_mps.unwrap_or(f64::INFINITY);
        let decision = decision.limited(most_mps, self.scenario.controller().body());
        self.convoy.sent(row.robot, row.time_s, decision.speeds);
        self.judge.decided(row, &decision);
        let tick = Tick {
            tick: row.tick,
            robot: row.robot,
            time_s: row.time_s,
            seen: row.seen,
            decision,
            truth: None,
            watched: None,
            step_us: 0.0,
            late_us: f64::NAN,
        };
        self.decisions += 1;
        if let Some(difference) = difference(&tick, &row.outcome, &row.decided) {
            self.different += 1;
            self.first.get_or_insert(difference);
        }
    }

    fn finished(self, truncated: bool) -> Replay {
        let (summary, mut doubts) = self.judge.finished(self.time_s, truncated);
        if summary.verdict != Verdict::NotKnown {
            doubts.clear();
        }
        Replay {
            decisions: self.decisions,
            different: self.different,
            first: self.first,
            truncated,
            verdict: summary.verdict,
            doubts,
            first_unsafe_s: summary.first_unsafe_s,
            least_distance: summary.least_distance,
        }
    }
}

/// Whether the run of a log was safe: a simulation by its true places, a session as when it ran, by the poses that the log has.
struct Judging<'a> {
    scenario: &'a Scenario,
    summary: Summarising,
    tracks: Tracks,
    session: Option<Replayed<'a>>,
}

struct Replayed<'a> {
    robots: &'a RealRobots,
    measured: Measured<'a>,
    told: Vec<Commanded>,
    /// Of which the newest poses were not believed
    disbelieved: Vec<bool>,
}

impl<'a> Judging<'a> {
    fn new(scenario: &'a Scenario, robots: Option<&'a RealRobots>) -> Self {
        let wheel_base_m = scenario.controller().body().wheel_base_m;
        let session = robots.map(|robots| Replayed {
            robots,
            measured: Measured::new(scenario, robots.hear_commands),
            told: vec![Commanded::new(wheel_base_m); scenario.starts().len()],
            disbelieved: vec![false; scenario.starts().len()],
        });
        Self {
            scenario,
            summary: Summarising::new(scenario),
            tracks: Tracks::new(scenario),
            session,
        }
    }

    /// The rows of one step are from the back.
    fn step(&mut self, rows: &[LoggedTick]) {
        let Some(session) = &mut self.session else {
            return self.judge_places(rows);
        };
        let mut seen: Vec<_> = rows
            .iter()
            .filter_map(|row| Some((row.robot, row.seen?)))
            .collect();
        seen.sort_by(|(_, a), (_, b)| a.stamp_s.total_cmp(&b.stamp_s));
        let told = &session.told;
        let told_m = |robot: usize, time_s: f64| told[robot].until(time_s).path_m;
        for (robot, seen) in seen {
            session.measured.saw(robot, seen, told_m, &mut self.summary);
        }
        for row in rows {
            session.disbelieved[row.robot] = row.disbelieved_s.is_some();
            let misplaced_m = row.misplaced_m.unwrap_or(0.0);
            session.measured.misplaced(row.robot, misplaced_m);
        }
    }

    fn judge_places(&mut self, rows: &[LoggedTick]) {
        let places: Vec<_> = rows.iter().rev().map(|row| row.place).collect();
        let time_s = rows.first().map_or(f64::NAN, |row| row.time_s);
        let controller = self.scenario.controller();
        let safeties = safeties(controller, &mut self.tracks, &places);
        for safety in safeties.iter().flatten() {
            self.summary.add_measured(time_s, safety);
        }
        self.summary.add_places(time_s, &places);
    }

    fn decided(&mut self, row: &LoggedTick, decision: &Decision) {
        let Some(session) = &mut self.session else {
            return;
        };
        session.told[row.robot].sent(row.time_s, decision.speeds);
        let truth = session.measured.truth(row.robot, decision.speeds);
        if let Some(truth) = truth.filter(|_| row.seen.is_some()) {
            self.summary.add_measured(row.time_s, &truth.safety);
        }
    }

    fn finished(mut self, time_s: f64, truncated: bool) -> (Summary, Vec<String>) {
        let mut doubts = Vec::new();
        if let Some(session) = self.session {
            let (mut measured, told) = (session.measured, session.told);
            for (robot, disbelieved) in session.disbelieved.into_iter().enumerate() {
                if disbelieved {
                    measured.sights().doubt(Doubt::Disbelieved(robot));
                }
            }
            measured.over(time_s, |robot, time_s| told[robot].until(time_s).path_m);
            let texts = measured.sights().doubts().iter();
            doubts.extend(texts.map(|doubt| doubt.text(&session.robots.ids)));
        }
        if truncated {
            doubts.push("the end of the log is missing".to_owned());
        }
        if !doubts.is_empty() {
            self.summary.doubt();
        }
        (self.summary.finished(), doubts)
    }
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
