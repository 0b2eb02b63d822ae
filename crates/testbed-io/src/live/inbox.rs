//! From the threads that receive to the loop: the newest pose of each robot, and counts of everything else.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use unicycle_cbf::{Pose, StampedPose};

use super::clock::Clock;
use super::counts::{Counts, Dropped};
use super::gate::{Bounds, Gate};
use super::stamps::{StampMap, Stamping};

/// A pose as a source gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// How the tracker calls the robot
    pub id: u32,
    /// Where
    pub pose: Pose,
    /// When, on the tracker's own clock in s, if it says so
    pub stamp_s: Option<f64>,
    /// How old the pose was when the stamp was made or, without a stamp, when it was sent, in s, as far as is known
    pub age_s: f64,
}

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
    stamps: StampMap,
    gate: Gate,
    newest: Vec<Option<StampedPose>>,
    counts: Counts,
    notes: Vec<String>,
}

impl Inbox {
    /// Of robots by their ids, from the front.
    #[must_use]
    pub fn new(clock: Clock, ids: &[u32], bounds: Bounds) -> Self {
        let state = State {
            ids: ids.to_vec(),
            stamps: StampMap::default(),
            gate: Gate::new(bounds, ids.len()),
            newest: vec![None; ids.len()],
            counts: Counts::default(),
            notes: Vec::new(),
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

    /// Something that the user should know, once: "the server speaks NatNet 3.1".
    pub fn note(&self, text: String) {
        self.lock().notes.push(text);
    }

    /// A pose that arrived at `arrival_s`; what cannot be true is counted and dropped.
    pub fn pose(&self, arrival_s: f64, seen: Seen) {
        let mut state = self.lock();
        if let Err(reason) = state.take(arrival_s, seen) {
            state.counts.add(reason);
        }
    }

    /// The newest pose of each robot that arrived since the last call.
    #[must_use]
    pub fn newest(&self) -> Vec<Option<StampedPose>> {
        self.lock().newest.iter_mut().map(Option::take).collect()
    }

    /// Ids of robots whose last `needed` poses do not agree, or that were not seen as often.
    pub(super) fn unsteady(&self, needed: u32) -> Vec<u32> {
        let state = self.lock();
        let robots = state.ids.iter().enumerate();
        let unsteady = robots.filter(|(robot, _)| state.gate.agreeing(*robot) < needed);
        unsteady.map(|(_, id)| *id).collect()
    }

    /// From now on a robot is where its last pose said.
    pub(super) fn start(&self) {
        self.lock().gate.start();
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
    fn take(&mut self, arrival_s: f64, seen: Seen) -> Result<(), Dropped> {
        let known = self.ids.iter().position(|id| *id == seen.id);
        let robot = known.ok_or(Dropped::OtherRobot)?;
        let stamped = seen.stamp_s.is_none_or(f64::is_finite) && seen.age_s.is_finite();
        if !(seen.pose.is_finite() && stamped) {
            return Err(Dropped::NotFinite);
        }
        let stamp_s = match self.stamps.at(arrival_s, seen.stamp_s) {
            Stamping::At(stamp_s) => stamp_s,
            Stamping::Jumped(stamp_s) => {
                self.counts.clock_jumps += 1;
                self.notes.push("the tracker's clock jumped".to_owned());
                stamp_s
            }
            Stamping::Contradicts => return Err(Dropped::Stamp),
        } - seen.age_s.max(0.0);
        let pose = seen.pose;
        let accepted = StampedPose { stamp_s, pose };
        self.gate.pass(robot, accepted)?;
        self.newest[robot] = Some(accepted);
        self.counts.poses += 1;
        Ok(())
    }
}
