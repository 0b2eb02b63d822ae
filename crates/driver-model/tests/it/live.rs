//! A drive that goes on is predicted as its beginning would be, if it were cut there.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::LazyLock;

use drive_log::{Channel, LayoutChoice, Preparation, RowReader, Smoothing};
use driver_model::live::{Event, Forecast, LivePredictor, LiveSettings};
use driver_model::speed_ahead::{DirectModel, DirectSettings};
use driver_model::{
    BEGUN_S, DriveBehaviour, DriverModel, Error, FitSettings, Manoeuvre, ModelFile, ModelKind,
    Motion, PhaseCurve, PhaseExtent, PhaseModel, PhaseSettings, TrainingRecord, fit_with,
};
use proptest::prelude::*;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/drives");

/// Rows of a simulated drive with a pedal, there and back in time where it is to be long; a row without a limit and a pedal now and then.
fn rows(number: usize, long: bool) -> Vec<String> {
    let text = std::fs::read_to_string(format!("{FOLDER}/drive-{number:02}.csv")).unwrap();
    let rows: Vec<Vec<String>> = text
        .lines()
        .skip(1)
        .map(|row| row.split(',').map(str::to_owned).collect())
        .collect();
    let back: Vec<_> = rows.iter().rev().skip(1).cloned().collect();
    let all = if long { [rows, back].concat() } else { rows };
    let row = |(k, cells): (usize, &Vec<String>)| {
        let pedal = if k % 97 == 5 {
            String::new()
        } else {
            format!("{}", (k / 30) % 7 * 10)
        };
        let limit = if k % 61 == 7 { "" } else { &cells[2] };
        format!(
            "{:.1},{},{limit},{},{pedal}\n",
            0.1 * k as f64,
            cells[1],
            cells[5]
        )
    };
    all.iter().enumerate().map(row).collect()
}

const HEADER: &str = "time_s,speed_mps,speed_limit_mps,lead_gap_m,accelerator_pedal_pct\n";

fn motion(rows: &[String]) -> Motion {
    let text = HEADER.to_owned() + &rows.concat();
    let read = drive_log::read_bytes(Path::new("a.csv"), text.as_bytes(), &LayoutChoice::Auto);
    let log = read.unwrap().logs.remove(0);
    let drive = drive_log::prepare(log, &Preparation::default()).unwrap();
    assert_eq!(drive.pieces.len(), 1);
    Motion::of_drive(&drive, ev_energy::DEFAULT_SLOPE_BANDWIDTH_M)
        .unwrap()
        .remove(0)
}

fn settings(told: Vec<Channel>) -> LiveSettings {
    LiveSettings {
        step_s: 0.1,
        smoothing: Smoothing::Hann(5),
        max_gap_s: 2.0,
        told,
        horizons_s: Vec::new(),
    }
}

/// Everything that is told of a stream.
fn follow(files: &[ModelFile], text: &str) -> Vec<Event> {
    let reader = RowReader::new(Path::new("stdin"), text.as_bytes(), 0.1, 2.0).unwrap();
    let mut reader = reader.telling(&LivePredictor::CHANNELS);
    let settings = settings(reader.told().to_vec());
    let mut predictor = LivePredictor::new(files.to_vec(), &settings).unwrap();
    let mut events = Vec::new();
    while let Some(row) = reader.next_row(&mut |_| {}).unwrap() {
        events.extend(predictor.push(&row).unwrap());
    }
    events.extend(predictor.finish());
    events
}

fn without_record(model: DriverModel) -> ModelFile {
    let record = TrainingRecord {
        phases: 0,
        points: 0,
        inputs: Vec::new(),
        prior_inputs: Vec::new(),
        prior_weight: 0.0,
        extent: PhaseExtent::Threshold,
    };
    ModelFile::new(model, record, serde_json::json!({}))
}

