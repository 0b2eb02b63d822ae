//! Whether a run was safe: by the bodies of all robots and by their lanes, as far as it was seen.

use serde::{Deserialize, Serialize};
use unicycle_cbf::{Controller, Located, Safety, State, Tracks};

/// What is known of the safety of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// No robot left its lane, came nearer to another than their bodies and the clearance need, or lost its headway
    Safe,
    /// One did
    Unsafe,
    /// Too little was seen
    NotKnown,
}

/// The moment at which two robots were nearest to each other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LeastDistance {
    /// Indices of the two from the front
    pub robots: [usize; 2],
    /// When, in s
    pub at_s: f64,
    /// Between the middles of their axles, in m
    pub centres_m: f64,
    /// Between their bodies, in m; below zero they touch
    pub gap_m: f64,
}

/// What each robot has to keep at one time, by the states of all from the front.
#[must_use]
pub fn safeties(
    controller: &Controller,
    tracks: &mut Tracks,
    states: &[Option<State>],
) -> Vec<Option<Safety>> {
    let robots = states.iter().enumerate();
    let robots: Vec<Option<Located>> = robots
        .map(|(robot, state)| Some(tracks.located(controller, robot, (*state)?)))
        .collect();
    let mut safety = |robot: usize| {
        let own = robots[robot]?;
        let ahead = robot.checked_sub(1).and_then(|ahead| robots[ahead]);
        if let Some(ahead) = &ahead {
            tracks.follow(controller, robot, &own, ahead);
        }
        Some(tracks.safety(controller, robot, &own, ahead.as_ref()))
    };
    (0..states.len()).map(&mut safety).collect()
}

/// Watches the distances between all robots.
#[derive(Debug, Clone)]
pub(crate) struct Judge {
    offset_m: f64,
    bodies_m: f64,
    clearance_m: f64,
    least: Option<LeastDistance>,
    first_near_s: Option<f64>,
    /// Middles of the axles of the robots that were seen, with their indices
    axles: Vec<(usize, [f64; 2])>,
}

impl Judge {
    pub(crate) fn new(controller: &Controller) -> Self {
        let body = controller.body();
        Self {
            offset_m: body.offset_m,
            bodies_m: 2.0 * body.radius_m(),
            clearance_m: controller.settings().headway.clearance_m,
            least: None,
            first_near_s: None,
            axles: Vec::new(),
        }
    }

    /// States of the points of interest at one time, from the front; none of robots that were not seen.
    pub(crate) fn add(&mut self, time_s: f64, states: &[Option<State>]) {
        let mut axles = std::mem::take(&mut self.axles);
        axles.clear();
        for (robot, state) in states.iter().enumerate() {
            axles.extend(state.map(|state| (robot, self.axle(&state))));
        }
        for (index, own) in axles.iter().enumerate() {
            for other in &axles[..index] {
                self.add_pair(time_s, *other, *own);
            }
        }
        self.axles = axles;
    }

    fn axle(&self, state: &State) -> [f64; 2] {
        let (sin, cos) = state.heading_rad.sin_cos();
        [
            state.x_m - self.offset_m * cos,
            state.y_m - self.offset_m * sin,
        ]
    }

    fn add_pair(&mut self, at_s: f64, a: (usize, [f64; 2]), b: (usize, [f64; 2])) {
        let ((first, [ax, ay]), (second, [bx, by])) = (a, b);
        let robots = [first, second];
        let centres_m = (bx - ax).hypot(by - ay);
        let gap_m = centres_m - self.bodies_m;
        if self.least.is_none_or(|least| centres_m < least.centres_m) {
            self.least = Some(LeastDistance {
                robots,
                at_s,
                centres_m,
                gap_m,
            });
        }
        if gap_m < self.clearance_m && self.first_near_s.is_none() {
            self.first_near_s = Some(at_s);
        }
    }

    pub(crate) fn least(&self) -> Option<LeastDistance> {
        self.least
    }

    /// When two robots were nearer to each other than their bodies and the clearance need, for the first time.
    pub(crate) fn first_near_s(&self) -> Option<f64> {
        self.first_near_s
    }
}
