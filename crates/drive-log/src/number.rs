//! Numbers as people and loggers write them.

/// Words for a value that is not there, in lower case. Cells without a letter or digit, such as
/// `--`, `?` or `***`, say the same.
const MISSING: [&str; 24] = [
    "na",
    "n/a",
    "n.a.",
    "#n/a",
    "<na>",
    "nan",
    "-nan",
    "null",
    "(null)",
    "<null>",
    "none",
    "nil",
    "\\n",
    "inf",
    "+inf",
    "-inf",
    "infinity",
    "missing",
    "undefined",
    "#div/0!",
    "#value!",
    "1.#qnan",
    "1.#ind",
    "-1.#ind",
];

/// Whether a cell says that there is no value.
pub(crate) fn is_missing(text: &str) -> bool {
    !text.chars().any(char::is_alphanumeric)
        || MISSING.iter().any(|word| word.eq_ignore_ascii_case(text))
}

/// A number with a decimal point or a decimal comma; where both marks stand in it, the last is the
/// decimal mark and the other separates thousands: `1.234,5`, `1,234.5`.
pub(crate) fn number(text: &str) -> Option<f64> {
    match (text.rfind('.'), text.rfind(',')) {
        (_, None) => text.parse().ok(),
        (None, Some(_)) => text.replacen(',', ".", 1).parse().ok(),
        (Some(point), Some(comma)) => {
            let (thousands, decimal) = if point > comma {
                (',', point)
            } else {
                ('.', comma)
            };
            let whole = ungrouped(&text[..decimal], thousands)?;
            format!("{whole}.{}", &text[decimal + 1..]).parse().ok()
        }
    }
}

/// A whole number whose thousands are separated by `mark`: `1.234.567`.
pub(crate) fn thousands(text: &str, mark: char) -> Option<f64> {
    ungrouped(text, mark)?.parse().ok()
}

/// The digits of a whole number without the marks between its groups of three.
fn ungrouped(text: &str, mark: char) -> Option<String> {
    let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
    let mut groups = digits.split(mark);
    let first = groups.next()?;
    let whole = |group: &str| group.bytes().all(|b| b.is_ascii_digit());
    let grouped = (1..=3).contains(&first.len())
        && whole(first)
        && digits.len() > first.len()
        && groups.all(|group| group.len() == 3 && whole(group));
    grouped.then(|| text.replace(mark, ""))
}

/// Whether the decimal mark of a number is a comma; `None` if it has none.
pub(crate) fn decimal_mark(text: &str) -> Option<bool> {
    text.bytes()
        .rfind(|b| matches!(b, b',' | b'.'))
        .map(|b| b == b',')
}

/// As [`decimal_mark`], but `None` too for a mark that may separate thousands: that of `1.234`, not
/// those of `0.234`, `1.2340` and `1.234,5`.
pub(crate) fn decided_mark(text: &str) -> Option<bool> {
    let comma = decimal_mark(text)?;
    let mark = if comma { ',' } else { '.' };
    let leading_zero = text.trim_start_matches(['+', '-']).starts_with('0');
    (leading_zero || ungrouped(text, mark).is_none()).then_some(comma)
}

/// A number with a unit after it, `52.1 km/h`, cut in two.
pub(crate) fn number_and_rest(text: &str) -> Option<(f64, &str)> {
    let end = text.find(|c: char| !(c.is_ascii_digit() || "+-.,".contains(c)))?;
    let value = number(&text[..end])?;
    Some((value, text[end..].trim_start()))
}

/// Two numbers joined by a dash: `48-40`.
pub(crate) fn is_range(text: &str) -> bool {
    text.split_once(['-', '–']).is_some_and(|(from, to)| {
        [from, to]
            .iter()
            .all(|end| number(end.trim()).is_some_and(|value| value >= 0.0))
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn marks_of_decimals_and_thousands() {
        for (text, value) in [
            ("1.5", 1.5),
            ("1,5", 1.5),
            ("1.234,5", 1234.5),
            ("-1,234,567.25", -1_234_567.25),
            ("1e3", 1000.0),
        ] {
            assert_eq!(number(text), Some(value), "{text}");
        }
        for text in [
            "1.23,5",
            "1,2345.6",
            "1.2.3",
            "1,2,3",
            "",
            "1 km",
            "1.234,5.6",
        ] {
            assert_eq!(number(text), None, "{text}");
        }
        assert_eq!(thousands("1.234.567", '.'), Some(1_234_567.0));
        assert_eq!(thousands("-1,000", ','), Some(-1000.0));
        for text in ["1000", "1.0000", "1.00", ".123", "1234.567", "1.-23"] {
            assert_eq!(thousands(text, '.'), None, "{text}");
        }
    }

    #[test]
    fn a_mark_before_three_digits_decides_nothing() {
        for (text, comma) in [
            ("1.234", None),
            ("12,345", None),
            ("1234", None),
            ("0.234", Some(false)),
            ("0,000", Some(true)),
            ("1.23", Some(false)),
            ("1234.567", Some(false)),
            ("1.234,0", Some(true)),
        ] {
            assert_eq!(decided_mark(text), comma, "{text}");
        }
    }

    #[test]
    fn words_ranges_and_units() {
        for text in [
            "", "--", "?", "***", ".", "n.a.", "<NA>", "\\N", "1.#QNAN", "#DIV/0!",
        ] {
            assert!(is_missing(text), "{text}");
        }
        for text in ["0", "NPI", "-1", "x"] {
            assert!(!is_missing(text), "{text}");
        }
        assert!(is_range("48-40") && is_range("48.5 – 40"));
        assert!(!is_range("-48") && !is_range("2026-03-04") && !is_range("a-b"));
        assert_eq!(number_and_rest("52.1 km/h"), Some((52.1, "km/h")));
        assert_eq!(number_and_rest("12%"), Some((12.0, "%")));
        assert_eq!(number_and_rest("fast"), None);
    }
}
