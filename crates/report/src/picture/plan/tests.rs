use super::*;
use crate::picture::well_formed::assert_well_formed;

const POSITION_M: [f64; 5] = [0.0, 100.0, 200.0, 300.0, 400.0];
const LIMIT_MPS: [f64; 5] = [0.0, 20.0, 8.0, 20.0, 20.0];

fn run(speed_mps: &[f64]) -> RoadRun<'_> {
    RoadRun {
        position_m: &POSITION_M,
        speed_mps,
        time_s: (0..5).map(|k| [10.0 * f64::from(k); 2]).collect(),
        effort: Effort::ALL.to_vec(),
    }
}

#[test]
fn every_part_of_a_plan_is_drawn() {
    let document = plan_over_road(&PlanPicture {
        title: "road <1>",
        plan: Some(run(&[0.0, 10.0, 8.0, 10.0, 0.0])),
        own: Some(run(&[0.0, 15.0, 8.0, 15.0, 0.0])),
        limit_mps: &LIMIT_MPS,
        elevation_m: &[100.0, 101.0, 102.0, 101.0, 100.0],
        signals: vec![SignalTimes {
            position_m: 300.0,
            green_s: &[[0.0, 12.0], [25.0, 40.0]],
        }],
        frontier: vec![(40.0, 2e5), (60.0, 1e5)],
        own_point: Some((45.0, 3e5)),
    })
    .unwrap();
    assert!(assert_well_formed(&document) > 40);
    assert!(document.contains("<title>Speed plan of road &lt;1&gt;</title>"));
    for word in [
        "drives",
        "coasts",
        "regenerates",
        "brakes by friction",
        "own run",
        "limit",
        "signal",
        "position (km)",
        "speed (km/h)",
        "time (s)",
        "above the start (m)",
        "energy (kWh)",
        "arrival (s)",
    ] {
        assert!(document.contains(word), "{word}");
    }
    for colour in Effort::ALL
        .map(Effort::colour)
        .into_iter()
        .chain([OWN, LIMIT, GREEN, RED, GROUND])
    {
        let hex = format!("#{:02X}{:02X}{:02X}", colour.0, colour.1, colour.2);
        assert!(document.contains(&hex), "{hex}");
    }
}

#[test]
fn what_is_not_there_has_no_panel() {
    let plan = Some(run(&[5.0; 5]));
    let only_plan = PlanPicture {
        plan,
        ..PlanPicture::default()
    };
    assert_eq!(panels(&only_plan), [Panel::Speed]);
    let only_frontier = PlanPicture {
        frontier: vec![(40.0, 2e5), (60.0, 1e5)],
        ..PlanPicture::default()
    };
    assert_eq!(panels(&only_frontier), [Panel::Frontier]);
    let nothing = plan_over_road(&PlanPicture::default()).unwrap();
    assert_well_formed(&nothing);
    assert!(nothing.contains("nothing to show"));
}

#[test]
fn no_content_makes_it_fail() {
    for value in [f64::NAN, f64::INFINITY, -1e300, 1e300, 0.0] {
        let values = [value; 5];
        let mut broken = run(&values);
        broken.time_s = vec![[value; 2]; 5];
        for plan in [broken.clone(), run(&[5.0; 5]), run(&[1.0])] {
            let document = plan_over_road(&PlanPicture {
                title: "</title>&\u{0}",
                plan: Some(plan),
                own: Some(broken.clone()),
                limit_mps: &values,
                elevation_m: &values,
                signals: vec![SignalTimes {
                    position_m: value,
                    green_s: &[[value, value], [1.0, value]],
                }],
                frontier: vec![(value, value), (1.0, value)],
                own_point: Some((value, value)),
            })
            .unwrap();
            assert_well_formed(&document);
        }
    }
}
