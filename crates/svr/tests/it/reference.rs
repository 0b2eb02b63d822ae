//! Reference solutions computed by an independent slow program, when they are there.

use serde_json::Value;
use svr::{Kernel, Penalty, Response, Samples, Scaling, Settings, Status, Stopping, fit};

use crate::shared::shared;

fn numbers(value: &Value) -> Vec<f64> {
    let items = value.as_array().expect("an array");
    items
        .iter()
        .flat_map(|item| {
            if item.is_array() {
                numbers(item)
            } else {
                vec![item.as_f64().expect("a number")]
            }
        })
        .collect()
}

#[test]
fn objectives_and_predictions_are_the_reference_solutions() {
    let Some(folder) = shared("vectors/svr") else {
        return;
    };
    let mut checked = 0;
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("a folder entry").path();
        let vector: Value =
            serde_json::from_str(&std::fs::read_to_string(&path).expect("a file")).expect("JSON");
        let number = |key: &str| vector[key].as_f64().expect("a number");
        let kernel = match vector["kernel"].as_str() {
            Some("linear") => Kernel::Linear,
            Some("quadratic") => Kernel::Quadratic,
            Some("rbf") => Kernel::Rbf,
            other => panic!("kernel {other:?}"),
        };
        let settings = Settings {
            kernel,
            kernel_scale: Some(number("kernel_scale")),
            predictor_scaling: Scaling::None,
            stopping: Stopping {
                tolerance: Some(1e-12),
                ..Stopping::default()
            },
            ..Settings::default()
        };
        let penalty = Penalty {
            box_constraint: Some(number("C")),
            tube_epsilon: Some(number("epsilon")),
        };
        let (x, y, test) = (
            numbers(&vector["X"]),
            numbers(&vector["y"]),
            numbers(&vector["X_test"]),
        );
        let d = vector["d"].as_u64().expect("a number") as usize;
        let samples = Samples::new(&x, d).expect("samples");
        let fitted = fit(
            &samples,
            &Response::new(&y).expect("responses"),
            &settings,
            &penalty,
        )
        .expect("a fit");

        let name = path.display();
        assert_eq!(fitted.status, Status::Optimal, "{name}");
        assert!(
            (fitted.dual_objective + number("dual_objective")).abs() <= 1e-8,
            "{name}: {fitted:?}"
        );
        assert!(
            (fitted.primal_objective - number("primal_objective")).abs() <= 1e-8,
            "{name}"
        );
        for (rows, key) in [(&x, "pred_train"), (&test, "pred_test")] {
            let predicted = fitted
                .model
                .predict(&Samples::new(rows, d).expect("samples"))
                .expect("predictions");
            for (ours, expected) in predicted.iter().zip(numbers(&vector[key])) {
                assert!(
                    (ours - expected).abs() <= 1e-8,
                    "{name}: {key} {ours} {expected}"
                );
            }
        }
        checked += 1;
    }
    assert_eq!(checked, 4);
}
