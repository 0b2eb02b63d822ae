//! The configuration of a fit says what the memory of the same file does.

use serde_json::{Value, json};

use super::{PhaseMemory, file};
use crate::model_file::is_same;
use crate::{ModelKind, PhaseCurve};

impl PhaseMemory {
    /// What of the configuration of a fit of this model is not what is remembered.
    pub(crate) fn check_config(&self, model: ModelKind, config: &Value) -> Result<(), String> {
        let rules = &self.rules;
        for (key, remembered) in [
            ("model", json!(model)),
            ("phase", json!(self.manoeuvre)),
            ("to", json!(self.points_of)),
            ("extent", json!(rules.extent)),
            ("min_duration", json!(rules.min_duration_s)),
            ("min_gain", json!(rules.min_gain_mps * 3.6)),
            ("accel_deadband", json!(rules.accel_deadband_mps2)),
        ] {
            let said = config.get(key).unwrap_or(&remembered);
            if !is_same(said, &remembered) {
                return Err(format!(
                    "config.{key} is {said}, and not {remembered} as in model and memory"
                ));
            }
        }
        let step_s = config.get("step").and_then(Value::as_f64);
        let Some(step_s) = step_s.filter(|step_s| file::STEP_S.contains(step_s)) else {
            return Err("config.step is missing or no sampling interval in s".to_owned());
        };
        let is_raw = config.get("raw") == Some(&json!(true));
        let steps_s = self.drives().flat_map(|drive| {
            let short = drive.short.iter().map(|short| short.outline.step_s);
            drive.phases.iter().map(PhaseCurve::step_s).chain(short)
        });
        let mut other = steps_s.filter(|found_s| !is_raw && (found_s - step_s).abs() > 1e-9);
        match other.next() {
            Some(found_s) => Err(format!(
                "config.step is {step_s}, and the memory has phases sampled every {found_s} s"
            )),
            None => Ok(()),
        }
    }
}
