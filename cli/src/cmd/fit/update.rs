//! More drives for a model that was fitted before.

use std::path::Path;

use anyhow::{Context as _, bail};
use driver_model::{Manoeuvre, ModelFile, PointsOf};
use serde_json::Value;

use super::args::{FitArgs, Phase, Points};
use crate::flags::Context;
use crate::inputs::{Inputs, notes};

/// What there was before.
pub(super) struct Before {
    pub(super) file: ModelFile,
    name: String,
}

impl Before {
    pub(super) fn read(path: &Path) -> anyhow::Result<Self> {
        let file = crate::cmd::model::read(path)?;
        file.remembered()
            .with_context(|| format!("--update `{}`", path.display()))?;
        let name = path.display().to_string();
        Ok(Self { file, name })
    }

    /// The flags with what the file says; one that says otherwise is refused.
    pub(super) fn completed(&self, args: &FitArgs) -> anyhow::Result<FitArgs> {
        let memory = self.file.remembered()?;
        let mut completed = args.clone();
        completed.model = Some(self.file.model.kind());
        completed.extent = self.file.training.extent;
        completed.phase = match memory.manoeuvre() {
            Manoeuvre::Acceleration => Phase::Acceleration,
            Manoeuvre::Braking => Phase::Braking,
        };
        completed.to = match memory.points_of() {
            PointsOf::Means => Points::Means,
            PointsOf::Samples => Points::Samples,
        };
        let weight = self.file.config.get("prior_weight").and_then(Value::as_f64);
        completed.prior.prior_weight = weight.unwrap_or(args.prior.prior_weight);
        let (settings, phases) = (memory.settings(), &mut completed.phases);
        let duration_s = settings.min_duration_s;
        let gain_kmh = settings.min_gain_mps * 3.6;
        let deadband_mps2 = settings.statistical.accel_deadband_mps2;
        for (id, flag, found) in [
            ("min_duration", &mut phases.min_duration, duration_s),
            ("min_gain", &mut phases.min_gain, gain_kmh),
            ("accel_deadband", &mut phases.accel_deadband, deadband_mps2),
        ] {
            let differs = (*flag - found).abs() > 1e-9;
            if differs && args.given.iter().any(|given| given == id) {
                let name = id.replace('_', "-");
                bail!(
                    "--{name} {flag}: the model learns from phases with --{name} {found}, as its file says; leave it out"
                );
            }
            *flag = found;
        }
        let reading = ["step", "smooth", "raw"];
        match (self.file).read_otherwise(&reading, &serde_json::to_value(args)?) {
            None => Ok(completed),
            Some([then, now]) => bail!(
                "the model learnt from logs read {then}, and these are read {now}; read them alike"
            ),
        }
    }

    /// The logs that the model has not learnt yet.
    pub(super) fn new_among(&self, inputs: Inputs, context: &Context) -> anyhow::Result<Inputs> {
        let training = &self.file.training;
        let before = inputs.beside().twice.len();
        let new = inputs.without_learnt(&self.name, |sha256| training.has_learnt(sha256));
        notes::twice(&new.beside().twice[before..], context);
        if new.is_empty() {
            bail!("the model has learnt from all of these already");
        }
        if let Some(input) = new
            .iter()
            .find(|input| training.has_as_prior(&input.sha256))
        {
            bail!(
                "{} is among the logs of other drivers that the model has learnt from; fit it anew",
                input.label()
            );
        }
        Ok(new)
    }
}
