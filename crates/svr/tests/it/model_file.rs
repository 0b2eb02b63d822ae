//! A model in a file is the model, and a file that is none is refused or harmless.

use proptest::prelude::*;
use serde_json::{Value, json};
use svr::{Kernel, Landmarks, Model, Penalty, Samples, Scaling, Settings};

use crate::problem::{KERNELS, fit_to, noisy, predict};

fn models() -> Vec<Model> {
    let (x, y) = noisy(25, 3, 0.2, 1);
    let mut models = Vec::new();
    for kernel in KERNELS {
        for scaling in [Scaling::None, Scaling::Standardize, Scaling::Range] {
            for landmarks in [Landmarks::Never, Landmarks::Count(4)] {
                let settings = Settings {
                    kernel,
                    predictor_scaling: scaling,
                    response_scaling: scaling,
                    landmarks,
                    ..Settings::default()
                };
                models.push(fit_to(&x, 3, &y, &settings, &Penalty::default()).model);
                models.push(fit_to(&x, 3, &[0.1; 25], &settings, &Penalty::default()).model);
            }
        }
    }
    models
}

#[test]
fn a_model_from_a_file_predicts_the_same_bits() {
    let (elsewhere, _) = noisy(40, 3, 0.2, 2);
    for model in models() {
        for file in [
            serde_json::to_string(&model),
            serde_json::to_string_pretty(&model),
        ] {
            let read: Model = serde_json::from_str(&file.expect("JSON")).expect("a model");
            assert_eq!(read, model);
            let bits = |model: &Model| {
                predict(model, &elsewhere)
                    .iter()
                    .map(|f| f.to_bits())
                    .collect::<Vec<_>>()
            };
            assert_eq!(bits(&read), bits(&model));
        }
    }
}

#[test]
fn files_that_contradict_themselves_are_refused() {
    let (x, y) = noisy(25, 3, 0.2, 1);
    for kernel in KERNELS {
        let settings = Settings {
            kernel,
            ..Settings::default()
        };
        let model = fit_to(&x, 3, &y, &settings, &Penalty::default()).model;
        let good = serde_json::to_value(&model).expect("JSON");
        assert!(serde_json::from_value::<Model>(good.clone()).is_ok());
        let refused = |change: &dyn Fn(&mut Value)| {
            let mut bad = good.clone();
            change(&mut bad);
            serde_json::from_value::<Model>(bad)
                .expect_err("an error")
                .to_string()
        };
        let push = |field: &'static str| {
            move |model: &mut Value| {
                model
                    .pointer_mut(field)
                    .expect("a field")
                    .as_array_mut()
                    .expect("an array")
                    .push(json!(1.0));
            }
        };
        for field in [
            "/coefficients",
            "/support_vectors",
            "/predictors/offset",
            "/predictors/factor",
            "/response/offset",
        ] {
            assert!(refused(&push(field)).starts_with("not a model"), "{field}");
        }
        let both = refused(&|model| {
            push("/response/offset")(model);
            push("/response/factor")(model);
        });
        assert_eq!(both, "not a model: there is more than one response");
        let both = refused(&|model| {
            push("/predictors/offset")(model);
            push("/predictors/factor")(model);
        });
        // One more predictor may happen to fit the number of values.
        assert_eq!(both, "not a model: coefficients do not fit the predictors");
        refused(&|model| {
            model["predictors"] = json!({"offset": [], "factor": []});
            model["coefficients"] = json!([]);
            model["support_vectors"] = json!([]);
        });
        for scale in [json!(0.0), json!(-1.0), json!(null), json!("1")] {
            refused(&|model| model["kernel_scale"] = scale.clone());
        }
        refused(&|model| model["predictors"]["factor"][0] = json!(-1.0));
        refused(&|model| model["kernel"] = json!("sigmoid"));
        refused(&|model| model["colour"] = json!("blue"));
        refused(&|model| model["bias"] = json!(null));
        for field in [
            "kernel",
            "kernel_scale",
            "predictors",
            "response",
            "coefficients",
            "support_vectors",
            "bias",
        ] {
            refused(&|model| {
                model.as_object_mut().expect("an object").remove(field);
            });
        }
    }
}

