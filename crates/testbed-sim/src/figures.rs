//! What the pictures of a run are drawn from, by robot and over time.

use serde::Serialize;
use unicycle_cbf::cbf::LaneBarrier;
use unicycle_cbf::{Scenario, Tracker};

use crate::tick::Tick;

/// Points along the lane.
const OUTLINE: usize = 400;

/// Lines are for the eye: their values have five digits.
type Line = Vec<f64>;

/// Everything on one page.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunFigures {
    lane: Outline,
    headway_s: f64,
    lane_barrier: &'static str,
    robot: Shape,
    time_s: Line,
    robots: Vec<RobotLines>,
    undisturbed: Option<Vec<RobotLines>>,
}

/// Something that the scenario does to a robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Event {
    robot: usize,
    kind: &'static str,
    from_s: f64,
    to_s: Option<f64>,
    value: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Outline {
    half_width_m: f64,
    closed: bool,
    centre_m: Vec<[f64; 2]>,
    left_m: Vec<[f64; 2]>,
    right_m: Vec<[f64; 2]>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Shape {
    length_m: f64,
    offset_m: f64,
    wheel_base_m: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct RobotLines {
    name: String,
    x_m: Line,
    y_m: Line,
    heading_rad: Line,
    speed_mps: Line,
    turn_rate_rad_s: Line,
    h_headway_m: Option<Line>,
    /// Barrier at the newest true or measured place, in its own units
    h_lane: Line,
    /// Of the same place
    lane_clearance_m: Line,
    deviation_m: Line,
    v1: Line,
    v2: Line,
    v3: Line,
    slack: [Line; 3],
    outcome: Vec<(String, usize)>,
    pose_age_s: Line,
    step_us: Line,
}

impl RunFigures {
    /// Of a run, and of the same without disturbances where it had some.
    #[must_use]
    pub fn new(scenario: &Scenario, ticks: &[Tick], undisturbed: Option<&[Tick]>) -> Self {
        let spec = scenario.spec();
        let body = spec.body;
        let first = ticks.iter().filter(|tick| tick.robot == 0);
        let lines = |ticks: &[Tick]| {
            let robots = 0..spec.robots.len();
            let half_width_m = spec.controller.lane.half_width_m;
            let lines = robots.map(|robot| RobotLines::new(robot, ticks, half_width_m));
            lines.collect()
        };
        Self {
            lane: Outline::new(scenario, ticks),
            headway_s: spec.controller.headway.time_s,
            lane_barrier: match spec.controller.lane.barrier {
                LaneBarrier::Quadratic { .. } => "quadratic",
                LaneBarrier::Braking { .. } => "braking",
                LaneBarrier::Exponential { .. } => "exponential",
            },
            robot: Shape {
                length_m: 2.0 * body.offset_m,
                offset_m: body.offset_m,
                wheel_base_m: body.wheel_base_m,
            },
            time_s: first.map(|tick| rounded(tick.time_s)).collect(),
            robots: lines(ticks),
            undisturbed: undisturbed.map(lines),
        }
    }
}

impl Event {
    /// All of a scenario.
    #[must_use]
    pub fn all(scenario: &Scenario) -> Vec<Self> {
        let mut events = Vec::new();
        for (robot, spec) in scenario.spec().robots.iter().enumerate() {
            let mut add = |kind, from_s, to_s, value| {
                events.push(Self {
                    robot,
                    kind,
                    from_s,
                    to_s,
                    value,
                });
            };
            match spec.tracker {
                Tracker::On => {}
                Tracker::Off { from_s, to_s } => add("tracker-off", from_s, Some(to_s), None),
                Tracker::Decay { from_s, .. } => add("tracker-decay", from_s, None, None),
            }
            for [from_s, to_s] in &spec.stops_s {
                add("stop", *from_s, Some(*to_s), None);
            }
            for [from_s, speed_mps] in spec.desired_speed_mps.iter().skip(1) {
                add("desired-speed", *from_s, None, Some(*speed_mps));
            }
        }
        events
    }
}

impl Outline {
    fn new(scenario: &Scenario, ticks: &[Tick]) -> Self {
        let path = scenario.controller().path();
        let half_width_m = scenario.spec().controller.lane.half_width_m;
        let length_m = path.length_m();
        let [from_m, to_m] =
            length_m.map_or_else(|| reach(scenario, ticks), |length| [0.0, length]);
        let step_m = (to_m - from_m) / OUTLINE as f64;
        let line = |side: f64| {
            let point = |index: usize| {
                let foot = path.at(from_m + index as f64 * step_m);
                let [nx, ny] = foot.normal();
                let [x_m, y_m] = [foot.x_m + side * nx, foot.y_m + side * ny];
                [rounded(x_m), rounded(y_m)]
            };
            (0..=OUTLINE).map(point).collect()
        };
        Self {
            half_width_m,
            closed: length_m.is_some(),
            centre_m: line(0.0),
            left_m: line(-half_width_m),
            right_m: line(half_width_m),
        }
    }
}

fn rounded(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let scale = 10_f64.powi(4 - value.abs().log10().floor() as i32);
    (value * scale).round() / scale
}

/// The part of an open path that robots were on, and a little more.
fn reach(scenario: &Scenario, ticks: &[Tick]) -> [f64; 2] {
    let path = scenario.controller().path();
    let starts = scenario.starts().iter().map(|pose| (pose.x_m, pose.y_m));
    let places = ticks.iter().filter_map(Tick::place).chain(starts);
    let places = places.map(|(x_m, y_m)| path.nearest(x_m, y_m).s_m);
    let [low, high] = places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], s_m| {
        [low.min(s_m), high.max(s_m)]
    });
    let more = 0.05 * (high - low) + 0.1;
    [low - more, high + more]
}

