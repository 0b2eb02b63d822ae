//! Data without anything to learn, and data that no solver converges on.

use svr::{
    Fit, Kernel, Landmarks, Penalty, Response, Samples, Scaling, Settings, Status, Stopping, fit,
};

use crate::problem::{
    KERNELS, Naive, Random, fit_to, greatest_difference, noisy, penalty, precise, predict, tight,
};

pub(crate) fn assert_optimal(fit: &Fit) {
    assert_eq!(fit.status, Status::Optimal, "{fit:?}");
    let gap = fit.duality_gap();
    let rounding = 1e-6 * fit.primal_objective.abs() + 1e-9;
    assert!(gap.abs() <= rounding, "{gap} of {}", fit.primal_objective);
}

#[test]
fn a_constant_response_is_predicted_as_the_constant() {
    let (x, _) = noisy(20, 3, 0.0, 1);
    for kernel in KERNELS {
        for scaling in [Scaling::None, Scaling::Standardize, Scaling::Range] {
            for constant in [0.0, -0.1, 1234.5] {
                let settings = Settings {
                    response_scaling: scaling,
                    ..tight(kernel)
                };
                for penalty in [Penalty::default(), penalty(10.0, 0.0)] {
                    let fit = fit_to(&x, 3, &[constant; 20], &settings, &penalty);
                    assert_optimal(&fit);
                    assert_eq!(fit.support_vectors, 0);
                    let predicted = predict(&fit.model, &x);
                    assert!(
                        greatest_difference(&predicted, &[constant; 20]) <= 1e-12 * constant.abs()
                    );
                }
            }
        }
    }
}

#[test]
fn defaults_of_a_constant_response_are_those_of_matlab() {
    let fit = fit_to(
        &[1.0, 2.0],
        1,
        &[3.0, 3.0],
        &Settings::default(),
        &Penalty::default(),
    );
    assert_eq!(
        (fit.penalty.box_constraint, fit.penalty.tube_epsilon),
        (1.0, 0.1)
    );
}

#[test]
fn equal_samples_with_different_responses_get_one_prediction() {
    for kernel in KERNELS {
        for (c, tube) in [(1.0, 0.0), (100.0, 0.1), (1e-3, 0.5)] {
            let x = [1.0, 2.0, 1.0, 2.0, 1.0, 2.0, -3.0, 0.5];
            let fit = fit_to(
                &x,
                2,
                &[1.0, 5.0, 2.0, 0.0],
                &tight(kernel),
                &penalty(c, tube),
            );
            assert_optimal(&fit);
            let predicted = predict(&fit.model, &x);
            assert_eq!(predicted[0], predicted[1]);
            assert_eq!(predicted[0], predicted[2]);
        }
        // Nothing but one sample many times: the median, within the tube.
        let y = [1.0, 7.0, 3.0, 2.0, 9.0];
        let fit = fit_to(&[4.0; 5], 1, &y, &tight(kernel), &penalty(5.0, 0.0));
        assert_optimal(&fit);
        assert!(
            (predict(&fit.model, &[4.0])[0] - 3.0).abs() < 1e-6,
            "{kernel:?} {fit:?}"
        );
    }
}

#[test]
fn one_sample_is_predicted_everywhere() {
    for kernel in KERNELS {
        for tube in [0.0, 0.5] {
            for scaling in [Scaling::None, Scaling::Standardize, Scaling::Range] {
                let settings = Settings {
                    predictor_scaling: scaling,
                    response_scaling: scaling,
                    ..tight(kernel)
                };
                let fit = fit_to(&[1.0, -2.0], 2, &[7.5], &settings, &penalty(1.0, tube));
                assert_optimal(&fit);
                assert_eq!(predict(&fit.model, &[1.0, -2.0, 50.0, 3.0]), [7.5, 7.5]);
            }
        }
    }
}

#[test]
fn two_samples_are_met_to_the_tube() {
    for kernel in KERNELS {
        for tube in [0.0, 0.25] {
            let x = [0.0, 1.0];
            let fit = fit_to(&x, 1, &[1.0, 3.0], &tight(kernel), &penalty(1e3, tube));
            assert_optimal(&fit);
            let expected = [1.0 + tube, 3.0 - tube];
            let difference = greatest_difference(&predict(&fit.model, &x), &expected);
            assert!(difference < 1e-6, "{kernel:?} {difference}");
            assert_eq!(fit.support_vectors, 2);
        }
    }
}

#[test]
fn a_constant_predictor_says_nothing() {
    let (x, y) = noisy(30, 2, 0.2, 5);
    for constant in [0.0, 0.1, -1e9] {
        let wider: Vec<f64> = x
            .chunks(2)
            .flat_map(|row| [row[0], constant, row[1]])
            .collect();
        // The same model with the constant changed: whatever it is later, it changes nothing.
        let later: Vec<f64> = x.chunks(2).flat_map(|row| [row[0], 17.0, row[1]]).collect();
        for kernel in KERNELS {
            for scaling in [Scaling::Standardize, Scaling::Range] {
                let settings = Settings {
                    kernel_scale: Some(1.7),
                    predictor_scaling: scaling,
                    ..tight(kernel)
                };
                let narrow = fit_to(&x, 2, &y, &settings, &penalty(1.0, 0.1));
                let wide = fit_to(&wider, 3, &y, &settings, &penalty(1.0, 0.1));
                let expected = predict(&narrow.model, &x);
                for rows in [&wider, &later] {
                    let difference = greatest_difference(&predict(&wide.model, rows), &expected);
                    assert!(difference < 1e-6, "{kernel:?} {scaling:?} {difference}");
                }
            }
        }
    }
}

