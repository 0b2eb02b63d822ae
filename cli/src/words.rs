//! Numbers and lists in sentences.

/// Names in a list at most; more are counted.
const MOST_NAMES: usize = 8;

/// `1 drive`, `2 drives`, `2 stretches`.
pub(crate) fn plural(count: usize, noun: &str) -> String {
    match count {
        1 => format!("1 {noun}"),
        _ if noun.ends_with("ch") => format!("{count} {noun}es"),
        _ => format!("{count} {noun}s"),
    }
}

/// `a, b and 3 more`.
pub(crate) fn listed(names: &[&str]) -> String {
    let more = names.len().saturating_sub(MOST_NAMES);
    let shown = names[..names.len() - more].join(", ");
    match more {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_of_a_kind_has_no_plural() {
        assert_eq!(plural(1, "finding"), "1 finding");
        assert_eq!(plural(0, "finding"), "0 findings");
        assert_eq!(plural(12, "stretch"), "12 stretches");
    }

    #[test]
    fn long_lists_end_with_a_number() {
        assert_eq!(listed(&["a", "b"]), "a, b");
        assert_eq!(listed(&["n"; 11]), "n, n, n, n, n, n, n, n and 3 more");
    }
}
