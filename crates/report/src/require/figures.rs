//! Which figures a document has, and where.

use serde_json::Value;

/// Keys that may be left out on the way to a figure.
const TRANSPARENT: [&str; 4] = ["models", "baselines", "totals", "logs"];

/// The figures of one document, a line each: keys from the outside in, `*` for a name and `[]` for an entry of a list.
#[derive(Debug, Clone)]
pub struct KnownFigures {
    list: &'static str,
    /// What `*` stands for; anything where there are none.
    names: Vec<String>,
}

/// Suggestions of one message.
const SUGGESTED: usize = 3;

impl KnownFigures {
    /// Of a document without names of models.
    #[must_use]
    pub fn new(list: &'static str) -> Self {
        Self {
            list,
            names: Vec::new(),
        }
    }

    /// With these names of models.
    #[must_use]
    pub fn of(list: &'static str, names: impl IntoIterator<Item = String>) -> Self {
        Self {
            list,
            names: names.into_iter().collect(),
        }
    }

    fn patterns(&self) -> impl Iterator<Item = Vec<&'static str>> {
        self.list.lines().map(|line| line.split('.').collect())
    }

    /// `None` where the figure is one of these; or else the nearest.
    pub(super) fn nearest_unless_known(&self, figure: &[String]) -> Option<String> {
        let figure: Vec<&str> = figure.iter().map(String::as_str).collect();
        if self
            .patterns()
            .any(|pattern| self.matches(&pattern, &figure, false))
        {
            return None;
        }
        let of_a_name = self
            .patterns()
            .any(|pattern| self.matches(&pattern, &figure, true));
        let named = figure.iter().find(|key| self.is_name(key));
        let name = named.or(figure.first()).copied().unwrap_or_default();
        let candidates: Vec<String> = if of_a_name {
            let with = |(at, _): (usize, &&str)| {
                let named = |name: &String| {
                    let mut figure: Vec<&str> = figure.clone();
                    figure[at] = name;
                    figure.join(".")
                };
                self.names.iter().map(named).collect::<Vec<_>>()
            };
            figure.iter().enumerate().flat_map(with).collect()
        } else {
            self.patterns()
                .flat_map(|pattern| spelt(&pattern, name))
                .collect()
        };
        Some(nearest(&figure.join("."), candidates))
    }

    /// Whether the keys of a figure lead to a pattern, with any name for `*` or with a known one.
    fn matches(&self, pattern: &[&str], figure: &[&str], any_name: bool) -> bool {
        let Some((key, below)) = pattern.split_first() else {
            return figure.is_empty();
        };
        let may_be_left_out = *key == "[]" || TRANSPARENT.contains(key);
        if may_be_left_out && self.matches(below, figure, any_name) {
            return true;
        }
        // Names and horizons may hold dots.
        (1..=figure.len()).any(|count| {
            let given = figure[..count].join(".");
            let fits = match *key {
                "[]" => true,
                "*" => any_name || self.is_name(&given),
                key => key == given,
            };
            fits && self.matches(below, &figure[count..], any_name)
        })
    }

    fn is_name(&self, given: &str) -> bool {
        self.names.is_empty()
            || self.names.iter().any(|name| name == given)
            || given.parse::<f64>().is_ok()
    }
}

/// A pattern as one would type it with a name, short and in full.
fn spelt(pattern: &[&str], name: &str) -> [String; 2] {
    let keys = pattern.iter().copied().filter(|key| *key != "[]");
    let keys = keys.map(|key| if key == "*" { name } else { key });
    let full: Vec<&str> = keys.collect();
    let short = full
        .iter()
        .copied()
        .filter(|key| !TRANSPARENT.contains(key));
    [short.collect::<Vec<_>>().join("."), full.join(".")]
}

fn nearest(figure: &str, candidates: Vec<String>) -> String {
    let mut candidates = candidates;
    candidates.sort();
    candidates.dedup();
    candidates.sort_by_key(|candidate| strsim::levenshtein(figure, candidate));
    let quoted = candidates
        .iter()
        .take(SUGGESTED)
        .map(|near| format!("`{near}`"));
    quoted.collect::<Vec<_>>().join(" or ")
}

/// Gathers the figures that the keys lead to; `None` for what is not defined.
pub(super) fn find(value: &Value, figure: &[String], found: &mut Vec<Option<f64>>) {
    match value {
        Value::Object(keys) => {
            for count in 1..=figure.len() {
                if let Some(below) = keys.get(&figure[..count].join(".")) {
                    return find(below, &figure[count..], found);
                }
            }
            for key in TRANSPARENT {
                let before = found.len();
                if let Some(below) = keys.get(key) {
                    find(below, figure, found);
                }
                if found.len() > before {
                    return;
                }
            }
        }
        Value::Array(entries) => find_in_list(entries, figure, found),
        Value::Null => found.push(None),
        Value::Bool(holds) if figure.is_empty() => found.push(Some(f64::from(u8::from(*holds)))),
        Value::Number(number) if figure.is_empty() => found.push(number.as_f64()),
        Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

/// One entry by its index or name, or else all of them.
fn find_in_list(entries: &[Value], figure: &[String], found: &mut Vec<Option<f64>>) {
    let is_called = |entry: &Value, name: &str| {
        [
            "name", "vehicle", "model", "drive", "log", "scenario", "key",
        ]
        .iter()
        .any(|key| entry.get(key).and_then(Value::as_str) == Some(name))
    };
    for count in 1..=figure.len() {
        let name = figure[..count].join(".");
        let index = name.parse::<usize>().ok();
        let named = entries
            .iter()
            .enumerate()
            .filter(|(k, entry)| index == Some(*k) || is_called(entry, &name));
        let named: Vec<&Value> = named.map(|(_, entry)| entry).collect();
        if !named.is_empty() {
            return named
                .into_iter()
                .for_each(|entry| find(entry, &figure[count..], found));
        }
    }
    for entry in entries {
        find(entry, figure, found);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nearest_to(figures: &KnownFigures, figure: &str) -> Option<String> {
        let figure: Vec<String> = figure.split('.').map(str::to_owned).collect();
        figures.nearest_unless_known(&figure)
    }

    #[test]
    fn known_figures_are_known_and_others_have_neighbours() {
        let list =
            "models.*.rmse_mps\nbraking.models.*.rmse_mps\nmodels.*.by.*\ntotals.[].error_pct";
        let figures = KnownFigures::of(list, ["profile".to_owned(), "inverse".to_owned()]);
        for known in [
            "profile.rmse_mps",
            "models.inverse.rmse_mps",
            "braking.profile.rmse_mps",
            "profile.by.0.5",
            "error_pct",
            "totals.b250e.error_pct",
            "totals.0.error_pct",
        ] {
            assert_eq!(nearest_to(&figures, known), None, "{known}");
        }
        for (unknown, near) in [
            ("profil.rmse_mps", "`profile.rmse_mps`"),
            ("profile.rmse", "`profile.rmse_mps`"),
            ("braking.profile.rmse_mp", "`braking.profile.rmse_mps`"),
            ("eror_pct", "`error_pct`"),
        ] {
            let found = nearest_to(&figures, unknown).unwrap_or_default();
            assert!(found.starts_with(near), "{unknown}: {found}");
        }
    }
}
