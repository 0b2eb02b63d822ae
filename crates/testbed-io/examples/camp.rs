use testbed_io::*;
use unicycle_cbf::*;
fn main() {
    let runs: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let groups = if std::env::args().nth(2).is_some() { vec![Group::All] } else { Group::ALL.to_vec() };
    let presets = if std::env::args().nth(2).is_some() { vec![Preset::Hardened] } else { vec![Preset::Thesis, Preset::Hardened] };
    let scenarios = Testbed::ALL.iter().flat_map(|t| t.scenarios().iter().map(|s| (*t, (*s).to_owned()))).collect();
    let c = Campaign { scenarios, presets, groups, runs, duration_s: 60.0, seed: 1, disturbances: Disturbances::HARD };
    let r = c.run(&|| {}).unwrap();
    println!("{} runs {:.0} s/s {:.1} s", r.runs, r.simulated_s_per_s, r.seconds);
    for t in &r.totals { let a=&t.tally; println!("{:?} {:?}: runs {} unsafe {} lane {} headway {} minh {:?} clear {:.4} v {:.4} relaxed {:.3} braking {:.3}", t.preset, t.disturbance, a.runs, a.violations, a.lane_departures, a.headway_violations, a.min_h_headway_m, a.min_lane_clearance_m, a.mean_speed_mps, a.relaxed_pct, a.braking_pct); }
    for t in r.rows.iter().filter(|r| r.preset==Preset::Hardened && r.disturbance==Group::All) { let a=&t.tally; println!("   {} {}: unsafe {} lane {} headway {} minh {:?} clear {:.4} v {:.4} relaxed {:.3} braking {:.3}", t.testbed, t.scenario, a.violations, a.lane_departures, a.headway_violations, a.min_h_headway_m, a.min_lane_clearance_m, a.mean_speed_mps, a.relaxed_pct, a.braking_pct); }
}
