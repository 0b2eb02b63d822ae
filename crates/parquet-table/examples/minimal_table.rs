//! Two columns as Parquet in memory, and back.
//!
//! `cargo run -p parquet-table --example minimal_table`

#![allow(clippy::print_stdout)]

use std::error::Error;

use parquet_table::{Column, File, Values};

fn main() -> Result<(), Box<dyn Error>> {
    let columns = [
        Column::new("time_s", Values::Float(vec![0.0, 0.1])),
        Column::new("robot", Values::Text(vec!["a".into(), "b".into()])),
    ];
    let mut bytes = Vec::new();
    parquet_table::write(&columns, &[("by", "example")], &mut bytes)?;

    let file = File::open(&bytes)?;
    println!("{} rows in {} bytes", file.rows(), bytes.len());
    println!("by: {:?}", file.metadata("by"));
    println!("time_s: {:?}", file.floats(&[0])?);
    println!("robot: {:?}", file.texts(1, 1000)?);
    Ok(())
}
