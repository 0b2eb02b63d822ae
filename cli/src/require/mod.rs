//! `--require 'profile.in_band_pct>=60'`: thresholds that a script can rely on.

mod figures;

use std::str::FromStr;

use anyhow::bail;
use clap::Args;
use serde::Serialize;
use serde_json::Value;

use crate::exit::Outcome;
use crate::output;
pub(crate) use figures::Figures;

/// Thresholds of any command that computes figures.
#[derive(Debug, Clone, Default, Args, Serialize)]
pub(crate) struct RequireArgs {
    /// A threshold for a figure of the JSON document, such as 'totals.error_pct<=5' or 'profile.in_band_pct>=60' (also <, >); exit
    /// code 1 if missed. Of several logs, each has to meet it; may be repeated
    #[arg(long = "require", value_name = "FIGURE>=NUMBER")]
    #[serde(skip)]
    require: Vec<Requirement>,
}

/// A comparison of one figure of the document with a number.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Requirement {
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
pub(crate) struct Judged {
    require: String,
    met: bool,
    /// The worst of several; none where it is not defined.
    found: Option<f64>,
    /// How many figures it is about.
    figures: usize,
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

impl RequireArgs {
    /// Refuses a figure that the command does not compute, before it computes any.
    pub(crate) fn check(&self, known: &Figures) -> anyhow::Result<()> {
        for requirement in &self.require {
            if let Some(near) = known.nearest_unless_known(&requirement.figure) {
                bail!(
                    "--require `{}`: no figure `{}`; is it {near}?",
                    requirement.text,
                    requirement.figure.join(".")
                );
            }
        }
        Ok(())
    }

    /// Looks the figures up, and says on stderr what became of each, whatever `--quiet` says.
    pub(crate) fn judge(
        &self,
        document: &impl Serialize,
    ) -> anyhow::Result<(Vec<Judged>, Outcome)> {
        if self.require.is_empty() {
            return Ok((Vec::new(), Outcome::Done));
        }
        let document = serde_json::to_value(document)?;
        let judged: Vec<Judged> = self
            .require
            .iter()
            .map(|requirement| requirement.judge(&document))
            .collect();
        for judged in &judged {
            output::announce(&judged.text());
        }
        let all_met = judged.iter().all(|judged| judged.met);
        let outcome = if all_met {
            Outcome::Done
        } else {
            Outcome::Negative
        };
        Ok((judged, outcome))
    }
}

impl Requirement {
    fn judge(&self, document: &Value) -> Judged {
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

impl Judged {
    fn text(&self) -> String {
        let verdict = if self.met { "met" } else { "missed" };
        let found = match self.found {
            Some(found) => format!("found {found}"),
            None => "not defined".to_owned(),
        };
        let of = match self.figures {
            0 | 1 => String::new(),
            count => format!(", the worst of {count}"),
        };
        format!("{verdict}: {}: {found}{of}", self.require)
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
