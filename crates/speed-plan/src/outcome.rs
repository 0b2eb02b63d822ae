use std::fmt;

use crate::problem::Problem;

/// What came of a problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Obstacle {
    /// Even the fastest plan arrives later.
    TooLate {
        /// When the fastest plan arrives, s.
        earliest_arrival_s: f64,
    },
    /// A signal is red whenever it can be reached.
    SignalsUnreachable {
        /// Node of the signal.
        node: usize,
        /// Earliest passage, s.
        earliest_s: f64,
        /// Latest passage, s; infinite where the car could wait for ever.
        latest_s: f64,
    },
    /// The leader holds the car up for too long.
    LeaderBlocks {
        /// Earliest arrival behind the leader, s.
        earliest_arrival_s: f64,
    },
    /// The road ahead ends or slows down before the allowed deceleration does its work.
    CannotStop {
        /// Where the speed has to be lower, m.
        position_m: f64,
        /// Deceleration that it would take in the last step, m/s², below 0.
        needed_mps2: f64,
        /// Deceleration that is allowed, m/s², below 0.
        allowed_mps2: f64,
    },
    /// The lowest speed is out of reach of the allowed acceleration.
    CannotAccelerate {
        /// From where, m.
        position_m: f64,
        /// Acceleration that it would take, m/s².
        needed_mps2: f64,
        /// Acceleration that is allowed, m/s².
        allowed_mps2: f64,
    },
    /// Motor or battery cannot hold the lowest speed.
    TooSteep {
        /// Where, m.
        position_m: f64,
        /// Slope angle there, rad.
        slope_rad: f64,
    },
}

impl Obstacle {
    /// In words, with places and windows of the problem.
    #[must_use]
    pub fn words(&self, problem: &Problem) -> String {
        let columns = problem.columns();
        let (node, earliest_s, latest_s) = match *self {
            Self::SignalsUnreachable {
                node,
                earliest_s,
                latest_s,
            } => (node, earliest_s, latest_s),
            Self::TooLate { earliest_arrival_s } if !columns.signals.is_empty() => {
                return format!(
                    "the earliest arrival that was found is after {earliest_arrival_s:.3} s; allow as much"
                );
            }
            _ => return self.to_string(),
        };
        let at_m = columns.position_m[node];
        let of_node = columns.signals.iter().find(|signal| signal.node == node);
        let windows = of_node.map_or(&[][..], |signal| &signal.green_s);
        let reached =
            format!("the signal at {at_m:.1} m is reached after {earliest_s:.1} s at the earliest");
        match windows.iter().find(|window| window[1] >= earliest_s) {
            Some([from_s, _]) if *from_s > latest_s => format!(
                "{reached}, has to be passed by {latest_s:.1} s, and turns green after {from_s:.1} s; allow to arrive {:.1} s later",
                from_s - latest_s
            ),
            Some([from_s, to_s]) => format!(
                "{reached} and no way was found to pass it from {from_s:.1} to {to_s:.1} s; allow a later arrival or give other windows"
            ),
            None => match windows.last() {
                Some([_, to_s]) => format!(
                    "{reached} and is red for good after {to_s:.1} s; give later green windows"
                ),
                None => format!("{reached} and is never green; give green windows"),
            },
        }
    }
}

impl fmt::Display for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::TooLate { earliest_arrival_s } => write!(
                f,
                "the earliest arrival is after {earliest_arrival_s:.3} s; allow as much"
            ),
            Self::LeaderBlocks { earliest_arrival_s } => write!(
                f,
                "no way was found behind the leader, who allows no arrival before {earliest_arrival_s:.3} s; allow a later one, or a leader who is farther ahead"
            ),
            Self::SignalsUnreachable {
                node,
                earliest_s,
                latest_s,
            } => write!(
                f,
                "the signal at node {node} is reached after {earliest_s:.1} s at the earliest and red from then on for as long as it may be passed ({latest_s:.1} s)"
            ),
            Self::CannotStop {
                position_m,
                needed_mps2,
                allowed_mps2,
            } => write!(
                f,
                "slowing down for {position_m:.1} m takes {needed_mps2:.2} m/s² in the last step, allowed is {allowed_mps2:.2} m/s²; start slower or allow more"
            ),
            Self::CannotAccelerate {
                position_m,
                needed_mps2,
                allowed_mps2,
            } => write!(
                f,
                "the speed beyond {position_m:.1} m takes {needed_mps2:.2} m/s², possible is {allowed_mps2:.2} m/s²; ask for less"
            ),
            Self::TooSteep {
                position_m,
                slope_rad,
            } => write!(
                f,
                "from {position_m:.1} m on, at a slope of {:.1} %, motor or battery cannot reach or hold the slowest speed; take a stronger car, or check slope and vehicle",
                // Without a sign where it is level.
                100.0 * slope_rad.tan() + 0.0
            ),
        }
    }
}
