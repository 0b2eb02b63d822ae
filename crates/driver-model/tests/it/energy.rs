//! From logs to energy: what the vehicle model is given, and how well a calibrated one does on recorded drives.

use std::collections::BTreeMap;

use drive_log::{Channel, Drive, DriveLog};
use driver_model::energy::{EnergyTotals, drive_energy};
use driver_model::portrait::Portrait;
use driver_model::{DriveBehaviour, Error, PhaseSettings, SlopeSource};

use crate::support::{SAMPLES, i3, motions, steady};

fn drive(channels: &[(Channel, f64)]) -> Drive {
    let speed = (0..SAMPLES).map(|i| (12.0 + 8.0 * (i as f64 * 0.01).sin()).max(0.0));
    let mut all: BTreeMap<Channel, Vec<f64>> = channels
        .iter()
        .map(|(channel, value)| (*channel, vec![*value; SAMPLES]))
        .collect();
    all.insert(Channel::Speed, speed.collect());
    Drive::from(DriveLog::new("drive", 0.0, 0.1, all).unwrap())
}

fn energy(channels: &[(Channel, f64)]) -> driver_model::energy::DriveEnergy {
    drive_energy(&motions(&[&drive(channels)]), &i3(), &mut |_| {}).unwrap()
}

#[test]
fn slope_comes_from_the_best_that_the_log_has() {
    use Channel::{Accelerometer, Elevation, Slope};
    for (channels, source) in [
        (&[][..], SlopeSource::Level),
        (&[(Elevation, 500.0)], SlopeSource::Elevation),
        (&[(Accelerometer, 0.0)], SlopeSource::Accelerometer),
        (
            &[(Accelerometer, 0.0), (Elevation, 500.0)],
            SlopeSource::ElevationAndAccelerometer,
        ),
        (
            &[(Slope, 0.02), (Accelerometer, 0.0), (Elevation, 500.0)],
            SlopeSource::Recorded,
        ),
    ] {
        assert_eq!(energy(channels).slope.source, source);
    }
    let uphill = energy(&[(Slope, 0.02)]);
    let level = energy(&[]);
    let more_j = uphill.modelled.terminal_energy_j - level.modelled.terminal_energy_j;
    assert!((uphill.slope.energy_j - more_j).abs() < 1e-6 && more_j > 0.0);
    assert_eq!(level.slope.energy_j, 0.0);
}

#[test]
fn an_error_about_one_of_many_drives_names_it() {
    let rocket = steady("rocket", 2000.0, &[(Channel::Elevation, 500.0)]);
    let drives = motions(&[&drive(&[]), &rocket]);
    let errors = [
        drive_energy(&motions(&[&rocket]), &i3(), &mut |_| {}).err(),
        Portrait::of(&drives, &i3(), &PhaseSettings::default()).err(),
    ];
    for error in errors {
        let error = error.unwrap();
        assert!(
            matches!(&error, Error::InLog { log, .. } if log == "rocket"),
            "{error}"
        );
        assert!(
            error
                .to_string()
                .starts_with("rocket: `speed_mps`[0] is 2000"),
            "{error}"
        );
    }
}

#[test]
fn a_car_that_creeps_back_at_every_stop_drives_on() {
    let creeping = |v_mps: f64| {
        let speed = (0..SAMPLES).map(|i| 10.0 * (i as f64 * 0.01).sin());
        let speed = speed.map(|v| if v > 0.0 { v } else { v_mps });
        let channels = BTreeMap::from([
            (Channel::Speed, speed.collect()),
            (Channel::Elevation, vec![500.0; SAMPLES]),
        ]);
        Drive::from(DriveLog::new("creeping", 0.0, 0.1, channels).unwrap())
    };
    let [standing, back] = [0.0, -0.01].map(creeping);
    let energy_j = |drive: &Drive| {
        let energy = drive_energy(&motions(&[drive]), &i3(), &mut |_| {}).unwrap();
        energy.modelled.terminal_energy_j
    };
    assert!((energy_j(&back) / energy_j(&standing) - 1.0).abs() < 0.1);
    let distance_m = back.pieces[0].distance_m();
    assert!(distance_m.windows(2).all(|pair| pair[1] >= pair[0]));
    assert!(
        back.pieces[0]
            .place_m()
            .windows(2)
            .any(|pair| pair[1] < pair[0])
    );
    DriveBehaviour::of_drive(&motions(&[&back]), &PhaseSettings::default()).unwrap();
}

#[test]
fn auxiliaries_add_to_the_base_of_the_vehicle() {
    let heated = energy(&[
        (Channel::HeatingPower, 2000.0),
        (Channel::AuxPower, f64::NAN),
    ]);
    assert!((heated.auxiliaries.mean_w.unwrap() - 2300.0).abs() < 1e-6);
    assert_eq!(
        heated.auxiliaries.source,
        "base 300 W + aux_power_w + heating_power_w"
    );
    assert_eq!(energy(&[]).auxiliaries.source, "base 300 W");
}

#[test]
fn cold_air_costs_energy_and_charge_is_followed() {
    let at = |degc| energy(&[(Channel::AmbientTemperature, degc)]);
    let (cold, mild) = (at(-5.0), at(20.0));
    assert_eq!(cold.ambient_degc, Some(-5.0));
    assert!(cold.modelled.terminal_energy_j > 1.05 * mild.modelled.terminal_energy_j);
    let charged = energy(&[(Channel::StateOfCharge, 80.0)]);
    let end_pct = charged.modelled.soc_end_pct.unwrap();
    assert_eq!(charged.soc_start_pct, Some(80.0));
    assert!((75.0..80.0).contains(&end_pct), "{end_pct}");
    assert_eq!(mild.modelled.soc_end_pct, None);
}

#[test]
fn the_curve_covers_the_drive_in_half_seconds() {
    let curve = energy(&[
        (Channel::BatteryVoltage, 380.0),
        (Channel::BatteryCurrent, 10.0),
    ]);
    assert_eq!(curve.curve.time_s.len(), (SAMPLES - 1).div_ceil(5));
    assert_eq!(curve.curve.time_s[1], 0.5);
    assert!(curve.curve.measured_w.iter().all(|p| *p == Some(3800.0)));
    let totals = EnergyTotals::of(&[&curve, &curve]);
    let energy_j = 3800.0 * 0.1 * (SAMPLES - 1) as f64;
    let measured_j = totals.measured_terminal_energy_j.unwrap();
    assert!((measured_j - 2.0 * energy_j).abs() < 1e-3);
    assert_eq!(totals.error_pct, curve.measured.error_pct);
}