static AHEAD: LazyLock<DirectModel> = LazyLock::new(|| {
    let motions: Vec<Motion> = (1..=6).map(|number| motion(&rows(number, false))).collect();
    let settings = DirectSettings::at(&[1.0, 5.0]);
    DirectModel::fit(
        ModelKind::Ridge,
        &motions.iter().collect::<Vec<_>>(),
        &settings,
    )
    .unwrap()
});

fn phases(manoeuvre: Manoeuvre, extent: PhaseExtent) -> ModelFile {
    let motions: Vec<Motion> = (1..=6).map(|number| motion(&rows(number, false))).collect();
    let settings = FitSettings {
        phases: PhaseSettings::default().reaching(extent),
        manoeuvre,
        ..FitSettings::default()
    };
    let fitted = fit_with(ModelKind::ProfilePedal, &motions, None, &settings, &|| {}).unwrap();
    without_record(fitted.model).with_memory(fitted.memory)
}

#[test]
fn the_speed_ahead_is_that_of_the_drive_so_far() {
    let file = without_record(DriverModel::SpeedAhead(AHEAD.clone()));
    assert!(AHEAD.needs_limits() && !AHEAD.channels().is_empty());
    assert!(AHEAD.past_s() >= 600.0);
    let rows = rows(9, true);
    let events = follow(&[file], &(HEADER.to_owned() + &rows.concat()));
    let ahead: Vec<&Event> = events
        .iter()
        .filter(|e| matches!(e, Event::Ahead { .. }))
        .collect();
    assert_eq!(ahead.len(), (rows.len() - 53) / 10 + 1);
    let (mut bounds, mut apart) = (0, 0);
    for (number, event) in ahead.iter().enumerate().step_by(7) {
        let Event::Ahead {
            time_s,
            known_s,
            speed_mps,
            horizons,
        } = event
        else {
            continue;
        };
        let origin = 50 + 10 * number;
        // Smoothing looks two samples ahead.
        let motion = motion(&rows[..origin + 3]);
        let expected = AHEAD.predict(&motion, &[origin]).unwrap().remove(0);
        assert!((time_s - 0.1 * origin as f64).abs() < 1e-9);
        assert!((known_s - time_s - 0.2).abs() < 1e-9);
        assert!((speed_mps - motion.speed_mps()[origin]).abs() < 1e-9);
        for (k, found) in horizons.iter().enumerate() {
            let same = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
            assert!(same(found.speed_mps, expected.speed_mps[k]), "{time_s} s");
            let (low_mps, high_mps) = expected.interval_mps[k].unwrap();
            for (found, expected) in [(found.low_mps, low_mps), (found.high_mps, high_mps)] {
                let off_mps = (found.unwrap() - expected).abs();
                assert!(off_mps < 0.2, "{time_s} s: {off_mps}");
                (bounds, apart) = (bounds + 1, apart + usize::from(off_mps > 1e-12));
            }
        }
    }
    // Bounds are by trees. Speeds that are interpolated row by row differ from those of a whole log in the last digit, which decides where a
    // predictor is on a threshold.
    assert!(50 * apart < bounds, "{apart} of {bounds}");
    let remarks = events.iter().filter(|e| matches!(e, Event::Remark { .. }));
    assert_eq!(remarks.count(), 1);
}

#[test]
fn a_stream_without_the_pedal_is_predicted_without_and_it_is_said_once() {
    let file = without_record(DriverModel::SpeedAhead(AHEAD.clone()));
    let rows = rows(9, false);
    let without = rows
        .iter()
        .map(|row| row.rsplit_once(',').unwrap().0.to_owned() + "\n");
    let header = "time_s,speed_mps,speed_limit_mps,lead_gap_m\n";
    let events = follow(&[file], &(header.to_owned() + &without.collect::<String>()));
    let remarks = events.iter().filter_map(|event| match event {
        Event::Remark { text } => Some(text.as_str()),
        _ => None,
    });
    let remarks: Vec<&str> = remarks.collect();
    assert_eq!(remarks.len(), 2, "{remarks:?}");
    assert!(remarks[1].contains("accelerator_pedal_pct"), "{remarks:?}");
    assert!(events.len() > 500);
}

