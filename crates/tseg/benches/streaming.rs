//! SWAB one sample at a time on the WLTC at 10 Hz: the time of every push.

#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs)]

mod wltc;

use std::hint::black_box;
use std::time::Instant;

use tseg::{Cost, Refill, Swab};

const THRESHOLD: f64 = 0.2;
const WINDOW: usize = 100;
const SAMPLES: usize = 1_000_000;

fn main() {
    // As `cargo bench -- --test`: once, without measuring.
    let samples = if std::env::args().any(|arg| arg == "--test") {
        1_000
    } else {
        SAMPLES
    };
    println!("time per push of {samples} in ns, window {WINDOW}");
    println!("refill      mean     p50     p99   p99.9     max");
    for refill in [Refill::Keogh, Refill::Fixed, Refill::Literal] {
        let mut times = push_times_ns(refill, samples);
        let mean = times.iter().sum::<u64>() / times.len() as u64;
        times.sort_unstable();
        let share =
            |per_mille: usize| times[(times.len() * per_mille / 1_000).min(times.len() - 1)];
        println!(
            "{:<8} {mean:7} {:7} {:7} {:7} {:7}",
            format!("{refill:?}"),
            share(500),
            share(990),
            share(999),
            share(1_000)
        );
    }
}

fn push_times_ns(refill: Refill, samples: usize) -> Vec<u64> {
    let (speed, accel) = wltc::wltc(samples);
    let swab = Swab::new(Cost::MeanDeviation, THRESHOLD, WINDOW).unwrap();
    let mut stream = swab.with_refill(refill).stream(&[1.8, 1.0]).unwrap();
    let mut times = Vec::with_capacity(samples);
    for (&v, &a) in speed.iter().zip(&accel) {
        let start = Instant::now();
        let segment = stream.push(&[v, a]);
        times.push(u64::try_from(start.elapsed().as_nanos()).unwrap());
        black_box(segment).unwrap();
    }
    times
}
