//! Do the robots do what they are told? Those that do not are named, slowed down and stopped.

mod differing;
mod displacement;
mod held;

use testbed_sim::measured::most_mps;
use testbed_sim::tick::Watched;
use unicycle_cbf::{Pose, Scenario, Speeds, StampedPose};

use super::commanded::Commanded;
use super::displaced::{Displaced, Steady};
use super::fit::{Differs, Fit, Stated};
use super::gate::{distance_m, wrapped};
use super::heading::{Heading, Room};
use super::jump::Jumps;
use super::moved::{KEPT_S, Trail};
use super::note::{Consequence, Differing, Note};
use super::roll_call::RollCall;
use differing::misplaced_m;
use held::Held;

/// What settings without guards are held against: noise of poses in m and rad, error of each wheel.
const NOISE_M: f64 = 3e-3;
const NOISE_RAD: f64 = 0.0087;
const WHEEL_ERROR: f64 = 0.1;
/// Heading and direction of motion may differ by this and the noise, in rad: bodies are put on trackers by hand.
const COURSE_RAD: f64 = 0.2;
/// Latency that nobody stated, in s: told to the user from the first on, and not driven with beyond the second.
const LAG_NOTED_S: f64 = 0.15;
const LAG_MOST_S: f64 = 0.4;
/// Poses that are older than this, in s, and than what robots are driven on are not looked at any more.
const RECENT_S: f64 = 0.5;
/// Over which times poses are compared with commands, in s.
const WINDOWS_S: [f64; 2] = [0.8, KEPT_S];
/// The same for the difference that is shown, in s.
const SHOWN_S: f64 = 0.5;
/// How often each robot is looked at, in s, and how often in a row it has to differ.
const LOOK_S: f64 = 0.1;
const IN_A_ROW: u32 = 2;
/// The same of a lag that is only told, and by how much its size may differ, in s.
const LATE_IN_A_ROW: u32 = 5;
const SAME_LAG_S: f64 = 0.06;
/// Share of its speed at which a robot that differs goes on, at least so many m/s, and for how long, in s, before it is looked at anew.
const SLOW: f64 = 0.5;
const SLOW_MPS: f64 = 0.02;
const SLOW_S: f64 = 1.2;
/// How often noise is counted where a robot is held against what rows keep.
const NOISE_PEAKS: f64 = 3.0;
/// A robot that differs, or did once, does not go on beyond this share of its lane.
const SURE_OF_LANE: f64 = 0.85;
/// A robot that was told nothing does not move farther than this, in m and rad.
const STANDING_M: f64 = 0.05;
const STANDING_RAD: f64 = 0.3;

/// Watches all robots of a session.
#[derive(Debug)]
pub(super) struct Watch {
    ids: Vec<u32>,
    stated: Stated,
    half_width_m: f64,
    room: Room,
    /// Noise of a point of interest, in m
    point_noise_m: f64,
    /// Older poses are not looked at, in s
    recent_s: f64,
    /// Steps between two looks at a robot
    every: usize,
    /// Whoever is nearer than this to a robot whose poses jumped stands, in m
    near_m: f64,
    steady: Steady,
    robots: Vec<Own>,
    roll_call: RollCall,
    notes: Vec<Note>,
}

#[derive(Debug)]
struct Own {
    told: Commanded,
    trail: Trail,
    allowed: Allowed,
    /// Looks in a row that found it different
    differing: u32,
    /// The same of those that found it late by about this, in s
    late: (u32, f64),
    lag_told: bool,
    deviation_m: f64,
    was_inside: bool,
    shown: Option<[f64; 2]>,
    heading: Heading,
    jumps: Jumps,
    displaced: Displaced,
    /// What it might do, and how far its point of interest was off in m, before its poses jumped
    before_jump: Option<(Allowed, f64)>,
    /// How late it may follow its commands, from and to, in s
    lags_s: [f64; 2],
    /// How far its point of interest was found to be from where it is taken to be, in m
    misplaced_m: f64,
    held: Held,
}

