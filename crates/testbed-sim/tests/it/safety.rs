//! What a run may not come to, whatever a scenario asks of its robots: bodies that touch, a lane that is left, wheels that jump.

mod beside;
mod bodies;
mod branches;
mod crowd;
mod deadlock;
mod lane;
mod meeting;
mod once_wrong;
mod settling;
mod stated;
mod turning;
mod wheels;

use testbed_sim::{Disturbances, RunSpec, Summary, Tick, Verdict};
use unicycle_cbf::{PathSpec, Preset, RobotSpec, RowKind, ScenarioSpec, Testbed};

pub(crate) struct Driven {
    pub(crate) ticks: Vec<Tick>,
    pub(crate) summary: Summary,
}

pub(crate) fn driven_with(scenario: ScenarioSpec, disturbances: Disturbances, seed: u64) -> Driven {
    let spec = RunSpec {
        seed,
        scenario,
        disturbances,
    };
    let (run, summary) = spec.simulate().unwrap();
    Driven {
        ticks: run.ticks,
        summary,
    }
}

pub(crate) fn driven(scenario: ScenarioSpec) -> Driven {
    driven_with(scenario, Disturbances::default(), 1)
}

impl Driven {
    pub(crate) fn of(&self, robot: usize) -> impl DoubleEndedIterator<Item = &Tick> {
        self.ticks.iter().filter(move |tick| tick.robot == robot)
    }

    pub(crate) fn gap_m(&self) -> f64 {
        self.summary.least_distance.unwrap().gap_m
    }

    /// Safe, and bodies at least this far apart.
    pub(crate) fn assert_safe(&self, clearance_m: f64, what: &str) {
        assert_eq!(
            self.summary.verdict,
            Verdict::Safe,
            "{what}: {:?}",
            self.summary
        );
        let least = self.summary.least_distance;
        assert!(
            least.is_none_or(|least| least.gap_m >= clearance_m),
            "{what}: {least:?}"
        );
    }

    pub(crate) fn is_ever_held(&self, robot: usize, kind: RowKind) -> bool {
        self.of(robot).any(|tick| tick.decision.is_held_by(kind))
    }

    pub(crate) fn final_speed_mps(&self, robot: usize) -> f64 {
        let last = self.of(robot).next_back().unwrap();
        last.truth.unwrap().state.speed_mps
    }
}

/// A hardened built-in scenario with other robots, the clearance of every robot in it left as it is.
pub(crate) fn hardened(testbed: Testbed, name: &str, robots: Vec<RobotSpec>) -> ScenarioSpec {
    let scenario = testbed.scenario(name, Preset::Hardened).unwrap();
    ScenarioSpec { robots, ..scenario }
}

/// A robot with other desired speeds from a time on.
pub(crate) fn then(robot: RobotSpec, from_s: f64, speed_mps: f64) -> RobotSpec {
    let mut robot = robot;
    robot.desired_speed_mps.push([from_s, speed_mps]);
    robot
}

/// A figure eight about the origin, which it crosses at the start and after half a lap.
pub(crate) fn eight(half_length_m: f64, half_height_m: f64) -> PathSpec {
    let point = |at: usize| {
        let turn = std::f64::consts::TAU * at as f64 / 64.0;
        [
            half_length_m * turn.sin(),
            half_height_m * (2.0 * turn).sin(),
        ]
    };
    PathSpec::Closed {
        points_m: (0..64).map(point).collect(),
    }
}
