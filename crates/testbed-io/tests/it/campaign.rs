//! Campaigns: counts, reproducibility, and that the hardened preset holds.

use testbed_io::{Campaign, Disturbances, Group, NamedScenario, RunSpec, SettingsOf};
use unicycle_cbf::{Preset, Testbed};

fn campaign(presets: &[Preset], groups: &[Group], runs: usize) -> Campaign {
    let of = |preset: &Preset| NamedScenario::built_in(&Testbed::ALL, &[], *preset).unwrap();
    Campaign {
        scenarios: presets.iter().flat_map(of).collect(),
        groups: groups.to_vec(),
        runs,
        seed: 1000,
        disturbances: Disturbances::HARD,
    }
}

#[test]
fn the_hardened_preset_holds_under_everything_at_once() {
    let report = campaign(&[Preset::Hardened], &[Group::All], 130)
        .run(&|| {})
        .unwrap();
    let tally = &report.totals[0].tally;
    assert_eq!(
        (tally.runs, tally.violations),
        (130, 0),
        "{:?}",
        report.violations
    );
    assert!(tally.min_h_headway_m.unwrap() > 0.0 && tally.min_lane_clearance_m > 0.0);
}

#[test]
fn every_violation_is_counted_and_its_seed_repeats_it() {
    let report = campaign(&[Preset::Thesis], &[Group::None, Group::All], 65)
        .run(&|| {})
        .unwrap();
    let (calm, rough) = (&report.totals[0].tally, &report.totals[1].tally);
    assert_eq!(calm.violations, 0, "{:?}", report.violations);
    assert!(rough.violations > 20, "{}", rough.violations);
    let rows = report
        .rows
        .iter()
        .filter(|row| row.disturbance == Group::All);
    assert_eq!(
        rows.map(|row| row.tally.violations).sum::<usize>(),
        rough.violations
    );
    assert_eq!(report.violations.len(), 20);
    for violation in &report.violations {
        let testbed = Testbed::ALL
            .into_iter()
            .find(|t| t.name() == violation.testbed)
            .unwrap();
        let SettingsOf::Preset(preset) = violation.preset else {
            panic!("{violation:?}");
        };
        let spec = RunSpec {
            seed: violation.seed,
            scenario: testbed.scenario(&violation.scenario, preset).unwrap(),
            disturbances: Disturbances::HARD.only(violation.disturbance),
            link: None,
        };
        let (_, summary) = spec.simulate().unwrap();
        assert_eq!(summary.first_unsafe_s, violation.first_unsafe_s);
        assert_eq!(summary.min_h_headway_m, violation.min_h_headway_m);
        assert_eq!(summary.lane_clearance_m, violation.lane_clearance_m);
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let campaign = campaign(&[Preset::Hardened], &[Group::All], 26);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let mut report = pool.install(|| campaign.run(&|| {})).unwrap();
        (report.seconds, report.simulated_s_per_s) = (0.0, 0.0);
        report
    };
    assert_eq!(with(1), with(2));
}
