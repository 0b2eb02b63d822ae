//! What a user of the library wants to write, in the fewest lines.

use driver_model::{Error, ModelKind, Motion, Phase, Prior, Situation, fit};

/// Rises and falls of many heights, ten samples a second.
fn samples(phase: f64) -> (Vec<f64>, Vec<f64>) {
    let time_s: Vec<f64> = (0..6000).map(|k| 0.1 * f64::from(k)).collect();
    let speed = |t: &f64| {
        let height = 9.0 + 4.0 * (t / 40.0 + phase).sin();
        height * (1.0 - (t / 4.0).cos())
    };
    let speed_mps = time_s.iter().map(speed).collect();
    (time_s, speed_mps)
}

#[test]
fn three_lines_from_two_vectors_to_a_prediction() -> Result<(), Error> {
    let (time_s, speed_mps) = samples(0.0);

    let m = Motion::from_samples("anna", &time_s, &speed_mps)?;
    let model = fit(ModelKind::ProfileOnset, &[m], None)?;
    let v = model.predict(&Phase::from_to(0.0, 13.9).lasting(8.0))?;

    assert_eq!(v.len(), 81);
    assert!(v[0].abs() < 1e-9 && (v[80] - 13.9).abs() < 1e-9);
    assert!(v.windows(2).all(|pair| pair[1] > pair[0] - 0.2));
    Ok(())
}

#[test]
fn every_kind_of_model_is_fitted_by_one_function_and_says_what_it_cannot_predict() {
    let motions = [0.0, 1.0, 2.0].map(|phase| {
        let (time_s, speed_mps) = samples(phase);
        Motion::from_samples("anna", &time_s, &speed_mps).unwrap()
    });
    let others = Prior {
        motions: &motions[1..],
        weight: 0.3,
    };
    assert!(fit(ModelKind::Profile, &motions[..1], Some(others)).is_ok());
    assert!(matches!(
        fit(ModelKind::Idm, &motions, Some(others)),
        Err(Error::NoPrior { .. })
    ));
    let ahead = fit(ModelKind::Ridge, &motions, None).unwrap();
    let moment = Situation::Moment {
        motion: &motions[0],
        origin: 1000,
    };
    assert_eq!(ahead.predict(moment).unwrap().len(), 10);
    let phase = Phase::from_to(0.0, 13.9).lasting(8.0);
    assert!(matches!(ahead.predict(&phase), Err(Error::Subject { .. })));
}

#[test]
fn a_recording_with_a_gap_is_no_motion() {
    let (mut time_s, speed_mps) = samples(0.0);
    for time in &mut time_s[3000..] {
        *time += 60.0;
    }
    assert!(matches!(
        Motion::from_samples("anna", &time_s, &speed_mps),
        Err(Error::Broken { pieces: 2, .. })
    ));
}
