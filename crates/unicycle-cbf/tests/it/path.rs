//! Paths: feet of normals, arc length, curvature and its rate, refusals.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use proptest::prelude::*;
use unicycle_cbf::path::{Path, PathError, PathPoint, PolarPath};

fn polar() -> impl Strategy<Value = Path> {
    (0.2..2.0, -0.9..0.9, 0u32..7).prop_map(|(radius_m, share, periods)| {
        Path::polar(radius_m, share * radius_m, periods).unwrap()
    })
}

/// Loops through points at uneven angles and distances, in either direction, without cusps.
fn closed() -> impl Strategy<Value = Path> {
    let points = prop::collection::vec((0.4..1.0, 0.7..1.3), 4..20);
    let loops = (points, any::<bool>()).prop_map(|(points, clockwise)| {
        let step = TAU / points.len() as f64;
        let turn = if clockwise { -step } else { step };
        let points: Vec<[f64; 2]> = points
            .iter()
            .enumerate()
            .map(|(i, (shift, radius))| polar_point(turn * (i as f64 + shift), *radius))
            .collect();
        Path::closed(&points).unwrap()
    });
    loops.prop_filter("cusp", |path| path.max_curvature_1pm() < 40.0)
}

fn straight() -> impl Strategy<Value = Path> {
    (-2.0..2.0, -2.0..2.0, -4.0..4.0)
        .prop_map(|(x, y, heading)| Path::straight(x, y, heading).unwrap())
}

fn any_path() -> impl Strategy<Value = Path> {
    prop_oneof![3 => polar(), 1 => straight(), 3 => closed()]
}

fn polar_point(phi: f64, radius: f64) -> [f64; 2] {
    [radius * phi.cos(), radius * phi.sin()]
}

/// Points of a polar path, at equal angles.
fn points_of(path: &PolarPath, count: u32) -> Vec<[f64; 2]> {
    (0..count)
        .map(|i| path.at_angle(f64::from(i) * TAU / f64::from(count)))
        .map(|point| [point.x_m, point.y_m])
        .collect()
}

fn as_polar(path: &Path) -> &PolarPath {
    match path {
        Path::Polar(path) => path,
        _ => panic!("not polar"),
    }
}

fn distance_m(point: &PathPoint, x_m: f64, y_m: f64) -> f64 {
    (point.x_m - x_m).hypot(point.y_m - y_m)
}

