//! What holds for every series.

use proptest::prelude::*;
use tseg::{
    BottomUp, Cost, Error, Metrics, Refill, Scale, Segmentation, Series, Similarity, SlidingWindow,
    Stop, Swab, merge_similar, runs,
};

use crate::rivals;

pub(crate) const COSTS: [Cost; 3] = [Cost::ZScale, Cost::MeanDeviation, Cost::SquaredError];
const STOPS: [Stop; 4] = [
    Stop::Keogh,
    Stop::SegmentMax,
    Stop::CandidateMax,
    Stop::Total,
];
pub(crate) const REFILLS: [Refill; 3] = [Refill::Keogh, Refill::Literal, Refill::Fixed];

/// A variable in pieces: few levels and constant stretches, so that ties and zero costs are common, or a random walk.
fn variable(len: usize) -> impl Strategy<Value = Vec<f64>> {
    let levels = prop::collection::vec((0..4_i32, 1..8_usize), len).prop_map(|pieces| {
        let spread = |(level, run): (i32, usize)| std::iter::repeat_n(f64::from(level) * 0.1, run);
        pieces.into_iter().flat_map(spread).collect::<Vec<_>>()
    });
    let walk = prop::collection::vec(-0.3..0.3_f64, len).prop_map(|steps| {
        let walked = steps.into_iter().scan(0.0, |x, step| {
            *x += step;
            Some(*x)
        });
        walked.collect::<Vec<_>>()
    });
    prop_oneof![levels, walk].prop_map(move |mut samples| {
        samples.truncate(len);
        samples
    })
}

pub(crate) fn variables(
    len: std::ops::Range<usize>,
) -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
    len.prop_flat_map(|len| (variable(len), variable(len)))
}

/// Around the costs of pairs, of segments, and of everything.
pub(crate) fn thresholds() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), 0.0..0.5_f64, 0.0..3.0_f64, 0.0..300.0_f64]
}

pub(crate) fn series((x, y): &(Vec<f64>, Vec<f64>)) -> Series {
    Series::new(&[(x, 1.8), (y, 1.0)]).unwrap()
}

proptest! {
    #[test]
    fn costs_are_those_of_the_formulas(data in variables(1..60), bounds in (0.0..1.0, 0.0..1.0)) {
        let n = data.0.len();
        let start = (bounds.0 * n as f64) as usize;
        let end = start + 1 + (bounds.1 * (n - start - 1) as f64) as usize;
        let grid = series(&data);
        for cost in COSTS {
            let exact = cost.of_segment(&grid, start..end).unwrap();
            let naive = rivals::cost(cost, &[(&data.0, 1.8), (&data.1, 1.0)], start..end);
            prop_assert!((exact - naive).abs() <= 1e-7 * naive.max(1.0), "{cost:?}: {exact} against {naive}");
        }
    }

    #[test]
    fn bottom_up_is_the_plain_one(data in variables(1..80), threshold in 0.0..1.5_f64) {
        let series = series(&data);
        for cost in COSTS {
            let fast = BottomUp::new(cost, threshold).unwrap().segment(&series);
            let plain = rivals::bottom_up(cost, threshold, &series, 0..series.len());
            prop_assert_eq!(fast.boundaries(), plain);
        }
    }

    #[test]
    fn every_stop_rule_is_the_plain_one(data in variables(1..60), threshold in thresholds()) {
        let series = series(&data);
        for cost in COSTS {
            for stop in STOPS {
                let fast = BottomUp::new(cost, threshold).unwrap().with_stop(stop).segment(&series);
                let plain = rivals::bottom_up_until(stop, cost, threshold, &series);
                prop_assert_eq!(fast.boundaries(), plain, "{:?} {:?}", cost, stop);
            }
        }
    }

    #[test]
    fn swab_is_the_plain_one(data in variables(1..120), threshold in 0.0..1.5_f64, window in 1..40_usize) {
        let series = series(&data);
        for cost in COSTS {
            for refill in REFILLS {
                let fast = Swab::new(cost, threshold, window).unwrap().with_refill(refill).segment(&series);
                let plain = rivals::swab(cost, threshold, window, refill, &series);
                prop_assert_eq!(fast.boundaries(), plain);
            }
        }
    }

    #[test]
    fn sliding_window_is_the_plain_one(data in variables(1..120), threshold in thresholds()) {
        let series = series(&data);
        for cost in COSTS {
            let fast = SlidingWindow::new(cost, threshold).unwrap().segment(&series);
            prop_assert_eq!(fast.boundaries(), rivals::sliding_window(cost, threshold, &series));
        }
    }

    #[test]
    fn swab_in_one_window_is_bottom_up(data in variables(1..100), threshold in 0.0..1.0_f64, more in 0..3_usize) {
        let series = series(&data);
        for cost in COSTS {
            let bottom_up = BottomUp::new(cost, threshold).unwrap().segment(&series);
            for refill in REFILLS {
                let swab = Swab::new(cost, threshold, series.len() + more).unwrap().with_refill(refill);
                prop_assert_eq!(swab.segment(&series), bottom_up.clone());
            }
        }
    }

    #[test]
    fn every_method_gives_a_partition(data in variables(1..100), threshold in 0.0..1.0_f64, window in 1..200_usize) {
        let series = series(&data);
        let (labelled, labels) = runs(&data.0).unwrap();
        prop_assert_eq!(labels.len(), labelled.segment_count());
        for segmentation in [
            BottomUp::new(Cost::MeanDeviation, threshold).unwrap().segment(&series),
            Swab::new(Cost::MeanDeviation, threshold, window).unwrap().segment(&series),
            SlidingWindow::new(Cost::MeanDeviation, threshold).unwrap().segment(&series),
            labelled,
        ] {
            prop_assert_eq!(segmentation.sample_count(), series.len());
            let again = Segmentation::from_boundaries(segmentation.boundaries().to_vec());
            prop_assert_eq!(again, Ok(segmentation));
        }
    }

    #[test]
    fn merging_adds_no_boundary(data in variables(1..100), threshold in 0.0..1.0_f64) {
        let fine = BottomUp::new(Cost::MeanDeviation, 0.1).unwrap().segment(&series(&data));
        let coarse = merge_similar(&data.1, &fine, Similarity::Percentile { threshold }).unwrap();
        prop_assert_eq!(coarse.sample_count(), fine.sample_count());
        prop_assert!(coarse.boundaries().iter().all(|b| fine.boundaries().contains(b)));
    }

    #[test]
    fn shares_are_at_least_half(data in variables(1..100), threshold in 0.0..1.0_f64) {
        let segmentation = BottomUp::new(Cost::MeanDeviation, threshold).unwrap().segment(&series(&data));
        let metrics = Metrics::new(&data.1, &segmentation).unwrap();
        for share in [metrics.positive_share_pct, metrics.negative_share_pct].into_iter().flatten() {
            prop_assert!((50.0..=100.0).contains(&share));
        }
    }

    #[test]
    fn scaling_keeps_the_order(data in variables(1..50)) {
        for scale in [Scale::None, Scale::ZScore, Scale::Range, Scale::Max] {
            let scaled = scale.scaled(&data.0);
            prop_assert!(scaled.iter().all(|x| x.is_finite()));
            for (before, after) in data.0.windows(2).zip(scaled.windows(2)) {
                prop_assert!(before[0] > before[1] || after[0] <= after[1]);
            }
        }
    }
}

