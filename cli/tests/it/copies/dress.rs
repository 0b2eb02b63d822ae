//! The ways to write one drive down.

use std::io::Write as _;

use super::table::Table;

/// Whether a copy keeps the digits of the original.
#[derive(Clone, Copy)]
pub(super) enum Digits {
    All,
    Few,
}

pub(super) struct Copy {
    pub(super) name: &'static str,
    pub(super) content: Vec<u8>,
    pub(super) digits: Digits,
}

fn exact(name: &'static str, content: impl Into<Vec<u8>>) -> Copy {
    Copy {
        name,
        content: content.into(),
        digits: Digits::All,
    }
}

fn rounded(name: &'static str, table: &Table) -> Copy {
    Copy {
        digits: Digits::Few,
        ..exact(name, table.text())
    }
}

/// All copies that the channels of a drive allow.
pub(super) fn copies(drive: &Table) -> Vec<Copy> {
    [
        in_other_units(drive),
        with_fewer_digits(drive),
        on_other_clocks(drive),
        in_other_orders(drive),
        between_other_marks(drive),
        with_odd_rows(drive),
        in_other_bytes(drive),
    ]
    .into_iter()
    .flatten()
    .collect()
}

type Conversion = fn(f64) -> f64;

const MPH: f64 = 0.44704;

/// Column, its name in another unit, and the factor or function in between.
const UNITS: [(&str, &str, Conversion); 41] = [
    ("time_s", "time_ms", |t| t * 1e3),
    ("time_s", "time_us", |t| t * 1e6),
    ("time_s", "time_ns", |t| t * 1e9),
    ("time_s", "time_min", |t| t / 60.0),
    ("time_s", "time_h", |t| t / 3600.0),
    ("time_s", "time_d", |t| t / 86_400.0),
    ("time_s", "time_seconds", |t| t + 12_345.0),
    ("time_s", "t", |t| t - 300.0),
    ("speed_mps", "speed_kmh", |v| v * 3.6),
    ("speed_mps", "speed_kph", |v| v * 3.6),
    ("speed_mps", "speed_mph", |v| v / MPH),
    ("speed_mps", "speed_knots", |v| v * 3600.0 / 1852.0),
    ("speed_mps", "speed_cmps", |v| v * 100.0),
    ("speed_kmh", "speed_mps", |v| v / 3.6),
    ("speed_kmh", "v", |v| v / 3.6),
    ("speed_kmh", "speed_mph", |v| v / 3.6 / MPH),
    ("speed_kmh", "speed_kn", |v| v / 1.852),
    ("speed_kmh", "speed_cmps", |v| v / 0.036),
    ("speed_limit_mps", "speed_limit_kmh", |v| v * 3.6),
    ("speed_limit_mps", "speed_limit_mph", |v| v / MPH),
    ("lead_speed_mps", "lead_speed_kmh", |v| v * 3.6),
    ("lead_gap_m", "lead_gap_km", |d| d / 1e3),
    ("lead_gap_m", "lead_gap_ft", |d| d / 0.3048),
    ("elevation_m", "elevation_km", |z| z / 1e3),
    ("elevation_m", "elevation_ft", |z| z / 0.3048),
    ("elevation_m", "Elevation [m]", |z| z),
    ("grade_rad", "grade_deg", f64::to_degrees),
    ("grade_rad", "grade_pct", |angle| 100.0 * angle.tan()),
    ("grade_rad", "grade_fraction", f64::tan),
    ("grade_rad", "Grade (deg)", f64::to_degrees),
    ("battery_voltage_v", "Battery Voltage [V]", |u| u),
    ("battery_current_a", "battery_current_ma", |i| i * 1e3),
    ("battery_current_a", "battery current (mA)", |i| i * 1e3),
    ("soc_pct", "soc_fraction", |soc| soc / 100.0),
    ("accelerometer_mps2", "accelerometer_g", |a| a / 9.80665),
    ("accelerometer_mps2", "Accelerometer [m/s^2]", |a| a),
    ("aux_power_kw", "aux_power_w", |p| p * 1e3),
    ("heating_power_kw", "heating_power_w", |p| p * 1e3),
    ("heating_request_w", "heating_request_kw", |p| p / 1e3),
    ("ambient_temperature_degc", "ambient_temperature_k", |t| {
        t + 273.15
    }),
    (
        "ambient_temperature_degc",
        "ambient_temperature_degf",
        |t| t * 1.8 + 32.0,
    ),
];

