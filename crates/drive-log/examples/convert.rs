//! A recorded drive at one sample a second as CSV on stdout; as Parquet it reads back the same.
//!
//! `cargo run -p drive-log --example convert > drive-01.csv`

use std::error::Error;
use std::io::{BufWriter, stdout};
use std::path::Path;

use drive_log::{
    Channel, LayoutChoice, Preparation, prepare, read_bytes, read_file, write_csv, write_parquet,
};

const DRIVE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../fixtures/drives/drive-01.csv"
);

fn main() -> Result<(), Box<dyn Error>> {
    let preparation = Preparation {
        step_s: 1.0,
        ..Preparation::default()
    };
    for log in read_file(Path::new(DRIVE), &LayoutChoice::Auto)?.logs {
        for piece in &prepare(log, &preparation)?.pieces {
            write_csv(piece, BufWriter::new(stdout().lock()))?;

            let mut bytes = Vec::new();
            write_parquet(piece, &mut bytes)?;
            let again = read_bytes(Path::new("again.parquet"), &bytes, &LayoutChoice::Auto)?;
            let speed_mps = again
                .logs
                .first()
                .and_then(|log| log.channel(Channel::Speed));
            if speed_mps != Some(piece.speed_mps()) {
                return Err("another speed came back".into());
            }
        }
    }
    Ok(())
}
