use super::random::Random;
use super::route::Route;

/// Range of the sensor that measures gap and speed of the vehicle ahead.
const RANGE_M: f64 = 150.0;

/// A vehicle cuts in only where it is driven faster than this.
const SLOWEST_CUT_IN_MPS: f64 = 6.0;

/// The lead vehicle drives towards a share of the limit with this time constant, and its acceleration lags behind.
const RESPONSE_S: f64 = 2.5;
const ACCEL_LAG_S: f64 = 0.8;

/// A vehicle ahead with a mind of its own.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leader {
    position_m: f64,
    pub(super) speed_mps: f64,
    accel_mps2: f64,
    limit_share: f64,
    changes_mind_s: f64,
    leaves_s: f64,
}

impl Leader {
    pub(super) fn gap_m(&self, position_m: f64) -> f64 {
        self.position_m - position_m
    }
}

/// Vehicles that turn up ahead for a while, one at a time.
#[derive(Debug)]
pub(super) struct Traffic {
    random: Random,
    pub(super) leader: Option<Leader>,
    next_s: f64,
}

impl Traffic {
    /// Without `leaders` the road stays empty.
    pub(super) fn new(mut random: Random, leaders: bool) -> Self {
        let next_s = if leaders {
            random.between(20.0, 120.0)
        } else {
            f64::INFINITY
        };
        Self {
            random,
            leader: None,
            next_s,
        }
    }

    /// Lets the leader leave, or a new one cut in where that is possible.
    pub(super) fn update(
        &mut self,
        time_s: f64,
        position_m: f64,
        speed_mps: f64,
        may_cut_in: bool,
    ) {
        match self.leader {
            Some(leader) => {
                if time_s >= leader.leaves_s || leader.gap_m(position_m) > RANGE_M {
                    self.clear(time_s);
                }
            }
            None if time_s < self.next_s => {}
            None if may_cut_in && speed_mps > SLOWEST_CUT_IN_MPS => {
                let gap_s = self.random.between(1.8, 3.5);
                self.leader = Some(Leader {
                    position_m: position_m + 5.0 + gap_s * speed_mps,
                    speed_mps: speed_mps * self.random.between(0.85, 1.0),
                    accel_mps2: 0.0,
                    limit_share: self.random.between(0.7, 0.95),
                    changes_mind_s: time_s + self.random.between(6.0, 15.0),
                    leaves_s: time_s + self.random.between(10.0, 35.0),
                });
            }
            // Not at the first possible moment, or every cut-in would be at the same speed.
            None => self.next_s = time_s + self.random.between(2.0, 20.0),
        }
    }

    /// The leader turns off; the next one comes after a while.
    pub(super) fn clear(&mut self, time_s: f64) {
        if self.leader.take().is_some() {
            self.next_s = time_s + self.random.between(50.0, 150.0);
        }
    }

    /// Moves the leader by one step.
    pub(super) fn advance(&mut self, time_s: f64, step_s: f64, route: &Route) {
        let Some(leader) = &mut self.leader else {
            return;
        };
        if time_s >= leader.changes_mind_s {
            leader.limit_share = self.random.between(0.55, 0.95);
            leader.changes_mind_s = time_s + self.random.between(6.0, 15.0);
        }
        let ahead_m = leader.position_m + RESPONSE_S * leader.speed_mps;
        let limit_mps = route
            .limit_mps(leader.position_m)
            .min(route.limit_mps(ahead_m));
        let wanted_mps = leader.limit_share * limit_mps;
        let wanted_mps2 = ((wanted_mps - leader.speed_mps) / RESPONSE_S).clamp(-1.8, 1.2);
        leader.accel_mps2 += (wanted_mps2 - leader.accel_mps2) * (step_s / ACCEL_LAG_S).min(1.0);
        let before_mps = leader.speed_mps;
        leader.speed_mps = (before_mps + leader.accel_mps2 * step_s).max(0.0);
        leader.position_m += 0.5 * (before_mps + leader.speed_mps) * step_s;
    }
}
