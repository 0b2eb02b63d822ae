use testbed_io::*;
use unicycle_cbf::*;
fn go(tag: &str, spec: ScenarioSpec, d: Disturbances) {
    let s = Scenario::new(spec).unwrap();
    let r = Simulation { scenario: &s, disturbances: d, seed: 1 }.run(|_| {}).unwrap();
    println!("{tag:40} h {:?} lane {:.4} clear {:.4} y {:.4} v {:.4} end {:.4} {:?} slack {:.3} safe {} {:?}", r.min_h_headway_m.map(|x| (x*1e5).round()/1e5), r.min_h_lane, r.lane_clearance_m, r.max_abs_lateral_m, r.mean_speed_mps, r.final_speed_mps, r.outcomes, r.max_slack, r.safe, r.first_unsafe_s);
}
fn main() {
    let none = Disturbances::default();
    for (t, n) in [(Testbed::Khepera,"on-off"),(Testbed::Khepera,"decay"),(Testbed::Robotarium,"on-off"),(Testbed::Robotarium,"decay"),(Testbed::Robotarium,"track")] {
        let base = t.scenario(n, Preset::Thesis).unwrap();
        go(&format!("{} {n}", t.name()), base.clone(), none);
        let mut s = base.clone(); s.controller.headway.margin_m = 0.0; s.controller.lane.margin_m = 0.0; go("   no margins", s, none);
        for l in [Literal::UnsignedAngleRate, Literal::BarrierSign, Literal::IgnoredLeader, Literal::SwitchingLane, Literal::DecayingSpeedWeight] {
            let mut s = base.clone(); s.controller.literal = vec![l]; go(&format!("   {l:?}"), s, none);
        }
        let mut s = base.clone(); s.body.centripetal = Centripetal::Newton; go("   newton", s, none);
        go("   latency .1", base.clone(), Disturbances { latency_s: 0.1, ..none });
        go("   latency .2", base.clone(), Disturbances { latency_s: 0.2, ..none });
        go("   drops .1", base.clone(), Disturbances { drop_share: 0.1, ..none });
        go("   outages", base.clone(), Disturbances { outages_per_minute: 6.0, outage_s: 2.0, ..none });
        if n == "track" { let mut s = base.clone(); s.robots[0].start = 0.25; go("   lead .25", s, none); }
        let mut s = base.clone(); for r in &mut s.robots { r.start = -r.start; } let _ = s;
    }
}
