//! Controllers beside recorded motion: they decide at every step, and the robots do what they did.

use testbed_sim::measured::most_mps;
use testbed_sim::sight::{BESIDE_S, Doubt, Glimpse, Sights};
use testbed_sim::summary::Summarising;
use testbed_sim::tick::Truth;
use testbed_sim::verdict::safeties;
use testbed_sim::{Convoy, Summary, Tick, Verdict};
use unicycle_cbf::{
    ControllerSettings, PathSpec, Pose, RobotSpec, Safety, Scenario, ScenarioSpec, Speeds,
    StampedPose, State, Testbed, Tracks,
};

use crate::error::Error;
use crate::recorded::{FindingKind, RecordedPose, RecordedRobot, Recording};

/// Span over which speeds are measured, in s.
const SPEED_SPAN_S: f64 = 0.2;
/// A robot that went farther in it moved, in m; headings along which it moved less than this share of it are none in rad.
const MOVED_M: f64 = 0.01;
const LEAST_ALONG: f64 = 0.5;

/// A scenario around recorded robots: a circular lane about the middle of the last robot's poses, wide enough for where it went.
///
/// # Errors
///
/// A recording without poses or with more robots than a scenario may have.
pub fn scenario_of(
    recording: &Recording,
    testbed: Testbed,
    settings: ControllerSettings,
) -> Result<ScenarioSpec, Error> {
    let last = recording.robots.last().map(|robot| robot.poses.as_slice());
    let poses = last
        .filter(|poses| !poses.is_empty())
        .ok_or(Error::NoPoses)?;
    let mean =
        |part: fn(&RecordedPose) -> f64| poses.iter().map(part).sum::<f64>() / poses.len() as f64;
    let (x_m, y_m) = (mean(|pose| pose.x_m), mean(|pose| pose.y_m));
    let radius = |pose: &RecordedPose| (pose.x_m - x_m).hypot(pose.y_m - y_m);
    let radius_m = (poses.iter().map(radius).sum::<f64>() / poses.len() as f64).max(0.1);
    let angle = |i: u32| f64::from(i) * std::f64::consts::TAU / 64.0;
    let point = |i| {
        [
            x_m + radius_m * f64::cos(angle(i)),
            y_m + radius_m * f64::sin(angle(i)),
        ]
    };
    let mut controller = settings;
    controller.lane.half_width_m = 0.9 * radius_m;
    Ok(ScenarioSpec {
        name: "recorded".to_owned(),
        testbed: testbed.name().to_owned(),
        rate_hz: testbed.rate_hz(),
        duration_s: recording.end_s().max(1.0),
        path: PathSpec::Closed {
            points_m: (0..64).map(point).collect(),
        },
        body: testbed.body(),
        controller,
        // Starts are not used, but a scenario has to have its robots in order.
        robots: (0..recording.robots.len())
            .rev()
            .map(|place| RobotSpec::steady(place as f64 / recording.robots.len() as f64, 0.2))
            .collect(),
    })
}

/// Makes a scenario last as long as a recording at least, so that all of that is judged; gives the duration that it had, in s, where it was shorter.
pub fn lengthen(spec: &mut ScenarioSpec, recording: &Recording) -> Option<f64> {
    let (had_s, end_s) = (spec.duration_s, recording.end_s());
    (had_s < end_s).then(|| std::mem::replace(&mut spec.duration_s, end_s))
}

/// Whose lane recorded robots are judged by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lane {
    /// The scenario's
    Given,
    /// The one of [`scenario_of`]: who leaves it may have had another
    Laid,
}

/// What controllers did beside a recording, and what is known of its robots.
#[derive(Debug, Clone, PartialEq)]
pub struct Shadow {
    /// One per robot and step, from the back
    pub ticks: Vec<Tick>,
    /// By the recorded poses
    pub summary: Summary,
    /// Why it is not known whether the robots were safe, unless they were unsafe
    pub doubts: Vec<String>,
}

