//! What a whole file, one that is cut off, and one with a damaged page header are answered with.
//!
//! `cargo run -p parquet-table --example damaged_file`

#![allow(clippy::print_stdout)]

use std::error::Error;

use parquet_table::{Column, File, Values};

fn main() -> Result<(), Box<dyn Error>> {
    let speed_mps = (0..1000).map(|k| f64::from(k) * 0.01).collect();
    let columns = [Column::new("speed_mps", Values::Float(speed_mps))];
    let mut whole = Vec::new();
    parquet_table::write(&columns, &[], &mut whole)?;

    let cut_off = &whole[..whole.len() / 2];
    let mut damaged = whole.clone();
    damaged[4..8].fill(0xff); // the header of the first page, behind four bytes of magic
    for (name, bytes) in [
        ("whole", whole.as_slice()),
        ("cut off", cut_off),
        ("damaged", damaged.as_slice()),
    ] {
        match File::open(bytes) {
            Ok(file) => println!("{name}: {} rows", file.rows()),
            Err(error) => println!("{name}: {error}"),
        }
    }
    Ok(())
}
