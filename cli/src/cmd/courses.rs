//! Drives as predictions of speed see them, shared by `fit`, `predict` and `evaluate`.

use anyhow::Context as _;
use driver_model::speed_ahead::Course;
use rayon::prelude::*;

use crate::flags::Context;
use crate::inputs::Input;
use crate::output;

/// The drives of every log; says so where preparing a log let its past know something of its future.
pub(crate) fn courses(
    inputs: &[Input],
    slope_bandwidth_m: f64,
    context: &Context,
) -> anyhow::Result<Vec<Vec<Course>>> {
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
    let of_input = |input: &Input| -> anyhow::Result<Vec<Course>> {
        let courses = input
            .drive
            .pieces
            .iter()
            .map(|log| Course::of_log(log, slope_bandwidth_m));
        courses
            .collect::<Result<_, _>>()
            .with_context(|| input.label())
    };
    inputs.par_iter().map(of_input).collect()
}
