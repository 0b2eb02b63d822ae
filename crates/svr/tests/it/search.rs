//! The search over grids and the folds it is given.

use proptest::prelude::*;
use svr::{
    Candidate, Error, Fold, Grid, Kernel, Response, Samples, Settings, blocked_folds,
    grouped_folds, hold_out, search,
};

use crate::problem::{Random, fit_to, noisy, penalty, precise, predict};

/// Many predictors, few of which count, and much noise.
fn noisy_linear(n: usize, seed: u64) -> (Vec<f64>, Vec<f64>) {
    let mut random = Random(seed);
    let x: Vec<f64> = (0..n * 20).map(|_| random.normal()).collect();
    let y = x
        .chunks(20)
        .map(|row| row[0] - 0.5 * row[1] + 2.0 * random.normal())
        .collect();
    (x, y)
}

fn found(
    settings: &Settings,
    x: &[f64],
    d: usize,
    y: &[f64],
    grid: &Grid,
    folds: &[Fold],
) -> Result<Vec<Candidate>, Error> {
    search(
        &Samples::new(x, d).expect("samples"),
        &Response::new(y).expect("responses"),
        settings,
        grid,
        folds,
    )
}

#[test]
fn the_better_box_constraint_is_found() {
    let (x, y) = noisy_linear(80, 3);
    let grid = Grid {
        tube_epsilons: vec![Some(0.1)],
        box_constraints: vec![Some(1e-5), Some(0.01), Some(1e3)],
        ..Grid::default()
    };
    let settings = precise(Kernel::Linear, 1e-8);
    let folds = blocked_folds(80, 5, 0).expect("folds");
    let candidates = found(&settings, &x, 20, &y, &grid, &folds).expect("candidates");
    assert_eq!(candidates.len(), 3);
    assert!(candidates.iter().all(|candidate| candidate.optimal == 5));
    assert!(candidates.is_sorted_by(|a, b| a.rmse <= b.rmse));

    // The order is that of the errors on ten thousand samples more.
    let (elsewhere, truth) = noisy_linear(10_000, 4);
    let error = |c: f64| {
        let fit = fit_to(&x, 20, &y, &settings, &penalty(c, 0.1));
        let square = predict(&fit.model, &elsewhere)
            .iter()
            .zip(&truth)
            .map(|(p, y)| (p - y) * (p - y))
            .sum::<f64>();
        (square / 10_000.0).sqrt()
    };
    let errors: Vec<f64> = candidates
        .iter()
        .map(|candidate| error(candidate.penalty.box_constraint.expect("a constraint")))
        .collect();
    assert_eq!(candidates[0].penalty, penalty(0.01, 0.1));
    assert!(errors[0] < errors[1] && errors[0] < errors[2], "{errors:?}");
    assert!((candidates[0].rmse / errors[0] - 1.0).abs() < 0.2);
}

#[test]
fn a_candidate_has_the_error_of_fits_by_hand() {
    let (x, y) = noisy(60, 2, 0.3, 9);
    let grid = Grid {
        kernel_scales: vec![None, Some(3.0)],
        tube_epsilons: vec![Some(0.1), Some(0.3)],
        box_constraints: vec![Some(0.1), Some(1.0), Some(10.0)],
    };
    let folds = blocked_folds(60, 4, 2).expect("folds");
    for kernel in [Kernel::Linear, Kernel::Rbf] {
        let settings = precise(kernel, 1e-9);
        let candidates = found(&settings, &x, 2, &y, &grid, &folds).expect("candidates");
        assert_eq!(candidates.len(), 12);
        for candidate in candidates {
            let mut square = 0.0;
            for fold in &folds {
                let rows = |of: &[usize]| {
                    of.iter()
                        .flat_map(|i| x[2 * i..2 * i + 2].to_vec())
                        .collect::<Vec<f64>>()
                };
                let values = |of: &[usize]| of.iter().map(|&i| y[i]).collect::<Vec<f64>>();
                let settings = Settings {
                    kernel_scale: candidate.kernel_scale,
                    ..settings.clone()
                };
                let fit = fit_to(
                    &rows(&fold.train),
                    2,
                    &values(&fold.train),
                    &settings,
                    &candidate.penalty,
                );
                let predicted = predict(&fit.model, &rows(&fold.test));
                square += predicted
                    .iter()
                    .zip(values(&fold.test))
                    .map(|(p, y)| (p - y) * (p - y))
                    .sum::<f64>();
            }
            assert!(
                (candidate.rmse - (square / 60.0).sqrt()).abs() < 1e-6,
                "{candidate:?}"
            );
        }
    }
}

#[test]
fn one_thread_and_two_find_the_same() {
    let (x, y) = noisy(120, 3, 0.3, 10);
    let grid = Grid {
        kernel_scales: vec![None, Some(0.7), Some(4.0)],
        tube_epsilons: vec![None, Some(0.05)],
        box_constraints: vec![Some(0.1), Some(1.0), Some(10.0)],
    };
    let folds = blocked_folds(120, 5, 1).expect("folds");
    for kernel in [Kernel::Linear, Kernel::Quadratic, Kernel::Rbf] {
        let settings = Settings {
            kernel,
            ..Settings::default()
        };
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("threads");
            pool.install(|| found(&settings, &x, 3, &y, &grid, &folds).expect("candidates"))
        };
        assert_eq!(with(1), with(2));
    }
}