/// The extent of what tests look at along a path.
fn range_m(path: &Path) -> f64 {
    path.length_m().unwrap_or(8.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn the_foot_is_stationary(path in any_path(), x_m in -1.4..1.4, y_m in -1.4..1.4) {
        let foot = path.nearest(x_m, y_m);
        let along = (x_m - foot.x_m) * foot.tangent[0] + (y_m - foot.y_m) * foot.tangent[1];
        let beside = foot.deviation_m(x_m, y_m);
        // A rounding error of the foot is felt as much as the distance bends there.
        let stretch = 1.0 + foot.curvature_1pm * beside;
        prop_assert!(along.abs() < 1e-13 * (1.0 + stretch.abs()), "{} m along, of {}", along, beside);
        prop_assert!(stretch >= -1e-6, "a maximum, {}", stretch);
        prop_assert!((beside.abs() - distance_m(&foot, x_m, y_m)).abs() < 1e-13);
    }

    #[test]
    fn the_foot_is_the_nearest_point(path in any_path(), x_m in -1.4..1.4, y_m in -1.4..1.4) {
        let foot = path.nearest(x_m, y_m);
        let least = distance_m(&foot, x_m, y_m);
        let step_m = range_m(&path) / 2000.0;
        for i in -1000..1000 {
            let point = path.at(f64::from(i) * step_m);
            prop_assert!(least <= distance_m(&point, x_m, y_m) + 1e-13, "{:?} is nearer than {:?}", point, foot);
        }
    }

    #[test]
    fn far_away_the_polar_foot_is_still_the_nearest(path in polar(), x_m in -50.0..50.0, y_m in -50.0..50.0) {
        let least = distance_m(&path.nearest(x_m, y_m), x_m, y_m);
        let step_m = range_m(&path) / 2000.0;
        for i in 0..2000 {
            prop_assert!(least <= distance_m(&path.at(f64::from(i) * step_m), x_m, y_m) + 1e-12);
        }
    }

    #[test]
    fn the_foot_beside_a_point_of_the_path_is_that_point(path in any_path(), share in 0.0..1.0, sideways in -0.5..0.5) {
        let point = path.at(share * range_m(&path));
        // So near that no other part of the path is nearer.
        let beside: f64 = sideways * (0.02 / path.max_curvature_1pm().max(1.0));
        let [nx, ny] = point.normal();
        let (x_m, y_m) = (point.x_m + beside * nx, point.y_m + beside * ny);
        let foot = path.nearest(x_m, y_m);
        prop_assume!(distance_m(&foot, x_m, y_m) > beside.abs() - 1e-12);
        prop_assert!(distance_m(&foot, point.x_m, point.y_m) < 1e-12, "{:?} for {:?}", foot, point);
        prop_assert!((foot.deviation_m(x_m, y_m) - beside).abs() < 1e-13);
        let across = path.distance_along_m(point.s_m, foot.s_m);
        prop_assert!(across.min(range_m(&path) - across) < 1e-12);
    }

    #[test]
    fn the_arc_length_of_a_foot_leads_back_to_it(path in any_path(), x_m in -1.4..1.4, y_m in -1.4..1.4) {
        let foot = path.nearest(x_m, y_m);
        let again = path.at(foot.s_m);
        prop_assert!(distance_m(&again, foot.x_m, foot.y_m) < 1e-12, "{:?} for {:?}", again, foot);
        if let Some(length_m) = path.length_m() {
            prop_assert!((0.0..length_m).contains(&foot.s_m));
        }
    }

    #[test]
    fn the_frame_is_the_derivative_along_the_path(path in any_path(), share in 0.0..1.0) {
        let step_m = 1e-3 / path.max_curvature_1pm().max(1.0);
        let s_m = share * range_m(&path);
        let [before, point, after] = [-step_m, 0.0, step_m].map(|by_m| path.at(s_m + by_m));
        // The third derivative of a spline jumps at its joints.
        prop_assume!((after.curvature_rate_1pm2 - before.curvature_rate_1pm2).abs() < 0.05 * path.max_curvature_1pm().powi(2));

        let scale = path.max_curvature_1pm().max(1.0);
        for (side, tangent) in [(after.x_m - before.x_m, point.tangent[0]), (after.y_m - before.y_m, point.tangent[1])] {
            prop_assert!((side / (2.0 * step_m) - tangent).abs() < 1e-5);
        }
        prop_assert!((point.tangent[0].hypot(point.tangent[1]) - 1.0).abs() < 1e-15);
        let turn = (after.heading_rad() - before.heading_rad() + PI).rem_euclid(TAU) - PI;
        prop_assert!((turn / (2.0 * step_m) - point.curvature_1pm).abs() < 1e-4 * scale);
        let change = (after.curvature_1pm - before.curvature_1pm) / (2.0 * step_m);
        prop_assert!((change - point.curvature_rate_1pm2).abs() < 0.05 * scale.powi(2), "{} for {}", change, point.curvature_rate_1pm2);
    }

    #[test]
    fn chords_add_up_to_the_arc_length(path in any_path(), from in 0.0..1.0, part in 0.01..0.9) {
        let (start, span): (f64, f64) = (from * range_m(&path), part * range_m(&path));
        let chords = |count: u32| -> f64 {
            (0..count)
                .map(|i| [i, i + 1].map(|i| path.at(start + span * f64::from(i) / f64::from(count))))
                .map(|[a, b]| distance_m(&a, b.x_m, b.y_m))
                .sum()
        };
        let (coarse, fine) = (chords(2000), chords(4000));
        let sum_m = fine + (fine - coarse) / 3.0;
        let bound = 1e-9 + 0.01 * (path.max_curvature_1pm() * span / 4000.0).powi(4);
        prop_assert!((sum_m / span - 1.0).abs() < bound, "{} for {}", sum_m, span);
    }

    #[test]
    fn no_point_of_a_path_turns_more_than_the_largest_curvature(path in any_path()) {
        let step_m = range_m(&path) / 5000.0;
        let most = (0..5000).map(|i| path.at(f64::from(i) * step_m).curvature_1pm.abs()).fold(0.0, f64::max);
        prop_assert!(most <= path.max_curvature_1pm() * (1.0 + 1e-6));
        if most * step_m < 0.02 {
            prop_assert!(most >= path.max_curvature_1pm() * 0.95);
        }
    }

    #[test]
    fn the_length_of_a_polar_path_is_its_integral(radius_m in 0.2..2.0, share in -0.9..0.9, periods in 0u32..7) {
        let path = Path::polar(radius_m, share * radius_m, periods).unwrap();
        let (count, path) = (1 << 14, as_polar(&path));
        // The trapezoidal rule converges exponentially over a period.
        let sum: f64 = (0..count)
            .map(|i| path.radius(f64::from(i) * TAU / f64::from(count)))
            .map(|[radius, r1, ..]| radius.hypot(r1))
            .sum();
        let length_m = sum * TAU / f64::from(count);
        prop_assert!((path.length_m() / length_m - 1.0).abs() < 1e-12);
    }

    #[test]
    fn closed_paths_wrap(path in prop_oneof![polar(), closed()], share in 0.0..1.0, turns in -3i32..4) {
        let length_m = path.length_m().unwrap();
        let (once, again) = (path.at(share * length_m), path.at((share + f64::from(turns)) * length_m));
        prop_assert!(distance_m(&once, again.x_m, again.y_m) < 1e-12);
        let ahead = path.distance_along_m(0.75 * length_m, 0.25 * length_m);
        prop_assert!((ahead - 0.5 * length_m).abs() < 1e-12);
        prop_assert_eq!(path.distance_along_m(1.0, 1.0 - 1e-300), 0.0);
        prop_assert!(path.distance_along_m(1e-17, 0.0) < length_m);
    }

    #[test]
    fn circles_have_closed_forms(radius_m in 0.1..3.0, x_m in -4.0..4.0, y_m in -4.0..4.0, periods in 0u32..4) {
        let path = Path::polar(radius_m, 0.0, periods).unwrap();
        let phi = f64::atan2(y_m, x_m);
        let foot = path.nearest(x_m, y_m);
        prop_assert!(distance_m(&foot, radius_m * phi.cos(), radius_m * phi.sin()) < 1e-14 * radius_m.max(1.0));
        prop_assert!((foot.deviation_m(x_m, y_m) - (x_m.hypot(y_m) - radius_m)).abs() < 1e-14);
        prop_assert!((foot.s_m - radius_m * phi.rem_euclid(TAU)).abs() < 1e-13);
        prop_assert!((foot.curvature_1pm * radius_m - 1.0).abs() < 1e-14);
        prop_assert_eq!(foot.curvature_rate_1pm2, 0.0);
        prop_assert!((path.max_curvature_1pm() * radius_m - 1.0).abs() < 1e-14);
        prop_assert!((path.length_m().unwrap() / (TAU * radius_m) - 1.0).abs() < 1e-14);
    }
}

#[test]
fn the_radius_comes_with_its_derivatives() {
    let path = Path::polar(0.9, 0.23, 3).unwrap();
    let path = as_polar(&path);
    assert_eq!(
        (path.radius_m(), path.amplitude_m(), path.periods()),
        (0.9, 0.23, 3)
    );
    let (phi, step) = (0.7, 1e-5);
    let [before, here, after] = [-step, 0.0, step].map(|by| path.radius(phi + by));
    assert!((here[0] - (0.9 + 0.23 * (3.0 * phi).sin())).abs() < 1e-15);
    for order in 0..3 {
        let slope = (after[order] - before[order]) / (2.0 * step);
        assert!((slope - here[order + 1]).abs() < 1e-8);
    }
    let point = path.at_angle(phi - 2.0 * TAU);
    assert!(distance_m(&point, here[0] * phi.cos(), here[0] * phi.sin()) < 1e-14);
}

#[test]
fn a_straight_line_is_signed() {
    let path = Path::straight(1.0, 2.0, FRAC_PI_2).unwrap();
    let foot = path.nearest(1.5, 1.0);
    assert!((foot.s_m + 1.0).abs() < 1e-15);
    assert!((foot.deviation_m(1.5, 1.0) - 0.5).abs() < 1e-15);
    assert!((foot.heading_rad() - FRAC_PI_2).abs() < 1e-15);
    assert_eq!((foot.curvature_1pm, path.max_curvature_1pm()), (0.0, 0.0));
    assert_eq!(
        (path.length_m(), path.distance_along_m(1.0, -2.0)),
        (None, -3.0)
    );
}

/// The error of a cubic spline falls with the fourth power of the distance between points, that of its curvature with the second.
#[test]
fn loops_through_points_converge_to_the_polar_path() {
    let truth = Path::polar(0.9, 0.23, 3).unwrap();
    let errors = |count: u32| {
        let path = Path::closed(&points_of(as_polar(&truth), count)).unwrap();
        let (mut position, mut curvature) = (0.0f64, 0.0f64);
        for i in 0..500 {
            let foot = path.at(f64::from(i) / 500.0 * path.length_m().unwrap());
            let expected = truth.nearest(foot.x_m, foot.y_m);
            position = position.max(distance_m(&expected, foot.x_m, foot.y_m));
            curvature = curvature.max((expected.curvature_1pm - foot.curvature_1pm).abs());
        }
        let length = (path.length_m().unwrap() - truth.length_m().unwrap()).abs();
        [position, curvature, length]
    };
    let (coarse, fine) = (errors(100), errors(200));
    assert!(
        fine[0] < 1e-6 && fine[1] < 2e-2 && fine[2] < 1e-6,
        "{fine:?}"
    );
    for (order, (coarse, fine)) in [4, 2, 4].into_iter().zip(coarse.into_iter().zip(fine)) {
        let ratio = coarse / fine;
        assert!(ratio > 0.8 * 2f64.powi(order), "{ratio} at order {order}");
    }
}

#[test]
fn a_loop_goes_through_its_points_in_their_order() {
    let points = [[0.0, 0.0], [2.0, 0.1], [2.1, 1.0], [1.0, 1.4], [-0.2, 0.9]];
    let path = Path::closed(&points).unwrap();
    let mut behind = -1.0;
    for [x_m, y_m] in points {
        let foot = path.nearest(x_m, y_m);
        assert!(distance_m(&foot, x_m, y_m) < 1e-15);
        assert!(foot.s_m > behind);
        behind = foot.s_m;
    }
    let repeated: Vec<[f64; 2]> = points.into_iter().chain([points[0]]).collect();
    assert_eq!(Path::closed(&repeated).unwrap(), path);
}

/// Two parallel straights closer to each other than a cell of the search grid.
#[test]
fn narrow_loops_are_told_apart() {
    let mut points: Vec<[f64; 2]> = (0..=50).map(|i| [f64::from(i) * 0.2, 0.0]).collect();
    points.extend((0..=50).rev().map(|i| [f64::from(i) * 0.2, 0.06]));
    let path = Path::closed(&points).unwrap();
    for i in 0..1000 {
        let x_m = 3.0 + 4.0 * f64::from(i) / 1000.0;
        for y_m in [-0.01, 0.01, 0.0299, 0.0301, 0.05, 0.07] {
            let foot = path.nearest(x_m, y_m);
            let expected = y_m.abs().min((0.06f64 - y_m).abs());
            assert!((distance_m(&foot, x_m, y_m) - expected).abs() < 1e-6);
        }
    }
}

#[test]
fn many_points_are_taken() {
    let truth = Path::polar(10.0, 2.0, 5).unwrap();
    let path = Path::closed(&points_of(as_polar(&truth), 10_000)).unwrap();
    assert!((path.length_m().unwrap() / truth.length_m().unwrap() - 1.0).abs() < 1e-11);
    for i in 0..1000 {
        let [x_m, y_m] = polar_point(f64::from(i) * 2.4, 12.0 * f64::from(i % 83) / 83.0);
        let (foot, expected) = (path.nearest(x_m, y_m), truth.nearest(x_m, y_m));
        let error = distance_m(&foot, x_m, y_m) - distance_m(&expected, x_m, y_m);
        assert!(error.abs() < 1e-9, "{foot:?} for {expected:?}");
    }
}

#[test]
fn what_is_no_path_is_refused() {
    let message = |path: Result<Path, PathError>| path.unwrap_err().to_string();
    assert_eq!(
        message(Path::polar(0.5, -0.5, 3)),
        "the radius is 0.5 m and the amplitude -0.5 m; the radius must be larger"
    );
    assert_eq!(
        message(Path::polar(0.0, 0.0, 0)),
        "the radius is 0 m and the amplitude 0 m; the radius must be larger"
    );
    assert_eq!(
        message(Path::polar(f64::NAN, 0.1, 3)),
        "`radius_m` is NaN; it must be finite and no larger than 1e9"
    );
    assert_eq!(
        message(Path::polar(1.0, f64::INFINITY, 3)),
        "`amplitude_m` is inf; it must be finite and no larger than 1e9"
    );
    assert_eq!(
        message(Path::polar(1.0, 0.1, 1001)),
        "1001 periods; a polar path has at most 1000"
    );
    assert_eq!(
        message(Path::straight(0.0, 0.0, f64::NAN)),
        "`heading_rad` is NaN; it must be finite and no larger than 1e9"
    );
    let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    assert_eq!(
        message(Path::closed(&[a, b, c])),
        "3 distinct points; a closed path needs at least 4"
    );
    assert_eq!(
        message(Path::closed(&[a, b, c, a])),
        "3 distinct points; a closed path needs at least 4"
    );
    assert_eq!(
        message(Path::closed(&[a, b, a, b, c])),
        "3 distinct points; a closed path needs at least 4"
    );
    assert_eq!(
        message(Path::closed(&[a, b, c, c, d])),
        "point 3 at (1, 1) repeats the one before it"
    );
    assert_eq!(
        message(Path::closed(&[a, b, [0.5, f64::NAN], d])),
        "point 2 is (0.5, NaN); coordinates must be finite and no larger than 1e9"
    );
    for points in [&[][..], &[a], &[a, a], &[a, a, a, a, a]] {
        assert!(Path::closed(points).is_err());
    }
}

#[test]
fn no_number_panics() {
    let odd = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::MAX,
        f64::MIN,
        f64::MIN_POSITIVE,
        1e200,
        -1e18,
        -0.0,
    ];
    let tiny: Vec<[f64; 2]> = (0..5).map(|i| polar_point(f64::from(i), 1e-300)).collect();
    let collinear = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.5, 0.0]];
    let eight = [
        [0.0, 0.0],
        [1.0, 1.0],
        [2.0, 0.0],
        [1.0, -1.0],
        [0.0, 0.0],
        [-1.0, 1.0],
        [-2.0, 0.0],
        [-1.0, -1.0],
    ];
    let paths = [
        Path::polar(0.9, 0.23, 3).unwrap(),
        Path::polar(1.0, 0.999_999, 1000).unwrap(),
        Path::polar(1e9, 1e8, 5).unwrap(),
        Path::polar(f64::MIN_POSITIVE, 0.0, 0).unwrap(),
        Path::straight(1.0, 1.0, 1.0).unwrap(),
        Path::closed(&tiny).unwrap(),
        Path::closed(&collinear).unwrap(),
        Path::closed(&eight).unwrap(),
    ];
    for path in &paths {
        for x_m in odd {
            let _ = path.at(x_m);
            for y_m in odd {
                let _ = path.nearest(x_m, y_m);
                let _ = path.distance_along_m(x_m, y_m);
            }
        }
        for foot in [
            path.nearest(f64::NAN, 0.0),
            path.nearest(0.0, f64::NAN),
            path.at(f64::NAN),
            path.at(f64::INFINITY),
        ] {
            let numbers = [
                foot.s_m,
                foot.x_m,
                foot.y_m,
                foot.tangent[0],
                foot.tangent[1],
                foot.curvature_1pm,
                foot.curvature_rate_1pm2,
            ];
            assert!(
                numbers.iter().all(|number| number.is_nan()),
                "{foot:?} of {path:?}"
            );
        }
        assert!(path.distance_along_m(f64::NAN, 0.0).is_nan());
    }
}