fn in_other_units(drive: &Table) -> Vec<Copy> {
    let converted = UNITS.iter().filter(|(header, _, _)| drive.has(header));
    let mut copies: Vec<Copy> = converted
        .map(|(header, name, convert)| exact(name, drive.with(header, name, convert).text()))
        .collect();
    let whole = drive.written("time_s", "time_ms", |t| format!("{:.0}", t * 1e3));
    copies.push(exact("whole-ms", whole.text()));
    copies
}

fn with_fewer_digits(drive: &Table) -> Vec<Copy> {
    let (speed, mps) = match drive.has("speed_kmh") {
        true => ("speed_kmh", 1.0 / 3.6),
        false => ("speed_mps", 1.0),
    };
    let days = |digits: usize| move |t: f64| format!("{:.digits$}", 46_110.08 + t / 86_400.0);
    vec![
        rounded(
            "kmh-2",
            &drive.written(speed, "speed_kmh", |v| format!("{:.2}", v * mps * 3.6)),
        ),
        rounded(
            "mph-2",
            &drive.written(speed, "speed_mph", |v| format!("{:.2}", v * mps / MPH)),
        ),
        rounded("days-9", &drive.written("time_s", "timestamp", days(9))),
        rounded("days-11", &drive.written("time_s", "timestamp", days(11))),
    ]
}

/// Hours, minutes, seconds and milliseconds of a time.
fn clock(time_s: f64) -> [u64; 4] {
    let ms = (time_s * 1e3).round() as u64;
    [
        ms / 3_600_000 % 24,
        ms / 60_000 % 60,
        ms / 1000 % 60,
        ms % 1000,
    ]
}

/// A clock from a quarter to ten on.
fn text(time_s: f64) -> String {
    let [h, m, s, ms] = clock(time_s + 9.75 * 3600.0);
    format!("{h:02}:{m:02}:{s:02}.{ms:03}")
}

fn packed(time_s: f64) -> String {
    text(time_s).replace(':', "")
}

fn over_midnight(time_s: f64) -> String {
    let [h, m, s, ms] = clock(time_s + 86_400.0 - 200.0);
    format!("{h:02}:{m:02}:{s:02}.{ms:03}")
}

/// With AM or PM, over noon.
fn half_of_day(time_s: f64, blank: &str) -> String {
    let [h, m, s, ms] = clock(time_s + 43_200.0 - 200.0);
    let half = if h < 12 { "AM" } else { "PM" };
    format!(
        "29-Mar-2026 {:02}:{m:02}:{s:02}.{ms:03}{blank}{half}",
        (h + 11) % 12 + 1
    )
}

