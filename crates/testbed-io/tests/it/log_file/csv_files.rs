//! CSV files as other programs read them; cut, damaged, and of before.

use testbed_io::log_file::{Column, LogFormat, LogTable, Values, read_bytes};

use super::{assert_same, bits, bytes, column, run};

fn plain() -> LogTable {
    let columns = vec![
        column(
            "x_m",
            Values::Float(vec![1.0, f64::NAN, -0.0, 1e300, f64::INFINITY]),
        ),
        column("n", Values::Integer(vec![1, -2, 3, i64::MAX, i64::MIN])),
        column(
            "word",
            Values::Text(["a", "", "b,c", "\"", "inf"].map(String::from).to_vec()),
        ),
    ];
    LogTable::new(r#"{"a": 1}"#, columns).unwrap()
}

/// Numbers and texts of one line each, as in run logs.
fn samples(rows: usize) -> LogTable {
    let ticks = Values::Integer((0..rows as i64).collect());
    let places = Values::Float((0..rows).map(|row| 22.2 / (row as f64 + 0.7)).collect());
    let outcomes = Values::Text(vec!["optimal".to_owned(); rows]);
    let columns = vec![
        column("tick", ticks),
        column("x_m", places),
        column("outcome", outcomes),
    ];
    LogTable::new(r#"{"seed": 1}"#, columns).unwrap()
}

fn read(text: &[u8]) -> Result<LogTable, String> {
    read_bytes(text, LogFormat::Csv).map_err(|error| error.to_string())
}

#[test]
fn a_csv_log_has_one_line_of_names_and_a_line_per_row() {
    let text = String::from_utf8(bytes(&plain(), LogFormat::Csv)).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 6);
    assert_eq!(lines[0], "x_m,n,word,about");
    let about = r#""{""log"":""drivekit run log 2"",""types"":""fit"",""check"":""crc "#;
    assert!(
        lines[1].starts_with(&format!("1,1,a,{about}")),
        "{}",
        lines[1]
    );
    assert!(
        lines[1].ends_with(r#""",""run"":{""a"": 1}}""#),
        "{}",
        lines[1]
    );
    assert!(lines[2].starts_with(",-2,,crc "), "{}", lines[2]);
    assert!(lines[4].starts_with("1e300,9223372036854775807,\"\"\"\",crc "));
    let windows = format!("\u{feff}{}", text.replace('\n', "\r\n"));
    assert_same(&read(windows.as_bytes()).unwrap(), &plain(), LogFormat::Csv);
    let eight_hundred = bytes(&samples(800), LogFormat::Csv);
    let lines = eight_hundred.iter().filter(|byte| **byte == b'\n').count();
    assert_eq!(lines, 801);
}

#[test]
fn csv_logs_of_before_are_read() {
    let text = "# drivekit run log 1 {\"a\": 1}\n# types f,i,t\nx_m,n,word\n1,1,a\n,-2,\n\
                -0,3,\"b,c\"\n1e300,9223372036854775807,\"\"\"\"\ninf,-9223372036854775808,inf\n";
    assert_same(&read(text.as_bytes()).unwrap(), &plain(), LogFormat::Csv);
    let cut = read(&text.as_bytes()[..text.len() - 3]).unwrap();
    assert!(cut.truncated() && cut.rows() == 4);
    let damaged = text.replace("-2,", "\"2,");
    let error = read(damaged.as_bytes()).unwrap_err();
    assert!(error.contains("line 5: a quotation mark"), "{error}");
    let none = read(b"# drivekit run log 1 null\n# types \n").unwrap();
    assert!(none.columns().is_empty());
}

#[test]
fn a_csv_cut_short_gives_its_whole_lines() {
    let table = run(3);
    let whole = bytes(&table, LogFormat::Csv);
    let ends_of_rows: Vec<usize> = (1..=whole.len())
        .filter(|end| read(&whole[..*end]).is_ok_and(|table| !table.truncated()))
        .collect();
    assert_eq!(ends_of_rows.len(), 3);
    for end in 0..whole.len() {
        let rows = ends_of_rows.iter().filter(|row| **row <= end).count();
        let cut = read(&whole[..end]);
        if rows == 0 {
            assert!(cut.is_err(), "{end}");
            continue;
        }
        let cut = cut.unwrap();
        assert_eq!(cut.rows(), rows);
        let mut pairs = bits(&cut).into_iter().zip(bits(&table));
        assert!(pairs.all(|(a, b)| b.1.starts_with(&a.1)), "{end}");
        // A file that ends between two lines looks whole.
        assert_eq!(cut.truncated(), !ends_of_rows.contains(&end), "{end}");
    }
}

#[test]
fn one_flipped_bit_is_an_error_that_names_the_line() {
    let whole = bytes(&samples(12), LogFormat::Csv);
    for at in 0..whole.len() - 1 {
        for bit in 0..8 {
            let mut damaged = whole.clone();
            damaged[at] ^= 1 << bit;
            let line = 1 + whole[..at].iter().filter(|byte| **byte == b'\n').count();
            let error = match read(&damaged) {
                Err(error) => error,
                Ok(table) => {
                    // Only of the last line it may look as if it had been cut.
                    assert!(table.truncated() && line == 13, "byte {at}, bit {bit}");
                    continue;
                }
            };
            // Without a line end two lines are one; names are checked with the first row.
            let named = [line - 1, line, line + 1].map(|line| format!(", line {line}"));
            let names = named.iter().any(|line| error.contains(line));
            assert!(names, "byte {at}, bit {bit}, line {line}: {error}");
        }
    }
}

#[test]
fn a_line_that_is_gone_is_an_error() {
    let whole = String::from_utf8(bytes(&samples(12), LogFormat::Csv)).unwrap();
    let without = |gone: usize| {
        let lines = whole.lines().enumerate().filter(|(line, _)| *line != gone);
        let lines: Vec<&str> = lines.map(|(_, text)| text).collect();
        read((lines.join("\n") + "\n").as_bytes())
    };
    let error = without(5).unwrap_err();
    assert!(
        error.contains("line 6: damaged or changed: its check is \"crc "),
        "{error}"
    );
    assert!(without(1).unwrap_err().contains("line 2, column \"about\""));
    // The last one is as good as never written.
    assert_eq!(without(12).unwrap().rows(), 11);
}

#[test]
fn a_log_without_rows_still_says_what_the_run_is() {
    let columns: Vec<Column> = samples(0).into_columns();
    let empty = LogTable::new(r#"{"seed": 1}"#, columns).unwrap();
    let text = bytes(&empty, LogFormat::Csv);
    assert_same(&read(&text).unwrap(), &empty, LogFormat::Csv);
    let names = text.split(|byte| *byte == b'\n').next().unwrap().len() + 1;
    let error = read(&text[..names]).unwrap_err();
    assert!(error.contains("ends before its first row"), "{error}");
}
