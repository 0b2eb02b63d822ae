//! Who is who: robots start one after another, and the one that is told to move has to be the one that does.

use unicycle_cbf::{Pose, StampedPose};

use super::commanded::Commanded;
use super::gate::distance_m;
use super::note::Note;

/// Beyond this and the noise a robot has moved, in m.
const MOVED_M: f64 = 0.01;
/// Share by which a newer pose counts, so that noise averages out.
const NEWER: f64 = 0.2;
/// What is told takes effect within this time, in s.
const EFFECT_S: f64 = 0.8;
/// A robot that was told less than it takes to see it in this time is not checked, in s.
const PATIENCE_S: f64 = 2.5;
/// How long robots are looked at for whether they stand, in s.
const STANDING_S: f64 = 0.2;

/// Robots from the front, one at a time.
#[derive(Debug)]
pub(super) struct RollCall {
    ids: Vec<u32>,
    moved_m: f64,
    places: Vec<Option<Pose>>,
    stage: Stage,
    unchecked: Vec<u32>,
}

#[derive(Debug, Clone, PartialEq)]
enum Stage {
    /// Nobody moves yet; with the time since which this is looked at
    Standing(Option<f64>, Vec<Option<Pose>>),
    /// This one may move since a time, in s; all were there
    Turn(usize, f64, Vec<Option<Pose>>),
    /// All may move
    Over,
    /// Nobody may move any more
    Failed,
}

impl RollCall {
    pub(super) fn new(ids: &[u32], noise_m: f64, is_told: bool) -> Self {
        let stage = if is_told && ids.len() > 1 {
            Stage::Standing(None, Vec::new())
        } else {
            Stage::Over
        };
        Self {
            ids: ids.to_vec(),
            moved_m: MOVED_M + 2.0 * noise_m,
            places: vec![None; ids.len()],
            stage,
            unchecked: Vec::new(),
        }
    }

    pub(super) fn saw(&mut self, robot: usize, seen: &StampedPose) {
        let new = &seen.pose;
        let place = self.places[robot].get_or_insert(*new);
        place.x_m += NEWER * (new.x_m - place.x_m);
        place.y_m += NEWER * (new.y_m - place.y_m);
    }

    /// Whether a robot has to wait.
    pub(super) fn holds(&self, robot: usize) -> bool {
        match &self.stage {
            Stage::Standing(..) | Stage::Failed => true,
            Stage::Turn(turn, ..) => robot > *turn,
            Stage::Over => false,
        }
    }

    /// Whether another robot moved than was told to, so that nothing is known of any.
    pub(super) fn has_failed(&self) -> bool {
        self.stage == Stage::Failed
    }

