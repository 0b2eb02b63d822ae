//! Whether robots are where they can start, and how long they are waited for.

use std::time::Duration;

use unicycle_cbf::{Scenario, Speeds, StampedPose};

use super::counts::Counts;
use super::gate::wrapped;
use super::heading::{Room, UNKNOWN_RAD};
use super::words::names;
use crate::error::Error;

/// How long robots have to appear before the start, and how long while the other side says that they are getting ready.
const APPEAR: Duration = Duration::from_secs(60);
const GETTING_READY: Duration = Duration::from_secs(300);
/// Headings beyond a turn and this are no headings in rad.
const SLACK_RAD: f64 = 0.3;
/// How far a heading may be from the path's direction, in rad.
const MOST_COURSE_RAD: f64 = 1.4;
/// How often noise of headings is counted, and after which way it shows where a robot moves, in m.
const NOISE_PEAKS: f64 = 3.0;
const SEEN_AFTER_M: f64 = 0.06;
/// Robots that shall start about half a lap from each other, and more, may be so by their noise.
const NEAR_HALF: f64 = 0.4;

/// # Errors
///
/// The first robot that is not where it can start.
pub(super) fn check(
    scenario: &Scenario,
    ids: &[u32],
    seen: &[Option<StampedPose>],
) -> Result<(), Error> {
    for (robot, own) in seen.iter().enumerate() {
        let Some(own) = own else { continue };
        let ahead = robot.checked_sub(1);
        let leader = ahead.and_then(|ahead| seen[ahead].as_ref().map(|pose| (ids[ahead], pose)));
        let problem = degrees(own)
            .or_else(|| lane(scenario, own))
            .or_else(|| heading(scenario, own))
            .or_else(|| misplaced(scenario, own))
            .or_else(|| leader.and_then(|(id, leader)| order(scenario, robot, own, id, leader)))
            .or_else(|| room(scenario, own, ids, &seen[..robot]));
        if let Some((problem, help)) = problem {
            return Err(Error::Link {
                peer: format!("robot {}", ids[robot]),
                problem,
                help: help.to_owned(),
            });
        }
    }
    Ok(())
}

