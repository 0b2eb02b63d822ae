//! Logs and layouts damaged at random: each a log or an error, none a panic. `DRIVEKIT_HOSTILE_SECONDS` runs them for longer.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

use drive_log::{Layout, LayoutChoice, Preparation, check, prepare, read_bytes, write_csv};

/// Damaged inputs of each kind in an ordinary run.
const CASES: u64 = 3000;

/// Longer ones only take longer.
const LONGEST: usize = 4000;

const LOGS: [&str; 12] = [
    "time_s,speed_mps,soc_pct\n0,1,50\n0.1,2,50\n0.2,3,49.9\n0.3,3,49.9\n",
    "Zeit;Tempo [km/h]\n0,0;1,5\n0,1;1,6\n0,2;1,7\n",
    "Time [s];Velocity [km/h];Elevation [m];Battery Voltage [V];Battery Current [A]\n0;0;574;391,6;-8,6\n0,1;0,45;574;391,57;-8,9\n",
    "Date,Time,Speed,Soc,Mode,GpsSpeed,WindSpeedAv,SpeedLimit\n3/30/2021,23:59:59,20,80,1,20,0,50\n3/31/2021,0:00:00,21,80,1,21,0,50\n",
    "x\nVehicle_order,1,2\n\n\n\nTime,Speed1,Speed2,IVS1\n0,1,2,3\n0.1,1,2,3\n",
    "0,10,0.1\n1,11,0.2\n2,12,0.2\n3,11,-0.2\n",
    "cycSecs,cycMps,cycGrade\n0,0,0\n1,1,0\n2,2,0.01\n",
    "# made\ntrip,vehid,timestamp,speed_kmh,speed_limit_kmh\n;;;;\n1,a,1754413076250,52.1,50\n1,a,1754413076350,52.2,48-40\n2,b,1754413076450,0,255\n",
    "sep=;\ntime_ms;speed_kmh;elevation_ft\n0;1.234,5;1.000\n100;1;999\n",
    "date,time,speed_kmh\n29.03.2026,01:55:00.25,\"1,5\"\n29.03.2026,01:55:01,2\nEnd\n",
    "t v a\n0 1 0\n0.1 1.1 1\n0.2 1.2 1\n",
    "timestamp,speed_mps,lead_gap_m,lead_speed_mps\n2026-03-29T01:55:00+01:00,3,252,0\n2026-03-29T01:55:01+01:00,3,-1,0\n",
];

const LAYOUTS: [&str; 4] = [
    include_str!("../../src/layouts/bmw-i3.toml"),
    include_str!("../../src/layouts/igdir.toml"),
    include_str!("../../src/layouts/rsk-twizy.toml"),
    "delimiter = \";\"\ndecimal = \",\"\nskip_lines = 1\nmissing = [\"ND\"]\nsplit_by = [\"trip\"]\n\
     time = { header = \"timestamp\" }\n[channels]\nspeed = { header = \"speed_kmh\", unit = \"km/h\" }\n",
];

/// The words that the fuzz targets know.
fn words() -> Vec<Vec<u8>> {
    let lines = include_str!("../../fuzz/log.dict").lines();
    let quoted = lines.filter_map(|line| line.strip_prefix('"')?.strip_suffix('"'));
    let unescaped = |word: &str| {
        let word = word.replace("\\x0a", "\n").replace("\\x1e", "\u{1e}");
        word.replace("\\\"", "\"").into_bytes()
    };
    let more = [
        "\n",
        "\r",
        ",",
        ";",
        "\"",
        "NaN",
        "1e308",
        "-1e308",
        "1e-320",
        "99999999999999999999",
        "\u{feff}",
        "é",
        "\0",
    ];
    quoted
        .map(unescaped)
        .chain(more.map(|word| word.as_bytes().to_vec()))
        .collect()
}

/// Numbers that look random, the same in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 33) as usize % limit.max(1)
    }

    fn of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }

    /// A part of the bytes, short more often than long.
    fn part(&mut self, len: usize) -> std::ops::Range<usize> {
        let start = self.below(len + 1);
        let longest = 1 << self.below(9);
        start..len.min(start + self.below(longest + 1))
    }
}

/// One to eight damages.
fn damaged(random: &mut Random, text: &[u8], others: &[&str], words: &[Vec<u8>]) -> Vec<u8> {
    let mut text = text.to_vec();
    for _ in 0..=random.below(8) {
        let part = random.part(text.len());
        match random.below(6) {
            0 => drop(text.drain(part)),
            1 => {
                let copy = text[part].to_vec();
                let at = random.below(text.len() + 1);
                let times = 1 + random.below(30);
                drop(text.splice(at..at, copy.repeat(times)));
            }
            2 => {
                let other = random.of(others).as_bytes();
                let piece = other[random.part(other.len())].to_vec();
                drop(text.splice(part, piece));
            }
            3 => text[part]
                .iter_mut()
                .for_each(|byte| *byte = random.below(256) as u8),
            _ => drop(text.splice(part.start..part.start, random.of(words).clone())),
        }
        text.truncate(LONGEST);
    }
    text
}

/// Reads, checks, resamples and writes, as commands do.
fn take(bytes: &[u8], choice: &LayoutChoice) {
    let Ok(file) = read_bytes(Path::new("hostile.csv"), bytes, choice) else {
        return;
    };
    let options = Preparation {
        step_s: 1.0,
        ..Preparation::default()
    };
    for log in file.logs.into_iter().take(8) {
        drop(check(log.clone()));
        let pieces = prepare(log, &options).map(|drive| drive.pieces);
        for piece in pieces.unwrap_or_default().iter().take(4) {
            write_csv(piece, &mut Vec::new()).unwrap();
        }
    }
}

/// Runs cases by number until there were enough, and names the one that panics with its input.
fn survive(kind: &str, case: impl Fn(&mut Random) -> Vec<u8>, run: impl Fn(&[u8])) {
    let seconds = std::env::var("DRIVEKIT_HOSTILE_SECONDS").ok();
    let limit = seconds.map(|text| Duration::from_secs(text.parse().unwrap()));
    let start = Instant::now();
    let goes_on = |number: u64| match limit {
        Some(limit) => start.elapsed() < limit,
        None => number < CASES,
    };
    let mut number = 0;
    while goes_on(number) {
        let input = case(&mut Random(number.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        let outcome = catch_unwind(AssertUnwindSafe(|| run(&input)));
        assert!(
            outcome.is_ok(),
            "{kind} {number}: {:?}",
            String::from_utf8_lossy(&input)
        );
        number += 1;
    }
    eprintln!("{kind}: {number} inputs");
}

#[test]
fn damaged_logs_are_logs_or_errors() {
    let words = words();
    let case = |random: &mut Random| {
        let log = random.of(&LOGS).as_bytes();
        damaged(random, log, &LOGS, &words)
    };
    survive("logs", case, |bytes| {
        // the decoder of Parquet panics on damaged files, which the reader catches
        if !bytes.starts_with(b"PAR1") {
            take(bytes, &LayoutChoice::Auto);
        }
    });
}

#[test]
fn damaged_layouts_are_layouts_or_errors() {
    let words = words();
    let case = |random: &mut Random| {
        let layout = random.of(&LAYOUTS).as_bytes();
        damaged(random, layout, &LAYOUTS, &words)
    };
    survive("layouts", case, |bytes| {
        let text = String::from_utf8_lossy(bytes);
        if let Ok(layout) = Layout::from_toml_str("hostile.toml", &text) {
            let choice = LayoutChoice::Described(layout);
            LOGS.iter().for_each(|log| take(log.as_bytes(), &choice));
        }
    });
}
