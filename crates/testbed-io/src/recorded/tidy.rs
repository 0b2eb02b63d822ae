//! Poses in order, and what is odd about them.

use std::f64::consts::TAU;

use super::recording::{Finding, FindingKind, RecordedPose, RecordedRobot};
use super::text::RawRobot;

/// Faster than any robot of a testbed, in m/s.
const MAX_SPEED: f64 = 5.0;
/// Within which poses of one time agree, in m.
const SAME_PLACE_M: f64 = 0.02;
/// In s.
const MAX_GAP: f64 = 0.5;
/// In rad; a little more than a full turn.
const MAX_HEADING: f64 = TAU * 1.01;

/// Counts times from `start_s`, sorts, drops duplicates and lists what is odd.
pub(super) fn tidy(robot: RawRobot, start_s: f64) -> RecordedRobot {
    let mut poses = robot.poses;
    for pose in &mut poses {
        // plus zero, so that there is one zero
        pose.time_s = pose.time_s - start_s + 0.0;
    }
    let bad = robot.first_bad.map(|(line, before)| {
        let at = before.checked_sub(1).map(|last| poses[last].time_s);
        let detail = format!(
            "lines without four numbers, or longer than the first, are dropped, first line {line}"
        );
        finding(FindingKind::NoNumbers, robot.bad_lines, at, detail)
    });
    let order = out_of_order(&poses);
    // stable: of the same time, the newest stays last
    poses.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    let places = two_places(&poses);
    let duplicates = drop_duplicates(&mut poses);
    let findings = [
        bad,
        order,
        duplicates,
        places,
        jumps(&poses),
        gaps(&poses),
        degrees(&poses),
    ];
    RecordedRobot {
        name: robot.name,
        findings: findings.into_iter().flatten().collect(),
        poses,
    }
}

fn finding(kind: FindingKind, count: usize, first_at_s: Option<f64>, detail: String) -> Finding {
    Finding {
        kind,
        count,
        first_at_s,
        detail,
    }
}

/// The times at which `odd` is true of a pose and the one before, and the largest value it gives.
fn steps(
    poses: &[RecordedPose],
    odd: impl Fn(&RecordedPose, &RecordedPose) -> Option<f64>,
) -> Option<(usize, f64, f64)> {
    let mut found: Option<(usize, f64, f64)> = None;
    for pair in poses.windows(2) {
        if let Some(value) = odd(&pair[0], &pair[1]) {
            let (count, _, worst) = found.get_or_insert((0, pair[0].time_s, value));
            *count += 1;
            *worst = worst.max(value);
        }
    }
    found
}

fn out_of_order(poses: &[RecordedPose]) -> Option<Finding> {
    let back = |a: &RecordedPose, b: &RecordedPose| {
        let back = a.time_s - b.time_s;
        (back > 0.0).then_some(back)
    };
    steps(poses, back).map(|(count, at, most)| {
        let detail = format!("times go back by up to {most:.3} s; the poses are sorted");
        finding(FindingKind::OutOfOrder, count, Some(at), detail)
    })
}

fn drop_duplicates(poses: &mut Vec<RecordedPose>) -> Option<Finding> {
    let before = poses.len();
    let mut first = None;
    poses.dedup_by(|next, kept| {
        let same = next.time_s.total_cmp(&kept.time_s).is_eq();
        if same {
            first.get_or_insert(kept.time_s);
            *kept = *next;
        }
        same
    });
    let detail = "of poses at the same time the newest is kept".to_owned();
    first.map(|at| {
        finding(
            FindingKind::DuplicateTime,
            before - poses.len(),
            Some(at),
            detail,
        )
    })
}

fn distance_m(a: &RecordedPose, b: &RecordedPose) -> f64 {
    (b.x_m - a.x_m).hypot(b.y_m - a.y_m)
}

fn two_places(poses: &[RecordedPose]) -> Option<Finding> {
    let apart = |a: &RecordedPose, b: &RecordedPose| {
        let same = a.time_s.total_cmp(&b.time_s).is_eq();
        let apart_m = distance_m(a, b);
        (same && apart_m > SAME_PLACE_M).then_some(apart_m)
    };
    steps(poses, apart).map(|(count, at, most)| {
        let detail = format!("poses of one time are up to {most:.3} m apart");
        finding(FindingKind::TwoPlaces, count, Some(at), detail)
    })
}

fn jumps(poses: &[RecordedPose]) -> Option<Finding> {
    let speed = |a: &RecordedPose, b: &RecordedPose| {
        let speed = distance_m(a, b) / (b.time_s - a.time_s);
        (speed > MAX_SPEED).then_some(speed)
    };
    steps(poses, speed).map(|(count, at, most)| {
        let detail = format!("faster than {MAX_SPEED} m/s between poses, up to {most:.1} m/s");
        finding(FindingKind::Jump, count, Some(at), detail)
    })
}

fn gaps(poses: &[RecordedPose]) -> Option<Finding> {
    let gap = |a: &RecordedPose, b: &RecordedPose| {
        let gap = b.time_s - a.time_s;
        (gap > MAX_GAP).then_some(gap)
    };
    steps(poses, gap).map(|(count, at, longest)| {
        let detail = format!("more than {MAX_GAP} s without a pose, at most {longest:.2} s");
        finding(FindingKind::Gap, count, Some(at), detail)
    })
}

fn degrees(poses: &[RecordedPose]) -> Option<Finding> {
    let mut beyond = poses.iter().filter(|p| p.heading_rad.abs() > MAX_HEADING);
    let first = beyond.next()?.time_s;
    let count = 1 + beyond.count();
    let largest = poses
        .iter()
        .fold(0.0_f64, |most, p| most.max(p.heading_rad.abs()));
    let detail = format!(
        "headings up to {largest:.1} are beyond a full turn in rad; are they degrees? they are not converted"
    );
    (count >= 3).then(|| finding(FindingKind::Degrees, count, Some(first), detail))
}
