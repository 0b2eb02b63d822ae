//! Weights: a phase or point of weight 2 counts as two of weight 1, and one of weight 0 as none.

use driver_model::phase_model::{
    ConditionedProfile, Conditioning, Constant, Exponential, Inverse, Profile, RiseTime,
};
use driver_model::{
    AccelPoint, DriveBehaviour, ModelKind, PhaseCurve, PhaseKind, PhaseModel, Subject, TrainingSet,
};

use crate::support::{assorted, fixture_trips, points_of, set, trip_of};

/// Points that scatter; every third has weight 2.
fn weighted_points() -> Vec<AccelPoint> {
    let point = |k: usize| {
        let v = 0.3 + 30.0 * (k as f64 * 0.618_034).fract();
        AccelPoint {
            speed_mps: v,
            accel_mps2: 1.2 * (-0.1 * v).exp() + 0.4 + 0.3 * (k as f64 * 2.4).sin(),
            weight: if k.is_multiple_of(3) { 2.0 } else { 1.0 },
        }
    };
    (0..90).map(point).collect()
}

/// Weight 1 each, those of weight 2 twice.
fn duplicated(points: &[AccelPoint]) -> Vec<AccelPoint> {
    let twice = points.iter().filter(|p| p.weight == 2.0);
    let all = points.iter().chain(twice);
    all.map(|p| AccelPoint::new(p.speed_mps, p.accel_mps2))
        .collect()
}

fn assert_alike(a: f64, b: f64, relative: f64) {
    assert!((a - b).abs() <= relative * a.abs().max(1.0), "{a} and {b}");
}

#[test]
fn a_point_of_weight_2_counts_as_two() {
    let points = weighted_points();
    let plain: Vec<AccelPoint> = points
        .iter()
        .map(|p| AccelPoint::new(p.speed_mps, p.accel_mps2))
        .collect();
    let twice = duplicated(&points);

    let (a, b) = (
        Inverse::fit(&points).unwrap(),
        Inverse::fit(&twice).unwrap(),
    );
    assert_alike(a.p1, b.p1, 1e-7);
    assert_alike(a.p2, b.p2, 1e-7);
    assert!((a.p2 - Inverse::fit(&plain).unwrap().p2).abs() > 1e-4);

    for fit in [Exponential::fit_printed, Exponential::fit_with_amplitude] {
        let (a, b) = (fit(&points).unwrap(), fit(&twice).unwrap());
        assert_alike(a.p0, b.p0, 1e-6);
        assert_alike(a.p1, b.p1, 1e-6);
        assert_alike(a.p2, b.p2, 1e-6);
        assert!((a.p2 - fit(&plain).unwrap().p2).abs() > 1e-4);
    }
}

/// Every third phase with weight 2, and the same set with those phases twice instead.
fn weighted_and_duplicated(curves: &[PhaseCurve]) -> [TrainingSet<'_>; 2] {
    let is_double = |k: usize| k.is_multiple_of(3);
    let numbered = || curves.iter().enumerate();
    let weighted = numbered().map(|(k, c)| (c, k / 5, if is_double(k) { 2.0 } else { 1.0 }));
    let once = numbered().map(|(k, c)| (c, k / 5, 1.0));
    let again = once.clone().enumerate().filter(|(k, _)| is_double(*k));
    [
        set(weighted),
        set(once.chain(again.map(|(_, phase)| phase))),
    ]
}

#[test]
fn a_phase_of_weight_2_counts_as_two() {
    let curves = assorted(60);
    let [weighted, twice] = weighted_and_duplicated(&curves);

    let constant = |t| Constant::fit(t).unwrap().accel_mps2;
    assert_alike(constant(&weighted), constant(&twice), 1e-12);

    let profile = |t| Profile::fit(t).unwrap().shape;
    for (a, b) in profile(&weighted).into_iter().zip(profile(&twice)) {
        assert_alike(a, b, 1e-12);
    }

    let rise_time = |t| RiseTime::fit(t, RiseTime::RISE_TIME_CONSTANTS).unwrap();
    let (a, b) = (rise_time(&weighted).groups, rise_time(&twice).groups);
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(&b) {
        assert_eq!(a.group, b.group);
        assert_alike(a.time_constant_s, b.time_constant_s, 1e-12);
    }
}

#[test]
fn a_phase_of_weight_2_counts_as_two_for_the_conditioned_shape() {
    let curves = assorted(60);
    let [weighted, twice] = weighted_and_duplicated(&curves);
    let fit = |t| ConditionedProfile::fit(Conditioning::Outline, t).unwrap();
    let (a, b) = (fit(&weighted), fit(&twice));
    assert_eq!(a.basis.centres.len(), b.basis.centres.len());
    for (a, b) in a
        .basis
        .centres
        .iter()
        .flatten()
        .zip(b.basis.centres.iter().flatten())
    {
        assert_alike(*a, *b, 1e-12);
    }
    for curve in &curves {
        let outline = curve.outline();
        for (a, b) in a
            .speeds_mps(&outline)
            .into_iter()
            .zip(b.speeds_mps(&outline))
        {
            assert_alike(a, b, 1e-9);
        }
    }
}

#[test]
fn a_prior_of_weight_0_is_none() {
    let trips = fixture_trips(6);
    let (own, prior) = trips.split_at(3);
    for kind in [PhaseKind::Acceleration, PhaseKind::Braking] {
        let alone = TrainingSet::from_trips(kind, own);
        let with = TrainingSet::from_trips(kind, own).with_prior(kind, prior, 0.0);
        assert_eq!(with.phases.len(), alone.phases.len());
        assert_eq!(with.points, alone.points);
        for model in ModelKind::of(Subject::Phases) {
            if model == ModelKind::ProfilePedal {
                continue;
            }
            let fit = |training| PhaseModel::fit(model, training).unwrap();
            assert_eq!(fit(&with), fit(&alone), "{model}");
        }
    }
}

#[test]
fn trips_of_a_prior_are_numbered_after_the_own() {
    let curves = assorted(6);
    let trip = |from: usize, to: usize| {
        trip_of(
            "trip",
            curves[from..to].to_vec(),
            &points_of(&curves[from..to]),
        )
    };
    let own: [DriveBehaviour; 3] = [trip(0, 2), trip(2, 2), trip(2, 3)];
    let prior = [trip(3, 4), trip(4, 6)];
    let kind = PhaseKind::Acceleration;
    let training = TrainingSet::from_trips(kind, &own).with_prior(kind, &prior, 0.25);
    let numbers: Vec<(usize, f64)> = training.phases.iter().map(|p| (p.trip, p.weight)).collect();
    let expected = [
        (0, 1.0),
        (0, 1.0),
        (2, 1.0),
        (3, 0.25),
        (4, 0.25),
        (4, 0.25),
    ];
    assert_eq!(numbers, expected);
    let weights: Vec<f64> = training.points.iter().map(|p| p.weight).collect();
    assert_eq!(weights, [1.0, 1.0, 1.0, 0.25, 0.25, 0.25]);
    assert!(
        TrainingSet::from_trips(PhaseKind::Braking, &own)
            .phases
            .is_empty()
    );
}
