//! From the axes of a NatNet server to the floor.

use std::f32::consts::{FRAC_PI_2, PI};

use testbed_io::live::natnet::{Body, Up, floor_pose};

/// Hamilton product of x, y, z, w.
fn times(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
    let ([ax, ay, az, aw], [bx, by, bz, bw]) = (a, b);
    [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
}

/// A turn about an axis.
fn turn(axis: usize, angle_rad: f32) -> [f32; 4] {
    let mut quaternion = [0.0; 4];
    quaternion[axis] = (angle_rad / 2.0).sin();
    quaternion[3] = (angle_rad / 2.0).cos();
    quaternion
}

fn body_at(position_m: [f32; 3], quaternion: [f32; 4]) -> Body {
    Body {
        id: 1,
        position_m,
        quaternion,
        mean_error_m: 0.001,
        tracked: true,
    }
}

/// Where a vector of the body points.
fn rotated(quaternion: [f32; 4], vector: [f32; 3]) -> [f32; 3] {
    let [x, y, z, w] = quaternion;
    let [a, b, c] = vector;
    let [x, y, z, _] = times(times(quaternion, [a, b, c, 0.0]), [-x, -y, -z, w]);
    [x, y, z]
}

fn difference_rad(a: f64, b: f64) -> f64 {
    (a - b).sin().atan2((a - b).cos()).abs()
}

#[test]
fn headings_count_from_x_to_y_of_the_floor() {
    for degrees in -179..=180 {
        let heading_rad = (degrees as f32).to_radians();
        for (up, axis) in [(Up::Y, 1), (Up::Z, 2)] {
            let quaternion = turn(axis, heading_rad);
            // The quaternion and its negative are the same turn, and a small error of the norm does not matter.
            for scale in [1.0, -1.0, 0.95] {
                let body = body_at([0.0; 3], quaternion.map(|part| scale * part));
                let pose = floor_pose(&body, up).unwrap();
                assert!(difference_rad(pose.heading_rad, f64::from(heading_rad)) < 1e-6);
            }
            // The x axis of the body points forward.
            let ahead = floor_pose(
                &body_at(rotated(quaternion, [1.0, 0.0, 0.0]), quaternion),
                up,
            );
            let ahead = ahead.unwrap();
            assert!(difference_rad(ahead.y_m.atan2(ahead.x_m), ahead.heading_rad) < 1e-6);
        }
    }
}

#[test]
fn small_tilts_hardly_change_headings() {
    let tilts = [-0.05, -0.02, 0.0, 0.02, 0.05_f32];
    let mut most_rad = [0.0_f64; 2];
    for step in -18..=18 {
        let heading_rad = step as f32 * PI / 18.0;
        for (about_x, about_side) in tilts.iter().flat_map(|a| tilts.map(|b| (*a, b))) {
            for (index, (up, axis, side)) in [(Up::Y, 1, 2), (Up::Z, 2, 1)].into_iter().enumerate()
            {
                let tilted = times(turn(0, about_x), turn(side, about_side));
                let quaternion = times(turn(axis, heading_rad), tilted);
                let pose = floor_pose(&body_at([0.0; 3], quaternion), up).unwrap();
                let error_rad = difference_rad(pose.heading_rad, f64::from(heading_rad));
                most_rad[index] = most_rad[index].max(error_rad);
            }
        }
    }
    println!("tilts up to 0.05 rad change headings by up to {most_rad:?} rad");
    assert!(most_rad.iter().all(|most_rad| *most_rad < 0.003));
}

#[test]
fn positions_keep_their_lengths_and_handedness() {
    let body = body_at([1.0, 2.0, 3.0], turn(1, FRAC_PI_2));
    let pose = floor_pose(&body, Up::Y).unwrap();
    assert_eq!((pose.x_m, pose.y_m), (1.0, -3.0));
    assert!((pose.heading_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
    let pose = floor_pose(&body, Up::Z).unwrap();
    assert_eq!((pose.x_m, pose.y_m), (1.0, 2.0));
}

#[test]
fn quaternions_that_are_no_rotation_give_no_pose() {
    for scale in [0.0, 0.5, 0.89, 1.11, f32::INFINITY] {
        let quaternion = [0.0, 0.6, 0.0, 0.8].map(|part| scale * part);
        let usable = floor_pose(&body_at([0.0; 3], quaternion), Up::Y);
        assert!(usable.is_none_or(|pose| !pose.is_finite()), "{scale}");
    }
    let pose = floor_pose(&body_at([0.0; 3], [f32::NAN; 4]), Up::Y);
    assert!(!pose.unwrap().is_finite());
}
