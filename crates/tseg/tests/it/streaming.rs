//! SWAB one sample at a time is SWAB on the whole series.

use std::ops::Range;

use proptest::prelude::*;
use tseg::{Cost, Error, Refill, Scale, Series, Swab, SwabStream};

use crate::laws::{COSTS, REFILLS, series, thresholds, variables};
use crate::shared::shared;

/// Segment ends from a stream; each segment starts where the one before ended.
fn streamed(swab: Swab, weights: &[f64], samples: impl Iterator<Item = Vec<f64>>) -> Vec<usize> {
    let mut stream = swab.stream(weights).unwrap();
    let mut boundaries = vec![0];
    let mut take = |segment: Range<usize>, seen: usize| {
        assert_eq!(segment.start, boundaries[boundaries.len() - 1]);
        assert!(segment.end <= seen);
        boundaries.push(segment.end);
    };
    for (i, sample) in samples.enumerate() {
        if let Some(segment) = stream.push(&sample).unwrap() {
            take(segment, i + 1);
        }
    }
    let seen = stream.sample_count();
    stream.finish().for_each(|segment| take(segment, seen));
    boundaries
}

fn pairs<'a>(x: &'a [f64], y: &'a [f64]) -> impl Iterator<Item = Vec<f64>> + 'a {
    x.iter().zip(y).map(|(&x, &y)| vec![x, y])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn streaming_is_the_whole_series(
        data in prop_oneof![variables(1..5), variables(1..120), variables(200..400)],
        threshold in thresholds(),
        window in prop_oneof![Just(1_usize), 1..10_usize, 1..60_usize],
    ) {
        let whole = series(&data);
        for cost in COSTS {
            for refill in REFILLS {
                let swab = Swab::new(cost, threshold, window).unwrap().with_refill(refill);
                let boundaries = streamed(swab, &[1.8, 1.0], pairs(&data.0, &data.1));
                let expected = swab.segment(&whole);
                prop_assert_eq!(expected.boundaries(), boundaries, "{:?} {:?}", cost, refill);
            }
        }
    }
}

#[test]
fn a_segment_comes_as_soon_as_the_window_is_full() {
    let swab = Swab::new(Cost::MeanDeviation, 0.2, 4)
        .unwrap()
        .with_refill(Refill::Fixed);
    let mut stream = swab.stream(&[1.0]).unwrap();
    let given: Vec<_> = [0.0, 0.0, 5.0, 5.0, 5.0, 9.0, 9.0]
        .map(|x| stream.push(&[x]).unwrap())
        .into();
    let expected = [None, None, None, Some(0..2), None, Some(2..5), None];
    assert_eq!(given, expected);
    assert_eq!(stream.finish().collect::<Vec<_>>(), [5..7]);
}

#[test]
fn nothing_gives_nothing() {
    let swab = Swab::new(Cost::ZScale, 0.2, 4).unwrap();
    assert_eq!(swab.stream(&[1.0]).unwrap().finish().count(), 0);
    assert_eq!(swab.stream(&[]).unwrap_err(), Error::NoVariables);
    assert!(matches!(
        swab.stream(&[1.0, -1.0]),
        Err(Error::Weight { variable: 1, .. })
    ));
}

#[test]
fn a_refused_sample_leaves_no_trace() {
    let swab = Swab::new(Cost::MeanDeviation, 0.2, 8).unwrap();
    let samples: Vec<f64> = (0..300).map(|i| f64::from(i * i % 7)).collect();
    let mut stream: SwabStream = swab.stream(&[1.0, 0.0]).unwrap();
    let mut boundaries = vec![0];
    for (i, &x) in samples.iter().enumerate() {
        let refused = stream.push(&[x, f64::NAN]).unwrap_err();
        assert!(matches!(refused, Error::NotFinite { variable: 1, sample, .. } if sample == i));
        let refused = stream.push(&[6e8, 0.0]).unwrap_err();
        assert!(
            matches!(refused, Error::TooLarge { variable: 0, sample, value: 6e8, .. } if sample == i)
        );
        let refused = stream.push(&[x]).unwrap_err();
        assert_eq!(
            refused,
            Error::Variables {
                found: 1,
                expected: 2
            }
        );
        boundaries.extend(stream.push(&[x, 1e300]).unwrap().map(|segment| segment.end));
    }
    boundaries.extend(stream.finish().map(|segment| segment.end));
    let whole = swab.segment(&Series::new(&[(&samples, 1.0)]).unwrap());
    assert_eq!(whole.boundaries(), boundaries);
}