#[test]
fn a_model_of_kernel_values_that_overflow_predicts_without_a_panic() {
    for kernel in ["linear", "quadratic", "cubic", "rbf"] {
        for scale in [5e-324, 1e-300, 1e300] {
            for size in [1e-300, 1e300] {
                let vectors = if kernel == "linear" {
                    json!([])
                } else {
                    json!([size, -size, size])
                };
                let coefficients = if kernel == "linear" {
                    json!([size])
                } else {
                    json!([size, size, -size])
                };
                let model: Model = serde_json::from_value(json!({
                    "kernel": kernel, "kernel_scale": scale,
                    "predictors": {"offset": [size], "factor": [size]},
                    "response": {"offset": [size], "factor": [size]},
                    "coefficients": coefficients, "support_vectors": vectors, "bias": size,
                }))
                .expect("a model");
                for x in [0.0, 1.0, 1e300, -1e300, 5e-324] {
                    assert_eq!(predict(&model, &[x]).len(), 1);
                }
            }
        }
    }
}

/// A broken file is refused, or a model whose predictions do not panic.
fn read(file: &[u8]) {
    if let Ok(model) = serde_json::from_slice::<Model>(file) {
        let row: Vec<f64> = (0..5 * model.predictors())
            .map(|i| i as f64 - 2.5)
            .collect();
        let samples = Samples::new(&row, model.predictors()).expect("samples");
        assert_eq!(model.predict(&samples).expect("predictions").len(), 5);
        assert_eq!(
            model.predictors() == 3,
            model
                .predict(&Samples::new(&[0.0; 3], 3).expect("a sample"))
                .is_ok()
        );
    }
}

fn file(model: usize) -> Vec<u8> {
    let kernel = KERNELS[model % 4];
    let (x, y) = noisy(8, 3, 0.2, 1);
    let landmarks = if model < 4 || kernel == Kernel::Linear {
        Landmarks::Never
    } else {
        Landmarks::Count(3)
    };
    let settings = Settings {
        kernel,
        landmarks,
        ..Settings::default()
    };
    serde_json::to_vec(&fit_to(&x, 3, &y, &settings, &Penalty::default()).model).expect("JSON")
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

    #[test]
    fn changed_bytes_are_refused_or_harmless(
        model in 0..8_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), prop_oneof![any::<u8>(), prop::sample::select(b"0123456789.-eE,[]{}\":".to_vec())]), 1..5),
    ) {
        let mut file = file(model);
        for (at, byte) in changes {
            let at = at.index(file.len());
            file[at] = byte;
        }
        read(&file);
    }

    #[test]
    fn pieces_of_a_file_are_refused_or_harmless(model in 0..8_usize, from in any::<prop::sample::Index>(), count in 1..200_usize, whole in any::<bool>()) {
        let mut file = file(model);
        let from = from.index(file.len());
        if whole {
            file.truncate(from);
            prop_assert!(serde_json::from_slice::<Model>(&file).is_err());
        } else {
            let to = (from + count).min(file.len());
            file.drain(from..to);
        }
        read(&file);
    }

    #[test]
    fn numbers_of_any_size_are_refused_or_harmless(model in 0..8_usize, at in any::<prop::sample::Index>(), value in any::<f64>()) {
        let mut file: Value = serde_json::from_slice(&file(model)).expect("JSON");
        let fields = ["/kernel_scale", "/bias", "/predictors/offset/1", "/predictors/factor/1", "/response/offset/0", "/response/factor/0", "/coefficients/0", "/support_vectors/2"];
        if let Some(field) = file.pointer_mut(fields[at.index(fields.len())]) {
            *field = json!(value);
        }
        read(&serde_json::to_vec(&file).expect("JSON"));
    }
}