/// Runs the controllers beside a recording, the robots in its order from the front. The recorded poses count as the truth; between them
/// robots go as fast as their wheels can.
///
/// # Errors
///
/// Another number of robots in the scenario than in the recording.
pub fn shadow(scenario: &Scenario, recording: &Recording, lane: Lane) -> Result<Shadow, Error> {
    let robots = scenario.starts().len();
    if robots != recording.robots.len() {
        return Err(Error::RobotCount {
            scenario: robots,
            recording: recording.robots.len(),
        });
    }
    let mut convoy = Convoy::new(scenario);
    let mut recorded: Vec<Recorded> = recording.robots.iter().map(Recorded::new).collect();
    let mut tracks = Tracks::new(scenario);
    let mut summary = Summarising::new(scenario);
    let mut sights = sights(scenario);
    let mut ticks = Vec::new();
    for step in 0..scenario.steps() {
        let now_s = scenario.time_s(step);
        let seen: Vec<Option<StampedPose>> = recorded.iter_mut().map(|r| r.newest(now_s)).collect();
        for (robot, (seen, recorded)) in seen.iter().zip(&recorded).enumerate() {
            if let Some(seen) = seen {
                convoy.sent(robot, seen.stamp_s, recorded.speeds());
                convoy.observe(robot, *seen);
            }
        }
        let oldest_s = now_s - most_age_s(scenario);
        let places = recorded.iter().map(|r| r.state(scenario, oldest_s));
        let places: Vec<Option<State>> = places.collect();
        let mut safeties = safeties(scenario.controller(), &mut tracks, &places);
        summary.add_places(now_s, &places);
        let clearances = safeties.iter().map(|safety| {
            let half_width_m = scenario.spec().controller.lane.half_width_m;
            safety.map_or(0.0, |safety| half_width_m - safety.deviation_m.abs())
        });
        look(scenario, &mut sights, &seen, clearances);
        if lane == Lane::Laid {
            doubt_laid_lane(scenario, &mut safeties, &mut sights);
        }
        let mut own: Vec<Tick> = (0..robots)
            .rev()
            .map(|robot| {
                let start = std::time::Instant::now();
                let decision = convoy.decide(robot, now_s);
                Tick {
                    tick: step,
                    robot,
                    time_s: now_s,
                    seen: seen[robot],
                    decision,
                    truth: None,
                    watched: None,
                    step_us: start.elapsed().as_secs_f64() * 1e6,
                    late_us: f64::NAN,
                }
            })
            .collect();
        for tick in &mut own {
            let truth = places[tick.robot].zip(safeties[tick.robot]);
            tick.truth = truth.map(|(state, safety)| Truth { state, safety });
            summary.add(tick);
        }
        ticks.append(&mut own);
    }
    let mut doubts = doubts(scenario, recording, sights);
    if !doubts.is_empty() {
        summary.doubt();
    }
    let summary = summary.finished();
    if summary.verdict != Verdict::NotKnown {
        doubts.clear();
    }
    Ok(Shadow {
        ticks,
        summary,
        doubts,
    })
}

/// Outside a lane that nobody gave nobody is unsafe, and it is not known whether anybody is safe.
fn doubt_laid_lane(scenario: &Scenario, safeties: &mut [Option<Safety>], sights: &mut Sights) {
    let half_width_m = scenario.spec().controller.lane.half_width_m;
    for (robot, safety) in safeties.iter_mut().enumerate() {
        let is_outside = |safety: &&mut Safety| safety.deviation_m.abs() > half_width_m;
        if let Some(safety) = safety.as_mut().filter(is_outside) {
            safety.lane = safety.lane.max(0.0);
            safety.deviation_m = half_width_m.copysign(safety.deviation_m);
            sights.doubt(Doubt::LaidLane(robot));
        }
    }
}

fn sights(scenario: &Scenario) -> Sights {
    Sights::new(
        scenario.starts().len(),
        most_age_s(scenario),
        scenario.controller().least_distance_m(),
        most_mps(scenario),
    )
}

/// From when on a robot counts as unseen, in s after its last pose.
fn most_age_s(scenario: &Scenario) -> f64 {
    let hardening = &scenario.controller().settings().hardening;
    hardening.max_pose_age_s.unwrap_or(BESIDE_S)
}

