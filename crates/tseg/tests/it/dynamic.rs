//! Dynamic programming against a search of all segmentations, and against reference vectors.

use std::ops::ControlFlow;

use proptest::prelude::*;
use serde_json::Value;
use tseg::{Certificate, Cost, Dynamic, Error, PenaltyPath, Segmentation, Series};

use crate::shared::shared;

const COSTS: [Cost; 3] = [Cost::ZScale, Cost::MeanDeviation, Cost::SquaredError];

/// The least cost over all segmentations, by trying each.
fn least(
    cost: Cost,
    series: &Series,
    segments: usize,
    at_most: bool,
    min_length: usize,
    start: usize,
) -> f64 {
    let n = series.len();
    if start == n {
        return if segments == 0 || at_most {
            0.0
        } else {
            f64::INFINITY
        };
    }
    if segments == 0 {
        return f64::INFINITY;
    }
    (start + min_length..=n)
        .map(|end| {
            cost.of_segment(series, start..end).unwrap()
                + least(cost, series, segments - 1, at_most, min_length, end)
        })
        .fold(f64::INFINITY, f64::min)
}

/// Short series with ties and constants: multiples of a half, or anything.
fn short(len: usize) -> impl Strategy<Value = Vec<f64>> {
    let ties = prop::collection::vec((0..3_i32).prop_map(|x| f64::from(x) * 0.5), len);
    let constant = (0..3_i32).prop_map(move |x| vec![f64::from(x); len]);
    let anything = prop::collection::vec(-1e3..1e3_f64, len);
    prop_oneof![4 => ties, 1 => constant, 4 => anything]
}

fn two(range: std::ops::Range<usize>) -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
    range.prop_flat_map(|len| (short(len), short(len)))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]
    #[test]
    fn nothing_is_cheaper((first, second) in two(1..11), segments in 1..11_usize, min_length in 1..4_usize, at_most: bool) {
        let series = Series::new(&[(&first, 1.8), (&second, 1.0)]).unwrap();
        for cost in COSTS {
            let mut method = Dynamic::new(cost, segments).unwrap().with_min_length(min_length);
            if at_most {
                method = method.at_most();
            }
            let least = least(cost, &series, segments, at_most, min_length, 0);
            match method.segment(&series) {
                Ok(best) => {
                    prop_assert!((best.cost - least).abs() <= 1e-9 * least.max(1.0), "{} against {least}", best.cost);
                    let count = best.segmentation.segment_count();
                    prop_assert!(count == segments || at_most && count < segments);
                    prop_assert!(best.segmentation.iter().all(|s| s.len() >= min_length));
                    prop_assert_eq!(best.segmentation.sample_count(), series.len());
                    prop_assert_eq!(best.certificate, Certificate::Optimal);
                    let total = cost.total(&series, &best.segmentation).unwrap();
                    prop_assert!((total - best.cost).abs() <= 1e-12 * total.max(1.0));
                }
                Err(error) => {
                    prop_assert!(least.is_infinite());
                    prop_assert_eq!(error, Error::TooManySegments { segments, min_length, samples: series.len() });
                }
            }
        }
    }
}