/// How far a robot may do what was decided.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Allowed {
    All,
    /// At most at a speed in m/s, since a time in s
    Slow {
        most_mps: f64,
        since_s: f64,
    },
    /// Nothing, for good
    Nothing,
}

impl Watch {
    /// `is_told` says whether the commands go to these robots.
    pub(super) fn new(scenario: &Scenario, ids: &[u32], is_told: bool) -> Self {
        let controller = scenario.controller();
        let wheel_base_m = controller.body().wheel_base_m;
        let hardening = &controller.settings().hardening;
        let noise_rad = hardening.heading_noise_rad.max(NOISE_RAD);
        let own = || Own {
            told: Commanded::new(wheel_base_m),
            trail: Trail::default(),
            allowed: Allowed::All,
            differing: 0,
            late: (0, 0.0),
            lag_told: false,
            deviation_m: 0.0,
            was_inside: false,
            shown: None,
            heading: Heading::UNKNOWN,
            jumps: Jumps::default(),
            displaced: Displaced::default(),
            before_jump: None,
            lags_s: displacement::LAGS_S,
            misplaced_m: 0.0,
            held: Held::default(),
        };
        let noise_m = hardening.position_noise_m.max(NOISE_M);
        Self {
            ids: ids.to_vec(),
            stated: Stated {
                noise_m,
                noise_rad,
                wheel_error: hardening.wheel_error.max(WHEEL_ERROR),
                wheel_base_m,
                course_rad: COURSE_RAD + noise_rad,
                lag_s: LAG_MOST_S,
            },
            half_width_m: scenario.spec().controller.lane.half_width_m,
            room: Room::of(scenario),
            point_noise_m: noise_m + controller.body().offset_m * noise_rad,
            recent_s: hardening.max_pose_age_s.unwrap_or(0.0).max(RECENT_S),
            every: (LOOK_S / controller.hold_s()).round().max(1.0) as usize,
            near_m: displacement::near_m(scenario),
            steady: Steady {
                noise_m,
                noise_rad,
                speed_mps: most_mps(scenario),
                turn_rate_rad_s: controller.body().max_turn_rate_rad_s,
            },
            robots: ids.iter().map(|_| own()).collect(),
            roll_call: RollCall::new(ids, noise_m, is_told),
            notes: Vec::new(),
        }
    }

    /// A pose that is believed, in the order of stamps, with the deviation from the path that it means, in m.
    pub(super) fn saw(&mut self, robot: usize, seen: StampedPose, deviation_m: f64) {
        let own = &mut self.robots[robot];
        self.roll_call.saw(robot, &seen);
        let outside_m = deviation_m.abs() - self.half_width_m;
        let twice = own.deviation_m.abs() > self.half_width_m;
        let is_out = outside_m > self.stated.noise_m || (outside_m > 0.0 && twice);
        own.trail.add(seen);
        let told = &own.told;
        own.held
            .add(seen, |from_s, to_s| told.between(from_s, to_s).path_m);
        own.displaced.add(seen, &self.steady);
        own.deviation_m = deviation_m;
        if own.was_inside && is_out && own.allowed != Allowed::Nothing {
            own.allowed = Allowed::Nothing;
            let id = self.ids[robot];
            let by_m = outside_m;
            self.notes.push(Note::OutsideLane { id, by_m });
        }
        own.was_inside |= outside_m <= 0.0;
    }

    /// What a robot does from `time_s` on.
    pub(super) fn told(&mut self, robot: usize, time_s: f64, speeds: Speeds) {
        self.robots[robot].told.sent(time_s, speeds);
    }

    /// The way that a robot was told to go in all up to a time, forward and backward, in m.
    pub(super) fn told_m(&self, robot: usize, time_s: f64) -> f64 {
        self.robots[robot].told.until(time_s).path_m
    }

    /// Whether poses of a robot stayed the same to the last bit while it was told to move.
    pub(super) fn were_held(&self, robot: usize) -> bool {
        self.robots[robot].held.were_held()
    }