#[test]
fn phases_begin_and_end_where_the_whole_drive_has_them() {
    for extent in [PhaseExtent::Threshold, PhaseExtent::Whole] {
        for manoeuvre in [Manoeuvre::Acceleration, Manoeuvre::Braking] {
            let file = phases(manoeuvre, extent);
            let kind = manoeuvre.into();
            for number in [7, 9] {
                let rows = rows(number, false);
                let motion = motion(&rows);
                let settings = PhaseSettings::default().reaching(extent);
                let trip = DriveBehaviour::of_drive(&[motion], &settings).unwrap();
                let text = HEADER.to_owned() + &rows.concat();
                let events = follow(std::slice::from_ref(&file), &text);
                let mut ends = events.iter().filter_map(|event| match event {
                    Event::PhaseEnds {
                        begin_s,
                        end_s,
                        end_speed_mps,
                        counts: true,
                        ..
                    } => Some((*begin_s, *end_s, *end_speed_mps)),
                    _ => None,
                });
                for curve in trip.phases_of(kind) {
                    let (begin_s, end_s, end_speed_mps) = ends.next().unwrap();
                    let outline = curve.outline();
                    assert!((begin_s - curve.start_s()).abs() < 1e-6);
                    assert!((end_s - begin_s - outline.duration_s()).abs() < 1e-6);
                    assert!((end_speed_mps - outline.end_speed_mps).abs() < 1e-9);
                }
                assert_eq!(ends.next(), None);
                let begins: Vec<f64> = events.iter().filter_map(begin_s).collect();
                let all = trip.phases_of(kind).chain(trip.short_phases_of(kind));
                for curve in all.filter(|curve| curve.early_gain_mps().is_some()) {
                    let began = begins.iter().any(|b| (b - curve.start_s()).abs() < 1e-6);
                    assert!(began, "{} {extent:?}", curve.start_s());
                }
            }
        }
    }
}

fn begin_s(event: &Event) -> Option<f64> {
    match event {
        Event::PhaseBegins { begin_s, .. } => Some(*begin_s),
        _ => None,
    }
}

#[test]
fn a_phase_is_told_once_it_has_lasted_and_its_band_holds_the_median() {
    let file = phases(Manoeuvre::Acceleration, PhaseExtent::Threshold);
    let events = follow(&[file], &(HEADER.to_owned() + &rows(9, false).concat()));
    let mut begun = 0;
    for event in &events {
        let Event::PhaseBegins {
            begin_s,
            from_s,
            known_s,
            forecast,
            ..
        } = event
        else {
            continue;
        };
        begun += 1;
        assert!((from_s - begin_s - BEGUN_S).abs() < 1e-9);
        // The next sample ends the last step, and the window of five reaches two further.
        assert!((known_s - from_s - 0.3).abs() < 1e-9 || (known_s - from_s).abs() < 0.31);
        let Forecast {
            seconds,
            counts_pct,
            duration_s,
            ..
        } = forecast;
        assert!(!seconds.is_empty() && *duration_s >= BEGUN_S);
        assert!((0.0..=100.0).contains(counts_pct));
        for second in seconds {
            assert!(second.low_mps <= second.speed_mps && second.speed_mps <= second.high_mps);
        }
        let shares = seconds.iter().map(|second| second.going_on_pct);
        assert!(shares.collect::<Vec<_>>().is_sorted_by(|a, b| a >= b));
    }
    assert!(begun > 5, "{begun}");
}

