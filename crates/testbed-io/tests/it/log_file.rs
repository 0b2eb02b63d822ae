//! Run logs to and from their three formats.

mod any_table;
mod csv_files;
mod mcap_files;

use std::path::Path;

use testbed_io::Error;
use testbed_io::log_file::{Column, LogFormat, LogTable, Values, read, read_bytes, write};

const FORMATS: [LogFormat; 3] = [LogFormat::Csv, LogFormat::Parquet, LogFormat::Mcap];

fn column(name: &str, values: Values) -> Column {
    Column {
        name: name.to_owned(),
        values,
    }
}

fn bytes(table: &LogTable, format: LogFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(table, format, &mut bytes).unwrap();
    bytes
}

/// All bits, with one NaN.
fn bits(table: &LogTable) -> Vec<(&str, Vec<String>)> {
    let columns = table.columns().iter().map(|column| {
        let values = match &column.values {
            Values::Float(values) => {
                let bits = |v: &f64| if v.is_nan() { u64::MAX } else { v.to_bits() };
                values.iter().map(|v| format!("f{:x}", bits(v))).collect()
            }
            Values::Integer(values) => values.iter().map(|v| format!("i{v}")).collect(),
            Values::Text(values) => values.iter().map(|v| format!("t{v}")).collect(),
        };
        (column.name.as_str(), values)
    });
    columns.collect()
}

fn assert_same(found: &LogTable, expected: &LogTable, format: LogFormat) {
    assert_eq!(found.meta(), expected.meta(), "{format:?}");
    assert_eq!(bits(found), bits(expected), "{format:?}");
    assert!(!found.truncated(), "{format:?}");
}

/// A run of two robots with a true pose, `rows` rows.
fn run(rows: usize) -> LogTable {
    let ticks = (0..rows).map(|row| row / 2);
    let floats = |f: &dyn Fn(f64) -> f64| Values::Float((0..rows).map(|r| f(r as f64)).collect());
    let texts = (0..rows).map(|row| format!("braking, \"{row}\"\n"));
    let columns = vec![
        column("tick", Values::Integer(ticks.map(|t| t as i64).collect())),
        column("outcome", Values::Text(texts.collect())),
        column("true_heading_rad", floats(&|_| 0.5)),
        column(
            "robot",
            Values::Integer((0..rows).map(|row| row as i64 % 2).collect()),
        ),
        column("time_s", floats(&|row| (row / 2.0).floor() / 30.0)),
        column(
            "true_x_m",
            floats(&|row| if row < 2.0 { f64::NAN } else { row / 3.0 }),
        ),
        column("true_y_m", floats(&|row| -row)),
        column("barrier", floats(&|row| 1.0 / row)),
    ];
    LogTable::new(
        r#"{"scenario": "zwei Roboter – ¿qué?", "gain": 0.1}"#,
        columns,
    )
    .unwrap()
}

#[test]
fn the_table_is_checked() {
    let one = || column("a", Values::Float(vec![1.0]));
    let refused = |meta: &str, columns: Vec<Column>| {
        let error = LogTable::new(meta, columns).unwrap_err();
        assert!(matches!(error, Error::Table { .. }));
        error.to_string()
    };
    assert!(refused("{", vec![]).contains("JSON"));
    assert!(refused("", vec![]).contains("JSON"));
    assert!(refused("{}", vec![one(), one()]).contains("two columns \"a\""));
    assert!(refused("{}", vec![column("", Values::Text(vec![]))]).contains("without a name"));
    let short = refused("{}", vec![one(), column("b", Values::Integer(vec![]))]);
    assert!(
        short.contains("\"b\" has 0 values and the first column 1"),
        "{short}"
    );
    assert_eq!(LogTable::new("{\r\n}", vec![]).unwrap().meta(), "{  }");
    let blanks = LogTable::new("{}\t \n", vec![]).unwrap();
    let csv = read_bytes(&bytes(&blanks, LogFormat::Csv), LogFormat::Csv).unwrap();
    assert_eq!(csv.meta(), "{}\t  ");
}

#[test]
fn the_extension_names_the_format() {
    let format = |name: &str| LogFormat::from_path(Path::new(name));
    assert_eq!(format("a/run.CSV").unwrap(), LogFormat::Csv);
    assert_eq!(format("run.parquet").unwrap(), LogFormat::Parquet);
    assert_eq!(format("run.1.mcap").unwrap(), LogFormat::Mcap);
    for name in ["run", "run.xlsx", ".csv"] {
        let error = format(name).unwrap_err().to_string();
        assert!(error.contains(".parquet or .mcap"), "{error}");
    }
}

#[test]
fn a_run_comes_back_from_files() {
    let folder = tempfile::tempdir().unwrap();
    let table = run(500);
    for (name, format) in ["run.csv", "run.parquet", "run.mcap"].iter().zip(FORMATS) {
        let path = folder.path().join(name);
        write(&table, format, &mut std::fs::File::create(&path).unwrap()).unwrap();
        assert_same(&read(&path).unwrap(), &table, format);
    }
    let absent = read(&folder.path().join("absent.csv")).unwrap_err();
    assert!(matches!(absent, Error::Read { .. }), "{absent}");
}

#[test]
fn a_flipped_bit_in_a_parquet_never_changes_a_value_silently() {
    let table = run(200);
    let whole = bytes(&table, LogFormat::Parquet);
    for at in (0..whole.len()).step_by(7) {
        let mut damaged = whole.clone();
        damaged[at] ^= 1 << (at % 8);
        if let Ok(read) = read_bytes(&damaged, LogFormat::Parquet) {
            assert_eq!(bits(&read), bits(&table), "byte {at}");
        }
    }
}

#[test]
fn nothing_comes_back_as_nothing() {
    let empty = run(0);
    for format in FORMATS {
        assert_same(
            &read_bytes(&bytes(&empty, format), format).unwrap(),
            &empty,
            format,
        );
    }
    let none = LogTable::new("null", vec![]).unwrap();
    for format in [LogFormat::Csv, LogFormat::Parquet] {
        assert_same(
            &read_bytes(&bytes(&none, format), format).unwrap(),
            &none,
            format,
        );
    }
}

#[test]
fn messages_name_the_place() {
    let head = "# drivekit run log 1 {}\n# types f,i\na,b\n";
    let message = |rest: &str| {
        let text = format!("{head}{rest}");
        read_bytes(text.as_bytes(), LogFormat::Csv)
            .unwrap_err()
            .to_string()
    };
    let wrong = message("1,2\n3,4.5\n");
    assert!(
        wrong.contains("line 5, column \"b\": \"4.5\" is no number"),
        "{wrong}"
    );
    let short = message("1\n1,2\n");
    assert!(
        short.contains("line 4: 1 fields where 2 are expected"),
        "{short}"
    );
    let foreign = read_bytes(b"t,x\n1,2\n", LogFormat::Csv)
        .unwrap_err()
        .to_string();
    assert!(foreign.contains("line 1: \"t,x\""), "{foreign}");
    for format in FORMATS {
        for junk in [
            &b""[..],
            b"PAR1",
            b"\x89MCAP0\r\n",
            b"# drivekit run log 1 {}\n",
        ] {
            let error = read_bytes(junk, format).unwrap_err();
            assert!(matches!(error, Error::Content { .. }), "{error}");
        }
    }
}
