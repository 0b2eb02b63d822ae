//! What holds for all simulated drives.

use std::path::Path;

use drive_log::{Channel, Drive, DriveLog, LayoutChoice, Preparation};
use drive_sim::{
    Error, Regime, SimulatedDrive, SimulatedDriver, SynthSettings, TRUTH_SCHEMA, TruePhase, Truth,
    simulate,
};
use driver_model::{
    DriveBehaviour, ModelKind, Motion, PhaseCurve, PhaseKind, PhaseModel, PhaseSettings, Span,
};
use ev_energy::Vehicle;
use proptest::prelude::*;

pub(crate) fn vehicle() -> Vehicle {
    Vehicle::builtin("b250e").unwrap()
}

pub(crate) fn run(settings: &SynthSettings) -> Vec<SimulatedDrive> {
    simulate(settings, &vehicle()).unwrap()
}

/// Every phase alike, nobody in the way, sensors exact.
pub(crate) fn ideal(kind: ModelKind) -> SynthSettings {
    SynthSettings {
        drives: 4,
        driver: SimulatedDriver::with(kind).unwrap(),
        variation: 0.0,
        sensor_noise: false,
        leaders: false,
        ..SynthSettings::default()
    }
}

/// Bits of all channels; not-a-number equals itself.
fn bits(log: &DriveLog) -> Vec<(Channel, Vec<u64>)> {
    log.channels()
        .map(|(channel, values)| (channel, values.iter().map(|v| v.to_bits()).collect()))
        .collect()
}

pub(crate) fn complete_accelerations(drive: &SimulatedDrive) -> impl Iterator<Item = &TruePhase> {
    drive
        .phases
        .iter()
        .filter(|p| p.regime == Regime::Acceleration && p.complete)
}

pub(crate) fn curve(log: &DriveLog, phase: &TruePhase) -> PhaseCurve {
    let phase = Span {
        start: phase.start,
        end: phase.end,
        kind: PhaseKind::Acceleration,
        lead_influenced: false,
    };
    PhaseCurve::cut(&Motion::of_log(log, 100.0).unwrap(), &phase).unwrap()
}

#[test]
fn the_same_seed_gives_the_same_bits() {
    let settings = SynthSettings {
        drives: 3,
        duration_s: 120.0,
        ..SynthSettings::default()
    };
    let drives = run(&settings);
    for (a, b) in drives.iter().zip(run(&settings)) {
        assert_eq!(bits(&a.log), bits(&b.log));
        assert_eq!(a.phases, b.phases);
    }
    let other = run(&SynthSettings {
        seed: 99,
        ..settings
    });
    for (a, b) in drives.iter().zip(&other) {
        assert_ne!(bits(&a.log), bits(&b.log));
    }
    assert_ne!(bits(&drives[0].log), bits(&drives[1].log));
}

#[test]
fn a_drive_does_not_depend_on_how_many_there_are() {
    let few = SynthSettings {
        drives: 2,
        duration_s: 100.0,
        ..SynthSettings::default()
    };
    let many = SynthSettings {
        drives: 5,
        ..few.clone()
    };
    for (a, b) in run(&few).iter().zip(&run(&many)) {
        assert_eq!(a.log.name(), b.log.name());
        assert_eq!(bits(&a.log), bits(&b.log));
    }
}

