//! A link that is open: a tracker that sends poses, and robots that take commands.

use std::time::Duration;

use unicycle_cbf::Scenario;

use super::clock::Clock;
use super::commands::{
    CommandSink, DeadMan, JsonUdpCommands, JsonWriter, Khepera, Nowhere, RobotariumCommands,
    RobotariumUdp,
};
use super::gate::{Arena, Bounds};
use super::inbox::Inbox;
use super::json_lines::PoseLine;
use super::natnet;
use super::poses::{Program, Receiver, Recorded, Running, listen};
use super::robotarium::{self, Robotarium};
use super::spec::{CommandsSpec, LinkSpec, PosesSpec};
use crate::Error;

/// How long robots have to confirm that they stand.
const STOP_PATIENCE: Duration = Duration::from_secs(3);
/// How far from the lane robots can be where no arena is given, in m.
const AROUND_LANE_M: f64 = 0.5;
/// How far from their starts on paths without end, in m.
const AROUND_STARTS_M: f64 = 20.0;
/// By how much robots may be faster than their data say.
const FASTER: f64 = 1.1;

pub(super) struct Link {
    pub(super) inbox: Inbox,
    pub(super) ids: Vec<u32>,
    pub(super) commands: DeadMan,
    source: Source,
    fast: bool,
    /// Ends after the commands, which it reads
    program: Option<Running>,
}

enum Source {
    Receiver(Receiver),
    /// The connection that the commands go over
    Shared,
    /// A connection of its own
    Robotarium {
        _poses: Robotarium,
    },
    Recording(Recorded),
}

impl Link {
    pub(super) fn open(spec: &LinkSpec, scenario: &Scenario) -> Result<Self, Error> {
        spec.check(scenario.starts().len())?;
        let ids = spec.robots.clone();
        let inbox = Inbox::new(Clock::start(), &ids, bounds(spec, scenario));
        let period_s = scenario.controller().hold_s();
        let watched = |sink| DeadMan::beside(sink, ids.len(), period_s);
        // Robots first, so that they are told to stand whatever happens to the tracker.
        let mut sink: Option<Box<dyn CommandSink>> = match &spec.commands {
            CommandsSpec::Khepera(spec) => Some(Box::new(Khepera::open(spec)?)),
            CommandsSpec::RobotariumUdp(spec) => Some(Box::new(RobotariumUdp::open(spec)?)),
            CommandsSpec::JsonUdp(spec) => {
                Some(Box::new(JsonUdpCommands::open(spec.address, &ids)?))
            }
            CommandsSpec::None => Some(Box::new(Nowhere)),
            CommandsSpec::Robotarium | CommandsSpec::Program => None,
        };
        let mut commands = sink.take().map(watched).transpose()?;
        let mut program = None;
        let source = match &spec.poses {
            PosesSpec::Natnet(spec) => Source::Receiver(natnet::start(spec, inbox.clone())?),
            PosesSpec::JsonUdp(spec) => Source::Receiver(listen(spec, inbox.clone())?),
            PosesSpec::Recording(spec) => Source::Recording(Recorded::open(spec, ids.len())?),
            PosesSpec::Robotarium(spec) if commands.is_some() => Source::Robotarium {
                _poses: robotarium::connect(spec, &[], inbox.clone())?,
            },
            PosesSpec::Robotarium(spec) => {
                let broker = robotarium::connect(spec, &ids, inbox.clone())?;
                sink = Some(Box::new(RobotariumCommands::new(broker)));
                Source::Shared
            }
            PosesSpec::Program(spec) => {
                let started = Program::start(spec, &starts(&ids, scenario), inbox.clone())?;
                program = started.child;
                if commands.is_none() {
                    sink = Some(Box::new(JsonWriter::start(started.commands, &ids)?));
                }
                Source::Receiver(started.poses)
            }
        };
        if let Some(sink) = sink {
            commands = Some(watched(sink)?);
        }
        let commands = match commands {
            Some(commands) => commands,
            None => watched(Box::new(Nowhere))?,
        };
        Ok(Self {
            inbox,
            ids,
            commands,
            source,
            fast: spec.is_fast(),
            program,
        })
    }

    /// Tells every robot to stand; gives the ids of those that may not have got it. A program that has ended got nothing.
    pub(super) fn stop(&mut self) -> Vec<u32> {
        let mut untold = self.commands.stop(STOP_PATIENCE);
        if self.program.is_some() && self.has_ended() {
            untold = (0..self.ids.len()).collect();
        }
        untold.iter().map(|robot| self.ids[*robot]).collect()
    }

    /// Hands over the poses of a recording that are due by a time.
    pub(super) fn play(&mut self, time_s: f64, start_s: f64) {
        if let Source::Recording(recording) = &mut self.source {
            recording.play(time_s, start_s, &self.ids, &self.inbox);
        }
    }

    /// Hands over the poses of a recording until every robot has one.
    pub(super) fn play_until_seen(&mut self, start_s: f64) {
        if let Source::Recording(recording) = &self.source {
            let all_seen_s = recording.all_seen_s(self.ids.len());
            self.play(all_seen_s, start_s);
        }
    }

    /// Whether time passes without waiting.
    pub(super) fn is_fast(&self) -> bool {
        self.fast
    }

    pub(super) fn is_recording(&self) -> bool {
        matches!(self.source, Source::Recording(_))
    }

    /// Whether no pose can come any more.
    pub(super) fn has_ended(&self) -> bool {
        match &self.source {
            Source::Receiver(thread) => thread.is_finished(),
            Source::Recording(recording) => recording.has_ended(),
            Source::Shared | Source::Robotarium { .. } => false,
        }
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.inbox.end();
    }
}

fn starts(ids: &[u32], scenario: &Scenario) -> Vec<PoseLine> {
    let starts = ids.iter().zip(scenario.starts());
    starts.map(|(id, pose)| PoseLine::new(*id, pose)).collect()
}

fn bounds(spec: &LinkSpec, scenario: &Scenario) -> Bounds {
    let body = scenario.controller().body();
    let turn_rate_rad_s = 2.0 * body.max_wheel_speed_mps / body.wheel_base_m;
    Bounds {
        arena: spec.arena.unwrap_or_else(|| around(scenario)),
        speed_mps: FASTER * body.max_wheel_speed_mps,
        turn_rate_rad_s: FASTER * turn_rate_rad_s,
        spacing_m: body.wheel_base_m,
    }
}

fn around(scenario: &Scenario) -> Arena {
    let path = scenario.controller().path();
    let (places, more_m): (Vec<[f64; 2]>, f64) = match path.length_m() {
        Some(length_m) => {
            let at = |index: u32| path.at(length_m * f64::from(index) / 256.0);
            let places = (0..256).map(at).map(|foot| [foot.x_m, foot.y_m]).collect();
            let half_width_m = scenario.spec().controller.lane.half_width_m;
            (places, half_width_m + AROUND_LANE_M)
        }
        None => {
            let starts = scenario.starts().iter();
            let places = starts.map(|pose| [pose.x_m, pose.y_m]).collect();
            (places, AROUND_STARTS_M)
        }
    };
    let range = |axis: usize| {
        let values = places.iter().map(|place| place[axis]);
        let from_to = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(value), high.max(value)]
        });
        [from_to[0] - more_m, from_to[1] + more_m]
    };
    Arena {
        x_m: range(0),
        y_m: range(1),
    }
}
