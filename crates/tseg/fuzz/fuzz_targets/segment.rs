//! Any series with any weights and parameters through every method. Nothing may panic, every result is a partition, a
//! stream gives what the whole series gives, and the optimum costs no more than what other methods find.
#![no_main]

use std::ops::ControlFlow;

use libfuzzer_sys::fuzz_target;
use tseg::{
    BottomUp, Cost, Dynamic, Error, Metrics, PenaltyPath, Refill, Scale, Segmentation, Series,
    Similarity, SlidingWindow, Stop, Swab, merge_similar,
};

const LONGEST: usize = 300;

/// Reads values from the fuzzer's bytes; zeros when they run out.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn array<const N: usize>(&mut self) -> [u8; N] {
        let mut array = [0; N];
        let count = N.min(self.0.len());
        let (taken, rest) = self.0.split_at(count);
        array[..count].copy_from_slice(taken);
        self.0 = rest;
        array
    }

    fn byte(&mut self) -> u8 {
        self.array::<1>()[0]
    }

    fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.byte() as usize % of.len()]
    }

    /// Mostly small and round, sometimes anything at all.
    fn number(&mut self) -> f64 {
        match self.byte() {
            255 => f64::from_bits(u64::from_le_bytes(self.array())),
            small => f64::from(small as i8) / 4.0,
        }
    }

    fn count(&mut self) -> usize {
        match self.byte() {
            255 => usize::MAX,
            small => small as usize,
        }
    }

    fn samples(&mut self, len: usize) -> Vec<f64> {
        (0..len).map(|_| self.number()).collect()
    }
}

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Bytes(bytes);
    let cost = bytes.pick(&[Cost::ZScale, Cost::MeanDeviation, Cost::SquaredError]);
    let scale = bytes.pick(&[Scale::None, Scale::ZScore, Scale::Range, Scale::Max]);
    let (threshold, window) = (bytes.number(), bytes.count());
    let (segments, min_length) = (bytes.count(), bytes.count());
    let similarity = similarity(&mut bytes);
    let weights: Vec<f64> = (0..bytes.byte() % 4)
        .map(|_| bytes.number().abs())
        .collect();
    let len = (bytes.0.len() / weights.len().max(1)).min(LONGEST);
    let variables: Vec<Vec<f64>> = weights
        .iter()
        .map(|_| scale.scaled(&bytes.samples(len)))
        .collect();
    let weighted: Vec<(&[f64], f64)> = variables.iter().map(Vec::as_slice).zip(weights).collect();
    let Ok(series) = Series::new(&weighted) else {
        return;
    };
    let mut found = dynamic(&series, cost, segments, min_length);
    for stop in [
        Stop::Keogh,
        Stop::SegmentMax,
        Stop::CandidateMax,
        Stop::Total,
    ] {
        let method = BottomUp::new(cost, threshold).map(|method| method.with_stop(stop));
        found.extend(method.map(|method| method.segment(&series)));
    }
    for refill in [Refill::Keogh, Refill::Literal, Refill::Fixed] {
        if let Ok(swab) = Swab::new(cost, threshold, window) {
            found.push(swab_both_ways(swab.with_refill(refill), &series, &weighted));
        }
    }
    found.extend(SlidingWindow::new(cost, threshold).map(|method| method.segment(&series)));
    for segmentation in &found {
        check(&series, cost, segmentation, &variables[0], similarity);
    }
});

fn similarity(bytes: &mut Bytes<'_>) -> Similarity {
    let (first, second) = (bytes.number(), bytes.number());
    match bytes.byte() % 4 {
        0 => Similarity::Mean {
            magnitude: first,
            difference: second,
        },
        1 => Similarity::MeanLiteral {
            magnitude: first,
            difference: second,
        },
        2 => Similarity::Association {
            l: first,
            threshold: second,
        },
        _ => Similarity::Percentile { threshold: first },
    }
}

/// Optima, none of them dearer than those of the path with as many segments.
fn dynamic(series: &Series, cost: Cost, segments: usize, min_length: usize) -> Vec<Segmentation> {
    let on = |_| ControlFlow::Continue(());
    let mut found = Vec::new();
    if let Ok(method) = Dynamic::new(cost, segments) {
        let method = method.with_min_length(min_length);
        for method in [method, method.at_most()] {
            found.extend(method.segment(series).map(|best| best.segmentation));
        }
    }
    if let Ok(path) = PenaltyPath::new(cost, min_length, series, &on) {
        let point = path.at_knee();
        let method =
            Dynamic::new(cost, point.segmentation.segment_count()).expect("at least one segment");
        let best = method
            .with_min_length(min_length)
            .segment(series)
            .expect("as many fit");
        let allowed = 1e-9 * point.cost.abs().max(f64::MIN_POSITIVE);
        assert!(
            (best.cost - point.cost).abs() <= allowed,
            "{} against {}",
            best.cost,
            point.cost
        );
        found.push(point.segmentation.clone());
    }
    found
}

fn swab_both_ways(swab: Swab, series: &Series, weighted: &[(&[f64], f64)]) -> Segmentation {
    let whole = swab.segment(series);
    let weights: Vec<f64> = weighted.iter().map(|(_, weight)| *weight).collect();
    let mut stream = swab
        .stream(&weights)
        .expect("the series took these weights");
    let mut ends = vec![0];
    for i in 0..series.len() {
        let sample: Vec<f64> = weighted.iter().map(|(samples, _)| samples[i]).collect();
        let closed = stream.push(&sample).expect("the series took this sample");
        ends.extend(closed.map(|segment| segment.end));
    }
    ends.extend(stream.finish().map(|segment| segment.end));
    assert_eq!(ends, whole.boundaries());
    whole
}

fn check(
    series: &Series,
    cost: Cost,
    segmentation: &Segmentation,
    signal: &[f64],
    similarity: Similarity,
) {
    assert_eq!(segmentation.sample_count(), series.len());
    assert_eq!(
        Segmentation::from_boundaries(segmentation.boundaries().to_vec()).as_ref(),
        Ok(segmentation)
    );
    cost.total(series, segmentation).expect("of this series");
    let _ = Metrics::new(signal, segmentation).expect("finite, of this length");
    match merge_similar(signal, segmentation, similarity) {
        Ok(merged) => assert!(
            merged
                .boundaries()
                .iter()
                .all(|b| segmentation.boundaries().contains(b))
        ),
        Err(error) => assert!(!matches!(
            error,
            Error::Length { .. } | Error::NotFinite { .. }
        )),
    }
}
