//! Vehicle files and loss tables from any bytes: an error or a vehicle whose every figure is finite.
#![no_main]

use ev_energy::{Error, LossTable, OperatingPoint, Trip, Vehicle, VehicleSpec};
use libfuzzer_sys::fuzz_target;

/// Between the vehicle file and its loss table.
const CUT: &str = "\n%%%\n";

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let (vehicle, table) = text.split_once(CUT).unwrap_or((text, ""));
    let table = LossTable::from_csv(table, "loss.csv");
    let Ok(mut spec) = VehicleSpec::from_toml(vehicle, "car.toml") else {
        return;
    };
    if let (Some(losses), Ok(table)) = (&mut spec.motor.loss_table, table) {
        losses.table = Some(table);
    }
    match Vehicle::new(spec) {
        Ok(vehicle) => drive(&vehicle),
        Err(error) => assert!(!matches!(error, Error::Read { .. })),
    }
});

fn drive(vehicle: &Vehicle) {
    for (v, a, slope) in [
        (0.0, 0.0, 0.0),
        (15.0, 1.0, 0.02),
        (30.0, -2.0, -0.05),
        (-3.0, 0.5, 0.1),
        (f64::MAX, f64::MIN, 1.0),
    ] {
        assert!(is_finite(&vehicle.operating_point(v, a, slope)));
    }
    let trip = Trip {
        speed_mps: &[0.0, 3.0, 9.0, 4.0, 0.0],
        soc_start_pct: Some(50.0),
        ..Trip::default()
    };
    let energy = vehicle.trip_energy(&trip).expect("a trip within range");
    assert!(energy.battery_energy_j.is_finite());
    let check = vehicle.check().expect("a vehicle that was read");
    assert!(check.top_speed_mps.is_finite());
    assert_eq!(
        VehicleSpec::from_toml(&vehicle.spec().to_toml().expect("TOML"), "again").ok().map(|s| s.name),
        Some(vehicle.spec().name.clone())
    );
}

fn is_finite(p: &OperatingPoint) -> bool {
    [p.wheel_force_n, p.motor_torque_nm, p.electric_power_w, p.battery_power_w, p.battery_current_a]
        .iter()
        .all(|value| value.is_finite())
}
