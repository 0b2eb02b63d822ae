//! The controller of one robot over time: observer, watchdog, and the speeds sent last.

use crate::controller::{Around, Controller, Leader, Objectives};
use crate::decision::{Brake, Decision, Outcome};
use crate::located::Located;
use crate::path::PathPoint;
use crate::pose::{Pose, Speeds};
use crate::predictor::{Predictor, StampedPose};

/// What one robot's controller remembers between steps.
#[derive(Debug, Clone)]
pub struct Pilot {
    predictor: Predictor,
    speeds: Speeds,
}

/// A robot as another one's controller knows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// Where it is and was seen
    pub leader: Leader,
    /// Age of its newest pose, in s
    pub age_s: f64,
}

/// Whom a robot follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ahead {
    /// It is the first
    Nobody,
    /// A robot of which no pose was ever seen
    Unseen,
    /// A robot that was seen, however long ago
    Seen(Sighting),
}

/// Where a robot is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// As its pilot sees it
    pub sighting: Sighting,
    /// Its foot on the path, where somebody looked for it
    pub foot: Option<PathPoint>,
}

/// What is around a robot at one time, all others as they were before their own steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surroundings<'a> {
    /// Itself where that is known already
    pub own: Option<Place>,
    /// Whom it follows
    pub ahead: Ahead,
    /// The others, the nearest first
    pub others: &'a [Located],
    /// How far it may go along the path, in m, where it gives way
    pub stop_line_m: Option<f64>,
}

impl From<Ahead> for Surroundings<'_> {
    fn from(ahead: Ahead) -> Self {
        Self {
            own: None,
            ahead,
            others: &[],
            stop_line_m: None,
        }
    }
}

impl From<Option<Sighting>> for Ahead {
    fn from(sighting: Option<Sighting>) -> Self {
        sighting.map_or(Self::Unseen, Self::Seen)
    }
}

impl Pilot {
    /// A robot that moves at `speeds` from `now_s` on: at rest, or at the desired speed (thesis 4.1).
    #[must_use]
    pub fn new(now_s: f64, speeds: Speeds) -> Self {
        let mut predictor = Predictor::default();
        predictor.sent(now_s, speeds);
        Self { predictor, speeds }
    }

    /// Takes a pose in; one that is not finite is ignored.
    pub fn observe(&mut self, controller: &Controller, seen: StampedPose) {
        let hardening = &controller.settings().hardening;
        let gains = [hardening.position_gain, hardening.heading_gain];
        let restart_after_s = hardening.max_pose_age_s.unwrap_or(f64::INFINITY);
        if seen.pose.is_finite() && seen.stamp_s.is_finite() {
            self.predictor.observe(seen, gains, restart_after_s);
        }
    }

    /// The robot as the one behind it sees it at `now_s`.
    #[must_use]
    pub fn sighting(&self, controller: &Controller, now_s: f64) -> Option<Sighting> {
        let last = self.predictor.last_seen()?;
        let offset_m = controller.body().offset_m;
        let seen = last.pose.state(offset_m, Speeds::ZERO);
        let state = self.pose(controller, now_s)?.state(offset_m, self.speeds);
        Some(Sighting {
            leader: Leader {
                state,
                last_seen_m: [seen.x_m, seen.y_m],
                near_m: None,
            },
            age_s: now_s - last.stamp_s,
        })
    }

    /// Remembers what the robot does from `now_s` on.
    pub fn sent(&mut self, now_s: f64, speeds: Speeds) {
        self.speeds = speeds;
        self.predictor.sent(now_s, speeds);
    }

    /// Decides at `now_s` with nobody around but the robot ahead, which is given as it was before its own step at this time.
    pub fn decide(
        &self,
        controller: &Controller,
        now_s: f64,
        ahead: Ahead,
        objectives: &Objectives,
    ) -> Decision {
        self.decide_among(controller, now_s, ahead.into(), objectives)
    }

    /// Decides at `now_s`.
    pub fn decide_among(
        &self,
        controller: &Controller,
        now_s: f64,
        around: Surroundings,
        objectives: &Objectives,
    ) -> Decision {
        let decision = self.wanted(controller, now_s, around, objectives);
        let slows = matches!(decision.outcome, Outcome::Braking { .. });
        if !slows || !controller.settings().hardening.wheel_rows {
            return decision;
        }
        let body = controller.body();
        let speeds = body.braked(self.speeds, controller.hold_s());
        Decision {
            speeds,
            wheels: body.wheel_speeds(speeds),
            ..decision
        }
    }

    fn wanted(
        &self,
        controller: &Controller,
        now_s: f64,
        around: Surroundings,
        objectives: &Objectives,
    ) -> Decision {
        let own = around.own.map(|own| own.sighting);
        let Some(own) = own.or_else(|| self.sighting(controller, now_s)) else {
            return Decision::braking(Brake::NoPose, None, None);
        };
        let (state, age_s) = (own.leader.state, own.age_s);
        let max_age_s = controller.settings().hardening.max_pose_age_s;
        let too_old = |age_s: f64| max_age_s.is_some_and(|most| age_s > most);
        if objectives.stop {
            return Decision::braking(Brake::Asked, Some(state), None);
        }
        if too_old(age_s) {
            return Decision::braking(Brake::StalePose, Some(state), None);
        }
        let (leader, age_s) = match &around.ahead {
            Ahead::Nobody => (None, age_s),
            Ahead::Seen(sighting) if !too_old(sighting.age_s) => {
                (Some(&sighting.leader), age_s.max(sighting.age_s))
            }
            Ahead::Seen(_) | Ahead::Unseen => {
                return Decision::braking(Brake::LeaderLost, Some(state), None);
            }
        };
        let around = Around {
            leader,
            others: around.others,
            stop_line_m: around.stop_line_m,
            foot: around.own.and_then(|own| own.foot),
        };
        controller.decide_among(&state, around, objectives, age_s)
    }

    fn pose(&self, controller: &Controller, now_s: f64) -> Option<Pose> {
        if controller.settings().hardening.predict {
            return self.predictor.at(now_s);
        }
        self.predictor.last_seen().map(|last| last.pose)
    }
}
