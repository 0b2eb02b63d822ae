//! Robots whose poses jumped: they stand, whoever is near them stands, and after a while it is for good.

use testbed_sim::measured::most_mps;
use unicycle_cbf::{Pose, Scenario, StampedPose};

use super::{Allowed, Own, Stated, Watch};
use crate::live::displaced::{Gap, LEAST_TURN_RAD, Off, Steady};
use crate::live::fit::Fit;
use crate::live::gate::{distance_m, wrapped};
use crate::live::note::{Consequence, Differing, Note};

/// A jump that lasts longer is for good, in s.
const LONG_S: f64 = 0.5;
/// Whoever can be there within this time is near, in s.
const NEAR_S: f64 = 0.5;
/// A place that is off by more leaves it open whether robots touch, in m.
const FAR_M: f64 = 0.04;
/// How many times the noise a way without poses has to miss, and by which share of it besides: headings and wheels are off.
const TIMES_NOISE: f64 = 7.5;
const ASIDE: f64 = 0.2;
/// Share of its speed before with which a robot that did not hear that it shall stand goes on.
const GOES_ON: f64 = 0.5;
/// Lags that nobody knows better, in s, and steps between them.
pub(super) const LAGS_S: [f64; 2] = [0.0, 0.3];
const STEP_S: f64 = 0.05;

/// From how near on a robot depends on where another one is, in m: it can be there soon, or follows it.
pub(super) fn near_m(scenario: &Scenario) -> f64 {
    let controller = scenario.controller();
    let headway_s = controller.settings().headway.time_s;
    controller.least_distance_m() + headway_s.max(NEAR_S) * most_mps(scenario)
}

impl Watch {
    /// A pose that is not believed.
    pub(in crate::live) fn strayed(&mut self, robot: usize, seen: StampedPose) {
        self.robots[robot].displaced.add(seen, &self.steady);
    }

    /// For how long the place of a robot has been off by what leaves it open whether robots touch, in s.
    pub(in crate::live) fn displaced_s(&self, robot: usize, time_s: f64) -> Option<f64> {
        let own = &self.robots[robot];
        let (_, since_s) = own.displaced_by().filter(|(off, _)| off.way_m() > FAR_M)?;
        Some(time_s - since_s).filter(|_| own.allowed == Allowed::Nothing)
    }

    /// Whether a robot is near another one whose poses jumped.
    pub(in crate::live) fn is_near_displaced(&self, robot: usize, pose: &Pose) -> bool {
        let mut others = self.robots.iter().enumerate();
        others.any(|(other, own)| {
            let off_m = own.displaced_by().map(|(off, _)| off.way_m());
            let place = own.displaced.newest().filter(|_| other != robot);
            off_m
                .zip(place)
                .is_some_and(|(off_m, place)| distance_m(&place.pose, pose) < self.near_m + off_m)
        })
    }

    /// Whether the poses of a robot jumped for good; the user is told so once.
    pub(super) fn has_jumped(&mut self, robot: usize, time_s: f64) -> bool {
        let own = &mut self.robots[robot];
        own.look_at_gap(&self.stated, &self.steady);
        own.look_whether_back(&self.stated, &self.steady);
        let Some((off, since_s)) = own.displaced_by() else {
            own.jumped_back();
            return false;
        };
        if own.allowed == Allowed::Nothing || time_s - since_s < LONG_S {
            return false;
        }
        own.before_jump = Some((own.allowed, own.misplaced_m));
        own.allowed = Allowed::Nothing;
        let off_m = off.way_m().max(self.room.misplaced_m(off.heading_rad));
        own.misplaced_m = own.misplaced_m.max(off_m);
        let heading_rad = own
            .displaced
            .newest()
            .map_or(0.0, |seen| seen.pose.heading_rad);
        self.notes.push(Note::Differs {
            id: self.ids[robot],
            how: Differing::Displaced {
                off_m: off.seen_along_m(heading_rad),
                turned_rad: off.heading_rad,
                noise_m: self.stated.noise_m,
            },
            then: Consequence::StandsUnlessBack,
        });
        true
    }
}