#[test]
fn nothing_but_constant_predictors_gives_a_median() {
    for kernel in KERNELS {
        let y = [1.0, 2.0, 30.0];
        let fit = fit_to(&[1.0; 6], 2, &y, &tight(kernel), &penalty(1.0, 0.0));
        assert_optimal(&fit);
        assert!((predict(&fit.model, &[1.0, 1.0])[0] - 2.0).abs() < 1e-6);
    }
}

#[test]
fn penalties_at_either_end() {
    let (x, y) = noisy(25, 2, 0.3, 7);
    for kernel in KERNELS {
        let fit = fit_to(&x, 2, &y, &tight(kernel), &penalty(1e-12, 0.05));
        assert_optimal(&fit);
        let flat = predict(&fit.model, &x);
        assert!(
            flat.iter().all(|f| (f - flat[0]).abs() < 1e-6),
            "{kernel:?} {flat:?}"
        );
    }
    // Few samples of a smooth function, so that no error is left.
    let (x, y) = noisy(6, 5, 0.0, 8);
    for kernel in KERNELS {
        let fit = fit_to(&x, 5, &y, &tight(kernel), &penalty(1e9, 0.01));
        assert_eq!(fit.status, Status::Optimal, "{fit:?}");
        let difference = greatest_difference(&predict(&fit.model, &x), &y);
        assert!(difference < 0.01 + 1e-6, "{kernel:?} {difference}");
        assert!((1..=6).contains(&fit.support_vectors), "{kernel:?} {fit:?}");
    }
}

#[test]
fn a_tube_without_width_and_one_wider_than_the_data() {
    let (x, y) = noisy(25, 2, 0.3, 7);
    for kernel in KERNELS {
        let fit = fit_to(&x, 2, &y, &tight(kernel), &penalty(1.0, 0.0));
        assert_optimal(&fit);
        assert!(fit.support_vectors >= 20, "{}", fit.support_vectors);

        let fit = fit_to(&x, 2, &y, &tight(kernel), &penalty(1.0, 100.0));
        assert_optimal(&fit);
        assert_eq!((fit.support_vectors, fit.iterations), (0, 0));
        assert_eq!((fit.primal_objective, fit.dual_objective), (0.0, 0.0));
        let (low, high) = y
            .iter()
            .fold((y[0], y[0]), |(l, h), &y| (l.min(y), h.max(y)));
        let middle = 0.5 * (low + high);
        assert!(
            predict(&fit.model, &x)
                .iter()
                .all(|f| (f - middle).abs() < 1e-9),
            "{kernel:?}"
        );
    }
}

#[test]
fn samples_of_weight_0_alone_teach_nothing() {
    let (x, y) = noisy(10, 2, 0.3, 7);
    for kernel in KERNELS {
        for landmarks in [Landmarks::Never, Landmarks::Count(5)] {
            let settings = Settings {
                landmarks,
                ..tight(kernel)
            };
            let response = Response::new(&y)
                .expect("responses")
                .weighted(&[0.0; 10])
                .expect("weights");
            let fit = fit(
                &Samples::new(&x, 2).expect("samples"),
                &response,
                &settings,
                &penalty(1.0, 0.1),
            )
            .expect("a fit");
            assert_eq!(fit.status, Status::Optimal);
            assert_eq!(
                (
                    fit.support_vectors,
                    fit.primal_objective,
                    fit.dual_objective
                ),
                (0, 0.0, 0.0)
            );
            let predicted = predict(&fit.model, &x);
            assert!(
                predicted
                    .iter()
                    .all(|f| f.is_finite() && *f == predicted[0]),
                "{predicted:?}"
            );
        }
    }
}

/// Metres and metres per second as they are, and kernels of scale 1.
fn unscaled(n: usize) -> (Vec<f64>, Vec<f64>) {
    let mut random = Random(11);
    let x: Vec<f64> = (0..n)
        .flat_map(|_| [500.0 * random.unit(), 30.0 * random.unit(), 9.0])
        .collect();
    let y = x
        .chunks(3)
        .map(|row| 0.01 * row[0] + (0.1 * row[1]).sin() + 0.3 * random.normal())
        .collect();
    (x, y)
}

fn fit_unscaled(kernel: Kernel, max_iterations: usize) -> (Fit, Vec<f64>) {
    let (x, y) = unscaled(200);
    let settings = Settings {
        kernel,
        kernel_scale: Some(1.0),
        predictor_scaling: Scaling::None,
        stopping: Stopping {
            max_iterations,
            ..Stopping::default()
        },
        ..Settings::default()
    };
    let fit = fit_to(&x, 3, &y, &settings, &penalty(1.0, 0.1));
    let predicted = predict(&fit.model, &x);
    (fit, predicted)
}

