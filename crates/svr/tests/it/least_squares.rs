//! Least squares in place of the tube.

use svr::{Kernel, Landmarks, Response, Samples, Scaling, Settings, fit_least_squares};

fn waves(samples: usize) -> (Vec<f64>, Vec<f64>) {
    let x: Vec<f64> = (0..samples).map(|i| 0.05 * i as f64).collect();
    let y = x.iter().map(|x| 3.0 + (1.3 * x).sin() + 0.2 * x).collect();
    (x, y)
}

/// Gradient of `½‖w‖² + C/2 Σ (y − w·x − b)²` at the solution.
#[test]
fn ridge_regression_is_where_the_gradient_vanishes() {
    let (x, y) = waves(80);
    let rows: Vec<f64> = x
        .iter()
        .flat_map(|x| [*x, x * x, 1.0 / (1.0 + x)])
        .collect();
    let samples = Samples::new(&rows, 3).unwrap();
    let settings = Settings {
        predictor_scaling: Scaling::None,
        ..Settings::default()
    };
    let c = 0.7;
    let models = fit_least_squares(&samples, &[Response::new(&y).unwrap()], &settings, c).unwrap();
    let predicted = models[0].predict(&samples).unwrap();
    let residuals: Vec<f64> = y.iter().zip(&predicted).map(|(y, p)| y - p).collect();
    assert!(residuals.iter().sum::<f64>().abs() < 1e-9);
    for (k, w) in models[0].coefficients().iter().enumerate() {
        let pull: f64 = samples
            .rows()
            .zip(&residuals)
            .map(|(row, r)| r * row[k])
            .sum();
        assert!((w - c * pull).abs() < 1e-8 * w.abs().max(1.0), "{k}");
    }
}

/// With every sample a landmark, `K β/C + β…`: the residual of a sample is its coefficient over `C`.
#[test]
fn with_all_samples_as_landmarks_it_is_the_exact_machine() {
    let (x, y) = waves(60);
    let samples = Samples::new(&x, 1).unwrap();
    let settings = Settings {
        kernel: Kernel::Rbf,
        kernel_scale: Some(0.3),
        landmarks: Landmarks::Never,
        ..Settings::default()
    };
    let c = 50.0;
    let model =
        &fit_least_squares(&samples, &[Response::new(&y).unwrap()], &settings, c).unwrap()[0];
    let predicted = model.predict(&samples).unwrap();
    let residuals = y.iter().zip(&predicted).map(|(y, p)| y - p);
    let mut sum = 0.0;
    for (residual, beta) in residuals.zip(model.coefficients()) {
        assert!((beta - c * residual).abs() < 1e-4 * c, "{beta} {residual}");
        sum += residual;
    }
    assert!(sum.abs() < 1e-6);
}

#[test]
fn one_factorisation_serves_all_responses_and_weights_of_predictors_count() {
    let (x, y) = waves(300);
    let rows: Vec<f64> = x
        .iter()
        .enumerate()
        .flat_map(|(i, x)| [*x, ((i * 7919) % 101) as f64])
        .collect();
    let samples = Samples::new(&rows, 2).unwrap();
    let negative: Vec<f64> = y.iter().map(|y| -y).collect();
    let responses = [
        Response::new(&y).unwrap(),
        Response::new(&negative).unwrap(),
    ];
    let error = |weights: Vec<f64>| {
        let settings = Settings {
            kernel: Kernel::Rbf,
            kernel_scale: Some(0.3),
            predictor_weights: weights,
            ..Settings::default()
        };
        let models = fit_least_squares(&samples, &responses, &settings, 10.0).unwrap();
        let (up, down) = (
            models[0].predict(&samples).unwrap(),
            models[1].predict(&samples).unwrap(),
        );
        assert!(up.iter().zip(&down).all(|(a, b)| (a + b).abs() < 1e-8));
        // Noise moved by one place is noise still; a model that looks at it is off.
        let moved: Vec<f64> = rows
            .chunks(2)
            .enumerate()
            .flat_map(|(i, row)| [row[0], ((i * 31) % 101) as f64])
            .collect();
        let elsewhere = models[0]
            .predict(&Samples::new(&moved, 2).unwrap())
            .unwrap();
        elsewhere
            .iter()
            .zip(&y)
            .map(|(p, y)| (p - y).abs())
            .sum::<f64>()
            / 300.0
    };
    let (blind, misled) = (error(vec![1.0, 0.0]), error(vec![1.0, 1.0]));
    assert!(blind < 0.5 * misled, "{blind} {misled}");
}

#[test]
fn bad_input_is_refused() {
    let (x, y) = waves(10);
    let samples = Samples::new(&x, 1).unwrap();
    let response = Response::new(&y).unwrap();
    let short = Response::new(&y[..9]).unwrap();
    let fit = |response, c| fit_least_squares(&samples, &[response], &Settings::default(), c);
    assert!(
        fit(response, 0.0).is_err() && fit(response, f64::NAN).is_err() && fit(short, 1.0).is_err()
    );
    let settings = Settings {
        predictor_weights: vec![1.0, 2.0],
        ..Settings::default()
    };
    assert!(fit_least_squares(&samples, &[response], &settings, 1.0).is_err());
}
