//! Bottom-up and SWAB on the WLTC at 10 Hz: time per call and throughput in samples.

#![allow(clippy::unwrap_used, missing_docs)]

mod wltc;

use std::num::NonZero;

use divan::Bencher;
use divan::counter::ItemsCount;
use pelt::{Pelt, SegmentCostFunction};
use tseg::{BottomUp, Cost, Refill, Series, Similarity, SlidingWindow, Swab, merge_similar};
use wltc::{series, wltc};

const THRESHOLD: f64 = 0.2;
const WINDOW: usize = 100;
const PELT_PENALTY: f64 = 2.0;
const LENGTHS: [usize; 3] = [3_000, 36_000, 1_000_000];

fn main() {
    divan::main();
}

#[divan::bench(args = LENGTHS, max_time = 2)]
fn new_series(bencher: Bencher<'_, '_>, len: usize) {
    let (speed, accel) = wltc(len);
    bencher
        .counter(ItemsCount::new(len))
        .bench(|| Series::new(&[(&speed, 1.8), (&accel, 1.0)]).unwrap());
}

#[divan::bench(args = LENGTHS, max_time = 5)]
fn bottom_up(bencher: Bencher<'_, '_>, len: usize) {
    let series = series(len);
    let method = BottomUp::new(Cost::MeanDeviation, THRESHOLD).unwrap();
    bencher
        .counter(ItemsCount::new(len))
        .bench(|| method.segment(&series));
}

#[divan::bench(args = LENGTHS, max_time = 5)]
fn sliding_window(bencher: Bencher<'_, '_>, len: usize) {
    let series = series(len);
    let method = SlidingWindow::new(Cost::MeanDeviation, THRESHOLD).unwrap();
    bencher
        .counter(ItemsCount::new(len))
        .bench(|| method.segment(&series));
}

#[divan::bench(args = [Refill::Keogh, Refill::Literal, Refill::Fixed], consts = LENGTHS, max_time = 5)]
fn swab<const LEN: usize>(bencher: Bencher<'_, '_>, refill: Refill) {
    let series = series(LEN);
    let method = Swab::new(Cost::MeanDeviation, THRESHOLD, WINDOW)
        .unwrap()
        .with_refill(refill);
    bencher
        .counter(ItemsCount::new(LEN))
        .bench(|| method.segment(&series));
}

/// The nearest that crates.io has to offer, `pelt`: the optimum of the sum of absolute deviations from the median, or of
/// squares, plus a penalty per segment, by dynamic programming with pruning. Another problem than bottom-up's: the
/// penalty stands in for the threshold and is chosen so that there are about as many segments. Version 0.3.4 fails with
/// single samples as segments or as steps, so it has every other boundary to choose from.
#[divan::bench(args = [SegmentCostFunction::L1, SegmentCostFunction::L2], consts = [3_000, 36_000], max_time = 5)]
fn rival_pelt<const LEN: usize>(bencher: Bencher<'_, '_>, cost: SegmentCostFunction) {
    let (speed, accel) = wltc(LEN);
    let samples: Vec<[f64; 2]> = speed
        .iter()
        .zip(&accel)
        .map(|(&v, &a)| [1.8 * v, a])
        .collect();
    let pelt = Pelt::new()
        .with_jump(NonZero::new(2).unwrap())
        .with_minimum_segment_length(NonZero::new(2).unwrap())
        .with_segment_cost_function(cost);
    bencher
        .counter(ItemsCount::new(LEN))
        .bench(|| pelt.predict(&samples[..], PELT_PENALTY).unwrap());
}

#[divan::bench(args = [3_000, 36_000])]
fn percentile_merging(bencher: Bencher<'_, '_>, len: usize) {
    let (_, accel) = wltc(len);
    let fine = Swab::new(Cost::MeanDeviation, THRESHOLD, WINDOW)
        .unwrap()
        .segment(&series(len));
    bencher
        .counter(ItemsCount::new(len))
        .bench(|| merge_similar(&accel, &fine, Similarity::percentile()).unwrap());
}