/// The stream has no end of its own: what has left the window does not count towards the limit on sums.
#[test]
fn large_samples_pass_for_ever() {
    for (refill, largest) in [(Refill::Keogh, 4e6), (Refill::Fixed, 7e6)] {
        let swab = Swab::new(Cost::MeanDeviation, 0.2, 10)
            .unwrap()
            .with_refill(refill);
        let mut stream = swab.stream(&[1.0]).unwrap();
        for i in 0..50_000 {
            assert!(stream.push(&[largest - f64::from(i % 3)]).is_ok());
        }
    }
}

/// The window of the literal refill grows for as long as nothing changes, until sums may overflow.
#[test]
fn an_endless_window_is_refused_in_time() {
    let swab = Swab::new(Cost::MeanDeviation, 0.2, 4)
        .unwrap()
        .with_refill(Refill::Literal);
    let mut stream = swab.stream(&[1.0]).unwrap();
    let refused = (0..5_000).find_map(|_| stream.push(&[2e5]).err());
    assert!(
        matches!(refused, Some(Error::TooLarge { value: 2e5, .. })),
        "{refused:?}"
    );
    assert!(stream.sample_count() > 2_600);
    assert_eq!(
        stream.finish().last().map(|segment| segment.end),
        Some(2_684)
    );
}

/// Recorded drives, where they are present: speed in m/s and dead-banded acceleration, as recorded and z-scored.
#[test]
fn recorded_drives() {
    let Some(folder) = shared("data/bmw-i3") else {
        return;
    };
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let (speed, accel) = drive(&std::fs::read(&path).unwrap());
        for scale in [Scale::None, Scale::ZScore] {
            let (speed, accel) = (scale.scaled(&speed), scale.scaled(&accel));
            let whole = Series::new(&[(&speed, 1.8), (&accel, 1.0)]).unwrap();
            for refill in REFILLS {
                let swab = Swab::new(Cost::MeanDeviation, 0.2, 100)
                    .unwrap()
                    .with_refill(refill);
                let boundaries = streamed(swab, &[1.8, 1.0], pairs(&speed, &accel));
                assert_eq!(
                    swab.segment(&whole).boundaries(),
                    boundaries,
                    "{} {refill:?}",
                    path.display()
                );
            }
        }
    }
}

/// The first two columns, time in s and speed in km/h; rows without both are skipped, time that stands still too.
fn drive(bytes: &[u8]) -> (Vec<f64>, Vec<f64>) {
    let text: String = bytes.iter().map(|&byte| char::from(byte)).collect();
    let mut rows: Vec<(f64, f64)> = Vec::new();
    for line in text.lines() {
        let mut cells = line.split(';').map(|cell| cell.trim().parse::<f64>());
        if let (Some(Ok(time)), Some(Ok(speed))) = (cells.next(), cells.next())
            && rows.last().is_none_or(|&(last, _)| last < time)
        {
            rows.push((time, speed / 3.6));
        }
    }
    assert!(rows.len() > 1_000);
    let slope = |pair: &[(f64, f64)]| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0);
    let dead_band = |a: f64| if a.abs() < 0.4 { 0.0 } else { a };
    let mut accel: Vec<f64> = rows.windows(2).map(|pair| dead_band(slope(pair))).collect();
    accel.push(accel[accel.len() - 1]);
    (rows.iter().map(|row| row.1).collect(), accel)
}