#[test]
fn noise_changes_the_sensors_and_not_the_drive() {
    let noisy = SynthSettings {
        drives: 1,
        ..SynthSettings::default()
    };
    let exact = SynthSettings {
        sensor_noise: false,
        ..noisy.clone()
    };
    let (noisy, exact) = (run(&noisy).remove(0), run(&exact).remove(0));
    assert_eq!(noisy.phases, exact.phases);
    let errors: Vec<f64> = noisy
        .log
        .speed_mps()
        .iter()
        .zip(exact.log.speed_mps())
        .filter(|&(_, &v)| v > 0.1)
        .map(|(a, b)| a - b)
        .collect();
    let variance = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
    // 0.015 m/s of noise and 0.01 m/s of resolution.
    let expected = (0.015_f64.powi(2) + 0.01_f64.powi(2) / 12.0).sqrt();
    assert!((variance.sqrt() / expected - 1.0).abs() < 0.05);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn every_drive_is_possible(
        seed in any::<u64>(),
        kind in 0..SimulatedDriver::KINDS.len(),
        variation in 0.0..2.0,
        sensor_noise in any::<bool>(),
    ) {
        let settings = SynthSettings {
            seed,
            drives: 1,
            duration_s: 300.0,
            driver: SimulatedDriver::with(SimulatedDriver::KINDS[kind]).unwrap(),
            variation,
            sensor_noise,
            ..SynthSettings::default()
        };
        let drive = run(&settings).remove(0);
        let log = &drive.log;
        prop_assert_eq!(log.len(), 3000);
        prop_assert!(log.speed_mps().iter().all(|&v| (0.0..60.0).contains(&v)));
        let gaps = log.channel(Channel::LeadGap).unwrap();
        prop_assert!(gaps.iter().all(|&gap| gap.is_nan() || gap > 0.5));
        let pedals = if sensor_noise { 12.0 } else { 9.0 };
        prop_assert!(log.accel_mps2().iter().all(|a| a.abs() < pedals));

        let phases = &drive.phases;
        prop_assert_eq!(phases[0].start, 0);
        prop_assert_eq!(phases[phases.len() - 1].end, log.len());
        for pair in phases.windows(2) {
            prop_assert_eq!(pair[0].end - 1, pair[1].start);
            prop_assert!(pair[0].end - pair[0].start >= 2);
        }
        for phase in phases.iter().filter(|p| p.regime == Regime::Standstill) {
            prop_assert!(log.speed_mps()[phase.start..phase.end].iter().all(|&v| v == 0.0));
        }
    }
}

#[test]
fn nobody_drives_through_a_leader() {
    for step_s in [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0] {
        for seed in 0..4 {
            let settings = SynthSettings {
                drives: 3,
                seed,
                step_s,
                duration_s: 600.0,
                sensor_noise: false,
                ..SynthSettings::default()
            };
            for drive in run(&settings) {
                let gap_m = drive.log.channel(Channel::LeadGap).unwrap_or_default();
                let nearest_m = gap_m.iter().copied().fold(f64::INFINITY, f64::min);
                assert!(nearest_m > 0.9, "{step_s} s, seed {seed}: {nearest_m} m");
            }
        }
    }
}

#[test]
fn limits_are_kept_at_the_sign() {
    for kind in [ModelKind::Profile, ModelKind::Inverse] {
        let settings = ideal(kind);
        let bias_mps = settings.driver.cruise.bias_mps;
        for drive in run(&settings) {
            let limit = drive.log.channel(Channel::SpeedLimit).unwrap();
            let speed = drive.log.speed_mps();
            let signs: Vec<usize> = (1..limit.len())
                .filter(|&k| limit[k] < limit[k - 1])
                .collect();
            for k in signs {
                assert!(
                    speed[k] <= limit[k] + bias_mps + 0.1,
                    "{} at {k}",
                    drive.log.name()
                );
            }
        }
    }
}

#[test]
fn elevation_is_the_integral_of_the_slope() {
    for drive in run(&ideal(ModelKind::Profile)) {
        let slope = drive.log.channel(Channel::Slope).unwrap();
        let elevation = drive.log.channel(Channel::Elevation).unwrap();
        let distance = drive.log.distance_m();
        let mut climbed_m = elevation[0];
        for k in 1..slope.len() {
            let sine = 0.5 * (slope[k - 1].sin() + slope[k].sin());
            climbed_m += sine * (distance[k] - distance[k - 1]);
            // Rounding: 10⁻³ m of elevation, 10⁻⁵ rad of slope over some km.
            assert!((climbed_m - elevation[k]).abs() < 0.02, "at {k}");
        }
    }
}

#[test]
fn volts_times_amps_is_what_the_vehicle_model_says() {
    let vehicle = vehicle();
    let settings = SynthSettings {
        sensor_noise: false,
        ..SynthSettings::default()
    };
    for drive in run(&settings) {
        let log = &drive.log;
        let voltage = log.channel(Channel::BatteryVoltage).unwrap();
        let current = log.channel(Channel::BatteryCurrent).unwrap();
        let power: Vec<f64> = voltage.iter().zip(current).map(|(u, i)| u * i).collect();
        let measured_j: f64 = power
            .windows(2)
            .map(|p| 0.5 * (p[0] + p[1]) * log.step_s())
            .sum();
        let model = vehicle
            .trip_energy(&ev_energy::Trip {
                step_s: log.step_s(),
                speed_mps: log.speed_mps(),
                slope_rad: log.channel(Channel::Slope),
                ..ev_energy::Trip::default()
            })
            .unwrap();
        // Samples against steps: the two differ where acceleration jumps.
        let error = measured_j / model.terminal_energy_j - 1.0;
        assert!(error.abs() < 1e-3, "{} {error}", log.name());
    }
}

