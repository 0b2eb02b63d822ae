//! Vehicle files: what is read, what is refused and how.

use ev_energy::{Error, Vehicle, VehicleSpec, library};

const NEWTON_PER_LBF: f64 = 4.448_221_615_260_5;
const MPS_PER_MPH: f64 = 0.447_04;
const KG_PER_LB: f64 = 0.453_592_37;

fn b250e_toml() -> String {
    Vehicle::builtin("b250e").unwrap().spec().to_toml().unwrap()
}

/// The message for the b250e file with one piece of text replaced.
fn message(from: &str, to: &str) -> String {
    let text = b250e_toml();
    assert!(text.contains(from), "{text}");
    Vehicle::from_toml(&text.replace(from, to), "car.toml")
        .unwrap_err()
        .to_string()
}

#[test]
fn library_vehicles_are_valid_named_and_survive_writing() {
    for name in library::names() {
        let vehicle = Vehicle::builtin(name).unwrap();
        let spec = vehicle.spec();
        assert_eq!(spec.name, name);
        assert_eq!(
            &VehicleSpec::from_toml(&spec.to_toml().unwrap(), name).unwrap(),
            spec
        );
        let json = serde_json::to_string(spec).unwrap();
        assert_eq!(&serde_json::from_str::<VehicleSpec>(&json).unwrap(), spec);
    }
}

#[test]
fn every_library_value_has_a_source() {
    for name in library::names() {
        let check = Vehicle::builtin(name).unwrap().check().unwrap();
        assert_eq!(check.without_source, [""; 0], "{name}");
    }
}

#[test]
fn values_without_a_source_are_named() {
    let mut spec = Vehicle::builtin("b250e").unwrap().spec().clone();
    spec.sources.remove("regeneration");
    spec.sources.remove("mass_kg");
    let check = Vehicle::new(spec).unwrap().check().unwrap();
    assert_eq!(check.without_source.len(), 6);
    assert_eq!(check.without_source[0], "mass_kg");
}

#[test]
fn cars_are_as_fast_and_as_efficient_as_cars() {
    for name in library::names() {
        let check = Vehicle::builtin(name).unwrap().check().unwrap();
        assert!(
            (0.9..0.98).contains(&check.peak_efficiency),
            "{name}: {check:?}"
        );
        assert!(
            (36.0..75.0).contains(&check.top_speed_mps),
            "{name}: {check:?}"
        );
        for figure in check.consumption {
            assert!(figure.error_pct.abs() < 25.0, "{name}: {figure:?}");
        }
    }
}

#[test]
fn coast_downs_are_converted_exactly() {
    for (name, lbf, lbf_per_mph, lbf_per_mph2, lb) in [
        ("b250e-coast-down", 31.7, 0.177, 0.0190, 4250.0),
        ("bmw-i3-60ah", 22.9, 0.346, 0.01626, 3125.0),
        ("nissan-leaf-2013", 29.97, 0.0713, 0.02206, 3625.0),
        ("vw-e-golf-2015", 39.36, 0.5083, 0.0125, 3625.0),
        ("tesla-model-3-lr-2017", 38.51, -0.0811, 0.0161, 4250.0),
    ] {
        let spec = Vehicle::builtin(name).unwrap().spec().clone();
        assert_eq!(spec.mass_kg, lb * KG_PER_LB);
        let ev_energy::RoadLoadSpec::CoastDown {
            constant_n,
            linear_n_per_mps,
            quadratic_n_per_mps2,
        } = spec.road_load
        else {
            panic!("{name} has no coast-down");
        };
        assert_eq!(constant_n, lbf * NEWTON_PER_LBF);
        assert_eq!(linear_n_per_mps, lbf_per_mph * NEWTON_PER_LBF / MPS_PER_MPH);
        assert_eq!(
            quadratic_n_per_mps2,
            lbf_per_mph2 * NEWTON_PER_LBF / (MPS_PER_MPH * MPS_PER_MPH)
        );
    }
}

#[test]
fn values_out_of_range_name_file_key_value_and_range() {
    assert_eq!(
        message("mass_kg = 1928.0", "mass_kg = -3.0"),
        "car.toml: `mass_kg` is -3, allowed is 1 to 1000000"
    );
    assert_eq!(
        message("resistance_ohm = 0.08", "resistance_ohm = nan"),
        "car.toml: `battery.resistance_ohm` is NaN, allowed is 0 to 100"
    );
    let inverted = message("fade_end_mps = 4.5", "fade_end_mps = 1.0");
    assert_eq!(
        inverted,
        "car.toml: `regeneration.fade_end_mps` is 1, allowed is 1.51 to 200"
    );
}

#[test]
fn incomplete_and_unknown_keys_are_named() {
    let missing = message("wheel_radius_m = 0.315\n", "");
    assert!(
        missing.starts_with("car.toml: ") && missing.contains("wheel_radius_m"),
        "{missing}"
    );
    let unknown = message("wheel_radius_m", "wheel_radius_cm");
    assert!(
        unknown.starts_with("car.toml: ") && unknown.contains("wheel_radius_cm"),
        "{unknown}"
    );
    let nested = message("max_power_w = 60000.0", "max_powr_w = 60000.0");
    assert!(nested.contains("max_powr_w"), "{nested}");
    let text = message("mass_kg = 1928.0", "mass_kg = \"heavy\"");
    assert!(text.contains("mass_kg") && text.contains("heavy"), "{text}");
    let empty = Vehicle::from_toml("", "car.toml").unwrap_err().to_string();
    assert!(
        empty.starts_with("car.toml: ") && empty.contains("missing field"),
        "{empty}"
    );
}

#[test]
fn sources_must_name_keys() {
    let mut spec = Vehicle::builtin("b250e").unwrap().spec().clone();
    let source = spec.sources["mass_kg"].clone();
    spec.sources.insert("battery.resistance".to_owned(), source);
    let error = Vehicle::new(spec).unwrap_err();
    assert!(
        matches!(&error, Error::UnknownSourceKey { key, .. } if key == "battery.resistance"),
        "{error}"
    );
}

#[test]
fn missing_files_and_names_are_reported() {
    let error = Vehicle::read("no/such/car.toml".as_ref())
        .unwrap_err()
        .to_string();
    assert!(error.starts_with("no/such/car.toml: "), "{error}");
    let error = Vehicle::builtin("trabant").unwrap_err().to_string();
    assert!(
        error.contains("trabant") && error.contains("b250e-coast-down"),
        "{error}"
    );
}
