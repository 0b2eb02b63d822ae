//! What the first block of a file tells before the rest is read.

use std::path::Path;

use crate::Error;
use crate::lines::{checked_text, decoded, fields, lines};
use crate::number::number;

/// Bytes that tell a log from other files.
pub(crate) const HEAD_BYTES: usize = 64 << 10;

/// Longest first line, in bytes: ten thousand headers of a hundred letters.
pub(crate) const LONGEST_LINE_BYTES: usize = 1 << 20;

/// Lines that are searched for a row of numbers.
const SEARCHED_LINES: usize = 200;

/// Files that are often found beside logs, by their first bytes.
const FOREIGN: [(&[u8], &str); 14] = [
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"GIF8", "a GIF picture"),
    (b"%PDF", "a PDF document"),
    (b"PK\x03\x04", "a ZIP archive or an Excel workbook"),
    (b"\xd0\xcf\x11\xe0", "an old Office document"),
    (b"SQLite format 3", "an SQLite database"),
    (b"\x89HDF", "an HDF5 file"),
    (b"MATLAB 5.0", "a MATLAB file"),
    (b"\x7fELF", "a program"),
    (b"<!", "an HTML or XML page"),
    (b"<?", "an XML document"),
    (b"<html", "an HTML page"),
    (b"<svg", "an SVG picture"),
];

pub(crate) const GZIP: &[u8] = &[0x1f, 0x8b];
pub(crate) const ZSTD: &[u8] = &[0x28, 0xb5, 0x2f, 0xfd];
pub(crate) const PARQUET: &[u8] = b"PAR1";

/// Whether bytes start as a compressed file or as Parquet, whose content only a decoder can judge.
pub(crate) fn is_container(bytes: &[u8]) -> bool {
    [GZIP, ZSTD, PARQUET]
        .iter()
        .any(|magic| bytes.starts_with(magic))
}

/// Refuses what cannot be a log.
pub(crate) fn check(path: &Path, head: &[u8]) -> Result<(), Error> {
    if is_container(head) {
        return Ok(());
    }
    if let Some(found) = foreign(head) {
        return Err(Error::NotALog {
            path: path.to_owned(),
            found,
        });
    }
    checked_text(path, head).map(|_| ())
}

/// Refuses a first line that does not end in these bytes.
pub(crate) fn check_first_line(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let start = &bytes[..bytes.len().min(LONGEST_LINE_BYTES)];
    if bytes.len() < LONGEST_LINE_BYTES
        || is_container(bytes)
        || start.iter().any(|byte| matches!(byte, b'\n' | b'\r'))
    {
        return Ok(());
    }
    Err(Error::LongLine {
        path: path.to_owned(),
        line: 1,
        limit_bytes: LONGEST_LINE_BYTES as u64,
    })
}

/// What a file is, if it is something else than a log.
fn foreign(head: &[u8]) -> Option<&'static str> {
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    if text.trim_ascii().is_empty() {
        return Some("an empty file");
    }
    let start = text.trim_ascii_start();
    let known = FOREIGN.iter().find(|(magic, _)| start.starts_with(magic));
    if let Some((_, found)) = known {
        return Some(found);
    }
    if is_json(start) {
        return Some("a JSON document");
    }
    if is_utf16(text) {
        return None;
    }
    if is_binary(text) {
        return Some("binary data");
    }
    let judged = !text.contains(&0) && !is_within_a_line(text);
    (judged && !has_rows(text)).then_some("a text without rows of numbers")
}

fn is_json(start: &[u8]) -> bool {
    let within = || start[1..].trim_ascii_start().first();
    match start.first() {
        Some(b'{') => matches!(within(), Some(b'"' | b'}')),
        Some(b'[') => matches!(within(), Some(b'{' | b'[' | b'"' | b']')),
        _ => false,
    }
}

