//! Real robots by the poses that were measured of them, in a session and in its replay.

use unicycle_cbf::cbf::Axle;
use unicycle_cbf::{Located, Scenario, Speeds, StampedPose, State, Tracks};

use crate::sight::{BESIDE_S, Doubt, Glimpse, Sights};
use crate::summary::Summarising;
use crate::tick::Truth;

/// How far each wheel may be off what it is told where less is stated.
const WHEEL_ERROR: f64 = 0.1;

/// Judges a session.
#[derive(Debug)]
pub struct Measured<'a> {
    scenario: &'a Scenario,
    /// Whether the robots hear the commands; else they go as fast as they can where nobody sees them
    is_told: bool,
    /// The newest by stamp
    poses: Vec<Option<StampedPose>>,
    tracks: Tracks,
    /// Of the points of interest, of those that are about as old as each other
    places: Vec<Option<State>>,
    sights: Sights,
    /// Least to the edge of the lane, and how far off places were found to be, of each robot in m
    clearance_m: Vec<f64>,
    misplaced_m: Vec<f64>,
    /// Least to the body of another robot, beyond what has to stay free
    gap_m: Vec<f64>,
}

impl<'a> Measured<'a> {
    /// Nobody seen yet; `is_told` says whether the robots hear the commands.
    #[must_use]
    pub fn new(scenario: &'a Scenario, is_told: bool) -> Self {
        let robots = scenario.starts().len();
        let controller = scenario.controller();
        let most_age_s = controller.settings().hardening.max_pose_age_s;
        let most_age_s = most_age_s.unwrap_or(f64::INFINITY);
        Self {
            scenario,
            is_told,
            poses: vec![None; robots],
            tracks: Tracks::new(scenario),
            places: Vec::with_capacity(robots),
            sights: Sights::new(
                robots,
                most_age_s,
                controller.least_distance_m(),
                most_mps(scenario),
            ),
            clearance_m: vec![f64::INFINITY; robots],
            misplaced_m: vec![0.0; robots],
            gap_m: vec![f64::INFINITY; robots],
        }
    }

    /// The point of interest of a robot was found to be this far from where it is taken to be, in m.
    pub fn misplaced(&mut self, robot: usize, misplaced_m: f64) {
        self.misplaced_m[robot] = self.misplaced_m[robot].max(misplaced_m);
    }

    /// What was seen of them so far.
    pub fn sights(&mut self) -> &mut Sights {
        &mut self.sights
    }

    /// Takes in a pose that is believed, in the order of stamps; `told_m` gives the way that a robot was told to go in all up to a
    /// time, in m. Gives how far it is from the path, in m.
    pub fn saw(
        &mut self,
        robot: usize,
        seen: StampedPose,
        told_m: impl Fn(usize, f64) -> f64 + Copy,
        summary: &mut Summarising,
    ) -> Option<f64> {
        self.poses[robot] = Some(seen);
        self.follow(robot, seen);
        let Truth { safety, .. } = self.truth(robot, Speeds::ZERO)?;
        if seen.stamp_s >= 0.0 {
            summary.add_measured(seen.stamp_s, &safety);
            self.judge_distances(seen.stamp_s, summary);
        }
        let half_width_m = self.scenario.spec().controller.lane.half_width_m;
        let glimpse = Glimpse {
            stamp_s: seen.stamp_s,
            place_m: [seen.pose.x_m, seen.pose.y_m],
            clearance_m: half_width_m - safety.deviation_m.abs(),
        };
        if seen.stamp_s >= 0.0 {
            let least_m = self.clearance_m[robot].min(glimpse.clearance_m);
            self.clearance_m[robot] = least_m;
        }
        let way_m = most_way_m(self.scenario, self.is_told, told_m);
        self.sights.saw(robot, glimpse, way_m);
        Some(safety.deviation_m)
    }

    /// The newest believed pose of each robot, by stamp.
    #[must_use]
    pub fn poses(&self) -> &[Option<StampedPose>] {
        &self.poses
    }

    /// The session is over.
    pub fn over(&mut self, time_s: f64, told_m: impl Fn(usize, f64) -> f64 + Copy) {
        let way_m = most_way_m(self.scenario, self.is_told, told_m);
        self.sights.over(time_s, way_m);
        for (robot, misplaced_m) in self.misplaced_m.iter().enumerate() {
            if *misplaced_m > self.clearance_m[robot] {
                self.sights.doubt(Doubt::Misplaced(robot));
            }
            if *misplaced_m > self.gap_m[robot].max(0.0) {
                self.sights.doubt(Doubt::MisplacedNear(robot));
            }
        }
    }

