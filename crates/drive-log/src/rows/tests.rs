use super::*;

fn read(text: &str) -> (Result<Vec<Row>, Error>, Vec<String>) {
    let mut remarks = Vec::new();
    let rows = read_into(text, &mut remarks);
    (rows, remarks)
}

fn read_into(text: &str, remarks: &mut Vec<String>) -> Result<Vec<Row>, Error> {
    let mut reader = RowReader::new(Path::new("stdin"), text.as_bytes(), 0.1, 2.0)?;
    let mut rows = Vec::new();
    while let Some(row) = reader.next_row(&mut |text| remarks.push(text))? {
        rows.push(row);
    }
    Ok(rows)
}

/// Rows of which nothing has to be said.
fn rows(text: &str) -> Result<Vec<Row>, Error> {
    let (rows, remarks) = read(text);
    assert!(remarks.is_empty(), "{remarks:?}");
    rows
}

#[test]
fn every_delimiter_and_decimal_mark_reads_alike() {
    let expected = rows("time_s,speed_kmh,lead_gap_m\n0,36,\n0.1,36.36,12.5\n").unwrap();
    assert_eq!(expected.len(), 2);
    assert_eq!(
        (expected[0].speed_mps, expected[0].starts_piece),
        (10.0, true)
    );
    assert!(expected[0].lead_gap_m.is_nan());
    assert_eq!(
        (expected[1].lead_gap_m, expected[1].starts_piece),
        (12.5, false)
    );
    for text in [
        "\u{feff}time_s;speed_kmh;lead_gap_m\r\n0;36;\r\n\r\n0,1;36,36;12,5",
        "LEAD_GAP_M\tx\tv\tt\n\t?\t10\t0\n12.5\t\t10.1\t0.1\n",
    ] {
        for (row, expected) in rows(text).unwrap().iter().zip(&expected) {
            assert_eq!(
                (row.time_s, row.speed_mps),
                (expected.time_s, expected.speed_mps)
            );
        }
    }
}

#[test]
fn what_is_asked_for_is_told_and_nothing_else_is_read() {
    let text = "t,v,speed_limit_kmh,pedal_pct,soc_pct\n0,1,36,10,?\n0.2,1,72,20,?\n0.3,1,,fast,?\n0.4,1,72,300,?\n";
    let text = text.replace("pedal_pct", "accelerator_pedal_pct");
    let mut remarks = Vec::new();
    let mut reader = RowReader::new(Path::new("stdin"), text.as_bytes(), 0.1, 2.0)
        .unwrap()
        .telling(&[
            Channel::AcceleratorPedal,
            Channel::Brake,
            Channel::SpeedLimit,
        ]);
    assert_eq!(
        reader.told(),
        [Channel::AcceleratorPedal, Channel::SpeedLimit]
    );
    let mut told = Vec::new();
    while let Some(row) = reader.next_row(&mut |text| remarks.push(text)).unwrap() {
        told.push(row.told);
    }
    assert_eq!(told[..3], [[10.0, 10.0], [15.0, 10.0], [20.0, 20.0]]);
    assert!(told[3].iter().all(|value| value.is_nan()));
    assert!(told[4][0].is_nan() && told[4][1].to_bits() == 20.0_f64.to_bits());
    let missing = remarks.iter().filter(|r| r.contains("counted as missing"));
    assert_eq!(missing.count(), 2, "{remarks:?}");
}

#[test]
fn a_gap_starts_a_piece() {
    let (rows, remarks) = read("t,v\n0,1\n0.1,1\n0.2,1\n5,1\n5.1,1\n");
    let starts: Vec<bool> = rows.unwrap().iter().map(|row| row.starts_piece).collect();
    assert_eq!(starts, [true, false, false, true, false]);
    assert!(
        remarks.len() == 1 && remarks[0].contains("line 5"),
        "{remarks:?}"
    );
}

#[test]
fn between_rows_that_are_not_a_step_apart_speed_is_a_straight_line() {
    let (rows, remarks) = read("t,v\n0,0\n0.15,1.5\n0.4,4\n");
    let speeds: Vec<f64> = rows.unwrap().iter().map(|row| row.speed_mps).collect();
    assert_eq!(speeds.len(), 5);
    for (speed, expected) in speeds.iter().zip([0.0, 1.0, 2.0, 3.0, 4.0]) {
        assert!((speed - expected).abs() < 1e-12, "{speeds:?}");
    }
    assert!(
        remarks.len() == 1 && remarks[0].contains("0.150 s"),
        "{remarks:?}"
    );
    let jitter = self::rows("t,v\n0,1\n0.109,1\n0.2,1\n").unwrap();
    assert_eq!(jitter.len(), 3);
}