fn on_other_clocks(drive: &Table) -> Vec<Copy> {
    type Written = fn(f64) -> String;
    let clocks: [(&str, &str, Written); 21] = [
        ("epoch-s", "time_s", |t| format!("{:.3}", 1.6e9 + t)),
        ("timestamp-s", "timestamp", |t| format!("{:.3}", 1.6e9 + t)),
        ("timestamp-ms", "timestamp", |t| {
            format!("{:.0}", 1.6e12 + t * 1e3)
        }),
        ("timestamp-us", "utc", |t| {
            format!("{:.0}", 1.6e15 + t * 1e6)
        }),
        ("timestamp-ns", "timestamp", |t| {
            format!("{:.0}000000", 1.6e12 + t * 1e3)
        }),
        ("iso", "timestamp", |t| format!("2026-03-29T{}", text(t))),
        ("iso-z", "time_utc", |t| format!("2026-03-29T{}Z", text(t))),
        ("iso-zone", "datetime", |t| {
            format!("2026-03-29 {}+02:00", text(t))
        }),
        ("iso-packed", "timestamp", |t| {
            format!("20260329T{}Z", packed(t))
        }),
        ("iso-in-seconds", "time_s", |t| {
            format!("2026-03-29T{}", text(t))
        }),
        ("slashes", "timestamp", |t| {
            format!("2026/03/29 {}", text(t))
        }),
        ("day-first", "time", |t| format!("29.03.2026 {}", text(t))),
        ("day-first-slashes", "time", |t| {
            format!("29/03/2026 {}", text(t))
        }),
        ("month-first", "time", |t| format!("03/29/2026 {}", text(t))),
        ("month-named", "timestamp", |t| {
            format!("Sun Mar 29 {} GMT+02:00 2026", text(t))
        }),
        ("noon", "timestamp", |t| half_of_day(t, " ")),
        ("noon-glued", "timestamp", |t| half_of_day(t, "")),
        ("clock", "time", text),
        ("clock-in-seconds", "time_s", text),
        ("midnight", "time", over_midnight),
        ("packed", "time", packed),
    ];
    let mut copies: Vec<Copy> = clocks
        .into_iter()
        .map(|(name, header, written)| exact(name, drive.written("time_s", header, written).text()))
        .collect();
    let mut two = drive.written("time_s", "Clock", text);
    two.columns.insert(
        0,
        (
            "Date".to_owned(),
            vec!["29.03.2026".to_owned(); drive.rows()],
        ),
    );
    copies.push(exact("date-and-clock", two.text()));
    (two.delimiter, two.decimal_comma) = (";", true);
    copies.push(exact("date-and-clock-comma", two.text()));
    copies
}

fn in_other_orders(drive: &Table) -> Vec<Copy> {
    let mut reversed = drive.clone();
    reversed.columns.reverse();
    let mut rotated = drive.clone();
    rotated.columns.rotate_left(3);
    let mut more = drive.clone();
    more.columns.insert(
        0,
        ("note".to_owned(), vec!["a, b".to_owned(); drive.rows()]),
    );
    more.columns
        .push(("Trip".to_owned(), vec!["3".to_owned(); drive.rows()]));
    more.quoted = true;
    let mut swapped: Vec<usize> = (0..drive.rows()).collect();
    (0..drive.rows() - 1)
        .step_by(10)
        .for_each(|i| swapped.swap(i, i + 1));
    let repeats = |i: usize| if i.is_multiple_of(10) { 2 } else { 1 };
    let twice = (0..drive.rows()).flat_map(|i| std::iter::repeat_n(i, repeats(i)));
    let twice: Vec<usize> = twice.collect();
    vec![
        exact("reversed", reversed.text()),
        exact("rotated", rotated.text()),
        exact("more-columns", more.text()),
        exact("late-rows", drive.in_order(&swapped).text()),
        exact("rows-twice", drive.in_order(&twice).text()),
    ]
}

fn between_other_marks(drive: &Table) -> Vec<Copy> {
    let marked = |delimiter, decimal_comma, quoted, missing| {
        let table = Table {
            delimiter,
            decimal_comma,
            quoted,
            missing,
            ..drive.clone()
        };
        table.text()
    };
    let plain = || marked(",", false, false, "");
    vec![
        exact("semicolons", marked(";", false, false, "")),
        exact("semicolons-comma", marked(";", true, false, "")),
        exact("tabs", marked("\t", false, false, "")),
        exact("tabs-comma", marked("\t", true, false, "")),
        exact("blanks", marked(" ", false, false, "nan")),
        exact("more-blanks", marked("  ", true, false, "-")),
        exact(
            "sep-line",
            "sep=;\n".to_owned() + &marked(";", false, false, ""),
        ),
        exact("quoted", marked(",", false, true, "")),
        exact("quoted-comma", marked(",", true, true, "")),
        exact("padded", marked(" , ", false, false, "")),
        exact("words", marked(",", false, false, "N/A")),
        exact("last-delimiter", plain().replace('\n', ",\n")),
        exact(
            "digits",
            with_forms_of_numbers(drive, |x| format!("{x:+.17}")),
        ),
        exact(
            "exponents",
            with_forms_of_numbers(drive, |x| format!("{x:e}")),
        ),
        exact("grouped", grouped(drive)),
        exact("upper-case", headed(drive, str::to_uppercase)),
        exact(
            "blank-headers",
            headed(drive, |header| format!(" {} ", header.replace('_', " "))),
        ),
        exact(
            "dashed-headers",
            headed(drive, |header| header.replace('_', "-")),
        ),
    ]
}

