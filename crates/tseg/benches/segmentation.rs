//! Bottom-up and SWAB on the WLTC at 10 Hz: time per call and throughput in samples.

#![allow(clippy::unwrap_used, missing_docs)]

mod wltc;

use divan::Bencher;
use divan::counter::ItemsCount;
use tseg::{BottomUp, Cost, Refill, Series, Swab, merge_percentile};
use wltc::{series, wltc};

const THRESHOLD: f64 = 0.2;
const WINDOW: usize = 100;
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

#[divan::bench(args = [3_000, 36_000])]
fn percentile_merging(bencher: Bencher<'_, '_>, len: usize) {
    let (_, accel) = wltc(len);
    let fine = Swab::new(Cost::MeanDeviation, THRESHOLD, WINDOW)
        .unwrap()
        .segment(&series(len));
    bencher
        .counter(ItemsCount::new(len))
        .bench(|| merge_percentile(&accel, &fine, 0.64).unwrap());
}
