#![allow(clippy::unwrap_used)]

use drive_log::Channel;

use super::*;
use crate::{ModelKind, Motion, Subject};

/// Speeds that swing by a sum of two sines: what comes next follows from the past.
fn motion(phase: f64) -> Motion {
    let speed = |i: usize| {
        let t = 0.2 * i as f64 + phase;
        12.0 + 4.0 * (0.3 * t).sin() + 2.0 * (0.11 * t).cos()
    };
    let speed_mps: Vec<f64> = (0..1500).map(speed).collect();
    Motion::of_channels(&format!("{phase}"), 0.2, [(Channel::Speed, speed_mps)])
}

fn settings() -> DirectSettings {
    DirectSettings {
        horizons_s: vec![1.0, 3.0],
        max_samples: 1500,
        ..DirectSettings::default()
    }
}

#[test]
fn what_follows_from_the_past_is_predicted_and_files_keep_it() {
    let motions: Vec<Motion> = (0..6).map(|k| motion(40.0 * f64::from(k))).collect();
    let (train, test) = (motions[..5].iter().collect::<Vec<_>>(), &motions[5]);
    for kind in ModelKind::of(Subject::SpeedAhead).filter(|kind| kind.is_fitted()) {
        let model = DirectModel::fit(kind, &train, &settings()).unwrap();
        let origins = model.origins(test, 1.0);
        let error = |model: &DirectModel| model.score(test, &origins).unwrap()[1].rmse_mps.unwrap();
        let stays = DirectModel::fit(ModelKind::Persistence, &train, &settings()).unwrap();
        assert!(
            error(&model) < 0.8 * error(&stays),
            "{kind}: {}",
            error(&model)
        );
        assert!(
            model.one_width_mps(None).all(|interval| interval.is_some()),
            "{kind}"
        );

        let text = serde_json::to_string(&model).unwrap();
        let read: DirectModel = serde_json::from_str(&text).unwrap();
        assert_eq!(
            read.predict(test, &origins).unwrap(),
            model.predict(test, &origins).unwrap(),
            "{kind}"
        );
        let broken = text.replacen("\"horizon_s\":1.0", "\"horizon_s\":-1.0", 1);
        assert!(
            serde_json::from_str::<DirectModel>(&broken).is_err(),
            "{kind}"
        );
    }
}

#[test]
fn baselines_are_what_they_say_and_never_negative() {
    let speed_mps = (0..1500).map(|i| (10.0 - 0.01 * f64::from(i)).max(0.0));
    let motion = Motion::of_channels("slower", 0.2, [(Channel::Speed, speed_mps.collect())]);
    let model = |kind| DirectModel::fit(kind, &[&motion], &settings()).unwrap();
    let ahead = |kind| model(kind).predict(&motion, &[500, 995]).unwrap();
    assert!((ahead(ModelKind::Persistence)[0].speed_mps[1] - 5.0).abs() < 1e-9);
    assert!((ahead(ModelKind::ConstantAcceleration)[0].speed_mps[1] - 4.85).abs() < 1e-9);
    assert!(ahead(ModelKind::ConstantAcceleration)[1].speed_mps[1].abs() < 1e-12);
    let decayed = 5.0 - 0.05 * 2.0 * (1.0 - (-1.5_f64).exp());
    assert!((ahead(ModelKind::DecayingAcceleration)[0].speed_mps[1] - decayed).abs() < 1e-9);
}

#[test]
fn a_drive_of_another_step_or_without_limits_is_refused() {
    let with_limits = |step_s| {
        let speed_mps = motion(0.0).speed_mps().to_vec();
        let channels = [
            (Channel::SpeedLimit, vec![14.0; speed_mps.len()]),
            (Channel::Speed, speed_mps),
        ];
        Motion::of_channels("with limits", step_s, channels)
    };
    let model = DirectModel::fit(ModelKind::Ridge, &[&with_limits(0.2)], &settings()).unwrap();
    assert!(matches!(
        model.predict(&with_limits(1.0), &[10]),
        Err(Error::Steps { .. })
    ));
    assert!(matches!(
        model.predict(&motion(0.0), &[100]),
        Err(Error::NoLimits { .. })
    ));
    let short = Motion::of_channels("short", 0.2, [(Channel::Speed, vec![1.0; 30])]);
    let too_few = DirectModel::fit(ModelKind::Ridge, &[&short], &settings());
    assert!(matches!(too_few, Err(Error::TooFewMoments { .. })));
}