#[test]
fn one_and_two_samples() {
    let one = Series::new(&[(&[3.0], 1.0)]).unwrap();
    let two = Series::new(&[(&[3.0, 9.0], 1.0)]).unwrap();
    for cost in COSTS {
        for (threshold, boundaries) in [(0.0, &[0, 1, 2][..]), (18.0, &[0, 2])] {
            assert_eq!(
                BottomUp::new(cost, threshold)
                    .unwrap()
                    .segment(&one)
                    .boundaries(),
                [0, 1]
            );
            assert_eq!(
                BottomUp::new(cost, threshold)
                    .unwrap()
                    .segment(&two)
                    .boundaries(),
                boundaries
            );
            for refill in REFILLS {
                let swab = Swab::new(cost, threshold, 2).unwrap().with_refill(refill);
                assert_eq!(swab.segment(&one).boundaries(), [0, 1]);
                assert_eq!(swab.segment(&two).boundaries(), boundaries);
            }
        }
    }
}

#[test]
fn a_constant_is_one_segment() {
    let series = Series::new(&[(&[0.1; 500], 1.8), (&[-7.3; 500], 1.0)]).unwrap();
    for cost in COSTS {
        assert_eq!(
            BottomUp::new(cost, 0.0)
                .unwrap()
                .segment(&series)
                .boundaries(),
            [0, 500]
        );
    }
}

/// Longer than a block, so that blocks are joined: flat stretches, noise below the threshold, steps.
#[test]
fn blocks_join_to_the_plain_result() {
    let mut state = 1_u64;
    let mut random = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 40) as f64 / 16_777_216.0
    };
    for (noise, level, period) in [
        (0.0, 1.0, 700),
        (0.3, 0.0, 1),
        (0.3, 0.5, 600),
        (1.0, 1.0, 9),
    ] {
        let sample = |i: usize| level * (i / period) as f64 + noise * random();
        let samples: Vec<f64> = (0..2500).map(sample).collect();
        let series = Series::new(&[(&samples, 1.0)]).unwrap();
        for threshold in [0.05, 0.12, 0.3] {
            let method = BottomUp::new(Cost::MeanDeviation, threshold).unwrap();
            let plain =
                rivals::bottom_up_until(Stop::Keogh, Cost::MeanDeviation, threshold, &series);
            assert_eq!(method.segment(&series).boundaries(), plain);
        }
    }
}

#[test]
fn huge_parameters_do_no_harm() {
    let samples: Vec<f64> = (0..50).map(|i| f64::from(i % 7)).collect();
    let series = Series::new(&[(&samples, f64::MAX)]).unwrap();
    for cost in COSTS {
        for stop in STOPS {
            let method = BottomUp::new(cost, f64::MAX).unwrap().with_stop(stop);
            assert_eq!(method.segment(&series).sample_count(), 50);
        }
        for refill in REFILLS {
            let swab = Swab::new(cost, f64::MAX, usize::MAX)
                .unwrap()
                .with_refill(refill);
            assert_eq!(swab.segment(&series).sample_count(), 50);
        }
    }
}

#[test]
fn not_a_number_is_refused_with_its_place() {
    let place = |variable, sample| move |error: &Error| matches!(error, Error::NotFinite { variable: v, sample: s, .. } if (*v, *s) == (variable, sample));
    let signal = [1.0, f64::NAN];
    let halves = Segmentation::from_boundaries(vec![0, 1, 2]).unwrap();
    assert!(Series::new(&[(&[0.0, 0.0], 1.0), (&signal, 1.0)]).is_err_and(|e| place(1, 1)(&e)));
    assert!(
        merge_similar(&signal, &halves, Similarity::percentile()).is_err_and(|e| place(0, 1)(&e))
    );
    assert!(Metrics::new(&signal, &halves).is_err_and(|e| place(0, 1)(&e)));
}
