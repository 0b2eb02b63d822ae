//! Input that is none: an error that says what and where.

use svr::{Error, Fit, Kernel, Landmarks, Penalty, Response, Samples, Settings, Trainer, fit};

use crate::degenerate::assert_optimal;
use crate::problem::{KERNELS, fit_to, noisy, penalty, tight};

fn refused(result: Result<Fit, Error>) -> Error {
    result.expect_err("an error")
}

#[test]
fn samples_that_are_none_are_refused() {
    assert_eq!(Samples::new(&[], 2), Err(Error::NoSamples));
    assert_eq!(
        Samples::new(&[1.0; 5], 2),
        Err(Error::Shape {
            values: 5,
            predictors: 2
        })
    );
    assert_eq!(
        Samples::new(&[1.0; 5], 0),
        Err(Error::Shape {
            values: 5,
            predictors: 0
        })
    );
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let values = [1.0, 2.0, 3.0, value];
        let refused = Samples::new(&values, 2);
        assert!(matches!(
            refused,
            Err(Error::NotFinite {
                sample: 1,
                what: "a predictor",
                ..
            })
        ));
        let refused = Response::new(&values[2..]);
        assert!(matches!(
            refused,
            Err(Error::NotFinite {
                sample: 1,
                what: "the response",
                ..
            })
        ));
    }
    assert_eq!(Response::new(&[]), Err(Error::NoSamples));
}

#[test]
fn weights_that_are_none_are_refused() {
    let response = Response::new(&[1.0, 2.0]).expect("responses");
    assert_eq!(
        response.weighted(&[1.0]),
        Err(Error::Length {
            what: "weights",
            found: 1,
            expected: 2
        })
    );
    for value in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            response.weighted(&[1.0, value]),
            Err(Error::Setting {
                name: "a sample weight",
                ..
            })
        ));
    }
}

#[test]
fn lengths_that_do_not_fit_are_refused() {
    let (x, y) = noisy(6, 2, 0.3, 7);
    let samples = Samples::new(&x, 2).expect("samples");
    for kernel in KERNELS {
        let short = Response::new(&y[..5]).expect("responses");
        assert_eq!(
            refused(fit(&samples, &short, &tight(kernel), &Penalty::default())),
            Error::Length {
                what: "responses",
                found: 5,
                expected: 6
            }
        );
        let fewer = fit_to(&x[..10], 2, &y[..5], &tight(kernel), &Penalty::default());
        let mut trainer = Trainer::new(&samples, &tight(kernel)).expect("a trainer");
        let response = Response::new(&y).expect("responses");
        assert_eq!(
            refused(trainer.fit(&response, &Penalty::default(), Some(&fewer))),
            Error::Length {
                what: "coefficients to start from",
                found: 5,
                expected: 6
            }
        );
        assert_eq!(
            fewer.model.predict(&Samples::new(&x, 3).expect("samples")),
            Err(Error::Length {
                what: "predictors",
                found: 3,
                expected: 2
            })
        );
    }
}

#[test]
fn settings_out_of_range_are_refused() {
    let (x, y) = noisy(6, 2, 0.3, 7);
    let name = |settings: &Settings, penalty: &Penalty| {
        let samples = Samples::new(&x, 2).expect("samples");
        let response = Response::new(&y).expect("responses");
        match refused(fit(&samples, &response, settings, penalty)) {
            Error::Setting { name, .. } => name,
            other => panic!("{other:?}"),
        }
    };
    for kernel in KERNELS {
        let good = tight(kernel);
        for c in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(name(&good, &penalty(c, 0.1)), "box_constraint");
        }
        for tube in [-1e-9, f64::NAN, f64::INFINITY] {
            assert_eq!(name(&good, &penalty(1.0, tube)), "tube_epsilon");
        }
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let mut settings = good.clone();
            settings.stopping.tolerance = Some(bad);
            assert_eq!(name(&settings, &Penalty::default()), "tolerance");
            let settings = Settings {
                kernel_scale: Some(bad),
                ..good.clone()
            };
            assert_eq!(name(&settings, &Penalty::default()), "kernel_scale");
        }
        for bad in [-1.0, f64::NAN] {
            let mut settings = good.clone();
            settings.stopping.time_limit_s = Some(bad);
            assert_eq!(name(&settings, &Penalty::default()), "time_limit_s");
        }
        let settings = Settings {
            landmarks: Landmarks::Count(0),
            ..good.clone()
        };
        assert_eq!(name(&settings, &Penalty::default()), "landmarks");
    }
}

#[test]
fn a_memory_limit_below_two_rows_is_refused_and_the_least_is_named() {
    let (x, y) = noisy(40, 2, 0.3, 7);
    for kernel in [Kernel::Quadratic, Kernel::Cubic, Kernel::Rbf] {
        let limited = |memory_limit_bytes| {
            let settings = Settings {
                memory_limit_bytes,
                ..tight(kernel)
            };
            let samples = Samples::new(&x, 2).expect("samples");
            fit(
                &samples,
                &Response::new(&y).expect("responses"),
                &settings,
                &penalty(1.0, 0.1),
            )
        };
        let Error::Memory {
            samples: 40,
            needed_bytes,
            limit_bytes: 0,
        } = refused(limited(0))
        else {
            panic!("another error");
        };
        assert!(matches!(
            limited(needed_bytes - 1),
            Err(Error::Memory { .. })
        ));
        assert_optimal(&limited(needed_bytes).expect("a fit"));
        assert_optimal(&limited(usize::MAX).expect("a fit"));
    }
}
