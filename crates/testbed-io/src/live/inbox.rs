//! From the threads that receive to the loop: the newest pose of each robot, and counts of everything else.

use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use unicycle_cbf::{Speeds, StampedPose};

use super::clock::Clock;
use super::clock_rate::ClockRate;
use super::counts::{Counts, Dropped};
use super::disbelieved::Disbelieved;
use super::gate::{Bounds, Gate};
use super::seen::Seen;
use super::senders::Senders;
use super::stamps::{StampMap, Stamping};

/// Beyond this an angle is not precise enough to be one.
const LARGEST_HEADING_RAD: f64 = 1e4;
/// Notes that wait to be read, and the time between two of a clock that jumps, in s.
const MOST_NOTES: usize = 32;
const JUMPS_APART_S: f64 = 5.0;
/// Of what somebody else says, in a note.
const MOST_CHARACTERS: usize = 200;
/// Poses that wait for the loop: of twenty robots at 100 Hz those of half a minute. A loop that hangs for longer has not watched.
const MOST_ARRIVED: usize = 1 << 16;

/// Shared by the receiving threads and the loop.
#[derive(Debug, Clone)]
pub struct Inbox {
    clock: Clock,
    ended: Arc<AtomicBool>,
    state: Arc<Mutex<State>>,
}

#[derive(Debug)]
struct State {
    ids: Vec<u32>,
    /// One for each robot: each may have a clock of its own
    stamps: Vec<StampMap>,
    gate: Gate,
    /// How fast these clocks run
    rates: Vec<ClockRate>,
    newest: Vec<Option<StampedPose>>,
    /// All that are believed, also those that came too late to act on
    arrived: Vec<(usize, StampedPose)>,
    /// Why the last pose of each was dropped, if it was
    dropped: Vec<Option<Dropped>>,
    /// Those that were not believed since the last that was
    disbelieved: Vec<Option<Disbelieved>>,
    counts: Counts,
    notes: Vec<String>,
    jump_told_s: f64,
    /// When somebody said last that robots are getting ready, and how
    getting_ready: Option<(f64, String)>,
    senders: Vec<Senders>,
}

impl Inbox {
    /// Of robots by their ids, from the front.
    #[must_use]
    pub fn new(clock: Clock, ids: &[u32], bounds: Bounds) -> Self {
        let state = State {
            ids: ids.to_vec(),
            stamps: vec![StampMap::default(); ids.len()],
            gate: Gate::new(bounds, ids.len()),
            senders: vec![Senders::new(bounds); ids.len()],
            getting_ready: None,
            rates: vec![ClockRate::default(); ids.len()],
            newest: vec![None; ids.len()],
            arrived: Vec::new(),
            dropped: vec![None; ids.len()],
            disbelieved: vec![None; ids.len()],
            counts: Counts::default(),
            notes: Vec::new(),
            jump_told_s: f64::NEG_INFINITY,
        };
        Self {
            clock,
            ended: Arc::default(),
            state: Arc::new(Mutex::new(state)),
        }
    }

    /// The clock of arrivals.
    #[must_use]
    pub fn clock(&self) -> Clock {
        self.clock
    }

