//! Which robots are out of sight, and why.

use super::counts::Dropped;
use super::note::Note;

/// The user is told of a robot without a pose for this long, in s.
const UNSEEN_S: f64 = 1.0;
/// A robot is seen again when its poses are not older than this share of what it is driven on.
const SEEN_AGAIN: f64 = 0.7;
/// Poses that came within this share of it were too old when they came, and have not failed to come.
const HEARD: f64 = 0.5;

/// Looks out for all robots.
#[derive(Debug)]
pub(super) struct Lookout {
    ids: Vec<u32>,
    /// Robots are not driven on older poses, in s
    most_age_s: f64,
    /// When a pose came last, however old, in s
    heard_s: Vec<f64>,
    /// Of which the user was told that they are out of sight
    unseen: Vec<bool>,
}

impl Lookout {
    pub(super) fn new(ids: &[u32], most_age_s: f64) -> Self {
        Self {
            ids: ids.to_vec(),
            most_age_s,
            heard_s: vec![f64::NEG_INFINITY; ids.len()],
            unseen: vec![false; ids.len()],
        }
    }

    /// A pose of a robot came, however old.
    pub(super) fn hears(&mut self, robot: usize, now_s: f64) {
        self.heard_s[robot] = now_s;
    }

    /// A robot whose poses are not believed or come too late is named as soon as it stands for that.
    pub(super) fn notes(
        &mut self,
        now_s: f64,
        ages_s: &[f64],
        why_dropped: impl Fn(usize) -> Option<Dropped>,
    ) -> Vec<Note> {
        let robots = ages_s.iter().enumerate();
        let notes = robots.filter_map(|(robot, age_s)| {
            let id = self.ids[robot];
            let is_heard = now_s - self.heard_s[robot] <= HEARD * self.most_age_s;
            let why = why_dropped(robot).or(is_heard.then_some(Dropped::Stamp));
            let after_s = why.map_or(UNSEEN_S, |_| self.most_age_s);
            let unseen = &mut self.unseen[robot];
            if *age_s > after_s && !*unseen {
                *unseen = true;
                return Some(Note::OutOfSight { id, why });
            }
            let again = *unseen && *age_s < SEEN_AGAIN * self.most_age_s;
            *unseen &= !again;
            again.then_some(Note::SeenAgain { id })
        });
        notes.collect()
    }
}
