//! Model files: write, read, and refuse what is not one.

use driver_model::phase_model::{Inverse, Profile, RiseTime, SpeedGroup};
use driver_model::{DriverModel, Error, ModelFile, PhaseKind, TrainingInput, TrainingRecord};

fn file(model: DriverModel) -> ModelFile {
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
    };
    let config = serde_json::json!({ "min_gain": 10.0 });
    ModelFile::new(PhaseKind::Braking, model, training, config)
}

fn models() -> Vec<DriverModel> {
    vec![
        DriverModel::Inverse(Inverse {
            p1: 0.1,
            p2: 1.0 / 3.0,
        }),
        DriverModel::Profile(Profile {
            shape: vec![0.0, 0.3, 1.0],
        }),
        DriverModel::RiseTime(RiseTime {
            groups: vec![driver_model::phase_model::GroupConstant {
                group: SpeedGroup {
                    start_band: 0,
                    end_band: 1,
                },
                time_constant_s: 2.5,
                phases: 7,
            }],
        }),
        DriverModel::Straight,
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
        (&good.replace("model/2", "model/9"), "drivekit/model/9"),
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
    assert!(reason.contains("reads `drivekit/model/2`"), "{reason}");
    assert!(reason.contains("drivekit fit"), "{reason}");

    let reason = refusal(r#"{"schema": "drivekit/evaluation/1", "models": []}"#);
    assert!(reason.contains("`drivekit/evaluation/1`"), "{reason}");
    assert!(reason.contains("is no model"), "{reason}");

    let good = file(DriverModel::Straight).to_json().unwrap();
    let reason = refusal(&good.replace("SI: m, s", "imperial: mi, h"));
    assert!(reason.contains("units"), "{reason}");
    let reason = refusal(&good.replace("\"braking\"", "\"cruise\""));
    assert!(reason.contains("cruise"), "{reason}");
    let reason = refusal(&good.replace("\"phase\"", "\"phrase\""));
    assert!(reason.contains("phrase"), "{reason}");
}
