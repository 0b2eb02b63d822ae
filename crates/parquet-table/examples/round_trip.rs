//! A table of all three kinds as Parquet and back, each column read as the kind that the file says.
//!
//! `cargo run -p parquet-table --example round_trip`

#![allow(clippy::print_stdout)]

use std::error::Error;

use parquet_table::{Column, ColumnHead, File, Kind, Values};

/// What the texts of a column may take.
const LIMIT_BYTES: u64 = 1_000_000;

fn main() -> Result<(), Box<dyn Error>> {
    let outcomes = ["solved", "infeasible", "solved"].map(String::from);
    let table = [
        Column::new("time_s", Values::Float(vec![0.0, 0.1, 0.2])),
        Column::new("gap_m", Values::Float(vec![12.5, f64::NAN, 12.1])), // NaN becomes null
        Column::new("rows", Values::Integer(vec![14, 15, 14])),
        Column::new("outcome", Values::Text(outcomes.to_vec())),
    ];
    let mut bytes = Vec::new();
    parquet_table::write(&table, &[], &mut bytes)?;

    let file = File::open(&bytes)?;
    for (number, head) in file.columns().iter().enumerate() {
        let values = read(&file, number, head)?;
        println!("{:<8} {:<10} {values:?}", head.name, head.type_name);
    }
    Ok(())
}

fn read(
    file: &File<'_>,
    number: usize,
    head: &ColumnHead,
) -> Result<Option<Values>, parquet_table::Error> {
    Ok(match head.kind {
        Kind::Float => file.floats(&[number])?.pop().map(Values::Float),
        Kind::Integer => {
            let integers = file.integers(&[number])?.pop();
            integers.map(|values| Values::Integer(values.into_iter().flatten().collect()))
        }
        Kind::Text => {
            let texts = file.texts(number, LIMIT_BYTES)?;
            Some(Values::Text(texts.into_iter().flatten().collect()))
        }
        Kind::Other => None,
    })
}
