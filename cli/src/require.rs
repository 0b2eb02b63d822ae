//! `--require 'profile.in_band_pct>=60'`: thresholds that a script can rely on.

use anyhow::bail;
use clap::Args;
use report::require::Requirement;
pub(crate) use report::require::{Judged, KnownFigures};
use serde::Serialize;

use crate::exit::Outcome;
use crate::output;

/// Thresholds of any command that computes figures.
#[derive(Debug, Clone, Default, Args, Serialize)]
pub(crate) struct RequireArgs {
    /// A threshold for a figure of the JSON document, such as 'totals.error_pct<=5' or 'profile.in_band_pct>=60' (also <, >); exit
    /// code 1 if missed. Of several logs, each has to meet it; may be repeated
    #[arg(long = "require", value_name = "FIGURE>=NUMBER")]
    #[serde(skip)]
    require: Vec<Requirement>,
}

impl RequireArgs {
    /// Refuses a figure that the command does not compute, before it computes any.
    pub(crate) fn check(&self, known: &KnownFigures) -> anyhow::Result<()> {
        for requirement in &self.require {
            if let Some(unknown) = requirement.unknown(known) {
                bail!("--require {unknown}");
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
            output::announce(&judged.to_string());
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