    /// How far the point of interest of a robot was found to be from where it is taken to be, in m.
    pub(super) fn misplaced_m(&self, robot: usize) -> f64 {
        self.robots[robot].misplaced_m
    }

    /// Looks at some of the robots, at all of them over a tenth of a second; gives what the user should know.
    pub(super) fn look(&mut self, step: usize, time_s: f64) -> Vec<Note> {
        for robot in 0..self.robots.len() {
            self.show(robot, time_s);
            if (step + robot).is_multiple_of(self.every) {
                self.look_at(robot, time_s);
            }
        }
        let told = |robot: usize| &self.robots[robot].told;
        self.notes.extend(self.roll_call.look(time_s, told));
        std::mem::take(&mut self.notes)
    }

    /// What goes into the run log.
    pub(super) fn watched(&self, robot: usize) -> Watched {
        let own = &self.robots[robot];
        let [position_m, heading_rad] = own.shown.unwrap_or([f64::NAN; 2]);
        let allowed_mps = match own.allowed {
            _ if self.roll_call.holds(robot) || own.displaced_by().is_some() => Some(0.0),
            Allowed::All => own.heading.most_mps(&self.room),
            Allowed::Slow { most_mps, .. } => Some(most_mps),
            Allowed::Nothing => Some(0.0),
        };
        Watched {
            innovation_position_m: position_m,
            innovation_heading_rad: heading_rad,
            allowed_mps,
            disbelieved_s: None,
            misplaced_m: Some(own.misplaced_m).filter(|misplaced_m| *misplaced_m > 0.0),
        }
    }

    /// Where it is, less where half a second of commands would have led it.
    fn show(&mut self, robot: usize, time_s: f64) {
        let own = &mut self.robots[robot];
        let is_known = own.is_seen(time_s - self.recent_s) && !own.told.is_empty();
        let mut last = own.trail.last(SHOWN_S).take_while(|_| is_known);
        own.shown = last.next().zip(own.trail.newest()).map(|(from, to)| {
            let led: Pose = own.told.carried(&from.seen, to.seen.stamp_s);
            let turned_rad = wrapped(to.seen.pose.heading_rad - led.heading_rad);
            [distance_m(&led, &to.seen.pose), turned_rad]
        });
    }

    fn look_at(&mut self, robot: usize, time_s: f64) {
        if self.roll_call.has_failed() || self.has_jumped(robot, time_s) {
            return;
        }
        let own = &mut self.robots[robot];
        let is_seen = own.is_seen(time_s - self.recent_s);
        if own.allowed == Allowed::Nothing || own.told.is_empty() || !is_seen {
            return;
        }
        let fit = Fit::new(&own.trail, KEPT_S, &own.told, self.stated);
        own.heading.learn(fit.as_ref().and_then(Fit::course));
        own.learn_lags(fit.as_ref());
        let how = own.certain(&self.stated);
        let misplaced_m = how.map_or(0.0, |how| misplaced_m(how, &self.room));
        own.misplaced_m = own.misplaced_m.max(misplaced_m);
        let most_m = own.deviation_m.abs() + misplaced_m;
        let near = most_m > SURE_OF_LANE * self.half_width_m;
        let id = self.ids[robot];
        let note = if near && matches!(own.allowed, Allowed::Slow { .. }) {
            own.allowed = Allowed::Nothing;
            Some(Note::NearEdge {
                id,
                most_m,
                half_width_m: self.half_width_m,
            })
        } else {
            how.and_then(|how| {
                let then = own.believed_less(time_s, near)?;
                Some(Note::Differs { id, how, then })
            })
        };
        let note = note.or_else(|| own.turned_outside(&self.room, self.point_noise_m, id));
        let note = note.or_else(|| own.late(fit.as_ref(), id));
        self.notes.extend(note);
    }
}

impl Own {
    fn is_seen(&self, since_s: f64) -> bool {
        let newest = self.trail.newest();
        newest.is_some_and(|newest| newest.seen.stamp_s >= since_s)
    }