/// What is wrong, and what to do.
type Problem = (String, &'static str);

fn degrees(own: &StampedPose) -> Option<Problem> {
    let heading_rad = own.pose.heading_rad;
    (heading_rad.abs() > std::f64::consts::TAU + SLACK_RAD).then(|| {
        let problem = format!("a heading of {heading_rad:.2} rad, more than a turn; degrees?");
        let help = "give headings in rad, between −π and π or 0 and 2π";
        (problem, help)
    })
}

/// By how much a robot heads off the path's direction, in rad.
fn off_rad(scenario: &Scenario, own: &StampedPose) -> f64 {
    let controller = scenario.controller();
    let state = own.pose.state(controller.body().offset_m, Speeds::ZERO);
    let foot = controller.foot(&state);
    wrapped(own.pose.heading_rad - foot.heading_rad())
}

/// A robot that stands along the path while its heading is measured off it turns its point of interest out of a narrow lane before that
/// shows in how it moves.
fn misplaced(scenario: &Scenario, own: &StampedPose) -> Option<Problem> {
    let room = Room::of(scenario);
    let off_rad = off_rad(scenario, own).abs();
    let noise_rad = scenario.controller().settings().hardening.heading_noise_rad;
    let most_rad = (off_rad + NOISE_PEAKS * noise_rad).min(UNKNOWN_RAD);
    let most_m = room.misplaced_m(most_rad) + SEEN_AFTER_M * most_rad.sin();
    let half_width_m = scenario.spec().controller.lane.half_width_m;
    (most_m > half_width_m).then(|| {
        let problem = format!(
            "it heads {:.0}° off the path's direction: if that is an error of its heading, its point of interest comes {:.0} mm from the path before \
             that shows, and the lane reaches {:.0} mm to each side",
            off_rad.to_degrees(),
            1e3 * most_m,
            1e3 * half_width_m
        );
        (problem, "turn it along the path, or see whether the tracker's headings are right")
    })
}

fn heading(scenario: &Scenario, own: &StampedPose) -> Option<Problem> {
    let off_rad = off_rad(scenario, own);
    (off_rad.abs() > MOST_COURSE_RAD).then(|| {
        let problem = format!(
            "it heads {:.0}° off the path's direction, at most {:.0}° can be started from",
            off_rad.to_degrees(),
            MOST_COURSE_RAD.to_degrees()
        );
        let help = "turn it, or see whether the tracker's headings are in rad and counter-clockwise from the x axis";
        (problem, help)
    })
}

fn lane(scenario: &Scenario, own: &StampedPose) -> Option<Problem> {
    let controller = scenario.controller();
    let half_width_m = scenario.spec().controller.lane.half_width_m;
    let state = own.pose.state(controller.body().offset_m, Speeds::ZERO);
    let deviation_m = controller.safety(&state, None).deviation_m.abs();
    (deviation_m > half_width_m).then(|| {
        let problem = format!(
            "{deviation_m:.3} m off the path, and the lane reaches {half_width_m} m to each side"
        );
        (problem, "place it within")
    })
}

/// Every robot has room for its body.
fn room(
    scenario: &Scenario,
    own: &StampedPose,
    ids: &[u32],
    others: &[Option<StampedPose>],
) -> Option<Problem> {
    let least_m = scenario.controller().least_distance_m();
    let apart_m =
        |other: &StampedPose| (other.pose.x_m - own.pose.x_m).hypot(other.pose.y_m - own.pose.y_m);
    let seen = others
        .iter()
        .zip(ids)
        .filter_map(|(other, id)| Some((id, apart_m(other.as_ref()?))));
    let (id, apart_m) = seen.into_iter().find(|(_, apart_m)| *apart_m < least_m)?;
    let problem = format!("{apart_m:.3} m from robot {id}, and {least_m:.3} m are needed");
    Some((problem, "place them farther apart"))
}

/// Behind the one ahead along the path, and not too near.
fn order(
    scenario: &Scenario,
    robot: usize,
    own: &StampedPose,
    leader_id: u32,
    leader: &StampedPose,
) -> Option<Problem> {
    let controller = scenario.controller();
    let offset_m = controller.body().offset_m;
    let [own, leader] = [own, leader].map(|seen| seen.pose.state(offset_m, Speeds::ZERO));
    let path = controller.path();
    let ahead_m = path.distance_along_m(controller.foot(&own).s_m, controller.foot(&leader).s_m);
    let planned_m = path.distance_along_m(scenario.start_m(robot), scenario.start_m(robot - 1));
    let most_m = path.length_m().map_or(f64::INFINITY, |length_m| {
        0.5 * if planned_m > NEAR_HALF * length_m {
            length_m + planned_m
        } else {
            length_m
        }
    });
    if ahead_m < 0.0 || ahead_m > most_m {
        let problem = format!(
            "robot {leader_id} is not ahead of it along the path, {:.2} m ahead as planned, but {:.2} m {}",
            planned_m,
            if ahead_m < 0.0 { -ahead_m } else { ahead_m },
            if ahead_m < 0.0 {
                "behind"
            } else {
                "ahead, almost a lap"
            }
        );
        return Some((
            problem,
            "place the robots in the order of `robots`, from the front, or change that order",
        ));
    }
    let headway_m = controller.safety(&own, Some(&leader)).headway_m;
    headway_m.is_some_and(|headway_m| headway_m < 0.0).then(|| {
        let problem = format!("too near to robot {leader_id}");
        (problem, "place it farther back")
    })
}

/// Robots that are waited for in vain.
pub(super) fn not_seen(ids: &[u32], counts: &Counts) -> Error {
    Error::Link {
        peer: "tracker".to_owned(),
        problem: format!(
            "not seen, or not steadily: {}; {}",
            names(ids),
            counts.text()
        ),
        help: "are these their ids at the tracker, are they in the arena?".to_owned(),
    }
}

/// `ready_told` is how long ago the other side said last that robots are getting ready.
pub(super) fn is_too_long(waited: Duration, ready_told: Option<Duration>) -> bool {
    let getting_ready = ready_told.is_some_and(|told| told < APPEAR);
    waited > if getting_ready { GETTING_READY } else { APPEAR }
}

#[cfg(test)]
mod tests {
    use super::{Duration, is_too_long};

    #[test]
    fn robots_that_get_ready_have_more_time_but_not_for_ever() {
        let seconds = Duration::from_secs;
        for (waited_s, told_s, too_long) in [
            (59, None, false),
            (61, None, true),
            (61, Some(1), false),
            (299, Some(1), false),
            (301, Some(1), true),
            // It said so once, and then no more.
            (59, Some(50), false),
            (70, Some(65), true),
        ] {
            let found = is_too_long(seconds(waited_s), told_s.map(seconds));
            assert_eq!(found, too_long, "{waited_s} s, told {told_s:?} s ago");
        }
    }
}
