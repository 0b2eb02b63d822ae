//! Thresholds for figures of a document, such as `profile.in_band_pct>=60`.

mod figures;

use std::fmt;
use std::str::FromStr;

use serde::Serialize;
use serde_json::Value;

pub use figures::KnownFigures;

/// A comparison of one figure of the document with a number.
#[derive(Debug, Clone, PartialEq)]
pub struct Requirement {
    text: String,
    figure: Vec<String>,
    comparison: Comparison,
    bound: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Comparison {
    AtLeast,
    AtMost,
    Above,
    Below,
}

const COMPARISONS: [(&str, Comparison); 4] = [
    (">=", Comparison::AtLeast),
    ("<=", Comparison::AtMost),
    (">", Comparison::Above),
    ("<", Comparison::Below),
];

/// What became of a requirement, as the document lists it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judged {
    /// As it was asked for
    pub require: String,
    /// By every figure that it is about, and by one at least
    pub met: bool,
    /// The worst of several; none where it is not defined
    pub found: Option<f64>,
    /// How many figures it is about
    pub figures: usize,
}

impl FromStr for Requirement {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let form = || {
            format!(
                "`{text}` is not of the form FIGURE>=NUMBER (also <=, >, <), such as totals.error_pct<=5 or MODEL.rmse_mps<=0.5"
            )
        };
        let (symbol, comparison) = COMPARISONS
            .into_iter()
            .find(|(symbol, _)| text.contains(symbol))
            .ok_or_else(form)?;
        let (path, bound) = text.split_once(symbol).ok_or_else(form)?;
        let bound: f64 = bound.trim().parse().map_err(|_| form())?;
        let figure: Vec<String> = path.trim().split('.').map(str::to_owned).collect();
        if !bound.is_finite() || figure.iter().any(String::is_empty) {
            return Err(form());
        }
        Ok(Self {
            text: text.to_owned(),
            figure,
            comparison,
            bound,
        })
    }
}

impl Requirement {
    /// Why a document of this kind cannot meet it: it has no such figure, but others with names like that.
    #[must_use]
    pub fn unknown(&self, known: &KnownFigures) -> Option<String> {
        let near = known.nearest_unless_known(&self.figure)?;
        let (text, figure) = (&self.text, self.figure.join("."));
        Some(format!("`{text}`: no figure `{figure}`; is it {near}?"))
    }

    /// Looks the figures up in a document.
    #[must_use]
    pub fn judge(&self, document: &Value) -> Judged {
        let mut found = Vec::new();
        figures::find(document, &self.figure, &mut found);
        let met = |value: &Option<f64>| value.is_some_and(|value| self.is_met_by(value));
        // What is not defined is worst.
        let worst = found
            .iter()
            .copied()
            .reduce(|worst, next| match (worst, next) {
                (Some(a), Some(b)) if self.is_worse(b, a) => Some(b),
                (Some(_), None) => None,
                _ => worst,
            });
        Judged {
            require: self.text.clone(),
            met: !found.is_empty() && found.iter().all(met),
            found: worst.flatten(),
            figures: found.len(),
        }
    }

    fn is_met_by(&self, value: f64) -> bool {
        match self.comparison {
            Comparison::AtLeast => value >= self.bound,
            Comparison::AtMost => value <= self.bound,
            Comparison::Above => value > self.bound,
            Comparison::Below => value < self.bound,
        }
    }

    fn is_worse(&self, value: f64, than: f64) -> bool {
        match self.comparison {
            Comparison::AtLeast | Comparison::Above => value < than,
            Comparison::AtMost | Comparison::Below => value > than,
        }
    }
}

impl fmt::Display for Judged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.met { "met" } else { "missed" };
        write!(f, "{verdict}: {}: ", self.require)?;
        match self.found {
            Some(found) => write!(f, "found {found}")?,
            None => f.write_str("not defined")?,
        }
        match self.figures {
            0 | 1 => Ok(()),
            count => write!(f, ", the worst of {count}"),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use serde_json::json;

    use super::*;

    fn judge(requirement: &str, document: &Value) -> Judged {
        requirement.parse::<Requirement>().unwrap().judge(document)
    }

    #[test]
    fn a_figure_is_found_by_its_path() {
        let document = json!({
            "models": { "profile": { "rmse_mps": 0.5, "by": { "0.5": 0.1 } } },
            "braking": { "baselines": { "straight": { "rmse_mps": 0.7 } } },
            "totals": [{ "vehicle": "a", "error_pct": -3.0 }, { "vehicle": "b", "error_pct": 7.0 }],
            "safe": true,
        });
        for (text, met, found, figures) in [
            ("profile.rmse_mps<=0.5", true, 0.5, 1),
            ("models.profile.rmse_mps<0.5", false, 0.5, 1),
            ("profile.by.0.5<=0.2", true, 0.1, 1),
            ("braking.straight.rmse_mps>=0.7", true, 0.7, 1),
            ("totals.error_pct<=5", false, 7.0, 2),
            ("error_pct>=-3", true, -3.0, 2),
            ("totals.a.error_pct<=5", true, -3.0, 1),
            ("totals.1.error_pct>7", false, 7.0, 1),
            ("safe>=1", true, 1.0, 1),
        ] {
            let expected = Judged {
                require: text.to_owned(),
                met,
                found: Some(found),
                figures,
            };
            assert_eq!(judge(text, &document), expected);
        }
    }

    #[test]
    fn what_is_not_defined_is_missed() {
        let document = json!({ "totals": [{ "x": 1.0 }, { "x": null }], "braking": null });
        for text in ["totals.x>=0", "braking.profile.rmse_mps<=1", "other>=0"] {
            let judged = judge(text, &document);
            assert!(!judged.met && judged.found.is_none(), "{text}");
        }
    }

    #[test]
    fn bounds_are_numbers() {
        for text in [
            "a.b",
            "a.b>=",
            "a.b>=nan",
            "a.b<=inf",
            ">=1",
            "a..b>=1",
            "a.b>=1e400",
        ] {
            assert!(text.parse::<Requirement>().is_err(), "{text}");
        }
    }
}
