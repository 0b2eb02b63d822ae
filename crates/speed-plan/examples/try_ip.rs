//! Try.
use speed_plan::*;
fn main() {
    for file in std::env::args().skip(1) {
        let case = Case::from_json(&std::fs::read_to_string(&file).unwrap(), &file).unwrap();
        let problem = Problem::new(
            ev_energy::StepModel::new(&case.vehicle),
            case.envelope.clone(),
            case.columns.clone(),
        )
        .unwrap();
        let t = std::time::Instant::now();
        let demand = case
            .latest_arrival_s
            .map_or(Demand::Price(0.0), Demand::Arrival);
        match plan(&problem, demand, &Settings::default()).unwrap() {
            Answer::Plan(p) => println!(
                "{:20} {:?} E {:.3} t {:.7} price {:.4} LB {:.3} gap {:.6} % solved {} in {:?}",
                case.name,
                p.arrival,
                p.energy_j,
                p.time_s,
                p.price_w,
                p.lower_bound_j,
                p.gap_pct,
                p.solved,
                t.elapsed()
            ),
            Answer::Obstacle(o) => println!("{:20} {o:?}", case.name),
        }
    }
}
