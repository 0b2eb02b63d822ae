//! Merging against the reference vectors and against the rules written as plainly as possible.

use proptest::prelude::*;
use serde_json::Value;
use tseg::{
    Merging, Metrics, Segmentation, Similarity, association_similarity, merge_similar,
    percentile_similarity,
};

use crate::shared::shared;

fn vectors() -> Vec<(String, Value)> {
    let Some(folder) = shared("vectors/segmentation") else {
        return Vec::new();
    };
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    paths
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .map(|path| {
            let json = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
            (path.display().to_string(), json)
        })
        .collect()
}

fn numbers(json: &Value) -> Vec<f64> {
    serde_json::from_value(json.clone()).unwrap()
}

fn segmentation(json: &Value) -> Segmentation {
    Segmentation::from_boundaries(serde_json::from_value(json["boundaries"].clone()).unwrap())
        .unwrap()
}

#[test]
fn boundaries_and_metrics_are_the_reference_s() {
    for (name, vector) in vectors() {
        let accel = numbers(&vector["a_seg"]);
        let fine = segmentation(&vector["swab_keogh"]);
        let param = |key: &str| vector["params"][key].as_f64().unwrap();
        let (magnitude, difference) = (param("m1"), param("m2"));
        for (key, similarity) in [
            (
                "merge_mc_text",
                Similarity::Mean {
                    magnitude,
                    difference,
                },
            ),
            (
                "merge_mc_literal",
                Similarity::MeanLiteral {
                    magnitude,
                    difference,
                },
            ),
            (
                "merge_lai",
                Similarity::Association {
                    l: param("l"),
                    threshold: param("J_lai"),
                },
            ),
            (
                "merge_pct",
                Similarity::Percentile {
                    threshold: param("J_pct"),
                },
            ),
        ] {
            let merged = merge_similar(&accel, &fine, similarity).unwrap();
            assert_eq!(merged, segmentation(&vector[key]), "{name} {key}");
            let metrics = Metrics::new(&accel, &merged).unwrap();
            let expected = &vector[key]["metrics"];
            for (found, key) in [
                (Some(metrics.mean_length), "mean_len"),
                (Some(metrics.std_length), "std_len"),
                (metrics.positive_share_pct, "+%"),
                (metrics.negative_share_pct, "-%"),
            ] {
                match (found, expected[key].as_f64()) {
                    (Some(found), Some(expected)) => assert!(
                        (found - expected).abs() < 1e-12 * expected.max(1.0),
                        "{name} {key}"
                    ),
                    (found, expected) => assert_eq!(found, expected, "{name} {key}"),
                }
            }
        }
    }
}

#[test]
fn similarities_of_all_pairs_are_the_reference_s() {
    for (name, vector) in vectors() {
        let accel = numbers(&vector["a_seg"]);
        let fine = segmentation(&vector["swab_keogh"]);
        let l = vector["params"]["l"].as_f64().unwrap();
        let pairs: Vec<[f64; 2]> = serde_json::from_value(vector["pair_J"].clone()).unwrap();
        assert_eq!(pairs.len(), fine.segment_count() - 1, "{name}");
        for ((left, right), expected) in fine.iter().zip(fine.iter().skip(1)).zip(pairs) {
            let (x, y) = (&accel[left.clone()], &accel[right]);
            let found = [
                association_similarity(x, y, l).unwrap(),
                percentile_similarity(x, y).unwrap(),
            ];
            for (found, expected) in found.iter().zip(expected) {
                assert!(
                    (found - expected).abs() < 1e-12,
                    "{name} {left:?}: {found} against {expected}"
                );
            }
        }
    }
}

#[test]
fn the_defaults_are_the_thesis_s() {
    let (magnitude, difference) = (0.4, 0.55);
    assert_eq!(
        Similarity::mean(),
        Similarity::Mean {
            magnitude,
            difference
        }
    );
    assert_eq!(
        Similarity::mean_literal(),
        Similarity::MeanLiteral {
            magnitude,
            difference
        }
    );
    assert_eq!(
        Similarity::association(),
        Similarity::Association {
            l: 2.0,
            threshold: 0.005
        }
    );
    assert_eq!(
        Similarity::percentile(),
        Similarity::Percentile { threshold: 0.64 }
    );
}