/// The pedal is moved every 4 s; from then on the speed goes to where it points. `has_pedal` says whether the log shows it.
fn pedalled(seed: u32, has_pedal: bool) -> Motion {
    let level = |block: u32| f64::from((block * 7919 + seed * 104_729) % 97) / 97.0;
    let pedal_pct: Vec<f64> = (0..1500).map(|i| 100.0 * level(i / 20)).collect();
    let mut speed = 10.0;
    let speed_mps = pedal_pct.iter().map(|pedal| {
        speed += 0.2 * (0.3 * pedal - speed) / 5.0;
        speed
    });
    let mut channels = vec![(Channel::Speed, speed_mps.collect())];
    if has_pedal {
        channels.push((Channel::AcceleratorPedal, pedal_pct));
    }
    Motion::of_channels(&format!("{seed}"), 0.2, channels)
}

#[test]
fn the_pedal_is_learnt_from_where_logs_have_it_and_drives_without_are_predicted_all_the_same() {
    let motions: Vec<Motion> = (0..8).map(|seed| pedalled(seed, seed != 3)).collect();
    let train: Vec<&Motion> = motions.iter().collect();
    let model = DirectModel::fit(ModelKind::Ridge, &train, &settings()).unwrap();
    assert_eq!(model.channels(), [DriverChannel::AcceleratorPedal]);
    assert_eq!(model.drives(), (7, 8));
    let untold = model.clone().without_channels();
    assert!(untold.channels().is_empty());

    let (with, without) = (pedalled(20, true), pedalled(20, false));
    let origins = model.origins(&with, 1.0);
    let rmse = |model: &DirectModel| model.score(&with, &origins).unwrap()[0].rmse_mps.unwrap();
    assert!(
        rmse(&model) < 0.8 * rmse(&untold),
        "{} {}",
        rmse(&model),
        rmse(&untold)
    );
    assert!(model.falls_back(&without) && !model.falls_back(&with));
    assert_eq!(
        model.predict(&without, &origins).unwrap(),
        untold.predict(&without, &origins).unwrap()
    );
    let few = DirectModel::fit(ModelKind::Ridge, &[&motions[3], &motions[4]], &settings()).unwrap();
    assert!(
        few.channels().is_empty(),
        "half of the time is not most of it"
    );
}

/// Calm above 10 m/s, erratic below.
fn uneven(seed: u32) -> Motion {
    let mut state = u64::from(seed) + 1;
    let mut noise = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
    };
    let speed_mps = (0..3000).map(|i| {
        let calm = (i / 300) % 2 == 0;
        if calm {
            15.0 + 0.1 * noise()
        } else {
            5.0 + 3.0 * noise()
        }
    });
    Motion::of_channels(
        &format!("{seed}"),
        0.2,
        [(Channel::Speed, speed_mps.collect())],
    )
}

#[test]
fn intervals_are_narrow_where_the_speed_is_certain_and_hold_their_share() {
    let motions: Vec<Motion> = (0..9).map(uneven).collect();
    let (train, test) = (motions[..8].iter().collect::<Vec<_>>(), &motions[8]);
    let model = DirectModel::fit(ModelKind::Ridge, &train, &settings()).unwrap();
    let origins = model.origins(test, 1.0);
    let score = &model.score(test, &origins).unwrap()[0];
    assert!(
        (score.inside_pct.unwrap() - 90.0).abs() < 4.0,
        "{:?}",
        score.inside_pct
    );
    let width = |calm: bool| {
        let of_kind = origins
            .iter()
            .enumerate()
            .filter(|(_, origin)| ((**origin / 300) % 2 == 0) == calm);
        mean(of_kind.map(|(k, _)| score.high_mps[k] - score.low_mps[k])).unwrap()
    };
    assert!(
        width(true) < 0.7 * width(false),
        "{} {}",
        width(true),
        width(false)
    );
}

/// Small enough that a byte changed at random often hits something that matters.
fn small_file() -> (String, Motion) {
    let motions: Vec<Motion> = (0..2).map(|k| motion(40.0 * f64::from(k))).collect();
    let settings = DirectSettings {
        horizons_s: vec![1.0],
        max_samples: 60,
        ..DirectSettings::default()
    };
    let train: Vec<&Motion> = motions.iter().collect();
    let model = DirectModel::fit(ModelKind::Blend, &train, &settings).unwrap();
    (serde_json::to_string(&model).unwrap(), motion(7.0))
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(400))]
    #[test]
    fn a_changed_byte_of_a_file_is_an_error_or_harmless(places in proptest::collection::vec((0.0..1.0f64, 32..127u8), 1..4)) {
        static FILE: std::sync::OnceLock<(String, Motion)> = std::sync::OnceLock::new();
        let (text, motion) = FILE.get_or_init(small_file);
        let mut bytes = text.clone().into_bytes();
        for (place, byte) in places {
            let index = (place * bytes.len() as f64) as usize;
            bytes[index] = byte;
        }
        if let Ok(model) = serde_json::from_slice::<DirectModel>(&bytes) {
            let origins = model.moments(motion, 30.0);
            let _ = model.score(motion, &origins);
        }
    }
}
