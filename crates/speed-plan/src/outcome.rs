use std::fmt;

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

impl fmt::Display for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::TooLate { earliest_arrival_s } => write!(
                f,
                "the earliest arrival is after {earliest_arrival_s:.3} s; allow as much"
            ),
            Self::LeaderBlocks { earliest_arrival_s } => write!(
                f,
                "behind the leader the earliest arrival is after {earliest_arrival_s:.3} s; allow as much"
            ),
            Self::SignalsUnreachable {
                node,
                earliest_s,
                latest_s,
            } => write!(
                f,
                "the signal at node {node} can be passed from {earliest_s:.1} s on and has to be by {latest_s:.1} s, when it is red; allow a later arrival"
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
                "at {position_m:.1} m the road climbs by {:.1} %, which motor or battery cannot hold at the slowest speed",
                100.0 * slope_rad.tan()
            ),
        }
    }
}