/// One pass that recomputes everything over the union each time.
fn plain(
    signal: &[f64],
    fine: &Segmentation,
    similar: impl Fn(&[f64], &[f64]) -> bool,
) -> Vec<usize> {
    let mut boundaries = vec![0];
    for next in fine.iter().skip(1) {
        let start = boundaries[boundaries.len() - 1];
        if !similar(&signal[start..next.start], &signal[next.clone()]) {
            boundaries.push(next.start);
        }
    }
    boundaries.push(signal.len());
    boundaries
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

fn plain_mean(x: &[f64], y: &[f64], [x_limit, y_limit]: [f64; 2], difference: f64) -> bool {
    let (x, y) = (mean(x), mean(y));
    let sign = |v: f64| if v == 0.0 { 0.0 } else { v.signum() };
    let sides =
        (x.abs() <= x_limit && y.abs() <= y_limit) || (x.abs() >= x_limit && y.abs() >= y_limit);
    sign(x) == sign(y) && sides && (x - y).abs() <= difference
}

/// Samples on a grid of quarters, so that sums are exact and ties common, with a segmentation.
fn case() -> impl Strategy<Value = (Vec<f64>, Segmentation)> {
    prop::collection::vec((1..6_usize, -4..5_i32, prop::bool::ANY), 1..30).prop_map(|segments| {
        let (mut signal, mut boundaries) = (Vec::new(), vec![0]);
        for (len, level, varies) in segments {
            let wave = |i: usize| if varies { (i % 3) as f64 * 0.5 } else { 0.0 };
            signal.extend((0..len).map(|i| f64::from(level) * 0.25 + wave(i)));
            boundaries.push(signal.len());
        }
        (signal, Segmentation::from_boundaries(boundaries).unwrap())
    })
}

proptest! {
    #[test]
    fn merging_is_the_plain_one(case in case(), magnitude in 0.0..1.0_f64, difference in 0.0..1.0_f64, threshold in 0.0..1.0_f64) {
        let (signal, fine) = &case;
        let merged = |similarity| merge_similar(signal, fine, similarity).unwrap().boundaries().to_vec();
        prop_assert_eq!(
            merged(Similarity::Mean { magnitude, difference }),
            plain(signal, fine, |x, y| plain_mean(x, y, [magnitude; 2], difference))
        );
        prop_assert_eq!(
            merged(Similarity::MeanLiteral { magnitude, difference }),
            plain(signal, fine, |x, y| plain_mean(x, y, [magnitude, difference], difference))
        );
        prop_assert_eq!(
            merged(Similarity::Association { l: 2.0, threshold: 0.1 * threshold }),
            plain(signal, fine, |x, y| association_similarity(x, y, 2.0).unwrap() > 0.1 * threshold)
        );
        prop_assert_eq!(
            merged(Similarity::Percentile { threshold }),
            plain(signal, fine, |x, y| percentile_similarity(x, y).unwrap() > threshold)
        );
    }

    #[test]
    fn the_association_is_the_formula(x in prop::collection::vec(-2.0..2.0_f64, 2..30), y in prop::collection::vec(-2.0..2.0_f64, 2..30), l in 0.0..3.0_f64) {
        let deviation = |x: &[f64]| {
            let squares: f64 = x.iter().map(|v| (v - mean(x)).powi(2)).sum();
            (squares / (x.len() as f64 - 1.0)).sqrt()
        };
        let holds = |x: &[f64], v: f64| (v - mean(x)).abs() < l * deviation(x);
        let inside = x.iter().chain(&y).filter(|&&v| holds(&x, v) && holds(&y, v)).count();
        let (centre, radius) = (mean(&x) - mean(&y), l * (deviation(&x) - deviation(&y)));
        let expected = inside as f64 / (x.len() + y.len()) as f64 / (1.0 + centre.hypot(radius));
        let found = association_similarity(&x, &y, l).unwrap();
        prop_assert!((found - expected).abs() < 1e-12, "{found} against {expected}");
        let swapped = association_similarity(&y, &x, l).unwrap();
        prop_assert!((found - swapped).abs() < 1e-12);
    }

    #[test]
    fn one_segment_at_a_time_is_the_same(case in case()) {
        let (signal, fine) = &case;
        for similarity in [Similarity::mean(), Similarity::mean_literal(), Similarity::association(), Similarity::percentile()] {
            let mut merging = Merging::new(similarity).unwrap();
            let starts: Vec<usize> = fine
                .iter()
                .filter(|segment| !merging.joins(&signal[segment.clone()]).unwrap())
                .map(|segment| segment.start)
                .collect();
            let merged = merge_similar(signal, fine, similarity).unwrap();
            prop_assert_eq!(&starts[..], &merged.boundaries()[..merged.segment_count()]);
        }
    }
}