#[test]
fn what_cannot_be_used_is_left_out_and_the_stream_goes_on() {
    for (bad, words) in [
        ("0.2,", "no value"),
        ("0.2,nan", "no value"),
        (",2", "no value"),
        ("0.2,fast", "fast"),
        ("0.2", "field"),
        ("# comment", "no comments; left out"),
        ("0.05,9", "comes after"),
        ("0.1,9", "comes after"),
        ("0.2,1e9", "outside"),
    ] {
        let (rows, remarks) = read(&format!("t,v\n0,0\n0.1,1\n{bad}\n0.3,3\n0.4,4\n"));
        let speeds: Vec<f64> = rows.unwrap().iter().map(|row| row.speed_mps).collect();
        assert_eq!(speeds.len(), 5, "{bad}");
        assert!((speeds[2] - 2.0).abs() < 1e-12, "{bad}: {speeds:?}");
        assert!(
            remarks[0].contains("line 4") && remarks[0].contains(words),
            "{remarks:?}"
        );
        assert!(
            remarks[1].contains("line 5") && remarks[1].contains("1 row"),
            "{remarks:?}"
        );
    }
}

#[test]
fn a_clock_that_is_set_back_starts_a_piece() {
    let (rows, remarks) = read("t,v\n9,1\n9.1,1\n0,1\n0.1,1\n");
    let rows = rows.unwrap();
    assert_eq!(rows.len(), 4);
    assert!(rows[2].starts_piece && rows[2].time_s == 0.0);
    assert!(
        remarks.len() == 1 && remarks[0].contains("set back"),
        "{remarks:?}"
    );
    // A little back, and it stays there.
    let late: String = (0..8)
        .map(|k| format!("{},1\n", 8.5 + 0.1 * f64::from(k)))
        .collect();
    let (rows, _) = read(&format!("t,v\n9,1\n9.1,1\n{late}"));
    assert_eq!(
        rows.unwrap().iter().filter(|row| row.starts_piece).count(),
        2
    );
}

#[test]
fn a_single_sample_is_no_piece() {
    let (rows, remarks) = read("t,v\n0,1\n0.1,1\n50,1\n0.2,1\n0.3,1\n");
    assert_eq!(rows.unwrap().len(), 4);
    assert!(
        remarks
            .iter()
            .any(|text| text.contains("50 s stands alone")),
        "{remarks:?}"
    );
}

#[test]
fn errors_say_what_is_wrong() {
    for (text, words) in [
        ("", "empty"),
        ("\n \n", "empty"),
        ("speed_kmh,x\n1,2\n", "time"),
        ("0,1\n0.1,1\n", "speed"),
        ("time_s,speed_furlong\n0,1\n", "speed_furlong"),
        ("t,v\n0,fast\n1,slow\n", "no row"),
    ] {
        let error = read(text).0.unwrap_err().to_string();
        assert!(error.contains(words), "{text:?}: {error}");
    }
    let long = format!("t,v\n0,1{}\n", " ".repeat(1 << 20));
    assert!(read(&long).0.unwrap_err().to_string().contains("line 2"));
}

#[test]
fn speeds_that_rows_repeat_are_told_once() {
    let row = |i: usize, v: f64| format!("{},{v}\n", i as f64 * 0.1);
    let wave = |i: usize| 12.0 + 6.0 * (0.02 * i as f64).sin();
    let text = |speed: &dyn Fn(usize) -> f64| {
        let rows: String = (0..600).map(|i| row(i, speed(i))).collect();
        "t,v\n".to_owned() + &rows
    };
    assert!(rows(&text(&wave)).is_ok());
    let whole_kmh = |i: usize| (3.6 * wave(i)).round() / 3.6;
    assert!(rows(&text(&whole_kmh)).is_ok());
    let (_, remarks) = read(&text(&|i| wave(i / 10 * 10)));
    let told = remarks.iter().filter(|r| r.contains("repeated"));
    assert_eq!(told.count(), 1, "{remarks:?}");
}
