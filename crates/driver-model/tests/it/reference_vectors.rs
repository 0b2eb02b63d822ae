//! The whole chain from recorded speed to phases, against the reference vectors where they are at hand.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use drive_log::{Channel, DriveLog};
use driver_model::segmentation::{HeuristicRules, Method, Scaling, Segmented, StatisticalRules};
use serde_json::Value;
use tseg::{Refill, Scale, Similarity};

use crate::shared::shared;

fn vectors() -> Option<Vec<PathBuf>> {
    let mut files: Vec<PathBuf> = shared("vectors/segmentation")?
        .read_dir()
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "json"))
        .collect();
    files.sort();
    assert!(!files.is_empty());
    Some(files)
}

fn drive(file: &Path, params: &Value) -> DriveLog {
    let text = std::fs::read_to_string(file.with_extension("csv")).unwrap();
    let rows: Vec<[f64; 2]> = text
        .lines()
        .skip(1)
        .map(|line| {
            let (t, v) = line.split_once(',').unwrap();
            [t.trim().parse().unwrap(), v.trim().parse().unwrap()]
        })
        .collect();
    let speed: Vec<f64> = rows.iter().map(|r| r[1]).collect();
    let speed = match params["hann"].as_u64().unwrap() {
        0 => speed,
        length => drive_log::hann(&speed, usize::try_from(length).unwrap()),
    };
    let step_s =
        ((rows[rows.len() - 1][0] - rows[0][0]) / (rows.len() - 1) as f64 * 1e6).round() / 1e6;
    let channels = BTreeMap::from([(Channel::Speed, speed)]);
    DriveLog::new("vector", rows[0][0], step_s, channels).unwrap()
}

fn assert_matches(name: &str, found: &Segmented, expected: &Value) {
    let boundaries: Vec<usize> = serde_json::from_value(expected["boundaries"].clone()).unwrap();
    assert_eq!(found.segmentation.boundaries(), boundaries, "{name}");
    let metrics = &expected["metrics"];
    let close = |found: f64, key: &str| {
        let expected = metrics[key].as_f64().unwrap();
        assert!(
            (found - expected).abs() < 1e-9,
            "{name} {key}: {found} against {expected}"
        );
    };
    close(found.metrics.mean_length, "mean_len");
    close(found.metrics.std_length, "std_len");
    for (found, key) in [
        (found.metrics.positive_share_pct, "+%"),
        (found.metrics.negative_share_pct, "-%"),
    ] {
        match found {
            Some(share) => close(share, key),
            None => assert!(metrics[key].is_null(), "{name} {key}"),
        }
    }
}

#[test]
fn every_vector_is_reproduced_from_its_speed() {
    for file in vectors().into_iter().flatten() {
        let name = file.file_stem().unwrap().to_string_lossy();
        let vector: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
        let params = &vector["params"];
        let log = drive(&file, params);

        let heuristic = HeuristicRules::default().segment(&log).unwrap();
        assert_matches(
            &format!("{name} heuristic"),
            &heuristic,
            &vector["heuristic"],
        );

        let rules = StatisticalRules {
            accel_deadband_mps2: params["a_thresh"].as_f64().unwrap(),
            weights: serde_json::from_value(params["w"].clone()).unwrap(),
            scaling: Scaling::PerLog(Scale::None),
            similarity: None,
            ..StatisticalRules::default()
        };
        let threshold = params["e_thresh"].as_f64().unwrap();
        let window = usize::try_from(params["window"].as_u64().unwrap()).unwrap();
        for (key, refill) in [
            ("swab_keogh", Refill::Keogh),
            ("swab_literal", Refill::Literal),
            ("swab_fixed", Refill::Fixed),
        ] {
            let rules = StatisticalRules {
                method: Method::Swab {
                    threshold,
                    window,
                    refill,
                },
                ..rules
            };
            assert_matches(
                &format!("{name} {key}"),
                &rules.segment(&log).unwrap(),
                &vector[key],
            );
        }
        let merged = StatisticalRules {
            method: Method::Swab {
                threshold,
                window,
                refill: Refill::Keogh,
            },
            similarity: Some(Similarity::Percentile {
                threshold: params["J_pct"].as_f64().unwrap(),
            }),
            ..rules
        };
        assert_matches(
            &format!("{name} merge_pct"),
            &merged.segment(&log).unwrap(),
            &vector["merge_pct"],
        );
    }
}