#[test]
fn a_search_without_anything_to_search_is_refused() {
    let (x, y) = noisy(20, 2, 0.3, 9);
    let folds = blocked_folds(20, 4, 0).expect("folds");
    let settings = Settings::default();
    let empty = Grid {
        box_constraints: vec![],
        ..Grid::default()
    };
    let setting = |result| matches!(result, Err(Error::Setting { .. }));
    assert!(setting(found(&settings, &x, 2, &y, &empty, &folds)));
    assert!(setting(found(&settings, &x, 2, &y, &Grid::default(), &[])));
    let bad = Grid {
        box_constraints: vec![Some(1.0), Some(-1.0)],
        ..Grid::default()
    };
    assert!(setting(found(&settings, &x, 2, &y, &bad, &folds)));

    let none = Fold {
        train: (0..20).collect(),
        test: vec![],
    };
    assert_eq!(
        found(&settings, &x, 2, &y, &Grid::default(), &[none]),
        Err(Error::NoSamples)
    );
    let none = Fold {
        train: vec![],
        test: vec![1],
    };
    assert_eq!(
        found(&settings, &x, 2, &y, &Grid::default(), &[none]),
        Err(Error::NoSamples)
    );
}

#[test]
fn responses_and_folds_of_another_size_are_refused() {
    let (x, y) = noisy(20, 2, 0.3, 9);
    let folds = blocked_folds(20, 4, 0).expect("folds");
    let settings = Settings::default();
    for count in [19, 1] {
        assert_eq!(
            found(&settings, &x, 2, &y[..count], &Grid::default(), &folds),
            Err(Error::Length {
                what: "responses",
                found: count,
                expected: 20
            })
        );
    }
    let fold = Fold {
        train: vec![0, 1, 2],
        test: vec![20],
    };
    assert!(found(&settings, &x, 2, &y, &Grid::default(), &[fold]).is_err());
    let fold = Fold {
        train: vec![0, 1, 99],
        test: vec![2],
    };
    assert!(found(&settings, &x, 2, &y, &Grid::default(), &[fold]).is_err());
}

#[test]
fn predictions_that_overflow_are_the_worst() {
    let (mut x, y) = noisy(20, 2, 0.3, 9);
    // Only what is held out overflows.
    x[38..].copy_from_slice(&[1e200, -1e200]);
    let fold = Fold {
        train: (0..15).collect(),
        test: (15..20).collect(),
    };
    let grid = Grid {
        box_constraints: vec![Some(0.1), Some(1.0)],
        ..Grid::default()
    };
    for kernel in [Kernel::Quadratic, Kernel::Cubic] {
        let settings = Settings {
            kernel,
            ..Settings::default()
        };
        let candidates =
            found(&settings, &x, 2, &y, &grid, std::slice::from_ref(&fold)).expect("candidates");
        assert!(
            candidates
                .iter()
                .all(|candidate| candidate.rmse == f64::INFINITY)
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn blocked_folds_never_learn_from_neighbours(samples in 0..300_usize, count in 0..12_usize, gap in 0..60_usize) {
        let Ok(folds) = blocked_folds(samples, count, gap) else {
            // Refused only where a block and its surroundings may be everything.
            prop_assert!(count < 2 || count > samples || samples <= samples.div_ceil(count) + 2 * gap);
            return Ok(());
        };
        let tested: Vec<usize> = folds.iter().flat_map(|fold| fold.test.clone()).collect();
        prop_assert_eq!(tested, (0..samples).collect::<Vec<_>>());
        for fold in folds {
            let (first, last) = (fold.test[0], fold.test[fold.test.len() - 1]);
            prop_assert!(fold.train.is_sorted_by(|a, b| a < b) && fold.test.is_sorted_by(|a, b| a < b));
            // All but the block and its surroundings is learnt from, and nothing of these.
            let expected: Vec<usize> = (0..samples).filter(|&i| i + gap < first || i > last + gap).collect();
            prop_assert_eq!(fold.train, expected);
        }
    }

    #[test]
    fn a_hold_out_is_the_end(samples in 0..300_usize, share in 0.0..1.0_f64, gap in 0..30_usize) {
        if let Ok(fold) = hold_out(samples, share, gap) {
            let first = fold.test[0];
            prop_assert_eq!(&fold.test, &(first..samples).collect::<Vec<_>>());
            prop_assert_eq!(fold.train, (0..first - gap).collect::<Vec<_>>());
            prop_assert!((fold.test.len() as f64 - share * samples as f64).abs() <= 0.5);
        }
    }

    #[test]
    fn groups_are_never_torn_apart(groups in prop::collection::vec(0..9_u8, 0..60), count in 0..6_usize) {
        if let Ok(folds) = grouped_folds(&groups, count) {
            let mut tested: Vec<usize> = folds.iter().flat_map(|fold| fold.test.clone()).collect();
            tested.sort_unstable();
            prop_assert_eq!(tested, (0..groups.len()).collect::<Vec<_>>());
            for fold in folds {
                prop_assert!(!fold.test.is_empty() && !fold.train.is_empty());
                prop_assert_eq!(fold.test.len() + fold.train.len(), groups.len());
                prop_assert!(fold.train.iter().all(|&i| fold.test.iter().all(|&j| groups[i] != groups[j])));
            }
        }
    }
}