/// What was seen at one step, in the order of stamps.
fn look(
    scenario: &Scenario,
    sights: &mut Sights,
    seen: &[Option<StampedPose>],
    clearances_m: impl Iterator<Item = f64>,
) {
    let fastest_mps = most_mps(scenario);
    let robots = seen.iter().zip(clearances_m).enumerate();
    let glimpses = robots.filter_map(|(robot, (seen, clearance_m))| {
        let StampedPose { stamp_s, pose } = (*seen)?;
        let place_m = [pose.x_m, pose.y_m];
        let glimpse = Glimpse {
            stamp_s,
            place_m,
            clearance_m,
        };
        Some((robot, glimpse))
    });
    let mut glimpses: Vec<(usize, Glimpse)> = glimpses.collect();
    glimpses.sort_by(|(_, a), (_, b)| a.stamp_s.total_cmp(&b.stamp_s));
    for (robot, glimpse) in glimpses {
        sights.saw(robot, glimpse, |_, time_s| fastest_mps * time_s);
    }
}

/// Why it is not known whether the recorded robots were safe.
fn doubts(scenario: &Scenario, recording: &Recording, mut sights: Sights) -> Vec<String> {
    let fastest_mps = most_mps(scenario);
    let end_s = scenario.spec().duration_s;
    sights.over(end_s, |_, time_s| fastest_mps * time_s);
    for (robot, recorded) in recording.robots.iter().enumerate() {
        let found = |kind| recorded.findings.iter().any(|finding| finding.kind == kind);
        let along = along_heading(recorded);
        if along.map_or(found(FindingKind::Degrees), |share| share < LEAST_ALONG) {
            sights.doubt(Doubt::Headings(robot));
        }
        if found(FindingKind::TwoPlaces) {
            sights.doubt(Doubt::TwoPlaces(robot));
        }
    }
    let names: Vec<&str> = recording.robots.iter().map(|r| r.name.as_str()).collect();
    let texts = sights.doubts().iter().map(|doubt| doubt.text(&names));
    texts.collect()
}

/// How much a robot moved along its heading, forward or backward: 1 for always, 0 for any direction; none of one that stood. Headings in
/// rad may go beyond a turn.
fn along_heading(robot: &RecordedRobot) -> Option<f64> {
    let mut from = robot.poses.first()?;
    let (mut sum, mut count) = (0.0, 0_u32);
    for to in &robot.poses {
        if to.time_s - from.time_s < SPEED_SPAN_S {
            continue;
        }
        let (dx, dy) = (to.x_m - from.x_m, to.y_m - from.y_m);
        if dx.hypot(dy) >= MOVED_M {
            sum += (2.0 * (dy.atan2(dx) - 0.5 * (from.heading_rad + to.heading_rad))).cos();
            count += 1;
        }
        from = to;
    }
    (count > 0).then(|| sum / f64::from(count))
}

/// One robot's recording, read forward.
struct Recorded<'a> {
    poses: &'a [RecordedPose],
    next: usize,
}

impl<'a> Recorded<'a> {
    fn new(robot: &'a RecordedRobot) -> Self {
        Self {
            poses: &robot.poses,
            next: 0,
        }
    }

    fn newest(&mut self, now_s: f64) -> Option<StampedPose> {
        let before = self.next;
        while self
            .poses
            .get(self.next)
            .is_some_and(|pose| pose.time_s <= now_s)
        {
            self.next += 1;
        }
        if self.next > before {
            self.last()
        } else {
            None
        }
    }

    fn last(&self) -> Option<StampedPose> {
        let pose = self.poses.get(self.next.checked_sub(1)?)?;
        Some(stamped(pose))
    }

    /// None of a robot that was not seen since: nobody knows where it is.
    fn state(&self, scenario: &Scenario, oldest_s: f64) -> Option<State> {
        let last = self.last().filter(|last| last.stamp_s >= oldest_s)?;
        let offset_m = scenario.controller().body().offset_m;
        Some(last.pose.state(offset_m, self.speeds()))
    }

    /// Between the newest pose and one some time before.
    fn speeds(&self) -> Speeds {
        let Some(last) = self.last() else {
            return Speeds::ZERO;
        };
        let past = self.poses[..self.next].iter().rev();
        let Some(first) = past
            .take_while(|pose| last.stamp_s - pose.time_s <= 1.0)
            .find(|pose| last.stamp_s - pose.time_s >= SPEED_SPAN_S)
        else {
            return Speeds::ZERO;
        };
        stamped(first).speeds_to(&last)
    }
}

fn stamped(pose: &RecordedPose) -> StampedPose {
    StampedPose {
        stamp_s: pose.time_s,
        pose: Pose {
            x_m: pose.x_m,
            y_m: pose.y_m,
            heading_rad: pose.heading_rad,
        },
    }
}
