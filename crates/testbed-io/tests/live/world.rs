//! Robots as they really are, and how near they came to what must not be.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use unicycle_cbf::{Pose, Scenario, Speeds};

const STEP: Duration = Duration::from_millis(2);

/// A command as a robot got it.
#[derive(Debug, Clone, Copy)]
pub struct Commanded {
    pub at: Instant,
    pub speeds: Speeds,
}

struct Robot {
    pose: Pose,
    speeds: Speeds,
    told: Vec<Commanded>,
    /// Motors stop by themselves after this time without a command
    stops_after: Option<Duration>,
}

/// The least that there was of each.
#[derive(Debug, Clone, Copy)]
pub struct Least {
    pub headway_m: f64,
    pub lane_clearance_m: f64,
}

struct State {
    robots: Vec<Robot>,
    least: Least,
}

/// Simulated robots in real time, from the front.
#[derive(Clone)]
pub struct World(Arc<Mutex<State>>);

/// Moves a world until it is dropped.
pub struct Moving {
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl World {
    /// At the start of a scenario.
    pub fn new(scenario: &Scenario, stops_after: Option<Duration>) -> (Self, Moving) {
        let robot = |pose: &Pose| Robot {
            pose: *pose,
            speeds: Speeds::ZERO,
            told: Vec::new(),
            stops_after,
        };
        let world = Self(Arc::new(Mutex::new(State {
            robots: scenario.starts().iter().map(robot).collect(),
            least: Least {
                headway_m: f64::INFINITY,
                lane_clearance_m: f64::INFINITY,
            },
        })));
        let ended = Arc::new(AtomicBool::new(false));
        let (moved, scenario, until) = (world.clone(), scenario.clone(), Arc::clone(&ended));
        let thread = std::thread::spawn(move || {
            let mut before = Instant::now();
            while !until.load(Ordering::Relaxed) {
                std::thread::sleep(STEP);
                let now = Instant::now();
                moved.advance(&scenario, (now - before).as_secs_f64());
                before = now;
            }
        });
        let moving = Moving {
            ended,
            thread: Some(thread),
        };
        (world, moving)
    }

    pub fn command(&self, robot: usize, speeds: Speeds) {
        let mut state = self.0.lock().unwrap();
        let robot = &mut state.robots[robot];
        robot.speeds = speeds;
        let at = Instant::now();
        robot.told.push(Commanded { at, speeds });
    }

    pub fn poses(&self) -> Vec<Pose> {
        let state = self.0.lock().unwrap();
        state.robots.iter().map(|robot| robot.pose).collect()
    }

    pub fn told(&self, robot: usize) -> Vec<Commanded> {
        self.0.lock().unwrap().robots[robot].told.clone()
    }

    pub fn least(&self) -> Least {
        self.0.lock().unwrap().least
    }

    pub fn stands(&self) -> bool {
        let state = self.0.lock().unwrap();
        state
            .robots
            .iter()
            .all(|robot| robot.speeds == Speeds::ZERO)
    }

    /// Whether every command that arrived from `from` to `to` was to stand.
    pub fn told_to_stand(&self, from: Instant, to: Instant) -> bool {
        let state = self.0.lock().unwrap();
        state.robots.iter().all(|robot| {
            let mut told = robot.told.iter();
            told.all(|told| told.at < from || told.at > to || told.speeds == Speeds::ZERO)
        })
    }

    fn advance(&self, scenario: &Scenario, duration_s: f64) {
        let mut state = self.0.lock().unwrap();
        let controller = scenario.controller();
        let offset_m = controller.body().offset_m;
        let half_width_m = scenario.spec().controller.lane.half_width_m;
        let mut least = state.least;
        let mut ahead = None;
        for robot in &mut state.robots {
            let since = robot.told.last().map(|told| told.at.elapsed());
            if robot
                .stops_after
                .is_some_and(|after| since.is_some_and(|s| s > after))
            {
                robot.speeds = Speeds::ZERO;
            }
            robot.pose = robot.pose.advanced(robot.speeds, duration_s);
            let now = robot.pose.state(offset_m, robot.speeds);
            let safety = controller.safety(&now, ahead.as_ref());
            least.headway_m = least
                .headway_m
                .min(safety.headway_m.unwrap_or(f64::INFINITY));
            let clearance_m = half_width_m - safety.deviation_m.abs();
            least.lane_clearance_m = least.lane_clearance_m.min(clearance_m);
            ahead = Some(now);
        }
        state.least = least;
    }
}

impl Drop for Moving {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap();
    }
}