impl RobotLines {
    fn new(robot: usize, ticks: &[Tick], half_width_m: f64) -> Self {
        let own: Vec<&Tick> = ticks.iter().filter(|tick| tick.robot == robot).collect();
        let line = |read: fn(&Tick) -> f64| own.iter().map(|tick| rounded(read(tick))).collect();
        let mut last_stamp_s = f64::NAN;
        let age = |tick: &&Tick| {
            last_stamp_s = tick.seen.map_or(last_stamp_s, |seen| seen.stamp_s);
            rounded(tick.time_s - last_stamp_s)
        };
        let barrier = |tick: &Tick| tick.truth.map(|truth| truth.safety.lane);
        let clearance = |tick: &Tick| tick.lane_clearance_m(half_width_m);
        let names: Vec<String> = own.iter().map(|tick| tick.outcome_name()).collect();
        let spans = names.chunk_by(|a, b| a == b);
        Self {
            name: match robot {
                0 => "leader".to_owned(),
                1 if ticks.iter().all(|tick| tick.robot < 2) => "follower".to_owned(),
                _ => format!("follower {robot}"),
            },
            x_m: line(|t| t.place().map_or(f64::NAN, |(x_m, _)| x_m)),
            y_m: line(|t| t.place().map_or(f64::NAN, |(_, y_m)| y_m)),
            heading_rad: line(|t| t.known_state().map_or(f64::NAN, |s| s.heading_rad)),
            speed_mps: line(|t| t.known_state().map_or(f64::NAN, |s| s.speed_mps)),
            turn_rate_rad_s: line(|t| t.known_state().map_or(f64::NAN, |s| s.turn_rate_rad_s)),
            h_headway_m: (robot > 0).then(|| newest(&own, |t| t.truth?.safety.headway_m)),
            h_lane: newest(&own, barrier),
            lane_clearance_m: newest(&own, clearance),
            deviation_m: newest(&own, |t| Some(t.truth?.safety.deviation_m)),
            v1: line(|t| t.lyapunov(0)),
            v2: line(|t| t.lyapunov(1)),
            v3: line(|t| t.lyapunov(2)),
            slack: [
                line(|t| t.slack(0)),
                line(|t| t.slack(1)),
                line(|t| t.slack(2)),
            ],
            outcome: spans
                .filter_map(|span| Some((span.first()?.clone(), span.len())))
                .collect(),
            pose_age_s: own.iter().map(age).collect(),
            step_us: line(|t| t.step_us),
        }
    }
}

/// Between poses the last that is known; NaN before the first.
fn newest(ticks: &[&Tick], read: impl Fn(&Tick) -> Option<f64>) -> Line {
    let mut last = f64::NAN;
    let values = ticks.iter().map(|tick| {
        last = read(tick).unwrap_or(last);
        rounded(last)
    });
    values.collect()
}
