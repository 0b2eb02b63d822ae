//! Campaigns: counts, reproducibility, and that the hardened preset holds.

use testbed_sim::campaign::Violation;
use testbed_sim::{Campaign, Disturbances, Group, NamedScenario, RunSpec, SettingsOf};
use unicycle_cbf::{Preset, Testbed};

fn campaign(presets: &[Preset], groups: &[Group], runs: usize) -> Campaign {
    let of = |preset: &Preset| NamedScenario::built_in(Testbed::ALL, &[], *preset).unwrap();
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
    // The thesis's rows hold where nothing disturbs; that bodies touch all the same is what they do not see.
    let calm_ones = |v: &&Violation| v.disturbance == Group::None;
    for violation in report.violations.iter().filter(calm_ones) {
        let gap_m = violation.least_distance.unwrap().gap_m;
        let rows_hold =
            violation.min_h_headway_m.is_none_or(|h| h >= 0.0) && violation.lane_clearance_m >= 0.0;
        assert!(rows_hold && gap_m < 0.025, "{violation:?}");
    }
    assert!(calm.violations > 0);
    assert!(rough.violations > 20, "{}", rough.violations);
    let rows = report
        .rows
        .iter()
        .filter(|row| row.disturbance == Group::All);
    assert_eq!(
        rows.map(|row| row.tally.violations).sum::<usize>(),
        rough.violations
    );
    assert_eq!(
        report
            .violations
            .iter()
            .filter(|v| v.disturbance == Group::All)
            .count(),
        20
    );
    for violation in &report.violations {
        let testbed = Testbed::ALL
            .iter()
            .find(|t| t.name() == violation.testbed)
            .unwrap();
        let SettingsOf::Preset(preset) = violation.preset else {
            panic!("{violation:?}");
        };
        let spec = RunSpec {
            seed: violation.seed,
            scenario: testbed.scenario(&violation.scenario, preset).unwrap(),
            disturbances: Disturbances::HARD.only(violation.disturbance),
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