impl Own {
    /// What was so before it jumped is so again.
    fn jumped_back(&mut self) {
        if let Some((allowed, misplaced_m)) = self.before_jump.take() {
            self.allowed = allowed;
            self.misplaced_m = misplaced_m;
        }
    }

    /// How far its poses are off by jumps, and since when, in s; robots that hear nobody are not watched.
    pub(super) fn displaced_by(&self) -> Option<(Off, f64)> {
        self.displaced.off().filter(|_| !self.told.is_empty())
    }

    /// By how much it may follow its commands late, as far as that is known.
    pub(super) fn learn_lags(&mut self, fit: Option<&Fit>) {
        let Some([least_s, most_s]) = fit.and_then(Fit::lags_s) else {
            return;
        };
        let [known_least_s, known_most_s] = self.lags_s;
        let (from_s, to_s) = (least_s.max(known_least_s), most_s.min(known_most_s));
        self.lags_s = if from_s <= to_s {
            [from_s, to_s]
        } else if from_s <= to_s + STEP_S {
            [to_s, from_s]
        } else {
            [least_s, most_s]
        };
    }

    /// Where nothing was seen for a while, a robot is where commands led it, or goes on as before.
    fn look_at_gap(&mut self, stated: &Stated, steady: &Steady) {
        let Some((gap, speed_mps)) = self.displaced.gap() else {
            return;
        };
        let off = self.least_missed(&gap);
        let before_mps = self
            .told
            .at(gap.from.stamp_s - self.lags_s[0])
            .speed_mps
            .abs();
        let goes_on = before_mps > 0.0 && speed_mps > GOES_ON * before_mps;
        if off.way_m() > self.led_within_m(&gap, stated) && !goes_on {
            let place_m = off.place_m;
            let off = Off {
                place_m,
                ..Off::default()
            };
            self.displaced.count(off, &gap, steady);
        }
    }

    /// A robot that jumped far is back where commands led it from before. How late it follows them must not make up for the jump.
    fn look_whether_back(&mut self, stated: &Stated, steady: &Steady) {
        let (Some((off, since_s)), Some(from)) = (self.displaced.off(), self.displaced.before())
        else {
            return;
        };
        let newest = self.trail.newest().map(|newest| newest.seen);
        let Some(to) = newest.filter(|newest| newest.stamp_s > since_s) else {
            return;
        };
        let way = Gap { from, to };
        let [least_s, most_s] = self.lags_s;
        let within_m = self.led_within_m(&way, stated);
        let missed = self.least_missed(&way);
        let is_led = missed.way_m() <= within_m && missed.heading_rad.abs() <= LEAST_TURN_RAD;
        if is_led && off.way_m() > 2.0 * (within_m + (most_s - least_s) * steady.speed_mps) {
            self.displaced.is_back(to.stamp_s);
        }
    }

    /// How near to where commands led it a robot has to come, in m.
    fn led_within_m(&self, gap: &Gap, stated: &Stated) -> f64 {
        let way = self
            .told
            .between(gap.from.stamp_s - self.lags_s[1], gap.to.stamp_s);
        TIMES_NOISE * stated.noise_m + ASIDE * way.path_m
    }

    /// By how much a robot is not where commands led it, with the lag that explains it best.
    fn least_missed(&self, gap: &Gap) -> Off {
        let [least_s, most_s] = self.lags_s;
        let steps = ((most_s - least_s) / STEP_S).ceil().max(0.0) as u32;
        let lags_s = (1..=steps).map(|step| (least_s + STEP_S * f64::from(step)).min(most_s));
        let missed = lags_s.map(|lag_s| self.missed(gap, lag_s));
        missed.fold(self.missed(gap, least_s), |least, next| {
            if next.way_m() < least.way_m() {
                next
            } else {
                least
            }
        })
    }

    fn missed(&self, gap: &Gap, lag_s: f64) -> Off {
        let from = StampedPose {
            stamp_s: gap.from.stamp_s - lag_s,
            ..gap.from
        };
        let led = self.told.carried(&from, gap.to.stamp_s - lag_s);
        Off {
            place_m: [gap.to.pose.x_m - led.x_m, gap.to.pose.y_m - led.y_m],
            heading_rad: wrapped(gap.to.pose.heading_rad - led.heading_rad),
        }
    }
}