    /// Whether receiving threads shall end.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        self.ended.load(Ordering::Relaxed)
    }

    /// Asks receiving threads to end.
    pub fn end(&self) {
        self.ended.store(true, Ordering::Relaxed);
    }

    /// Counts a packet, whatever is in it.
    pub fn packet(&self) {
        self.lock().counts.packets += 1;
    }

    /// Counts what is not used.
    pub fn dropped(&self, reason: Dropped) {
        self.lock().counts.add(reason);
    }

    /// Something that the user should know: "the server speaks NatNet 3.1". Of many at once the first are kept.
    pub fn note(&self, text: String) {
        self.lock().note(text);
    }

    /// Robots are not yet where they can start; the user is told why, once.
    pub(super) fn getting_ready(&self, arrival_s: f64, mut how: String) {
        let mut state = self.lock();
        how = how.chars().take(MOST_CHARACTERS).collect();
        let known = state.getting_ready.replace((arrival_s, how.clone()));
        if known.is_none_or(|(_, known)| known != how) {
            state.note(how);
        }
    }

    /// How long ago somebody said last that robots are getting ready.
    pub(super) fn getting_ready_told(&self) -> Option<Duration> {
        let told_s = self.lock().getting_ready.as_ref()?.0;
        Duration::try_from_secs_f64(self.clock.now_s() - told_s).ok()
    }

    /// A pose that arrived at `arrival_s`; what cannot be true is counted and dropped.
    pub fn pose(&self, arrival_s: f64, seen: Seen) {
        self.pose_from(arrival_s, seen, None);
    }

    /// The same from an address; of poses of one robot that come from two senders there is a note.
    pub(super) fn pose_from(&self, arrival_s: f64, seen: Seen, from: Option<SocketAddr>) {
        let mut state = self.lock();
        state.compare_senders(arrival_s, &seen, from);
        if let Err(reason) = state.take(arrival_s, seen) {
            state.counts.add(reason);
        }
    }

    /// The newest pose of each robot that arrived since the last call.
    #[must_use]
    pub fn newest(&self) -> Vec<Option<StampedPose>> {
        self.lock().newest.iter_mut().map(Option::take).collect()
    }

    /// Gives all poses that are believed and arrived since the last call, by the time at which they were true: more than
    /// [`Inbox::newest`] gives, and also those that came too late to act on.
    pub(super) fn arrived(&self, into: &mut Vec<(usize, StampedPose)>) {
        into.clear();
        std::mem::swap(into, &mut self.lock().arrived);
        into.sort_by(|(_, a), (_, b)| a.stamp_s.total_cmp(&b.stamp_s));
    }

    /// Why the last pose of a robot was dropped, if it was.
    pub(super) fn why_dropped(&self, robot: usize) -> Option<Dropped> {
        self.lock().dropped[robot]
    }

    /// The poses of each robot that were not believed since the last that was.
    pub(super) fn disbelieved(&self, into: &mut Vec<Option<Disbelieved>>) {
        into.clone_from(&self.lock().disbelieved);
    }

    /// What a robot does from `time_s` on, if the commands go to it.
    pub(super) fn told(&self, robot: usize, time_s: f64, speeds: Speeds) {
        self.lock().gate.told(robot, time_s, speeds);
    }

    /// From now on every robot is where its last pose said, if the last `needed` poses of each agree. Gives the ids of those of which
    /// they do not, or that were not seen as often.
    pub(super) fn start_if_steady(&self, needed: u32) -> Vec<u32> {
        let mut state = self.lock();
        let robots = state.ids.iter().enumerate();
        let unsteady = robots.filter(|(robot, _)| state.gate.agreeing(*robot) < needed);
        let unsteady: Vec<u32> = unsteady.map(|(_, id)| *id).collect();
        if unsteady.is_empty() {
            state.gate.start();
        }
        unsteady
    }

    /// Counts so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.lock().counts
    }

    /// Notes since the last call.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        std::mem::take(&mut self.lock().notes)
    }

    /// A receiving thread that panicked leaves a state that is whole: it is changed in single assignments.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn note(&mut self, text: String) {
        if self.notes.len() < MOST_NOTES {
            self.notes.push(text);
        }
    }

    fn compare_senders(&mut self, arrival_s: f64, seen: &Seen, from: Option<SocketAddr>) {
        let Some(robot) = self.ids.iter().position(|id| *id == seen.id) else {
            return;
        };
        if let Some(two) = self.senders[robot].add(arrival_s, seen, from) {
            self.note(format!(
                "poses of robot {} {two}; do two programs send them? end one of them",
                seen.id
            ));
        }
    }

    fn take(&mut self, arrival_s: f64, seen: Seen) -> Result<(), Dropped> {
        let known = self.ids.iter().position(|id| *id == seen.id);
        let robot = known.ok_or(Dropped::OtherRobot)?;
        let stamped = seen.stamp_s.is_none_or(f64::is_finite) && seen.age_s.is_finite();
        if !(seen.pose.is_finite() && stamped) {
            return Err(Dropped::NotFinite);
        }
        if seen.pose.heading_rad.abs() > LARGEST_HEADING_RAD {
            return Err(Dropped::Malformed);
        }
        let taken = self.take_from(robot, arrival_s, seen);
        self.dropped[robot] = taken.err();
        taken
    }

    fn take_from(&mut self, robot: usize, arrival_s: f64, seen: Seen) -> Result<(), Dropped> {
        let (stamp_s, late) = match self.stamps[robot].at(arrival_s, seen.stamp_s) {
            Stamping::At(stamp_s) => (stamp_s, false),
            Stamping::Late(stamp_s) => (stamp_s, true),
            Stamping::Jumped(stamp_s) => {
                self.jumped(robot, arrival_s);
                (stamp_s, false)
            }
            Stamping::Contradicts => return Err(Dropped::Stamp),
        };
        if let Some(own_s) = seen.stamp_s {
            let said = self.rates[robot].saw(arrival_s, own_s);
            said.into_iter().for_each(|text| {
                let id = self.ids[robot];
                self.note(format!("robot {id}: {text}"));
            });
        }
        let accepted = StampedPose {
            stamp_s: stamp_s - seen.age_s.max(0.0),
            pose: seen.pose,
        };
        let passed = self.gate.pass(robot, accepted);
        let off = self.gate.off(robot, &accepted);
        let disbelieved = &mut self.disbelieved[robot];
        match passed {
            Ok(()) => *disbelieved = None,
            Err(Dropped::Jump | Dropped::Overlapping | Dropped::Outside) => {
                *disbelieved = Some(Disbelieved::after(*disbelieved, accepted, off));
            }
            Err(_) => {}
        }
        passed?;
        if self.arrived.len() < MOST_ARRIVED {
            self.arrived.push((robot, accepted));
        }
        if late {
            return Err(Dropped::Stamp);
        }
        self.newest[robot] = Some(accepted);
        self.counts.poses += 1;
        Ok(())
    }

    fn jumped(&mut self, robot: usize, arrival_s: f64) {
        self.counts.clock_jumps += 1;
        self.rates[robot] = ClockRate::default();
        if arrival_s >= self.jump_told_s + JUMPS_APART_S {
            self.jump_told_s = arrival_s;
            self.note("the tracker's clock jumped".to_owned());
        }
    }
}
