//! Model files: write, read, and refuse what is not one.

use driver_model::phase_model::{Inverse, Profile, RiseTime, SpeedGroup};
use driver_model::{DriverModel, Error, MODEL_SCHEMA, ModelFile, TrainingInput};

fn file(model: DriverModel) -> ModelFile {
    ModelFile {
        schema: MODEL_SCHEMA.to_owned(),
        version: "0.1.0".to_owned(),
        model,
        training_phases: 3,
        training_segments: 5,
        inputs: vec![TrainingInput {
            path: "drive.csv".to_owned(),
            sha256: "ab".to_owned(),
        }],
        config: serde_json::json!({ "min_gain": 10.0 }),
    }
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
        (&good.replace("model/1", "model/9"), "drivekit/model/9"),
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
