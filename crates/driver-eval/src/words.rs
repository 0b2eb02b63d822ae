//! Numbers and lists in sentences.

/// Names in a list at most; more are counted.
const MOST_NAMES: usize = 8;

/// `1 drive`, `2 drives`, `2 stretches of cruising`: the plural is of the word before ` of `, ` behind ` or ` under `, or of the last.
#[must_use]
pub fn plural(count: usize, noun: &str) -> String {
    if count == 1 {
        return format!("1 {noun}");
    }
    let places = [" of ", " behind ", " under "].into_iter();
    let end = places.filter_map(|word| noun.find(word)).min();
    let (noun, rest) = noun.split_at(end.unwrap_or(noun.len()));
    let ending = if noun.ends_with("ch") { "es" } else { "s" };
    format!("{count} {noun}{ending}{rest}")
}

/// `a, b and 3 more`.
#[must_use]
pub fn listed(names: &[&str]) -> String {
    let more = names.len().saturating_sub(MOST_NAMES);
    let shown = names[..names.len() - more].join(", ");
    match more {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// To so many decimals.
pub(crate) fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10.0_f64.powi(decimals);
    (value * scale).round() / scale
}

/// To a millimetre per second, which no picture shows; not a number becomes null.
pub(crate) fn millimetres(values: impl Iterator<Item = f64>) -> Vec<f64> {
    values.map(|value| rounded(value, 3)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_of_a_kind_has_no_plural() {
        assert_eq!(plural(1, "finding"), "1 finding");
        assert_eq!(plural(0, "finding"), "0 findings");
        assert_eq!(plural(12, "stretch"), "12 stretches");
        assert_eq!(
            plural(2, "phase under a leader's influence"),
            "2 phases under a leader's influence"
        );
    }

    #[test]
    fn long_lists_end_with_a_number() {
        assert_eq!(listed(&["a", "b"]), "a, b");
        assert_eq!(listed(&["n"; 11]), "n, n, n, n, n, n, n, n and 3 more");
    }
}
