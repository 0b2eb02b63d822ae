//! What a look at a robot found, in words, and what that makes of its place.

use super::fit::{Differs, Stated};
use super::heading::Room;

/// What a look at a robot found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Found {
    /// It was told to stand and moved by this, in m and rad
    Untold {
        way_m: f64,
        turned_rad: f64,
    },
    Differs(Differs),
}

impl Found {
    /// How far the point of interest is from where it is taken to be, in m.
    pub(super) fn misplaced_m(&self, room: &Room) -> f64 {
        match self {
            Self::Untold { way_m, .. } => *way_m,
            Self::Differs(Differs::Course(off_rad)) => room.misplaced_m(*off_rad),
            Self::Differs(Differs::Jump(jump_m)) => jump_m.abs(),
            Self::Differs(Differs::Lag(_) | Differs::Wheels(_)) => 0.0,
        }
    }

    pub(super) fn text(&self, stated: &Stated) -> String {
        match self {
            Self::Untold { way_m, turned_rad } => format!(
                "was told to stand and has moved by {:.0} mm and {:.0}°",
                1e3 * way_m,
                turned_rad.to_degrees()
            ),
            Self::Differs(differs) => differs.text(stated),
        }
    }
}

impl Differs {
    fn text(self, stated: &Stated) -> String {
        let error = 100.0 * stated.wheel_error;
        match self {
            Self::Jump(jump_m) => format!(
                "jumps by {:.0} mm in all to the {} of its heading, where its commands cannot have led it; {:.0} mm of noise are stated",
                1e3 * jump_m.abs(),
                if jump_m > 0.0 { "left" } else { "right" },
                1e3 * stated.noise_m
            ),
            Self::Lag(lag_s) => format!(
                "follows its commands {lag_s:.2} s later than is stated, at most {:.2} s can be driven with: state `latency_s` under [poses]",
                stated.lag_s
            ),
            Self::Course(course_rad) => format!(
                "does not move where it heads but {:.0}° to the {}: is the body turned on the tracker? up to {:.0}° can be driven with",
                course_rad.abs().to_degrees(),
                if course_rad > 0.0 { "left" } else { "right" },
                stated.course_rad.to_degrees()
            ),
            Self::Wheels(gains) => {
                let [left, right] = gains.map(|gain| 100.0 * gain);
                format!(
                    "does not do what it is told: its left wheel does {left:.0} %, its right one {right:.0} %, and {error:.0} % of error are stated"
                )
            }
        }
    }
}
