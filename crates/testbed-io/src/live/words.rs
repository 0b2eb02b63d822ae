//! The sentences of a session.

use std::fmt::{Display, Formatter, Result};

use super::counts::Dropped;
use super::note::{Consequence, Differing, Loss, Note};

impl Display for Note {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        match self {
            Self::Receiver(text) => out.write_str(text),
            Self::WaitingForPoses { ids } => write!(out, "waiting for poses of {}", names(ids)),
            Self::RecordingEnds { at_s, duration_s } => write!(
                out,
                "the recording ends at {at_s:.1} of {duration_s:.1} s: nothing is known of the rest"
            ),
            Self::NoRealTimePriority => out.write_str(
                "no permission for real-time priority: on a busy computer steps may be late; see the page on testbeds",
            ),
            Self::OutOfSight { id, why } => {
                let help = help(*why);
                write!(out, "robot {id} is out of sight: it and those behind it stand; {help}")
            }
            Self::SeenAgain { id } => write!(out, "robot {id} is seen again"),
            Self::Disbelieved {
                id,
                lasted_s,
                place_m: [x_m, y_m],
                off,
            } => {
                let by = off.map_or(String::new(), |[off_m, off_rad]| {
                    let (mm, degrees) = (1e3 * off_m, off_rad.abs().to_degrees());
                    format!(", {mm:.0} mm and {degrees:.0}° off")
                });
                write!(
                    out,
                    "robot {id}: for {lasted_s:.1} s its poses have said that it is at ({x_m:.2}, {y_m:.2}) m, where its commands cannot have led it{by}: \
                     whether robots touch is not known, and robots near that place stand"
                )
            }
            Self::OutsideLane { id, by_m } => write!(
                out,
                "robot {id} is measured {:.0} mm outside its lane: it stands for good; put it back and start anew",
                1e3 * by_m
            ),
            Self::NearEdge {
                id,
                most_m,
                half_width_m,
            } => write!(
                out,
                "robot {id}, which did not move as told, may be {:.0} mm from the path, and its lane reaches {:.0} mm; it stands for good",
                1e3 * most_m,
                1e3 * half_width_m
            ),
            Self::Differs { id, how, then } => write!(out, "robot {id} {how}; {then}"),
            Self::BesideHeading {
                id,
                off_rad,
                outside_m,
            } => write!(
                out,
                "robot {id} moves {:.0}° beside its heading: it may be {:.0} mm from the path, beyond the edge of its lane; it stands for good",
                off_rad.to_degrees(),
                1e3 * outside_m
            ),
            Self::Late { id, lag_s } => write!(
                out,
                "robot {id} follows its commands {lag_s:.2} s later than is stated: if poses are this late, add it to `latency_s` under [poses]"
            ),
            Self::MovesAlready { id } => {
                write!(out, "robot {id} moves already: ids are not checked by motion")
            }
            Self::IdsChecked { unchecked } => ids_checked(out, unchecked),
            Self::WrongRobotMoved { commanded, moved } => write!(
                out,
                "robot {commanded} was told to move and robot {moved} did: do `robots` and the addresses name them in the same order? \
                 All robots stand for good; start anew"
            ),
            Self::DidNotMove { id, way_m } => write!(
                out,
                "robot {id} was told to move by {:.0} mm and did not: does it hear its commands, and is it the one that the tracker calls {id}? \
                 All robots stand for good; start anew",
                1e3 * way_m
            ),
        }
    }
}

fn ids_checked(out: &mut Formatter<'_>, unchecked: &[u32]) -> Result {
    if unchecked.is_empty() {
        return out.write_str(
            "ids are checked by motion: each robot moved when it was told to, and no other",
        );
    }
    let ids: Vec<String> = unchecked.iter().map(ToString::to_string).collect();
    write!(
        out,
        "ids are checked by motion, but for those of robots that were not told to move: {}",
        ids.join(", ")
    )
}

impl Display for Differing {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        match *self {
            Self::MovedWhileStanding { way_m, turned_rad } => write!(
                out,
                "was told to stand and has moved by {:.0} mm and {:.0}°",
                1e3 * way_m,
                turned_rad.to_degrees()
            ),
            Self::Jump { jump_m, noise_m } => write!(
                out,
                "jumps by {:.0} mm in all to the {} of its heading, where its commands cannot have led it; {:.0} mm of noise are stated",
                1e3 * jump_m.abs(),
                if jump_m > 0.0 { "left" } else { "right" },
                1e3 * noise_m
            ),
            Self::Displaced {
                off_m: [ahead_m, left_m],
                turned_rad,
                noise_m,
            } => write!(
                out,
                "jumps by {:.0} mm in all, {:.0} mm {} and {:.0} mm to the {}, and by {:.0}°, where its commands cannot have led it; {:.0} mm of noise are stated",
                1e3 * ahead_m.hypot(left_m),
                1e3 * ahead_m.abs(),
                if ahead_m < 0.0 { "back" } else { "ahead" },
                1e3 * left_m.abs(),
                if left_m < 0.0 { "right" } else { "left" },
                turned_rad.to_degrees(),
                1e3 * noise_m
            ),
            Self::Lag { lag_s, most_s } => write!(
                out,
                "follows its commands {lag_s:.2} s later than is stated, at most {most_s:.2} s can be driven with: state `latency_s` under [poses]"
            ),
            Self::Course {
                course_rad,
                most_rad,
            } => write!(
                out,
                "does not move where it heads but {:.0}° to the {}: is the body turned on the tracker? up to {:.0}° can be driven with",
                course_rad.abs().to_degrees(),
                if course_rad > 0.0 { "left" } else { "right" },
                most_rad.to_degrees()
            ),
            Self::Wheels { gains, error } => {
                let [left, right] = gains.map(|gain| 100.0 * gain);
                let error = 100.0 * error;
                write!(
                    out,
                    "does not do what it is told: its left wheel does {left:.0} %, its right one {right:.0} %, and {error:.0} % of error are stated"
                )
            }
        }
    }
}

impl Display for Consequence {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        out.write_str(match self {
            Self::HalfSpeed => "it goes on at half its speed",
            Self::Stands => "it stands for good",
            Self::StandsUnlessBack => "it stands for good unless they jump back",
        })
    }
}

impl Display for Loss {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        match self {
            Self::Ended => out.write_str("no more poses come: the tracker's side has ended"),
            Self::NoPose { for_s } => write!(out, "no pose for {for_s:.1} s"),
            Self::Silent { peer, for_s } => write!(out, "{peer} has been silent for {for_s:.1} s"),
        }
    }
}

/// Robots by their ids.
pub(super) fn names(ids: &[u32]) -> String {
    let names: Vec<String> = ids.iter().map(|id| format!("robot {id}")).collect();
    names.join(", ")
}

/// What to do about a robot out of sight, by why its last pose was dropped.
fn help(why: Option<Dropped>) -> &'static str {
    match why {
        Some(Dropped::Jump) => {
            "its poses say that it is or heads where its commands cannot have led it; if it was moved by hand, start anew"
        }
        Some(Dropped::Stamp) => {
            "its poses are too old when they come, or the tracker's clock is wrong"
        }
        Some(Dropped::Outside) => "its poses are outside the arena",
        Some(Dropped::Overlapping) => "its poses are where another robot is",
        _ => "if it was moved by hand, start anew",
    }
}