fn headed(drive: &Table, name: impl Fn(&str) -> String) -> String {
    let mut table = drive.clone();
    table
        .columns
        .iter_mut()
        .for_each(|(header, _)| *header = name(header));
    table.text()
}

fn with_forms_of_numbers(drive: &Table, form: impl Fn(f64) -> String) -> String {
    let headers = drive.headers();
    let forms = |table: Table, header: &String| table.written(header, header, &form);
    headers.iter().fold(drive.clone(), forms).text()
}

/// Points between thousands, commas before decimals.
fn grouped(drive: &Table) -> String {
    let grouped = |value: f64| {
        let text = value.to_string();
        let (whole, decimals) = text.split_once('.').unwrap_or((&text, "0"));
        let at = whole.len().saturating_sub(3);
        match whole.trim_start_matches('-').len() {
            4.. => format!("{}.{},{decimals}", &whole[..at], &whole[at..]),
            _ => format!("{whole},{decimals}"),
        }
    };
    let mut table = drive.clone();
    table.delimiter = ";";
    with_forms_of_numbers(
        &table.with("elevation_m", "elevation_ft", |z| z / 0.3048),
        grouped,
    )
}

fn with_odd_rows(drive: &Table) -> Vec<Copy> {
    let with = |at: usize, line: &str| {
        let mut lines = drive.lines();
        lines.insert(at, line.to_owned());
        lines.join("\n") + "\n"
    };
    let header = drive.lines()[0].clone();
    let headers = drive.headers();
    let units = headers
        .iter()
        .map(|h| h.rsplit_once('_').map_or("", |(_, unit)| unit));
    let units = units.collect::<Vec<_>>().join(",");
    let last = drive.rows() + 1;
    vec![
        exact("comment-above", with(0, "# logger 3: speed, time")),
        exact("comment-slashes", with(0, "// logger 3")),
        exact("comment-inside", with(1000, "# a mark")),
        exact("header-again", with(2000, &header)),
        exact("units-below", with(1, &units)),
        exact("footer", with(last, "end of log")),
        exact("blank-top", with(0, "\n")),
        exact("blank-lines", drive.text().replace('\n', "\n\n")),
    ]
}

fn in_other_bytes(drive: &Table) -> Vec<Copy> {
    let text = drive.text();
    let mut latin = drive.clone();
    latin
        .columns
        .push(("T (°C)".to_owned(), vec!["°".to_owned(); drive.rows()]));
    let latin: Vec<u8> = latin.text().chars().map(|c| c as u8).collect();
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    gzip.write_all(text.as_bytes()).unwrap();
    vec![
        exact("bom", format!("\u{feff}{text}")),
        exact(
            "bom-crlf",
            format!("\u{feff}{}", text.replace('\n', "\r\n")),
        ),
        exact("crlf", text.replace('\n', "\r\n")),
        exact("cr", text.replace('\n', "\r")),
        exact("both-line-ends", text.replacen('\n', "\r\n", 3000)),
        exact("no-last-end", text.trim_end()),
        exact("latin-1", latin),
        exact("gzip", gzip.finish().unwrap()),
    ]
}