/// Reads the drive as if from a file.
fn read_back(drive: &SimulatedDrive) -> (usize, Drive) {
    let mut csv = Vec::new();
    drive_log::write_csv(&drive.log, &mut csv).unwrap();
    let path = Path::new("drive.csv");
    let file = drive_log::read_bytes(path, &csv, &LayoutChoice::Auto).unwrap();
    let recorded = file.logs.into_iter().next().unwrap();
    let prepared = drive_log::prepare(recorded, &Preparation::default()).unwrap();
    (csv.len(), prepared)
}

/// Phases as the heuristic route finds them.
pub(crate) fn found(drive: &SimulatedDrive) -> DriveBehaviour {
    let motions = Motion::of_drive(&read_back(drive).1, 100.0).unwrap();
    DriveBehaviour::of_drive(&motions, &PhaseSettings::default()).unwrap()
}

#[test]
fn the_default_drives_are_small_and_clean() {
    let mut bytes = 0;
    for drive in run(&SynthSettings::default()) {
        let (size, prepared) = read_back(&drive);
        bytes += size;
        // Nobody ahead is no defect of the log, whether or not it is reported.
        let mut findings = prepared.findings.iter();
        assert!(
            findings.all(|f| f.channel.starts_with("lead_")),
            "{:?}",
            prepared.findings
        );
    }
    assert!(bytes < 5_000_000, "{bytes}");
}

#[test]
fn the_default_drives_offer_enough_to_learn_from() {
    for drive in run(&SynthSettings::default()) {
        let trip = found(&drive);
        let free = trip.phases_of(PhaseKind::Acceleration).count();
        let led = trip.lead_influenced.acceleration;
        assert!(free >= 10 && free > 2 * led, "{}: {free}, {led}", trip.name);
    }
}

#[test]
fn the_truth_document_holds_the_model() {
    let settings = SynthSettings {
        drives: 2,
        duration_s: 60.0,
        ..SynthSettings::default()
    };
    let drives = run(&settings);
    let vehicle = vehicle();
    let truth = serde_json::to_value(Truth::new(&settings, &vehicle, &drives)).unwrap();
    assert_eq!(truth["schema"], TRUTH_SCHEMA);
    assert_eq!(truth["vehicle"], "b250e");
    assert_eq!(truth["drives"][1]["name"], "drive-02");
    assert_eq!(truth["drives"][0]["phases"][0]["regime"], "standstill");
    let model: PhaseModel =
        serde_json::from_value(truth["settings"]["driver"]["acceleration"].clone()).unwrap();
    assert_eq!(model, settings.driver.acceleration);
}

#[test]
fn settings_out_of_range_are_named() {
    let refused = |change: &dyn Fn(&mut SynthSettings)| {
        let mut settings = SynthSettings::default();
        change(&mut settings);
        match simulate(&settings, &vehicle()) {
            Err(Error::Setting { name, .. }) => name,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(refused(&|s| s.drives = 0), "drives");
    assert_eq!(refused(&|s| s.step_s = 0.0), "step_s");
    assert_eq!(refused(&|s| s.step_s = f64::NAN), "step_s");
    assert_eq!(refused(&|s| s.duration_s = f64::INFINITY), "duration_s");
    assert_eq!(refused(&|s| s.variation = -0.1), "variation");
    assert_eq!(
        refused(&|s| s.driver.cruise.bias_mps = -9.0),
        "cruise.bias_mps"
    );
    assert_eq!(
        refused(&|s| s.driver.following.time_headway_s = 0.0),
        "idm.time_headway_s"
    );
    assert_eq!(
        refused(&|s| {
            s.drives = 999;
            s.duration_s = 86_400.0;
        }),
        "drives · duration_s / step_s"
    );
}
