//! Text, its lines and their fields.

use std::borrow::Cow;
use std::io::BufRead;
use std::path::Path;

use crate::Error;

/// How lines begin that comment on a log.
const COMMENT_MARKS: [&[u8]; 4] = [b"#", b"//", b"%", b"\"#"];

/// Whether a line may be a comment.
pub(crate) fn is_comment(line: &[u8]) -> bool {
    let line = line.trim_ascii_start();
    COMMENT_MARKS.iter().any(|mark| line.starts_with(mark))
}

/// The text without its byte order mark, if it is text.
pub(crate) fn checked_text<'a>(path: &Path, bytes: &'a [u8]) -> Result<&'a [u8], Error> {
    let not_text = |found, byte| Error::NotText {
        path: path.to_owned(),
        found,
        byte,
    };
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err(not_text("UTF-16 text", 0));
    }
    if text.trim_ascii().is_empty() {
        return Err(Error::NoData {
            path: path.to_owned(),
            found: "an empty file",
        });
    }
    if text.contains(&0) {
        let byte = text.iter().position(|b| *b == 0).unwrap_or_default();
        // ASCII characters in UTF-16 have a zero in every other byte
        let utf16 =
            text.len() > 3 && (text[0] == 0) != (text[1] == 0) && (text[0] == 0) == (text[2] == 0);
        return Err(not_text(
            if utf16 {
                "UTF-16 text"
            } else {
                "a NUL byte (binary data)"
            },
            byte,
        ));
    }
    Ok(text)
}

/// Text as UTF-8, or else as Latin-1.
pub(crate) fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().map(|b| char::from(*b)).collect()),
    }
}

/// The fields of a line, trimmed and without quotes. A blank delimiter stands for any run of
/// blanks.
pub(crate) fn fields(line: &str, delimiter: u8) -> Vec<&str> {
    if delimiter == b' ' {
        return line.split_ascii_whitespace().collect();
    }
    let mut quoted = false;
    line.split(|c| {
        quoted ^= c == '"';
        c == char::from(delimiter) && !quoted
    })
    .map(|field| field.trim().trim_matches('"').trim())
    .collect()
}

/// Lines with their number from 1, blank ones left out, line ends cut off.
pub(crate) fn lines(text: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let mut rest = text;
    let mut number = 0;
    std::iter::from_fn(move || {
        while !rest.is_empty() {
            let (line, after) = rest.split_at(line_len(rest));
            (rest, number) = (after, number + 1);
            if !line.trim_ascii().is_empty() {
                // a tab at the end delimits an empty cell
                let blanks = line
                    .iter()
                    .rev()
                    .take_while(|b| matches!(b, b'\r' | b'\n' | b' '));
                return Some((number, &line[..line.len() - blanks.count()]));
            }
        }
        None
    })
}

/// Bytes of the first line with its end. Reading from a slice cannot fail, and searches several
/// bytes at a time.
pub(crate) fn line_len(mut text: &[u8]) -> usize {
    text.skip_until(b'\n').unwrap_or(text.len())
}

/// Text with a line feed at the end of every line: old loggers end lines with a carriage return
/// alone.
pub(crate) fn with_line_feeds(text: &[u8]) -> Cow<'_, [u8]> {
    if text.contains(&b'\n') || !text.contains(&b'\r') {
        return Cow::Borrowed(text);
    }
    let feed = |byte: &u8| if *byte == b'\r' { b'\n' } else { *byte };
    Cow::Owned(text.iter().map(feed).collect())
}
