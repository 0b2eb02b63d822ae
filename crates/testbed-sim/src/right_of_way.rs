//! Who goes first where branches of the path meet: robots are let through in the order in which they came.
//!
//! A robot that comes near to a crossing takes a number; of robots that came at the same time the one nearer to the front is first. It
//! is let in when nobody is within or let in on the other branch, nobody with room beyond the crossing came there earlier, and
//! it has room beyond itself. Until then it waits at the line where the crossing begins.

use unicycle_cbf::{Controller, Crossing};

/// One robot at one branch of a crossing.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ticket {
    came_s: f64,
    is_let_in: bool,
}

/// Where a robot waits, and for whom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wait {
    pub(crate) line_m: f64,
    pub(crate) robot: usize,
}

/// The numbers of all robots at all crossings.
#[derive(Debug, Clone)]
pub(crate) struct RightOfWay {
    robots: usize,
    /// By crossing, branch and robot
    tickets: Vec<Option<Ticket>>,
    is_new: bool,
}

/// Along the path, in m; NaN of robots that were not seen.
pub(crate) struct Places<'a> {
    pub(crate) controller: &'a Controller,
    pub(crate) along_m: &'a [f64],
    /// From each robot to the next ahead
    pub(crate) room_m: &'a [f64],
}

impl Places<'_> {
    /// How far a robot is past the line of a branch, in m.
    fn past_m(&self, crossing: &Crossing, branch: usize, robot: usize) -> f64 {
        let span = &crossing.branches[branch];
        span.past_m(self.controller.path(), self.along_m[robot])
    }

    /// From a line to where a robot has left the crossing behind it, in m.
    fn through_m(&self, crossing: &Crossing, branch: usize) -> f64 {
        crossing.branches[branch].length_m + self.controller.body().offset_m
    }

    fn has_room(&self, crossing: &Crossing, branch: usize, robot: usize) -> bool {
        let to_exit_m = self.through_m(crossing, branch) - self.past_m(crossing, branch, robot);
        let room_m = self.room_m[robot];
        // Of a robot that was not seen nothing says that it lacks room.
        let lacks_room = room_m < to_exit_m + self.controller.room_m();
        !lacks_room
    }
}

impl RightOfWay {
    pub(crate) fn new(controller: &Controller, robots: usize) -> Self {
        Self {
            robots,
            tickets: vec![None; 2 * robots * controller.crossings().len()],
            is_new: true,
        }
    }

    /// Takes and gives back numbers, and lets in who may go.
    pub(crate) fn update(&mut self, now_s: f64, places: &Places) {
        for (index, crossing) in places.controller.crossings().iter().enumerate() {
            for branch in 0..2 {
                for robot in 0..self.robots {
                    self.come_and_go(now_s, places, crossing, [index, branch, robot]);
                }
            }
            self.let_in(places, crossing, index);
        }
        self.is_new = false;
    }

    fn come_and_go(&mut self, now_s: f64, places: &Places, crossing: &Crossing, at: [usize; 3]) {
        let [_, branch, robot] = at;
        let past_m = places.past_m(crossing, branch, robot);
        if past_m.is_nan() {
            return;
        }
        let is_near = past_m >= -places.controller.approach_m();
        let is_near = is_near && past_m <= places.through_m(crossing, branch);
        let is_within = past_m >= 0.0;
        let is_let_in = is_within && self.is_new;
        let place = self.place(at);
        let ticket = &mut self.tickets[place];
        if !is_near {
            *ticket = None;
        } else if ticket.is_none() {
            *ticket = Some(Ticket {
                came_s: now_s,
                is_let_in,
            });
        }
    }

    fn let_in(&mut self, places: &Places, crossing: &Crossing, index: usize) {
        for robot in 0..self.robots {
            for branch in 0..2 {
                let place = self.place([index, branch, robot]);
                let Some(ticket) = self.tickets[place] else {
                    continue;
                };
                let may = ticket.is_let_in
                    || places.has_room(crossing, branch, robot)
                        && self
                            .before(places, crossing, [index, branch, robot], ticket)
                            .is_none();
                self.tickets[place] = Some(Ticket {
                    is_let_in: may,
                    ..ticket
                });
            }
        }
    }

    /// Somebody on the other branch who goes first.
    fn before(
        &self,
        places: &Places,
        crossing: &Crossing,
        [index, branch, robot]: [usize; 3],
        own: Ticket,
    ) -> Option<usize> {
        let other_branch = 1 - branch;
        (0..self.robots)
            .filter(|other| *other != robot)
            .find(|other| {
                let ticket = self.tickets[self.place([index, other_branch, *other])];
                ticket.is_some_and(|ticket| {
                    let came_first = (ticket.came_s, *other) < (own.came_s, robot);
                    ticket.is_let_in
                        || came_first && places.has_room(crossing, other_branch, *other)
                })
            })
    }

    /// Where a robot waits: at the nearest line beyond which it was not let in.
    pub(crate) fn wait(&self, places: &Places, robot: usize) -> Option<Wait> {
        let mut nearest: Option<Wait> = None;
        for (index, crossing) in places.controller.crossings().iter().enumerate() {
            for branch in 0..2 {
                let at = [index, branch, robot];
                let Some(ticket) = self.tickets[self.place(at)].filter(|own| !own.is_let_in) else {
                    continue;
                };
                let line_m = -places.past_m(crossing, branch, robot);
                if nearest.is_none_or(|wait| line_m < wait.line_m) {
                    let first = self.before(places, crossing, at, ticket);
                    nearest = Some(Wait {
                        line_m,
                        robot: first.unwrap_or(robot),
                    });
                }
            }
        }
        nearest
    }

    fn place(&self, [crossing, branch, robot]: [usize; 3]) -> usize {
        (2 * crossing + branch) * self.robots + robot
    }
}
