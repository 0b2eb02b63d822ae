//! A small case with results that an independent program found, so that these tests need no other files.

use tseg::{BottomUp, Cost, Metrics, Refill, Series, Similarity, Swab, merge_similar};

/// Speed `v = 2 t − t² / 2` from 0 to 2 m/s and back at 10 Hz, and its forward difference, 0 where below 0.4 m/s².
fn hill() -> (Vec<f64>, Vec<f64>) {
    let speed = |i: i32| {
        let t = f64::from(i) * 0.1;
        2.0 * t - 0.5 * t * t
    };
    let accel = |i: i32| {
        let a = (speed((i + 1).min(39)) - speed(i.min(38))) / 0.1;
        if a.abs() < 0.4 { 0.0 } else { a }
    };
    ((0..40).map(speed).collect(), (0..40).map(accel).collect())
}

#[test]
fn hill_is_segmented_alike() {
    let (speed, accel) = hill();
    let series = Series::new(&[(&speed, 1.8), (&accel, 1.0)]).unwrap();
    let expected = [
        0, 1, 2, 3, 4, 6, 8, 10, 12, 14, 16, 24, 28, 30, 32, 34, 36, 38, 40,
    ];
    let bottom_up = BottomUp::new(Cost::MeanDeviation, 0.2)
        .unwrap()
        .segment(&series);
    assert_eq!(bottom_up.boundaries(), expected);

    let swab = Swab::new(Cost::MeanDeviation, 0.2, 10).unwrap();
    assert_eq!(swab.segment(&series).boundaries(), expected);
    assert_eq!(
        swab.with_refill(Refill::Literal)
            .segment(&series)
            .boundaries(),
        expected
    );
    let fixed = [
        0, 1, 2, 3, 5, 7, 8, 10, 12, 14, 16, 24, 28, 30, 32, 34, 36, 38, 40,
    ];
    assert_eq!(
        swab.with_refill(Refill::Fixed)
            .segment(&series)
            .boundaries(),
        fixed
    );

    let merged = merge_similar(&accel, &bottom_up, Similarity::percentile()).unwrap();
    assert_eq!(merged.boundaries(), [0, 10, 16, 24, 34, 40]);
    assert_eq!(
        Metrics::new(&accel, &merged).unwrap().positive_share_pct,
        Some(100.0)
    );
}