    /// How safe a robot is by its newest pose if it has these speeds.
    #[must_use]
    pub fn truth(&self, robot: usize, speeds: Speeds) -> Option<Truth> {
        self.truth_of(robot, speeds, &self.poses)
    }

    /// The same by other poses of about this time. A measured pose counts as the truth, with the speeds that the robot was told.
    #[must_use]
    pub fn truth_of(
        &self,
        robot: usize,
        speeds: Speeds,
        poses: &[Option<StampedPose>],
    ) -> Option<Truth> {
        let controller = self.scenario.controller();
        let own = poses[robot]?;
        let ahead = self.ahead(robot, own.stamp_s, poses);
        let located = self.located(robot, own, speeds);
        Some(Truth {
            state: located.state,
            safety: self
                .tracks
                .safety(controller, robot, &located, ahead.as_ref()),
        })
    }

    fn follow(&mut self, robot: usize, seen: StampedPose) {
        // Before the start robots may be carried about.
        if seen.stamp_s < 0.0 {
            self.tracks.reset(robot);
        }
        let controller = self.scenario.controller();
        let state = seen.pose.state(controller.body().offset_m, Speeds::ZERO);
        let own = self.tracks.located(controller, robot, state);
        if let Some(ahead) = self.ahead(robot, seen.stamp_s, &self.poses) {
            self.tracks.follow(controller, robot, &own, &ahead);
        }
    }

    /// The robot before one in the list, unless it was seen too long ago.
    fn ahead(&self, robot: usize, time_s: f64, poses: &[Option<StampedPose>]) -> Option<Located> {
        let ahead = robot.checked_sub(1)?;
        let seen = poses[ahead].filter(|seen| time_s - seen.stamp_s <= BESIDE_S)?;
        Some(self.located(ahead, seen, Speeds::ZERO))
    }

    fn located(&self, robot: usize, seen: StampedPose, speeds: Speeds) -> Located {
        let offset_m = self.scenario.controller().body().offset_m;
        self.tracks.last(robot, seen.pose.state(offset_m, speeds))
    }

    fn note_gaps(&mut self) {
        let controller = self.scenario.controller();
        let middle_m = |state: &State| {
            let axle = Axle::new(controller.body(), state);
            [axle.x_m, axle.y_m]
        };
        for (robot, gap_m) in self.gap_m.iter_mut().enumerate() {
            let Some(own) = self.places[robot].as_ref().map(middle_m) else {
                continue;
            };
            let others = self.places.iter().enumerate();
            let others = others.filter(|(other, _)| *other != robot);
            let apart_m = others.filter_map(|(_, place)| {
                let [x_m, y_m] = middle_m(place.as_ref()?);
                Some((x_m - own[0]).hypot(y_m - own[1]))
            });
            let nearest_m = apart_m.fold(f64::INFINITY, f64::min);
            *gap_m = gap_m.min(nearest_m - controller.least_distance_m());
        }
    }

    /// Of poses that are about as old as each other.
    fn judge_distances(&mut self, time_s: f64, summary: &mut Summarising) {
        let offset_m = self.scenario.controller().body().offset_m;
        let beside = |seen: &StampedPose| (time_s - seen.stamp_s).abs() <= BESIDE_S;
        let places = self.poses.iter().map(|seen| {
            let seen = seen.filter(beside)?;
            Some(seen.pose.state(offset_m, Speeds::ZERO))
        });
        self.places.clear();
        self.places.extend(places);
        self.note_gaps();
        summary.add_places(time_s, &self.places);
    }
}

/// The way that a robot can have gone: what it was told and the error of its wheels, or all that its wheels can.
fn most_way_m(
    scenario: &Scenario,
    is_told: bool,
    told_m: impl Fn(usize, f64) -> f64 + Copy,
) -> impl Fn(usize, f64) -> f64 + Copy {
    let most_mps = most_mps(scenario);
    let factor = wheel_factor(scenario);
    move |robot, time_s| {
        if is_told {
            factor * told_m(robot, time_s)
        } else {
            most_mps * time_s
        }
    }
}

fn wheel_factor(scenario: &Scenario) -> f64 {
    1.0 + wheel_error(scenario)
}

/// How far each wheel may be off what it is told, as a share.
pub fn wheel_error(scenario: &Scenario) -> f64 {
    let error = scenario.controller().settings().hardening.wheel_error;
    error.max(WHEEL_ERROR)
}

/// What wheels can do, error and all, in m/s.
pub fn most_mps(scenario: &Scenario) -> f64 {
    wheel_factor(scenario) * scenario.controller().body().max_wheel_speed_mps
}