proptest! {
    #[test]
    fn every_point_of_the_path_is_optimal((first, second) in two(2..150), min_length in 1..4_usize) {
        let min_length = min_length.min(first.len());
        let series = Series::new(&[(&first, 1.8), (&second, 1.0)]).unwrap();
        for cost in COSTS {
            let path = PenaltyPath::new(cost, min_length, &series, &|_| ControlFlow::Continue(())).unwrap();
            let rising = path.points.is_sorted_by(|a, b| {
                a.segmentation.segment_count() < b.segmentation.segment_count() && a.penalty > b.penalty && a.cost >= b.cost
            });
            prop_assert!(rising);
            prop_assert_eq!(path.points[0].segmentation.segment_count(), 1);
            prop_assert!(path.knee < path.points.len());
            for point in &path.points {
                let method = Dynamic::new(cost, point.segmentation.segment_count()).unwrap().with_min_length(min_length);
                let best = method.segment(&series).unwrap().cost;
                prop_assert!((point.cost - best).abs() <= 1e-9 * best.max(1.0), "{} against {best}", point.cost);
            }
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same() {
    let wave = |i: i32| (f64::from(i) * 0.05).sin() + (f64::from(i) * 0.31).cos() * 0.3;
    let samples: Vec<f64> = (0..2000).map(wave).collect();
    let series = Series::new(&[(&samples, 1.0)]).unwrap();
    let method = Dynamic::new(Cost::ZScale, 40).unwrap();
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| method.segment(&series).unwrap())
    };
    let one = run(1);
    for threads in [2, 3, 7] {
        assert_eq!(run(threads), one);
    }
}

#[test]
fn refuses_what_cannot_be() {
    assert_eq!(
        Dynamic::new(Cost::ZScale, 0).unwrap_err(),
        Error::NoSegments
    );
    let series = Series::new(&[(&[1.0, 2.0, 4.0], 1.0)]).unwrap();
    let two_of_two = Dynamic::new(Cost::ZScale, 2).unwrap().with_min_length(2);
    let refused = Error::TooManySegments {
        segments: 2,
        min_length: 2,
        samples: 3,
    };
    assert_eq!(two_of_two.segment(&series).unwrap_err(), refused);
    assert_eq!(
        two_of_two
            .at_most()
            .segment(&series)
            .unwrap()
            .segmentation
            .boundaries(),
        [0, 3]
    );
    assert!(
        two_of_two
            .at_most()
            .with_min_length(4)
            .segment(&series)
            .is_err()
    );
    assert!(
        Dynamic::new(Cost::ZScale, usize::MAX)
            .unwrap()
            .with_min_length(usize::MAX)
            .segment(&series)
            .is_err()
    );
    let heavy = Series::new(&[(&[0.0, 9.0], f64::MAX)]).unwrap();
    for cost in COSTS {
        let method = Dynamic::new(cost, 1).unwrap();
        assert_eq!(method.segment(&heavy).unwrap_err(), Error::CostOverflow);
    }
}

#[test]
fn a_long_run_can_be_cancelled() {
    let samples: Vec<f64> = (0..3000).map(|i| f64::from(i % 17)).collect();
    let series = Series::new(&[(&samples, 1.0)]).unwrap();
    let halfway = |done| {
        assert!((0.0..=1.0).contains(&done));
        if done > 0.5 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let method = Dynamic::new(Cost::MeanDeviation, 10).unwrap();
    assert_eq!(
        method.segment_with(&series, &halfway).unwrap_err(),
        Error::Cancelled
    );
}

#[test]
fn weightless_and_constant_series_cost_nothing() {
    for series in [
        Series::new(&[(&[1.0, 5.0, 2.0], 0.0)]).unwrap(),
        Series::new(&[(&[0.3; 3], 1.0)]).unwrap(),
    ] {
        let best = Dynamic::new(Cost::ZScale, 2)
            .unwrap()
            .segment(&series)
            .unwrap();
        assert_eq!((best.cost, best.segmentation.segment_count()), (0.0, 2));
    }
}

#[test]
fn reference_vectors() {
    let Some(folder) = shared("vectors/segmentation") else {
        return;
    };
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    for path in paths.filter(|path| path.extension().is_some_and(|e| e == "json")) {
        let vector: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        for (key, at_most) in [("dp_exact_k", false), ("dp_at_most_k", true)] {
            check(&path.display().to_string(), &vector, key, at_most);
        }
    }
}

fn check(place: &str, vector: &Value, key: &str, at_most: bool) {
    let samples = |key: &str| -> Vec<f64> { serde_json::from_value(vector[key].clone()).unwrap() };
    let number = |value: &Value| usize::try_from(value.as_u64().unwrap()).unwrap();
    let params = &vector["params"];
    let weights: [f64; 2] = serde_json::from_value(params["w"].clone()).unwrap();
    let series = Series::new(&[
        (&samples("v_seg"), weights[0]),
        (&samples("a_seg"), weights[1]),
    ])
    .unwrap();
    let mut method = Dynamic::new(Cost::ZScale, number(&params["k"]))
        .unwrap()
        .with_min_length(number(&params["min_len"]));
    if at_most {
        method = method.at_most();
    }
    let expected = &vector[key];
    let Some(cost) = expected["cost"].as_f64() else {
        assert!(method.segment(&series).is_err(), "{place} {key}");
        return;
    };
    let best = method.segment(&series).unwrap();
    assert!(
        (best.cost - cost).abs() <= 1e-9 * cost.max(1.0),
        "{place} {key}: {} against {cost}",
        best.cost
    );
    if number(&expected["n_optimal"]) == 1 {
        let boundaries: Vec<usize> =
            serde_json::from_value(expected["boundaries"].clone()).unwrap();
        assert_eq!(
            best.segmentation,
            Segmentation::from_boundaries(boundaries).unwrap(),
            "{place} {key}"
        );
    }
}
