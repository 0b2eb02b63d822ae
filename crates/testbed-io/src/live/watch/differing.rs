//! What was found of a robot, as the user is told.

use crate::live::fit::{Differs, Stated};
use crate::live::heading::Room;
use crate::live::note::Differing;

/// How far the point of interest is from where it is taken to be, in m.
pub(super) fn misplaced_m(how: Differing, room: &Room) -> f64 {
    match how {
        Differing::MovedWhileStanding { way_m, .. } => way_m,
        Differing::Course { course_rad, .. } => room.misplaced_m(course_rad),
        Differing::Jump { jump_m, .. } => jump_m.abs(),
        Differing::Displaced {
            off_m: [x_m, y_m], ..
        } => x_m.hypot(y_m),
        Differing::Lag { .. } | Differing::Wheels { .. } => 0.0,
    }
}

impl Differs {
    pub(super) fn beyond(self, stated: &Stated) -> Differing {
        match self {
            Self::Jump(jump_m) => Differing::Jump {
                jump_m,
                noise_m: stated.noise_m,
            },
            Self::Lag(lag_s) => Differing::Lag {
                lag_s,
                most_s: stated.lag_s,
            },
            Self::Course(course_rad) => Differing::Course {
                course_rad,
                most_rad: stated.course_rad,
            },
            Self::Wheels(gains) => Differing::Wheels {
                gains,
                error: stated.wheel_error,
            },
        }
    }
}
