//! Vehicles fitted to drives.

use drive_log::{Channel, Drive, LayoutChoice, Preparation, prepare, read_file};
use driver_eval::Error;
use driver_eval::calibration::calibrate_vehicle;

use crate::shared::shared;
use crate::support::{i3, motions, steady};

#[test]
fn an_error_about_one_of_many_drives_names_it() {
    let battery = [
        (Channel::BatteryVoltage, 350.0),
        (Channel::BatteryCurrent, 30.0),
    ];
    let (driven, rocket) = (
        steady("driven", 20.0, &battery),
        steady("rocket", 2000.0, &battery),
    );
    let error = calibrate_vehicle(&motions(&[&driven, &rocket]), &i3(), false, &|| {}).unwrap_err();
    assert!(
        matches!(&error, Error::Model(driver_model::Error::InLog { log, .. }) if log == "rocket"),
        "{error}"
    );
}

#[test]
fn drives_that_cannot_be_calibrated_to_are_named() {
    let battery = |amps: f64| {
        [
            (Channel::BatteryVoltage, 350.0),
            (Channel::BatteryCurrent, amps),
        ]
    };
    let turned = steady("turned", 20.0, &battery(-30.0));
    let blind = steady("blind", 20.0, &[]);
    let error = calibrate_vehicle(&motions(&[&turned, &blind]), &i3(), false, &|| {}).unwrap_err();
    let text = error.to_string();
    assert!(
        text.contains("turned: measured energy is negative"),
        "{text}"
    );
    assert!(text.contains("blind: less than a minute"), "{text}");
    let driven = steady("driven", 20.0, &battery(30.0));
    let drives = [&turned, &driven, &blind];
    let report = calibrate_vehicle(&motions(&drives), &i3(), false, &|| {}).unwrap();
    let left_out: Vec<&str> = report
        .left_out_drives
        .iter()
        .map(|l| l.log.as_str())
        .collect();
    assert_eq!(left_out, ["turned", "blind"]);
    assert_eq!((report.trips.len(), report.record()), (1, None));
    assert_eq!(report.vehicle.spec(), i3().spec());
}

/// Every third clean trip of the recorded BMW i3; all of them are in docs/results.md.
#[test]
fn a_calibrated_car_is_right_about_trips_it_has_not_seen() {
    let Some(folder) = shared("data/bmw-i3") else {
        return;
    };
    let entries = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| {
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        !["TripA04", "TripB34"].contains(&name.as_str())
    });
    files.sort();
    let drives: Vec<Drive> = files
        .iter()
        .step_by(3)
        .map(|file| {
            let mut logs = read_file(file, &LayoutChoice::Auto).unwrap().logs;
            prepare(logs.remove(0), &Preparation::default()).unwrap()
        })
        .collect();
    let drives: Vec<&Drive> = drives.iter().collect();
    let report = calibrate_vehicle(&motions(&drives), &i3(), false, &|| {}).unwrap();
    let (before, held_out) = (report.summary.start, report.summary.held_out);
    assert!(held_out.mean_abs_error_pct.unwrap() < 6.0, "{held_out:?}");
    assert!(
        held_out.total_error_pct.unwrap().abs() < 2.0,
        "{held_out:?}"
    );
    assert!(
        held_out.median_power_rmse_w.unwrap() < 2000.0,
        "{held_out:?}"
    );
    assert!(before.mean_abs_error_pct > held_out.mean_abs_error_pct);
    let counts = report.residuals.speed.iter().map(|bin| bin.count);
    let means: usize = report.residuals.power.iter().map(|bin| bin.count).sum();
    assert_eq!(counts.sum::<usize>(), means);
}