#[test]
fn polynomials_of_unscaled_predictors_that_are_stopped_say_how_far_off_they_are() {
    for (kernel, limits) in [
        (Kernel::Quadratic, &[0, 1, 10, 1000][..]),
        (Kernel::Cubic, &[0, 1, 10, 1000, 50_000]),
    ] {
        for &max_iterations in limits {
            let (fit, predicted) = fit_unscaled(kernel, max_iterations);
            assert_eq!(fit.status, Status::IterationLimit);
            assert_eq!(fit.iterations, max_iterations);
            assert!(fit.primal_objective.is_finite() && fit.dual_objective.is_finite());
            assert!(
                fit.duality_gap() > 0.0,
                "{kernel:?} {max_iterations}: {} {}",
                fit.primal_objective,
                fit.dual_objective
            );
            assert!(fit.kkt_residual > 1e-3);
            assert!(fit.hint().expect("a hint").contains("scale the predictors"));
            assert!(predicted.iter().all(|f| f.is_finite()));
        }
    }
}

#[test]
fn a_quadratic_kernel_of_unscaled_predictors_converges() {
    let (fit, _) = fit_unscaled(Kernel::Quadratic, 50_000);
    assert_eq!(fit.status, Status::Optimal, "{fit:?}");
}

#[test]
fn a_time_limit_of_0_stops_before_the_first_step() {
    let (x, y) = noisy(50, 2, 0.3, 7);
    for kernel in KERNELS {
        let mut settings = tight(kernel);
        settings.stopping.time_limit_s = Some(0.0);
        let fit = fit_to(&x, 2, &y, &settings, &penalty(1.0, 0.1));
        assert_eq!((fit.status, fit.iterations), (Status::TimeLimit, 0));
        assert!(fit.duality_gap() > 0.0 && fit.hint().is_some());
    }
}

/// Kernel values beyond what single, then double precision holds: anything but a wrong claim.
#[test]
fn kernel_values_that_overflow_are_never_called_optimal_with_figures_that_are_none() {
    let (x, y) = noisy(30, 2, 0.3, 7);
    for kernel in [
        Kernel::Quadratic,
        Kernel::Cubic,
        Kernel::Rbf,
        Kernel::Linear,
    ] {
        for unit in [1e5, 1e7, 1e10, 1e15, 1e30, 1e52, 1e80, 1e110, 1e160, 1e290] {
            for landmarks in [Landmarks::Never, Landmarks::Count(10)] {
                let x: Vec<f64> = x.iter().map(|x| unit * x).collect();
                let settings = Settings {
                    kernel,
                    kernel_scale: Some(1.0),
                    predictor_scaling: Scaling::None,
                    landmarks,
                    stopping: Stopping {
                        max_iterations: 20_000,
                        ..Stopping::default()
                    },
                    ..Settings::default()
                };
                let samples = Samples::new(&x, 2).expect("samples");
                let response = Response::new(&y).expect("responses");
                let Ok(fit) = fit(&samples, &response, &settings, &penalty(1.0, 0.1)) else {
                    continue;
                };
                if fit.status == Status::Optimal {
                    let figures = [
                        fit.primal_objective,
                        fit.dual_objective,
                        fit.kkt_residual,
                        fit.model.bias(),
                    ];
                    assert!(
                        figures.iter().all(|figure| figure.is_finite()),
                        "{kernel:?} {unit:e} {landmarks:?} {figures:?}"
                    );
                    let gap = fit.duality_gap();
                    assert!(
                        gap.abs() <= 1e-2 * fit.primal_objective.abs() + 0.1,
                        "{kernel:?} {unit:e} {landmarks:?} {figures:?}"
                    );
                }
            }
        }
    }
}

/// Single precision keeps no distances between points far from the origin, unless they are brought near first.
#[test]
fn a_radial_kernel_far_from_the_origin_is_as_exact_as_near_it() {
    let (x, y) = noisy(700, 1, 0.3, 7);
    for offset in [0.0, 1e3, 1e5] {
        let far: Vec<f64> = x.iter().map(|x| offset + x).collect();
        for tolerance in [1e-3, 1e-6] {
            let settings = Settings {
                kernel_scale: Some(1.0),
                predictor_scaling: Scaling::None,
                ..precise(Kernel::Rbf, tolerance)
            };
            let fit = fit_to(&far, 1, &y, &settings, &penalty(10.0, 0.1));
            assert_eq!(fit.status, Status::Optimal, "{fit:?}");
            let naive = Naive::new(Kernel::Rbf, 1.0, &far, 1, &y, vec![10.0; 700], 0.1);
            let products = naive.products(&fit.beta);
            let violation = naive.violation(&fit.beta, &products, 0.0);
            assert!(
                violation <= 1.2 * tolerance,
                "{offset} {tolerance} {violation} {}",
                fit.kkt_residual
            );
        }
    }
}
