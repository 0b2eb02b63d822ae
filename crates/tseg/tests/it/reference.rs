//! Against reference vectors computed by an independent program, where that folder is present.

use serde_json::Value;
use tseg::{
    BottomUp, Cost, Metrics, Refill, Segmentation, Series, Similarity, Stop, Swab, merge_similar,
    percentile_similarity, runs,
};

use crate::shared::shared;

const TOLERANCE: f64 = 1e-12;

struct Vector {
    name: String,
    json: Value,
}

impl Vector {
    fn samples(&self, key: &str) -> Vec<f64> {
        self.json[key]
            .as_array()
            .unwrap()
            .iter()
            .map(|v| v.as_f64().unwrap())
            .collect()
    }

    fn param(&self, key: &str) -> f64 {
        self.json["params"][key].as_f64().unwrap()
    }

    fn boundaries(&self, method: &str) -> Vec<usize> {
        let boundaries = self.json[method]["boundaries"].as_array().unwrap();
        boundaries
            .iter()
            .map(|b| usize::try_from(b.as_u64().unwrap()).unwrap())
            .collect()
    }

    fn series(&self) -> Series {
        let weights = &self.json["params"]["w"];
        Series::new(&[
            (&self.samples("v_seg"), weights[0].as_f64().unwrap()),
            (&self.samples("a_seg"), weights[1].as_f64().unwrap()),
        ])
        .unwrap()
    }

    /// Boundaries equal, metrics equal up to rounding.
    fn check(&self, method: &str, segmentation: &Segmentation) {
        let place = format!("{} {method}", self.name);
        assert_eq!(
            segmentation.boundaries(),
            self.boundaries(method),
            "{place}"
        );
        let expected = &self.json[method]["metrics"];
        let metrics = Metrics::new(&self.samples("a_seg"), segmentation).unwrap();
        assert_eq!(
            metrics.segments as u64,
            expected["segments"].as_u64().unwrap(),
            "{place}"
        );
        for (key, value) in [
            ("mean_len", Some(metrics.mean_length)),
            ("std_len", Some(metrics.std_length)),
            ("+%", metrics.positive_share_pct),
            ("-%", metrics.negative_share_pct),
        ] {
            match (value, expected[key].as_f64()) {
                (Some(value), Some(expected)) => {
                    assert_close(value, expected, &format!("{place} {key}"));
                }
                (value, expected) => assert_eq!(value, expected, "{place} {key}"),
            }
        }
    }
}

fn assert_close(value: f64, expected: f64, place: &str) {
    let scale = expected.abs().max(1.0);
    assert!(
        (value - expected).abs() <= TOLERANCE * scale,
        "{place}: {value} against {expected}"
    );
}

fn vectors() -> Vec<Vector> {
    let Some(folder) = shared("vectors/segmentation") else {
        return Vec::new();
    };
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let vectors: Vec<_> = paths
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "json")
        })
        .map(|path| Vector {
            name: path.file_stem().unwrap().to_string_lossy().into_owned(),
            json: serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap(),
        })
        .collect();
    assert!(!vectors.is_empty());
    vectors
}

#[test]
fn costs() {
    for vector in vectors() {
        let series = vector.series();
        for (key, cost) in [
            ("cost_z_samples", Cost::ZScale),
            ("cost_m_samples", Cost::MeanDeviation),
        ] {
            for sample in vector.json[key].as_array().unwrap() {
                let bound = |i: usize| usize::try_from(sample[i].as_u64().unwrap()).unwrap();
                let segment = bound(0)..bound(1);
                let place = format!("{} {key} {segment:?}", vector.name);
                let value = cost.of_segment(&series, segment).unwrap();
                assert_close(value, sample[2].as_f64().unwrap(), &place);
            }
        }
        if let Some(expected) = vector.json["dp_exact_k"]["cost"].as_f64() {
            let optimum = Segmentation::from_boundaries(vector.boundaries("dp_exact_k")).unwrap();
            let total = Cost::ZScale.total(&series, &optimum).unwrap();
            assert_close(total, expected, &vector.name);
        }
    }
}

#[test]
fn heuristic() {
    for vector in vectors() {
        let (speed, accel) = (vector.samples("v_seg"), vector.samples("a"));
        let label = |(&v, &a): (&f64, &f64)| match a {
            a if a >= 0.3 => "accel",
            a if a <= -0.3 => "brake",
            _ if v > 30.0 / 3.6 => "const",
            _ => "none",
        };
        let labels: Vec<_> = speed.iter().zip(&accel).map(label).collect();
        let (segmentation, labels) = runs(&labels).unwrap();
        vector.check("heuristic", &segmentation);
        assert_eq!(
            vector.json["heuristic"]["labels"],
            serde_json::json!(labels),
            "{}",
            vector.name
        );
    }
}

#[test]
fn bottom_up() {
    for vector in vectors() {
        let method = BottomUp::new(Cost::MeanDeviation, vector.param("e_thresh")).unwrap();
        for (key, stop) in [
            ("bu_keogh", Stop::Keogh),
            ("bu_segmax", Stop::SegmentMax),
            ("bu_candmax", Stop::CandidateMax),
            ("bu_total", Stop::Total),
        ] {
            vector.check(key, &method.with_stop(stop).segment(&vector.series()));
        }
    }
}

#[test]
fn swab() {
    for vector in vectors() {
        let window = vector.param("window") as usize;
        let method = Swab::new(Cost::MeanDeviation, vector.param("e_thresh"), window).unwrap();
        for (key, refill) in [
            ("swab_keogh", Refill::Keogh),
            ("swab_literal", Refill::Literal),
            ("swab_fixed", Refill::Fixed),
        ] {
            vector.check(key, &method.with_refill(refill).segment(&vector.series()));
        }
    }
}

#[test]
fn percentile_merging() {
    for vector in vectors() {
        let accel = vector.samples("a_seg");
        let fine = Segmentation::from_boundaries(vector.boundaries("swab_keogh")).unwrap();
        let threshold = vector.param("J_pct");
        let merged = merge_similar(&accel, &fine, Similarity::Percentile { threshold }).unwrap();
        vector.check("merge_pct", &merged);

        let pairs = vector.json["pair_J"].as_array().unwrap();
        assert_eq!(pairs.len(), fine.segment_count() - 1, "{}", vector.name);
        for ((left, right), pair) in fine.iter().zip(fine.iter().skip(1)).zip(pairs) {
            let place = format!("{} pair {left:?} {right:?}", vector.name);
            let value = percentile_similarity(&accel[left], &accel[right]).unwrap();
            assert_close(value, pair[1].as_f64().unwrap(), &place);
        }
    }
}
