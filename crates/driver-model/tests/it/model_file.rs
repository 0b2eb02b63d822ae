//! Model files: write, read, and refuse what is not one.

use driver_model::cruise::{Bias, CruiseModel};
use driver_model::following::{FollowingModel, Idm};
use driver_model::phase_model::{Inverse, Profile, RiseTime, SpeedGroup};
use driver_model::{
    DriverModel, Error, ModelFile, Phase, PhaseExtent, PhaseModel, TrainingInput, TrainingRecord,
};
use proptest::prelude::*;

fn file(model: PhaseModel) -> ModelFile {
    let input = |path: &str| TrainingInput {
        path: path.to_owned(),
        sha256: "ab".to_owned(),
    };
    let training = TrainingRecord {
        phases: 3,
        points: 5,
        inputs: vec![input("drive.csv")],
        prior_inputs: vec![input("other.csv")],
        prior_weight: 1.0 / 3.0,
        extent: PhaseExtent::Whole,
    };
    let config = serde_json::json!({ "min_gain": 10.0 });
    ModelFile::new(DriverModel::Braking(model), training, config)
}

fn models() -> Vec<PhaseModel> {
    vec![
        PhaseModel::Inverse(Inverse {
            p1: 0.1,
            p2: 1.0 / 3.0,
        }),
        PhaseModel::Profile(Profile {
            shape: vec![0.0, 0.3, 1.0],
        }),
        PhaseModel::RiseTime(RiseTime {
            groups: vec![driver_model::phase_model::GroupConstant {
                group: SpeedGroup {
                    start_band: 0,
                    end_band: 1,
                },
                time_constant_s: 2.5,
                phases: 7,
            }],
        }),
        PhaseModel::Straight,
    ]
}

#[test]
fn written_and_read_is_the_same() {
    for model in models() {
        let written = file(model);
        let text = written.to_json().unwrap();
        assert_eq!(ModelFile::from_json(&text).unwrap(), written);
    }
}

#[test]
fn foreign_damaged_and_impossible_files_are_refused() {
    let good = file(models().remove(0)).to_json().unwrap();
    let cases = [
        ("", "not JSON"),
        ("{}", "no key `schema`"),
        (&good.replace("model/3", "model/9"), "drivekit/model/9"),
        (&good.replace("\"p2\"", "\"q2\""), "q2"),
        (&good.replace("\"inverse\"", "\"unheard-of\""), "unheard-of"),
        (&good[..good.len() / 2], "EOF"),
        (&good.replace("0.1,", "-0.1,"), "p1 = -0.1"),
        (&good.replace("\"p1\": 0.1", "\"p1\": 1e999"), "number"),
        (&good.replace("\"p1\": 0.1", "\"p1\": 1000"), "p1 = 1000"),
    ];
    for (text, expected) in cases {
        let error = ModelFile::from_json(text).unwrap_err();
        assert!(
            matches!(error, Error::ModelFile { .. } | Error::Parameter { .. }),
            "{error}"
        );
        assert!(
            error.to_string().contains(expected),
            "{error} for {expected}"
        );
    }
}

#[test]
fn a_file_of_another_version_or_program_says_what_to_do() {
    let refusal = |text: &str| match ModelFile::from_json(text) {
        Err(Error::ModelFile { reason }) => reason,
        other => panic!("{other:?}"),
    };
    let old =
        r#"{"schema": "drivekit/model/1", "version": "0.1.0", "model": {"kind": "straight"}}"#;
    let reason = refusal(old);
    assert!(reason.contains("`drivekit/model/1`"), "{reason}");
    assert!(reason.contains("reads `drivekit/model/3`"), "{reason}");
    assert!(reason.contains("drivekit fit"), "{reason}");

    let reason = refusal(r#"{"schema": "drivekit/evaluation/1", "models": []}"#);
    assert!(reason.contains("`drivekit/evaluation/1`"), "{reason}");
    assert!(reason.contains("is no model"), "{reason}");

    let good = file(PhaseModel::Straight).to_json().unwrap();
    let reason = refusal(&good.replace("SI: m, s", "imperial: mi, h"));
    assert!(reason.contains("units"), "{reason}");
    let reason = refusal(&good.replace("\"braking\"", "\"cruise\""));
    assert!(reason.contains("the model:"), "{reason}");
    let reason = refusal(&good.replace("\"behaviour\"", "\"behavior\""));
    assert!(reason.contains("behavior"), "{reason}");
}

#[test]
fn models_of_cruising_and_following_have_files_of_the_same_kind() {
    let cruise = CruiseModel {
        bias: Some(Bias {
            mean_mps: 0.8,
            spread_mps: 0.4,
            stretches: 9,
        }),
        deviation_mps: 0.35,
        correlation_time_s: 120.0,
        stretches: 12,
    };
    let following = FollowingModel::Idm {
        idm: Idm::default(),
        desired_speed_mps: 30.0,
    };
    let training = file(PhaseModel::Straight).training;
    for (model, key, lie) in [
        (
            DriverModel::Cruise(cruise),
            "\"deviation_mps\": 0.35",
            "\"deviation_mps\": -1",
        ),
        (DriverModel::Following(following), "30.0", "9999.0"),
    ] {
        let written = ModelFile::new(model, training.clone(), serde_json::json!({}));
        let text = written.to_json().unwrap();
        assert_eq!(ModelFile::from_json(&text).unwrap(), written);
        assert!(text.contains(key));
        let refused = ModelFile::from_json(&text.replace(key, lie));
        assert!(
            matches!(refused, Err(Error::Parameter { .. })),
            "{refused:?}"
        );
    }
}

proptest! {
    /// Whatever happens to a file, reading it ends in a model or an error, and a model that was read predicts.
    #[test]
    fn a_changed_byte_is_an_error_or_harmless(model in 0..4usize, place in 0.0..1.0f64, byte in 32..127u8) {
        let mut bytes = file(models().remove(model)).to_json().unwrap().into_bytes();
        let index = (place * bytes.len() as f64) as usize;
        bytes[index] = byte;
        let text = String::from_utf8_lossy(&bytes);
        if let Ok(ModelFile { model: DriverModel::Braking(model), .. }) = ModelFile::from_json(&text) {
            let outline = Phase {
                start_speed_mps: 3.0,
                end_speed_mps: 12.0,
                step_s: 0.1,
                samples: 60,
                onset: None,
                input: driver_model::DriverInput::default(),
            };
            prop_assert_eq!(model.predict(&outline).len(), 60);
        }
    }
}
