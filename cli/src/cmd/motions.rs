//! Drives as models see them, for all commands that fit, predict or cost.

use anyhow::Context as _;
use driver_eval::LimitsKnown;
use driver_model::Motion;
use rayon::prelude::*;

use crate::flags::Context;
use crate::inputs::Input;
use crate::output;

/// The pieces of every log, in the order of the logs.
pub(crate) fn motions(inputs: &[Input], slope_bandwidth_m: f64) -> anyhow::Result<Vec<Motion>> {
    let of_input = |input: &Input| {
        Motion::of_drive(&input.drive, slope_bandwidth_m).with_context(|| input.label())
    };
    let of_inputs: Vec<Vec<Motion>> = inputs.par_iter().map(of_input).collect::<Result<_, _>>()?;
    Ok(of_inputs.into_iter().flatten().collect())
}

/// Says which speed limits were filled, and which are not used.
pub(crate) fn mention_limits(motions: &[Motion], context: &Context) {
    if let Some(words) = LimitsKnown::of(motions).and_then(|known| known.in_words()) {
        output::note(context, &words);
    }
}

/// Says so where preparing a log let its past know something of its future.
pub(crate) fn mention_finer_grids(inputs: &[Input], context: &Context) {
    let finer = |input: &&Input| input.drive.step_s > 1.5 * input.drive.pieces[0].step_s();
    if let Some(input) = inputs.iter().find(finer) {
        let step_s = input.drive.step_s;
        output::note(
            context,
            &format!(
                "{}: recorded every {step_s} s and resampled finer, so that what counts as past knows up to {step_s} s of the future; give --step {step_s}",
                input.path,
            ),
        );
    }
}
