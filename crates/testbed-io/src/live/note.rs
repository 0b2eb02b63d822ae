//! What the user of a session should know, as data; its `Display` puts it into sentences.

use super::counts::Dropped;

/// Something to know while a session is under way. Robots are named by their ids.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// What the side that receives poses says: of versions, connections, clocks and senders
    Receiver(String),
    /// Robots that have not been seen steadily yet
    WaitingForPoses {
        /// Which
        ids: Vec<u32>,
    },
    /// The system gives the loop no priority over other programs
    NoRealTimePriority,
    /// The recording that is played is shorter than the scenario
    RecordingEnds {
        /// In s
        at_s: f64,
        /// Of the scenario, in s
        duration_s: f64,
    },
    /// No pose of a robot can be acted on: it and those behind it stand
    OutOfSight {
        /// Which
        id: u32,
        /// Why its last pose was dropped, if it was
        why: Option<Dropped>,
    },
    /// A robot that was out of sight no longer is
    SeenAgain {
        /// Which
        id: u32,
    },
    /// Poses of a robot have said for long that it is where its commands cannot have led it
    Disbelieved {
        /// Which
        id: u32,
        /// For how long, in s
        lasted_s: f64,
        /// Where they say that it is, in m
        place_m: [f64; 2],
        /// How far that is from where they can have led it, in m and rad, if that is known
        off: Option<[f64; 2]>,
    },
    /// A robot was measured outside its lane and stands for good
    OutsideLane {
        /// Which
        id: u32,
        /// By how much, in m
        by_m: f64,
    },
    /// A robot that did not move as commanded comes near the edge of its lane and stands for good
    NearEdge {
        /// Which
        id: u32,
        /// How far from the path it may be, in m
        most_m: f64,
        /// How far its lane reaches, in m
        half_width_m: f64,
    },
    /// A robot does not move as commanded
    Differs {
        /// Which
        id: u32,
        /// In what
        how: Differing,
        /// What is done about it
        then: Consequence,
    },
    /// A robot that moves beside its heading may be outside its lane and stands for good
    BesideHeading {
        /// Which
        id: u32,
        /// By which angle, in rad
        off_rad: f64,
        /// How far from the path it may be, in m
        outside_m: f64,
    },
    /// A robot follows its commands later than is stated, and not too late to be driven
    Late {
        /// Which
        id: u32,
        /// By how much, in s
        lag_s: f64,
    },
    /// A robot moved before any was commanded to, so that ids are not checked by motion
    MovesAlready {
        /// Which
        id: u32,
    },
    /// Each robot moved when it was commanded to, and no other
    IdsChecked {
        /// But for these, which were not commanded to move
        unchecked: Vec<u32>,
    },
    /// Another robot than the one that was commanded moved; all stand for good
    WrongRobotMoved {
        /// Which was commanded to
        commanded: u32,
        /// Which did
        moved: u32,
    },
    /// A robot was commanded to move and did not; all stand for good
    DidNotMove {
        /// Which
        id: u32,
        /// How far it was commanded to go, in m
        way_m: f64,
    },
}

/// How a robot moves otherwise than commanded, with what was stated.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Differing {
    /// It was to stand and has moved
    MovedWhileStanding {
        /// How far, in m
        way_m: f64,
        /// By which angle, in rad
        turned_rad: f64,
    },
    /// Its poses jump across its heading
    Jump {
        /// By how much to the left in all, in m
        jump_m: f64,
        /// Noise that is stated, in m
        noise_m: f64,
    },
    /// Its poses jumped to where nothing on wheels goes at once
    Displaced {
        /// Ahead and to the left, in all, in m
        off_m: [f64; 2],
        /// To the left, in all, in rad
        turned_rad: f64,
        /// Noise that is stated, in m
        noise_m: f64,
    },
    /// It follows too late
    Lag {
        /// By how much, in s
        lag_s: f64,
        /// What can be driven with, in s
        most_s: f64,
    },
    /// It does not move where it heads
    Course {
        /// By which angle to the left, in rad
        course_rad: f64,
        /// What can be driven with, in rad
        most_rad: f64,
    },
    /// Its wheels do not go as fast as commanded
    Wheels {
        /// Left and right, as shares of what was commanded
        gains: [f64; 2],
        /// Stated, as a share
        error: f64,
    },
}

/// What a session does about a robot that does not move as commanded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Consequence {
    /// It goes on at half its speed
    HalfSpeed,
    /// It stands for good
    Stands,
    /// It stands for good, unless its poses jump back to where they were
    StandsUnlessBack,
}

/// How a link was lost.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Loss {
    /// The tracker's side has ended
    Ended,
    /// No pose of any robot came
    NoPose {
        /// For how long, in s
        for_s: f64,
    },
    /// A robot or a broker answers no more
    Silent {
        /// Which
        peer: String,
        /// For how long, in s
        for_s: f64,
    },
}