/// UTF-16 may well be a log, of which its own error says how to save it.
fn is_utf16(text: &[u8]) -> bool {
    text.starts_with(b"\xff\xfe")
        || text.starts_with(b"\xfe\xff")
        || (text.len() > 3 && (text[0] == 0) != (text[1] == 0) && (text[0] == 0) == (text[2] == 0))
}

/// A single odd byte is damage of a text, which has an error of its own.
fn is_binary(text: &[u8]) -> bool {
    let control = |byte: &&u8| matches!(byte, 0..=8 | 14..=25 | 28..=31 | 127);
    let count = text.iter().filter(control).count();
    count > 1 && 50 * count > text.len()
}

/// Whether a first line goes on after these bytes.
fn is_within_a_line(text: &[u8]) -> bool {
    let ends = |byte: &u8| matches!(byte, b'\n' | b'\r');
    text.len() + 3 >= HEAD_BYTES && !text.iter().any(ends)
}

/// Whether some line is a row of numbers, or a header of a speed, of which the rows may be missing.
fn has_rows(text: &[u8]) -> bool {
    lines(text).take(SEARCHED_LINES).any(|(_, line)| {
        let line = decoded(line);
        [b',', b';', b'\t', b' '].into_iter().any(|delimiter| {
            let fields = fields(&line, delimiter);
            let numbers = fields.iter().filter(|f| is_value(f)).count();
            let is_header = fields.len() > 1 && fields.iter().any(|field| names_a_speed(field));
            numbers > 1 && 2 * numbers >= fields.len() || delimiter != b' ' && is_header
        })
    })
}

/// A number, a date or a clock time.
fn is_value(field: &str) -> bool {
    let in_time = |c: char| c.is_ascii_digit() || "-/:.,+TZ".contains(c);
    number(field).is_some()
        || field.starts_with(|c: char| c.is_ascii_digit()) && field.chars().all(in_time)
}

/// Whether a header may be that of a speed, so that its table may be a log.
pub(crate) fn names_a_speed(header: &str) -> bool {
    const WORDS: [&str; 10] = [
        "speed", "veloc", "km/h", "kmh", "kph", "mph", "m/s", "mps", "geschw", "vitesse",
    ];
    // a limit alone, or what is said of a whole drive
    const OTHERS: [&str; 6] = ["limit", "mean", "average", "avg", "max", "median"];
    let header = header.to_lowercase();
    if OTHERS.iter().any(|word| header.contains(word)) {
        return false;
    }
    header == "v" || WORDS.iter().any(|word| header.contains(word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_files_are_told_by_their_first_bytes() {
        for (bytes, what) in [
            (&b""[..], "empty"),
            (b" \n \n", "empty"),
            (&[0; 4096], "binary"),
            (b"\x89PNG\r\n\x1a\n\0\0", "PNG"),
            (b"PK\x03\x04\x14\0", "ZIP"),
            (b"<!DOCTYPE html>", "HTML"),
            (b"{\n  \"schema\": 1}", "JSON"),
            (b"[[1, 2]]", "JSON"),
            (b"Notes of the 3rd of May, 2021.\nAll went well.\n", "text"),
        ] {
            assert!(
                foreign(bytes).is_some_and(|found| found.contains(what)),
                "{what}"
            );
        }
    }

    #[test]
    fn logs_are_not_taken_for_other_files() {
        for text in [
            "time_s,speed_mps\n0,1\n",
            "time_s,speed_mps\n",
            "# made by a logger\ntime_s,speed_mps\n0,1\n",
            "Zeit;Geschwindigkeit\n0,5;36,2\n",
            "0 0 0\n1 0.5 0.2\n",
            "[s],[km/h]\n1,2\n",
            "Date,Time,Speed\n05/25/2021,12:00:01,3\n",
            "time_s,speed_mps\nNaN,NaN\n",
            "t\tv\n1\t2\n",
        ] {
            assert_eq!(foreign(text.as_bytes()), None, "{text}");
        }
    }
}
