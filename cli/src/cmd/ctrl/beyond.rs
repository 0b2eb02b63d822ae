//! Disturbances that are larger than what the controllers were told to expect.

use testbed_sim::Disturbances;
use unicycle_cbf::{Demands, settings::Hardening};

/// A note with both numbers of each, where the settings would give a guarantee otherwise.
pub(super) fn note(
    disturbances: &Disturbances,
    stated: &Hardening,
    demands: &Demands,
) -> Option<String> {
    let beyond = disturbances.beyond(stated);
    if !demands.is_guaranteed || beyond.is_empty() {
        return None;
    }
    let texts: Vec<String> = beyond.iter().map(ToString::to_string).collect();
    Some(format!(
        "disturbances are larger than the controllers expect, nothing is guaranteed: {}; state them under [scenario.controller.hardening]",
        texts.join(", ")
    ))
}
