//! Reading a log of about 20 MB from memory, against the `csv` crate on the same columns; recorded
//! trips where they are at hand.
#![allow(clippy::unwrap_used, missing_docs)]

use std::fmt::Write;
use std::path::{Path, PathBuf};

use divan::counter::BytesCount;
use divan::{Bencher, black_box};
use drive_log::{LayoutChoice, Preparation, prepare, read_bytes, read_file};
use rayon::prelude::*;

fn main() {
    divan::main();
}

/// 100,000 rows of 28 columns as an instrumented car records them, nine of which are used.
fn text() -> String {
    let mut text = String::from(
        "time_s;speed_kmh;elevation_m;motor_torque_nm;accel_mps2;battery_voltage_v;battery_current_a;soc_pct;aux_power_kw",
    );
    for i in 9..28 {
        write!(text, ";sensor {i}").unwrap();
    }
    text.push('\n');
    for row in 0..100_000_u32 {
        let wave = (f64::from(row) * 0.01).sin();
        write!(
            text,
            "{:.1};{:.2};{:.2};{:.2};",
            f64::from(row) * 0.1,
            50.0 + 30.0 * wave,
            500.0 + 9.0 * wave,
            70.0 * wave
        )
        .unwrap();
        write!(
            text,
            "{:.2};{:.2};{:.2};{:.2};{:.2}",
            wave,
            380.0 - 9.0 * wave,
            60.0 * wave,
            80.0 - f64::from(row) * 1e-4,
            0.4
        )
        .unwrap();
        for i in 0..19_u32 {
            write!(text, ";{:.2}", f64::from(row % 977 * (i + 1)) * 0.37).unwrap();
        }
        text.push('\n');
    }
    text
}

#[divan::bench]
fn read(bencher: Bencher) {
    let text = text();
    bencher.counter(BytesCount::of_str(&text)).bench(|| {
        read_bytes(
            Path::new("log.csv"),
            black_box(text.as_bytes()),
            &LayoutChoice::Auto,
        )
        .unwrap()
    });
}

#[divan::bench]
fn read_and_prepare(bencher: Bencher) {
    let text = text();
    bencher.counter(BytesCount::of_str(&text)).bench(|| {
        let file = read_bytes(
            Path::new("log.csv"),
            black_box(text.as_bytes()),
            &LayoutChoice::Auto,
        )
        .unwrap();
        file.logs
            .into_iter()
            .map(|log| prepare(log, &Preparation::default()).unwrap())
            .collect::<Vec<_>>()
    });
}

#[divan::bench]
fn csv_crate(bencher: Bencher) {
    let text = text();
    bencher.counter(BytesCount::of_str(&text)).bench(|| {
        let mut columns = vec![Vec::new(); 9];
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(b';')
            .from_reader(black_box(text.as_bytes()));
        let mut record = csv::StringRecord::new();
        while reader.read_record(&mut record).unwrap() {
            for (column, values) in columns.iter_mut().enumerate() {
                values.push(record[column].parse::<f64>().unwrap());
            }
        }
        columns
    });
}

/// All recorded trips of a folder, in parallel over the files as the command line does it.
#[divan::bench]
fn recorded_trips(bencher: Bencher) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/bmw-i3");
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    let files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    let bytes: u64 = files
        .iter()
        .map(|file| file.metadata().unwrap().len())
        .sum();
    bencher.counter(BytesCount::new(bytes)).bench(|| {
        files
            .par_iter()
            .flat_map_iter(|path| read_file(path, &LayoutChoice::Auto).unwrap().logs)
            .map(|log| prepare(log, &Preparation::default()).unwrap().pieces.len())
            .sum::<usize>()
    });
}