#[test]
fn models_that_cannot_follow_are_refused() {
    let refusal = |files: Vec<ModelFile>, settings: &LiveSettings| {
        LivePredictor::new(files, settings).map(|_| ()).unwrap_err()
    };
    let told = settings(LivePredictor::CHANNELS.to_vec());
    let ahead = || without_record(DriverModel::SpeedAhead(AHEAD.clone()));
    let straight = without_record(DriverModel::Acceleration(PhaseModel::Straight));
    assert!(matches!(
        refusal(vec![straight], &told),
        Error::NoMemory { .. }
    ));
    assert!(matches!(
        refusal(vec![ahead(), ahead()], &told),
        Error::TwoOf { .. }
    ));
    assert!(matches!(
        refusal(vec![ahead()], &settings(Vec::new())),
        Error::NoLimits { .. }
    ));
    let slow = LiveSettings {
        step_s: 1.0,
        ..told.clone()
    };
    assert!(matches!(refusal(vec![ahead()], &slow), Error::Steps { .. }));
    let following = driver_model::following::FollowingModel::Idm {
        idm: driver_model::following::Idm::default(),
        desired_speed_mps: 30.0,
    };
    let following = without_record(DriverModel::Following(following));
    assert!(matches!(
        refusal(vec![following], &told),
        Error::NotLive { .. }
    ));
    let nothing = LiveSettings {
        step_s: 0.0,
        ..told
    };
    assert!(matches!(
        refusal(Vec::new(), &nothing),
        Error::Option { .. }
    ));
}

static BOTH: LazyLock<Vec<ModelFile>> = LazyLock::new(|| {
    vec![
        without_record(DriverModel::SpeedAhead(AHEAD.clone())),
        phases(Manoeuvre::Acceleration, PhaseExtent::Threshold),
        phases(Manoeuvre::Braking, PhaseExtent::Whole),
    ]
});

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10))]

    /// Whatever comes, it ends without a panic, and what is predicted are numbers.
    #[test]
    fn any_rows_are_followed(
        cells in prop::collection::vec((prop::num::f64::ANY, prop::num::f64::ANY, -1.0..3.0f64, 0usize..12), 1..400),
    ) {
        let (mut time_s, mut speed_mps) = (0.0, 10.0);
        let mut text = HEADER.to_owned();
        for (any, other, step, which) in cells {
            time_s += if which == 0 { 40.0 * step } else { 0.1 };
            speed_mps = (speed_mps + 0.3 * step - 0.2_f64).clamp(0.0, 40.0);
            let speed = if which == 1 { any } else { speed_mps };
            let _ = match which {
                2 => writeln!(text, "{time_s},{speed},{other},{any},{any}"),
                3 => writeln!(text, "{time_s},{speed},,,x"),
                _ => writeln!(text, "{time_s},{speed},13.9,{},{}", 20.0 * step.abs(), 30.0 * step.abs()),
            };
        }
        let files = &BOTH[..];
        let reader = RowReader::new(Path::new("stdin"), text.as_bytes(), 0.1, 2.0).unwrap();
        let mut reader = reader.telling(&LivePredictor::CHANNELS);
        let settings = settings(reader.told().to_vec());
        let mut predictor = LivePredictor::new(files.to_vec(), &settings).unwrap();
        while let Ok(Some(row)) = reader.next_row(&mut |_| {}) {
            for event in predictor.push(&row).unwrap() {
                prop_assert!(!serde_json::to_string(&event).unwrap().contains("_mps\":null,\"high"));
            }
        }
        predictor.finish();
    }
}

/// What is known when a phase begins is what a finished drive says of it.
#[test]
fn a_beginning_is_that_of_the_recorded_phase() {
    let trip = DriveBehaviour::of_drive(&[motion(&rows(9, false))], &PhaseSettings::default());
    for curve in &trip.unwrap().phases {
        let beginning = driver_model::live::Beginning::of(curve).unwrap();
        let early_mps = curve.speed_mps()[10] - curve.speed_mps()[0];
        assert_eq!(beginning.early_gain_mps, early_mps);
        assert_eq!(beginning.onset, PhaseCurve::outline(curve).onset);
    }
}
