//! Against independently computed values of single states.

use serde_json::Value;
use unicycle_cbf::cbf::LaneBarrier;
use unicycle_cbf::{Controller, Leader, Preset, State, Testbed, lateral::Deviation};

use crate::shared::shared;

use crate::states::controller;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

fn state(value: &Value) -> State {
    let x = numbers(value);
    State {
        x_m: x[0],
        y_m: x[1],
        speed_mps: x[2],
        heading_rad: x[3],
        turn_rate_rad_s: x[4],
    }
}

fn close(found: f64, expected: f64, scale: f64, what: &str) {
    let error = (found - expected).abs();
    assert!(
        error <= 1e-9 * scale.max(expected.abs()) + 1e-15,
        "{what}: {found} in place of {expected}"
    );
}

fn controller_of(case: &Value) -> Controller {
    let (testbed, name) = case["experiment"]
        .as_str()
        .unwrap()
        .split_once('-')
        .unwrap();
    let testbed = match testbed {
        "khepera" => Testbed::Khepera,
        _ => Testbed::Robotarium,
    };
    let name = if name == "onoff" { "on-off" } else { name };
    controller(testbed, name, Preset::Thesis, |settings| {
        settings.lane.deviation = match case["lat"].as_str().unwrap() {
            "frenet" => Deviation::Frenet,
            _ => Deviation::Radial,
        };
    })
}

fn cases() -> Vec<Value> {
    let Some(file) = shared("vectors/control.json") else {
        return Vec::new();
    };
    let text = std::fs::read_to_string(file).unwrap();
    let document: Value = serde_json::from_str(&text).unwrap();
    document["cases"].as_array().unwrap().clone()
}

#[test]
fn functions_and_rows_agree() {
    for case in cases() {
        let controller = controller_of(&case);
        let (own, ahead) = (state(&case["X"]), Leader::known(state(&case["X_leader"])));
        let objectives = controller.objectives(number(&case["v_d"]));
        let decision = controller.decide(&own, Some(&ahead), &objectives, 0.0);
        let terms = decision.terms.unwrap();
        for (i, lie) in terms.lyapunov.iter().enumerate() {
            close(lie.value, number(&case["V"][i]), 0.0, "V");
            close(lie.lf, number(&case["LfV"][i]), 1e-3, "LfV");
            for (found, expected) in lie.lg.iter().zip(numbers(&case["LgV"][i])) {
                close(*found, expected, 1e-3, "LgV");
            }
        }
        let headway = terms.headway.unwrap();
        close(headway.value, number(&case["h_asr"]), 0.0, "h_asr");
        close(headway.lf, number(&case["Lf_h_asr"]), 1e-3, "Lf_h_asr");
        close(
            terms.lateral.deviation_m,
            number(&case["y_lat"]),
            1e-3,
            "y_lat",
        );
        close(
            terms.lateral.rate_mps,
            number(&case["v_lat"]),
            1e-3,
            "v_lat",
        );
        let rows = case["A"].as_array().unwrap();
        assert_eq!(terms.rows.as_slice().len(), rows.len());
        for (i, (row, expected)) in terms.rows.as_slice().iter().zip(rows).enumerate() {
            let expected = numbers(expected);
            let scale = expected.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
            for (found, expected) in row.a.iter().zip(expected) {
                close(*found, expected, scale, "A");
            }
            close(row.b, number(&case["b"][i]), 1e-3, "b");
        }
    }
}

#[test]
fn every_lane_barrier_agrees() {
    for case in cases() {
        let controller = controller_of(&case);
        let lateral = controller.lateral(&state(&case["X"]));
        let half_width_m = controller.settings().lane.half_width_m;
        let kinds = [
            (
                "quad",
                LaneBarrier::Quadratic {
                    reference_speed_mps: 1.0,
                },
            ),
            (
                "brake",
                LaneBarrier::Braking {
                    max_acceleration_mps2: if controller.hold_s() < 0.03 { 0.5 } else { 0.3 },
                },
            ),
            ("ecbf", LaneBarrier::Exponential { rate_1ps: 3.0 }),
        ];
        for (name, kind) in kinds {
            let found = unicycle_cbf::cbf::lane(kind, half_width_m, &lateral);
            let expected = case["lk_rows"][name].as_array().unwrap();
            assert_eq!(found.iter().count(), expected.len());
            for ((_, lie), expected) in found.iter().zip(expected) {
                close(lie.value, number(&expected["h"]), 0.0, name);
                close(lie.lf, number(&expected["Lf"]), 1e-3, name);
                for (found, expected) in lie.lg.iter().zip(numbers(&expected["Lg"])) {
                    close(*found, expected, 1e-3, name);
                }
            }
        }
    }
}

#[test]
fn optima_agree() {
    for case in cases() {
        let controller = controller_of(&case);
        let (own, ahead) = (state(&case["X"]), Leader::known(state(&case["X_leader"])));
        let objectives = controller.objectives(number(&case["v_d"]));
        let decision = controller.decide(&own, Some(&ahead), &objectives, 0.0);
        let solution = decision.terms.unwrap().solution;
        let weights = numbers(&case["H"]);
        let scaled: Vec<(f64, f64)> = solution
            .z
            .iter()
            .zip(numbers(&case["u_opt"]))
            .zip(&weights)
            .map(|((found, expected), weight)| (found * weight.sqrt(), expected * weight.sqrt()))
            .collect();
        let length = scaled.iter().map(|(_, e)| e * e).sum::<f64>().sqrt();
        for (found, expected) in scaled {
            assert!((found - expected).abs() <= 1e-7 * length + 1e-12);
        }
    }
}
