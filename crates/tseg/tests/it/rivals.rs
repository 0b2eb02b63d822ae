//! The methods once more, as plainly as they can be written, to compare with.

use std::ops::Range;

use tseg::{Cost, Refill, Series, Stop};

/// All costs from their formulas in floating point, without a grid.
pub(crate) fn cost(cost: Cost, variables: &[(&[f64], f64)], segment: Range<usize>) -> f64 {
    let n = segment.len() as f64;
    let mut total = 0.0;
    for (samples, weight) in variables {
        let x = &samples[segment.clone()];
        if x.iter().all(|v| v == &x[0]) {
            continue;
        }
        let mean = x.iter().sum::<f64>() / n;
        let absolute: f64 = x.iter().map(|v| (v - mean).abs()).sum();
        let squares: f64 = x.iter().map(|v| (v - mean).powi(2)).sum();
        total += weight
            * match cost {
                Cost::ZScale => absolute / (squares / (n - 1.0)).sqrt(),
                Cost::MeanDeviation => absolute / n,
                Cost::SquaredError => squares,
            };
    }
    total
}

/// Bottom-up that evaluates every candidate in every step.
pub(crate) fn bottom_up(
    cost: Cost,
    threshold: f64,
    series: &Series,
    range: Range<usize>,
) -> Vec<usize> {
    let mut boundaries: Vec<usize> = range.clone().chain([range.end]).collect();
    loop {
        let mut best = (f64::INFINITY, 0);
        for i in 1..boundaries.len() - 1 {
            let union = cost
                .of_segment(series, boundaries[i - 1]..boundaries[i + 1])
                .unwrap();
            if union < best.0 {
                best = (union, i);
            }
        }
        if best.0 > threshold {
            return boundaries;
        }
        boundaries.remove(best.1);
    }
}

/// All stop rules of bottom-up to the letter.
pub(crate) fn bottom_up_until(
    stop: Stop,
    cost: Cost,
    threshold: f64,
    series: &Series,
) -> Vec<usize> {
    let between = |start: usize, end: usize| cost.of_segment(series, start..end).unwrap();
    let mut boundaries: Vec<usize> = (0..=series.len()).collect();
    let mut candidates: Vec<f64> = boundaries.windows(3).map(|b| between(b[0], b[2])).collect();
    while !candidates.is_empty() {
        let mut best = 0;
        for (i, candidate) in candidates.iter().enumerate() {
            if *candidate < candidates[best] {
                best = i;
            }
        }
        let before = boundaries.clone();
        boundaries.remove(best + 1);
        let segments = || boundaries.windows(2).map(|b| between(b[0], b[1]));
        let refused = match stop {
            Stop::Keogh => candidates[best] > threshold,
            Stop::Total => segments().sum::<f64>() > threshold,
            Stop::SegmentMax | Stop::CandidateMax => false,
        };
        if refused {
            return before;
        }
        candidates = boundaries.windows(3).map(|b| between(b[0], b[2])).collect();
        let finished = match stop {
            Stop::SegmentMax => segments().any(|cost| cost > threshold),
            Stop::CandidateMax => candidates.iter().any(|cost| *cost > threshold),
            Stop::Keogh | Stop::Total => false,
        };
        if finished {
            break;
        }
    }
    boundaries
}

/// The sliding window of the thesis's text.
pub(crate) fn sliding_window(cost: Cost, threshold: f64, series: &Series) -> Vec<usize> {
    let mut boundaries = vec![0];
    while boundaries[boundaries.len() - 1] < series.len() {
        let start = boundaries[boundaries.len() - 1];
        let crossing = |end: &usize| cost.of_segment(series, start..*end + 1).unwrap() > threshold;
        let end = (start + 1..series.len()).find(crossing);
        boundaries.push(end.unwrap_or(series.len()));
    }
    boundaries
}

/// SWAB that runs bottom-up anew on every window.
pub(crate) fn swab(
    cost: Cost,
    threshold: f64,
    window: usize,
    refill: Refill,
    series: &Series,
) -> Vec<usize> {
    let n = series.len();
    let between = |range: Range<usize>| cost.of_segment(series, range).unwrap();
    let mut boundaries = vec![0];
    let (mut start, mut end) = (0, window.min(n));
    loop {
        let inner = bottom_up(cost, threshold, series, start..end);
        if end == n {
            boundaries.extend(&inner[1..]);
            return boundaries;
        }
        start = inner[1];
        boundaries.push(start);
        match refill {
            Refill::Fixed => end = (start + window).min(n),
            Refill::Literal => {
                let first = end;
                end += 1;
                while end < n && between(first..end) < threshold {
                    end += 1;
                }
            }
            Refill::Keogh => {
                let most = (start + 2 * window).min(n);
                while end < most {
                    let first = end;
                    end += 1;
                    while end < most && between(first..end + 1) <= threshold {
                        end += 1;
                    }
                    if 2 * (end - start) >= window {
                        break;
                    }
                }
            }
        }
    }
}
