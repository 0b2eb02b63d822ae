use super::*;
use crate::picture::well_formed::assert_well_formed;

fn stretch(start: usize, end: usize, behaviour: Behaviour) -> Stretch {
    let samples = start..end;
    Stretch { samples, behaviour }
}

fn plot<'a>(speed_mps: &'a [f64], stretches: &[Stretch]) -> SpeedPlot<'a> {
    SpeedPlot {
        title: "drive",
        t0_s: 0.0,
        step_s: 0.1,
        speed_mps,
        speed_limit_mps: None,
        stretches: stretches.to_vec(),
    }
}

#[test]
fn every_phase_and_line_is_drawn() {
    let speed_mps: Vec<f64> = (0..500)
        .map(|k| 10.0 + 5.0 * (f64::from(k) * 0.02).sin())
        .collect();
    let limit_mps: Vec<f64> = (0..500).map(|k| if k < 250 { 13.9 } else { 8.3 }).collect();
    let stretches = [
        stretch(0, 100, Behaviour::Acceleration),
        stretch(100, 200, Behaviour::Braking),
        stretch(200, 300, Behaviour::Cruise),
        stretch(300, 400, Behaviour::LeadInfluenced),
        stretch(400, 500, Behaviour::Other),
    ];
    let plots = [SpeedPlot {
        speed_limit_mps: Some(&limit_mps),
        ..plot(&speed_mps, &stretches)
    }];
    let document = speed_with_phases(&plots).unwrap();
    assert!(assert_well_formed(&document) > 20);
    assert!(
        document.contains("<title>Speed over time of drive, coloured by driving phase</title>")
    );
    for colour in Behaviour::ALL
        .map(Behaviour::colour)
        .into_iter()
        .chain([LIMIT])
    {
        assert!(document.contains(&format!(
            "#{:02X}{:02X}{:02X}",
            colour.0, colour.1, colour.2
        )));
    }
    for word in [
        "acceleration",
        "braking",
        "cruise",
        "other",
        "lead-influenced",
        "speed limit",
        "time (s)",
        "speed (km/h)",
    ] {
        assert!(document.contains(word), "{word}");
    }
}

#[test]
fn titles_are_escaped() {
    let title = "</title><script>&\"'\u{0}\u{ffff}";
    let document = speed_with_phases(&[SpeedPlot {
        title,
        ..plot(&[1.0, 2.0], &[])
    }])
    .unwrap();
    assert_well_formed(&document);
    assert!(
        !document.contains("<script")
            && !document.contains('\u{0}')
            && document.contains("&lt;script&gt;&amp;")
    );
}

#[test]
fn nothing_to_draw_still_gives_a_picture() {
    assert!(speed_with_phases(&[]).unwrap().contains("no drive to show"));
    for speed_mps in [&[][..], &[1.0], &[f64::NAN; 4], &[f64::INFINITY, 1e300]] {
        let document = speed_with_phases(&[plot(speed_mps, &[])]).unwrap();
        assert_well_formed(&document);
        assert!(document.contains("no samples to show"));
    }
    for (t0_s, step_s) in [
        (0.0, 0.0),
        (0.0, -1.0),
        (f64::NAN, 0.1),
        (0.0, f64::INFINITY),
        (1e18, 0.1),
        (-1e308, 1e308),
    ] {
        let document = speed_with_phases(&[SpeedPlot {
            t0_s,
            step_s,
            ..plot(&[1.0, 2.0, 3.0], &[])
        }])
        .unwrap();
        assert_well_formed(&document);
    }
}

#[test]
fn gaps_split_the_line() {
    let speed_mps = [1.0, 2.0, f64::NAN, 3.0, 4.0, f64::NEG_INFINITY, 5.0, 6.0];
    let runs = thinned(&speed_mps, 0..8, 1);
    let indices: Vec<Vec<usize>> = runs
        .iter()
        .map(|run| run.iter().map(|point| point.0).collect())
        .collect();
    assert_eq!(indices, [vec![0, 1], vec![3, 4], vec![6, 7]]);
    let limit_mps = [f64::NAN, 3.0, 3.0, f64::NAN, 4.0, 5.0, 5.0, 5.0];
    let stretches = [
        stretch(6, 2, Behaviour::Braking),
        stretch(3, 99, Behaviour::Cruise),
        stretch(0, 4, Behaviour::Braking),
    ];
    let document = speed_with_phases(&[SpeedPlot {
        speed_limit_mps: Some(&limit_mps),
        ..plot(&speed_mps, &stretches)
    }])
    .unwrap();
    assert_well_formed(&document);
    assert!(!document.contains("NaN") && !document.contains("inf"));
}

#[test]
fn ranges_cover_every_sample() {
    let speed_mps = vec![1.0; 50];
    let stretches = [
        stretch(30, 40, Behaviour::Braking),
        stretch(5, 20, Behaviour::Acceleration),
    ];
    let mut covered = 0;
    for (range, _) in plot(&speed_mps, &stretches).coloured_ranges() {
        assert!(range.start <= covered && range.end > covered);
        covered = range.end - usize::from(range.end < 50);
    }
    assert_eq!(covered, 50);
}

#[test]
fn long_drives_are_thinned_but_keep_their_extremes() {
    let mut speed_mps: Vec<f64> = (0..500_000)
        .map(|k| 20.0 + 5.0 * (f64::from(k) * 0.37).sin())
        .collect();
    speed_mps[123_457] = 55.5;
    let plotted = plot(&speed_mps, &[]);
    let points: Vec<f64> = thinned(&speed_mps, 0..speed_mps.len(), plotted.stride())
        .concat()
        .iter()
        .map(|point| point.1)
        .collect();
    assert!(points.len() <= 4 * COLUMNS);
    assert!(
        points
            .iter()
            .any(|&speed_kmh| (speed_kmh - 55.5 * 3.6).abs() < 1e-9)
    );
    assert!(speed_with_phases(&[plotted]).unwrap().len() < 100_000);
}
