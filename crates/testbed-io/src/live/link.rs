//! A link that is open: a tracker that sends poses, and robots that take commands.

use std::io::Write;
use std::time::Duration;

use testbed_sim::measured::wheel_error;
use unicycle_cbf::Scenario;

use super::clock::Clock;
use super::commands::{
    CommandSink, DeadMan, JsonUdpCommands, JsonWriter, Khepera, Nowhere, RobotariumCommands,
    RobotariumUdp, Silence,
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
    /// Whether commands go to the program that gives the poses
    to_program: bool,
    /// Whether the robots that are seen hear the commands
    told: bool,
}

enum Source {
    Receiver(Receiver),
    /// The connection that the commands go over
    Shared,
    /// A connection of its own
    Robotarium {
        poses: Robotarium,
    },
    /// With its input, which it takes as the session's end when it ends
    Program {
        name: String,
        poses: Receiver,
        _input: Option<Box<dyn Write + Send>>,
        _running: Option<Running>,
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
        let commands = sink(&spec.commands, &ids)?.map(watched).transpose()?;
        let others = commands.is_some();
        let (source, own) = source(&spec.poses, others, &ids, scenario, &inbox)?;
        let commands = match commands {
            Some(commands) => commands,
            None => watched(own.unwrap_or_else(|| Box::new(Nowhere)))?,
        };
        Ok(Self {
            inbox,
            ids,
            commands,
            source,
            fast: spec.is_fast(),
            to_program: spec.commands == CommandsSpec::Program,
            told: spec.is_told(),
        })
    }

    /// Tells every robot to stand; gives the ids of those that may not have got it. A program that has ended got nothing.
    pub(super) fn stop(&mut self) -> Vec<u32> {
        let untold = self.commands.stop(STOP_PATIENCE);
        if self.to_program && self.has_ended() {
            return self.ids.clone();
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

    /// Whether the robots that are seen hear the commands.
    pub(super) fn is_told(&self) -> bool {
        self.told
    }

    /// Whether time passes without waiting.
    pub(super) fn is_fast(&self) -> bool {
        self.fast
    }

    pub(super) fn is_recording(&self) -> bool {
        matches!(self.source, Source::Recording(_))
    }

    /// Whether the other side is gone while robots are waited for: a program has ended, or a peer has been silent for too long.
    pub(super) fn is_there(&self, waited_s: f64, lost_after_s: f64) -> Result<(), Error> {
        let gone = |peer: String, problem: String, help: &str| {
            let help = help.to_owned();
            Err(Error::Link {
                peer,
                problem,
                help,
            })
        };
        if let Source::Program { name, .. } = &self.source
            && self.has_ended()
        {
            let counts = self.inbox.counts().text();
            let problem = format!("has ended before every robot was seen; {counts}");
            let help = "see what it says above, and start it by itself to try it";
            return gone(name.clone(), problem, help);
        }
        match self.lost(waited_s, lost_after_s) {
            Some(Silence { peer, for_s }) => {
                let problem =
                    format!("silent for {for_s:.1} s, and not every robot has been seen yet");
                gone(peer, problem, "start it again, then the session")
            }
            None => Ok(()),
        }
    }

    /// A peer that has been silent for too long, counted from when it could be heard.
    pub(super) fn lost(&self, listened_s: f64, lost_after_s: f64) -> Option<Silence> {
        let of_poses = match &self.source {
            Source::Robotarium { poses } => poses.disconnected_for_s(),
            _ => None,
        };
        let of_poses = of_poses.map(|for_s| Silence {
            peer: "the broker".to_owned(),
            for_s,
        });
        let silence = of_poses.or_else(|| self.commands.silence());
        silence.filter(|silence| silence.for_s.min(listened_s) > lost_after_s)
    }

    /// Whether no pose can come any more.
    pub(super) fn has_ended(&self) -> bool {
        match &self.source {
            Source::Receiver(thread) | Source::Program { poses: thread, .. } => {
                thread.is_finished()
            }
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

type Sink = Box<dyn CommandSink>;

/// None where commands go to the poses' side.
fn sink(spec: &CommandsSpec, ids: &[u32]) -> Result<Option<Sink>, Error> {
    Ok(Some(match spec {
        CommandsSpec::Khepera(spec) => Box::new(Khepera::open(spec)?),
        CommandsSpec::RobotariumUdp(spec) => Box::new(RobotariumUdp::open(spec)?),
        CommandsSpec::JsonUdp(spec) => Box::new(JsonUdpCommands::open(spec.address, ids)?),
        CommandsSpec::None => Box::new(Nowhere),
        CommandsSpec::Robotarium | CommandsSpec::Program => return Ok(None),
    }))
}

/// With a sink on the same connection, unless commands go to others.
fn source(
    spec: &PosesSpec,
    others: bool,
    ids: &[u32],
    scenario: &Scenario,
    inbox: &Inbox,
) -> Result<(Source, Option<Sink>), Error> {
    let inbox = inbox.clone();
    Ok(match spec {
        PosesSpec::Natnet(spec) => (Source::Receiver(natnet::start(spec, inbox)?), None),
        PosesSpec::JsonUdp(spec) => (Source::Receiver(listen(spec, inbox)?), None),
        PosesSpec::Recording(spec) => {
            let recorded = Recorded::open(spec, ids.len())?;
            (Source::Recording(recorded), None)
        }
        PosesSpec::Robotarium(spec) if others => {
            let poses = robotarium::connect(spec, &[], inbox)?;
            (Source::Robotarium { poses }, None)
        }
        PosesSpec::Robotarium(spec) => {
            let broker = robotarium::connect(spec, ids, inbox)?;
            let sink = Box::new(RobotariumCommands::new(broker));
            (Source::Shared, Some(sink))
        }
        PosesSpec::Program(spec) => {
            let started = Program::start(spec, &starts(ids, scenario), inbox)?;
            let (sink, input): (Option<Sink>, _) = if others {
                (None, Some(started.commands))
            } else {
                let writer = JsonWriter::start(started.commands, ids)?;
                (Some(Box::new(writer)), None)
            };
            let source = Source::Program {
                name: spec.name(),
                poses: started.poses,
                _input: input,
                _running: started.child,
            };
            (source, sink)
        }
    })
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
        wheel_base_m: body.wheel_base_m,
        wheel_error: wheel_error(scenario),
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
