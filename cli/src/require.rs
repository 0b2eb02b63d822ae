//! `--require 'profile.in_band_pct>=60'`: thresholds that a script can rely on.

use std::str::FromStr;

use anyhow::{Context as _, bail};
use serde_json::Value;

/// A comparison of one figure of the document with a number.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Requirement {
    text: String,
    model: String,
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

/// Parts of an evaluation beside acceleration.
const KINDS: [&str; 3] = ["braking", "cruise", "following"];

impl FromStr for Requirement {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let form = || {
            format!(
                "`{text}` is not of the form MODEL.FIGURE>=NUMBER or KIND.MODEL.FIGURE>=NUMBER (also <=, >, <)"
            )
        };
        let (symbol, comparison) = COMPARISONS
            .into_iter()
            .find(|(symbol, _)| text.contains(symbol))
            .ok_or_else(form)?;
        let (path, bound) = text.split_once(symbol).ok_or_else(form)?;
        let bound: f64 = bound.trim().parse().map_err(|_| form())?;
        let (model, figure) = path.trim().split_once('.').ok_or_else(form)?;
        if !bound.is_finite() || figure.is_empty() {
            return Err(form());
        }
        Ok(Self {
            text: text.to_owned(),
            model: model.to_owned(),
            figure: figure.split('.').map(str::to_owned).collect(),
            comparison,
            bound,
        })
    }
}

impl Requirement {
    /// Looks the figure up under `models` and `baselines` of a document, or of the part that the first name says (`braking`);
    /// the message says why it is missed.
    pub(crate) fn missed(&self, document: &Value) -> anyhow::Result<Option<String>> {
        let (part, model, figure) = match self.figure.split_first() {
            Some((model, figure)) if KINDS.contains(&self.model.as_str()) => {
                (&document[&self.model], model, figure)
            }
            _ => (document, &self.model, self.figure.as_slice()),
        };
        let entry = ["models", "baselines"]
            .iter()
            .find_map(|table| part[table].get(model));
        let Some(mut value) = entry else {
            bail!(
                "--require `{}`: no model `{model}` was evaluated",
                self.text
            );
        };
        for key in figure {
            value = value
                .get(key)
                .with_context(|| format!("--require `{}`: no figure `{key}`", self.text))?;
        }
        let found = match value {
            Value::Null => return Ok(Some(format!("{}: not defined", self.text))),
            _ => value
                .as_f64()
                .with_context(|| format!("--require `{}`: not a number", self.text))?,
        };
        let met = match self.comparison {
            Comparison::AtLeast => found >= self.bound,
            Comparison::AtMost => found <= self.bound,
            Comparison::Above => found > self.bound,
            Comparison::Below => found < self.bound,
        };
        Ok((!met).then(|| format!("{}: found {found}", self.text)))
    }
}