    /// How it moves otherwise than told, as it did when it was looked at before.
    fn certain(&mut self, stated: &Stated) -> Option<Differing> {
        let found = self.found(stated);
        self.differing = found.map_or(0, |_| self.differing + 1);
        found.filter(|_| self.differing >= IN_A_ROW)
    }

    /// Stands where its heading, as far off as its motion shows, takes its point of interest out of the lane.
    fn turned_outside(&mut self, room: &Room, noise_m: f64, id: u32) -> Option<Note> {
        let noise_m = NOISE_PEAKS * noise_m;
        let outside_m = self.heading.outside_m(room, self.deviation_m, noise_m)?;
        self.allowed = Allowed::Nothing;
        self.misplaced_m = self.misplaced_m.max(outside_m - self.deviation_m.abs());
        Some(Note::BesideHeading {
            id,
            off_rad: self.heading.off_rad(),
            outside_m,
        })
    }

    fn late(&mut self, fit: Option<&Fit>, id: u32) -> Option<Note> {
        let lag_s = self.lag_s(fit)?;
        self.lag_told = true;
        Some(Note::Late { id, lag_s })
    }

    /// How it moves otherwise than told.
    fn found(&mut self, stated: &Stated) -> Option<Differing> {
        let jumped_m = self.jumps.look(&self.trail, stated.noise_m);
        if let Some(how) = self.moved_untold(stated) {
            return Some(how);
        }
        let mut fits = WINDOWS_S.iter().filter_map(|window_s| {
            let fit = Fit::new(&self.trail, *window_s, &self.told, *stated)?;
            fit.differs()
        });
        let jump = jumped_m.map(Differs::Jump);
        let differs = fits.next().or(jump)?;
        Some(differs.beyond(stated))
    }

    fn lag_s(&mut self, fit: Option<&Fit>) -> Option<f64> {
        if self.lag_told {
            return None;
        }
        let lag_s = fit.and_then(|fit| fit.lag_s(LAG_NOTED_S));
        let (looks, first_s) = self.late;
        self.late = match lag_s {
            Some(lag_s) if looks > 0 && (lag_s - first_s).abs() <= SAME_LAG_S => {
                (looks + 1, first_s)
            }
            Some(lag_s) => (1, lag_s),
            None => (0, 0.0),
        };
        lag_s.filter(|_| self.late.0 >= LATE_IN_A_ROW)
    }

    fn moved_untold(&self, stated: &Stated) -> Option<Differing> {
        let (from, to) = (self.trail.last(KEPT_S).next()?, self.trail.newest()?);
        let way = self
            .told
            .between(from.seen.stamp_s - stated.lag_s, to.seen.stamp_s);
        let way_m = distance_m(&from.seen.pose, &to.seen.pose);
        let turned_rad = to.turned_rad - from.turned_rad;
        let still = way.wheels_m.iter().all(|wheel_m| *wheel_m < stated.noise_m);
        let moved = way_m > STANDING_M + 6.0 * stated.noise_m
            || turned_rad.abs() > STANDING_RAD + 6.0 * stated.noise_rad;
        (still && moved).then_some(Differing::MovedWhileStanding { way_m, turned_rad })
    }

    /// From all to less and to nothing; gives what is done about it, if anything is.
    fn believed_less(&mut self, time_s: f64, near: bool) -> Option<Consequence> {
        match self.allowed {
            Allowed::All if !near => {
                self.allowed = Allowed::Slow {
                    most_mps: SLOW_MPS.max(SLOW * self.told.speeds().speed_mps.abs()),
                    since_s: time_s,
                };
                Some(Consequence::HalfSpeed)
            }
            Allowed::Slow { since_s, .. } if time_s < since_s + SLOW_S => None,
            Allowed::All | Allowed::Slow { .. } => {
                self.allowed = Allowed::Nothing;
                Some(Consequence::Stands)
            }
            Allowed::Nothing => None,
        }
    }
}
