use testbed_io::*;
use unicycle_cbf::*;
fn main() {
    for testbed in Testbed::ALL { for name in testbed.scenarios() { for preset in [Preset::Thesis, Preset::Hardened] {
        let s = Scenario::new(testbed.scenario(name, preset).unwrap()).unwrap();
        for g in [Group::None, Group::All] {
        let sim = Simulation { scenario: &s, disturbances: Disturbances::HARD.only(g), seed: 1 };
        let mut us = vec![];
        let t = std::time::Instant::now();
        let r = sim.run(|t| us.push(t.step_us)).unwrap();
        let e = t.elapsed().as_secs_f64();
        us.sort_by(f64::total_cmp);
        println!("{:10} {:8} {:?} {:?}: h {:?} lane {:.4} clear {:.4} y {:.4} v {:.4} end {:.4} {:?} slack {:.3} safe {} {:?} med {:.2}us {:.0} s/s", testbed.name(), name, preset, g, r.min_h_headway_m.map(|x| (x*1e5).round()/1e5), r.min_h_lane, r.lane_clearance_m, r.max_abs_lateral_m, r.mean_speed_mps, r.final_speed_mps, r.outcomes, r.max_slack, r.safe, r.first_unsafe_s, us[us.len()/2], 60.0/e);
        }
    }}}
}