    /// Goes on to the next robot where it can; gives what the user should know.
    pub(super) fn look<'a>(
        &mut self,
        time_s: f64,
        told: impl Fn(usize) -> &'a Commanded,
    ) -> Option<Note> {
        match &self.stage {
            Stage::Standing(None, _) => {
                self.stage = Stage::Standing(Some(time_s), self.places.clone());
                None
            }
            Stage::Standing(Some(since_s), from) => {
                if let Some(robot) = (0..self.ids.len()).find(|robot| self.has_moved(*robot, from))
                {
                    self.stage = Stage::Over;
                    let id = self.ids[robot];
                    return Some(Note::MovesAlready { id });
                }
                let all_seen = self.places.iter().all(Option::is_some);
                if all_seen && time_s - since_s >= STANDING_S {
                    self.stage = Stage::Turn(0, time_s, self.places.clone());
                }
                None
            }
            Stage::Turn(turn, since_s, from) => {
                let (turn, since_s) = (*turn, *since_s);
                let others = turn + 1..self.ids.len();
                if let Some(other) = others.clone().find(|other| self.has_moved(*other, from)) {
                    return Some(self.failed(turn, Some(other)));
                }
                if self.has_moved(turn, from) {
                    return self.next(turn, time_s);
                }
                let told_m = told(turn).between(since_s, time_s - EFFECT_S).path_m;
                if told_m > 2.0 * self.moved_m {
                    return Some(self.failed(turn, None));
                }
                if time_s - since_s > PATIENCE_S && told_m < self.moved_m {
                    self.unchecked.push(self.ids[turn]);
                    return self.next(turn, time_s);
                }
                None
            }
            Stage::Over | Stage::Failed => None,
        }
    }

    fn has_moved(&self, robot: usize, from: &[Option<Pose>]) -> bool {
        let from = from.get(robot).copied().flatten();
        let moved = from.zip(self.places[robot]);
        moved.is_some_and(|(from, to)| distance_m(&from, &to) > self.moved_m)
    }

    fn next(&mut self, turn: usize, time_s: f64) -> Option<Note> {
        if turn + 1 < self.ids.len() {
            self.stage = Stage::Turn(turn + 1, time_s, self.places.clone());
            return None;
        }
        self.stage = Stage::Over;
        let unchecked = std::mem::take(&mut self.unchecked);
        Some(Note::IdsChecked { unchecked })
    }

    fn failed(&mut self, turn: usize, other: Option<usize>) -> Note {
        self.stage = Stage::Failed;
        let id = self.ids[turn];
        match other.map(|other| self.ids[other]) {
            Some(moved) => Note::WrongRobotMoved {
                commanded: id,
                moved,
            },
            None => Note::DidNotMove {
                id,
                way_m: 2.0 * self.moved_m,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use unicycle_cbf::Speeds;

    use super::*;

    /// What is said of three robots within 12 s; `moves` says how far one has gone at a time, of the ways that all were told, in m.
    fn said(moves: impl Fn(usize, f64, &[f64; 3]) -> f64, idle: Option<usize>) -> Vec<String> {
        let mut roll_call = RollCall::new(&[4, 5, 6], 3e-3, true);
        let mut told: Vec<Commanded> = (0..3).map(|_| Commanded::new(0.1)).collect();
        let mut notes = Vec::new();
        for step in 0..600_u32 {
            let time_s = 0.02 * f64::from(step);
            let ways_m = [0, 1, 2].map(|robot: usize| told[robot].until(time_s).path_m);
            for (robot, told) in told.iter_mut().enumerate() {
                let pose = Pose {
                    x_m: moves(robot, time_s, &ways_m),
                    y_m: 0.0,
                    heading_rad: 0.0,
                };
                let stamp_s = time_s;
                roll_call.saw(robot, &StampedPose { stamp_s, pose });
                let stands = roll_call.holds(robot) || idle == Some(robot);
                let speed_mps = if stands { 0.0 } else { 0.1 };
                let turn_rate_rad_s = 0.0;
                told.sent(
                    time_s,
                    Speeds {
                        speed_mps,
                        turn_rate_rad_s,
                    },
                );
            }
            let note = roll_call.look(time_s, |robot| &told[robot]);
            notes.extend(note.map(|note| note.to_string()));
        }
        notes
    }

    fn only(notes: &[String], what: &str) {
        assert!(notes.len() == 1 && notes[0].contains(what), "{notes:?}");
    }

    #[test]
    fn robots_that_do_as_told_are_checked_one_after_another() {
        only(
            &said(|robot, _, ways_m| ways_m[robot], None),
            "and no other",
        );
    }

    #[test]
    fn another_robot_that_moves_and_one_that_does_not_stop_all() {
        only(
            &said(|robot, _, ways_m| ways_m[[0, 2, 1][robot]], None),
            "robot 5 was told to move and robot 6 did",
        );
        let deaf = |robot: usize, _, ways_m: &[f64; 3]| [1.0, 0.0, 1.0][robot] * ways_m[robot];
        only(&said(deaf, None), "robot 5 was told to move by");
    }

    #[test]
    fn robots_that_need_not_move_or_move_already_are_not_checked_and_that_is_said() {
        only(
            &said(|robot, _, ways_m| ways_m[robot], Some(1)),
            "not told to move: 5",
        );
        only(
            &said(|_, time_s, _| 0.2 * time_s, None),
            "robot 4 moves already",
        );
    }
}
