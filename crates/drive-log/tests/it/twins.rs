//! Which drives are taken for one.

use drive_log::{
    Channel, Drive, DriveIndex, Kinship, LayoutChoice, Preparation, prepare, read_bytes,
};

/// A drive with stops, sampled every `step_s` from `from_s` on.
fn drive(from_s: f64, to_s: f64, step_s: f64, more: impl Fn(f64) -> f64) -> Drive {
    let mut csv = "time_s,speed_mps,battery_voltage_v\n".to_owned();
    for k in 0..((to_s - from_s) / step_s) as usize {
        let t = from_s + k as f64 * step_s;
        let speed = 12.0 + 9.0 * (t / 23.0).sin() + 7.0 * (t / 61.0).cos() + 2.0 * (t / 7.0).sin();
        csv += &format!("{t:.2},{:.3},{:.2}\n", speed.max(0.0), more(t));
    }
    prepared(&csv)
}

fn prepared(csv: &str) -> Drive {
    let file = read_bytes("log.csv".as_ref(), csv.as_bytes(), &LayoutChoice::Auto).unwrap();
    prepare(
        file.logs.into_iter().next().unwrap(),
        &Preparation::default(),
    )
    .unwrap()
}

fn kin(of: &Drive, drive: &Drive) -> Vec<(usize, Kinship)> {
    let mut index = DriveIndex::default();
    index.insert(7, of);
    index.kin(drive)
}

fn volts(t: f64) -> f64 {
    360.0 + 8.0 * (t / 40.0).sin()
}

#[test]
fn a_drive_is_itself_at_any_sampling() {
    let whole = drive(0.0, 600.0, 0.1, volts);
    for step_s in [0.05, 0.2, 0.5, 1.0] {
        let again = drive(0.3, 600.0, step_s, volts);
        assert_eq!(kin(&whole, &again), [(7, Kinship::Same)], "{step_s} s");
    }
}

#[test]
fn a_part_of_a_drive_is_found_wherever_it_lies() {
    let whole = drive(0.0, 900.0, 0.1, volts);
    for from_s in [0.0, 133.7, 400.0] {
        let part = drive(from_s, from_s + 400.0, 0.1, volts);
        assert_eq!(kin(&whole, &part), [(7, Kinship::PartOf)], "{from_s} s");
        assert_eq!(kin(&part, &whole), [(7, Kinship::Holds)], "{from_s} s");
    }
}

#[test]
fn drives_that_follow_each_other_are_two() {
    let first = drive(0.0, 600.0, 0.1, volts);
    assert_eq!(kin(&first, &drive(600.0, 1200.0, 0.1, volts)), []);
    assert_eq!(kin(&first, &drive(300.0, 900.0, 0.1, volts)), []);
}

#[test]
fn one_cycle_with_two_cars_is_two_drives() {
    let first = drive(0.0, 600.0, 0.1, volts);
    let other = drive(0.0, 600.0, 0.1, |t| volts(t) - 30.0);
    assert_eq!(kin(&first, &other), []);
}

#[test]
fn two_drives_at_one_constant_speed_are_two() {
    let rows = |volts: f64| {
        (0..600).fold(
            "time_s,speed_mps,battery_voltage_v\n".to_owned(),
            |csv, t| csv + &format!("{t},20,{volts}\n"),
        )
    };
    assert_eq!(kin(&prepared(&rows(360.0)), &prepared(&rows(360.0))), []);
}

#[test]
fn a_year_between_two_pieces_takes_no_memory() {
    let rows = |from: f64| (0..60).map(move |t| (from + f64::from(t), 10.0 + f64::from(t % 7)));
    let csv = rows(0.0)
        .chain(rows(3e7))
        .fold("time_s,speed_mps\n".to_owned(), |csv, (t, v)| {
            csv + &format!("{t},{v}\n")
        });
    let drive = prepared(&csv);
    assert_eq!(drive.pieces.len(), 2);
    assert_eq!(drive.pieces[0].channel(Channel::Speed).unwrap().len(), 591);
    assert_eq!(kin(&drive, &drive), [(7, Kinship::Same)]);
}
