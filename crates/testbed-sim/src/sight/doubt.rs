//! Why it is not known whether robots were safe.

/// Why it is not known whether a session was safe, with robots by their indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Doubt {
    /// No pose of it came
    NeverSeen(usize),
    /// It can have left its lane unseen
    Lane(usize),
    /// They can have touched while one of them was not seen
    Touch([usize; 2]),
    /// The same as [`Doubt::Lane`] of one that nobody knows to do as it is told
    LaneAtWill(usize),
    /// The same as [`Doubt::Touch`] where one of them is such a robot
    TouchAtWill([usize; 2]),
    /// It can have left its lane unseen if it heard no command either and went on
    LaneUnheard(usize),
    /// They can have touched while one of them was not seen and heard no command
    TouchUnheard([usize; 2]),
    /// Its poses stayed the same to the last bit while it was told to move
    Held(usize),
    /// It goes on after the command to stand
    GoesOn(usize),
    /// Its poses said for long that it is where it cannot be
    Disbelieved(usize),
    /// It was found to be off where it is taken to be by more than there was to the edge of its lane
    Misplaced(usize),
    /// The same by more than there was to another robot
    MisplacedNear(usize),
    /// It left a lane that was laid around its poses
    LaidLane(usize),
    /// It moves across its headings, or they are none in rad
    Headings(usize),
    /// Poses of one time are far from each other
    TwoPlaces(usize),
}

impl Doubt {
    /// For people, who know robots by their ids or names.
    #[must_use]
    pub fn text(self, ids: &[impl ToString]) -> String {
        let id = |robot: usize| {
            ids.get(robot)
                .map_or_else(|| "?".to_owned(), ToString::to_string)
        };
        match self {
            Self::NeverSeen(robot) => format!("robot {} was never seen", id(robot)),
            Self::Lane(robot) => format!(
                "robot {} was unseen for longer than its commands needed to the edge of its lane",
                id(robot)
            ),
            Self::Touch([a, b]) => format!(
                "robots {} and {} were unseen for longer than their commands needed to each other",
                id(a),
                id(b)
            ),
            Self::LaneAtWill(robot) => format!(
                "robot {} was seen too seldom to know that it does as it is told, and was unseen for longer than its wheels need to the edge of its lane",
                id(robot)
            ),
            Self::TouchAtWill([a, b]) => format!(
                "robots {} and {} were seen too seldom to know that they do as they are told, and were unseen for longer than their wheels need to each other",
                id(a),
                id(b)
            ),
            Self::LaneUnheard(robot) => format!(
                "robot {} was not seen any more: if it heard no command either, it can have gone on and left its lane",
                id(robot)
            ),
            Self::TouchUnheard([a, b]) => format!(
                "one of robots {} and {} was not seen any more: if it heard no command either, it can have gone on and touched the other",
                id(a),
                id(b)
            ),
            Self::Held(robot) => format!(
                "poses of robot {} stayed the same to the last bit while it was told to move: it did not, or the tracker held the last one",
                id(robot)
            ),
            Self::GoesOn(robot) => format!(
                "robot {} was seen to go on after the command to stand: STOP IT BY HAND",
                id(robot)
            ),
            Self::Misplaced(robot) => format!(
                "robot {} was measured beside where it was by more than there was to the edge of its lane",
                id(robot)
            ),
            Self::MisplacedNear(robot) => format!(
                "robot {} was measured beside where it was by more than there was to another robot",
                id(robot)
            ),
            Self::LaidLane(robot) => format!(
                "no lane was given, and robot {} left the circular one that was laid around the poses: a scenario file gives the lane that it had (`--scenario`)",
                id(robot)
            ),
            Self::Headings(robot) => format!(
                "headings of robot {} are not the direction in which it moves, or beyond a full turn: if they are in degrees or of another frame, convert them",
                id(robot)
            ),
            Self::TwoPlaces(robot) => format!(
                "poses of robot {} of the same time are at different places",
                id(robot)
            ),
            Self::Disbelieved(robot) => format!(
                "poses of robot {} said that it is where its commands cannot have led it",
                id(robot)
            ),
        }
    }
}
