//! What `fit` prints.

use std::fmt::Write as _;

use driver_model::{Behaviour, ModelFile};

use super::args::FitArgs;
use crate::words::plural;
use driver_eval::model_words::model_words;

pub(super) fn text(args: &FitArgs, file: &ModelFile, residuals: Option<f64>) -> String {
    let training = &file.training;
    let behaviour = file.model.behaviour();
    let what = match behaviour {
        Behaviour::Acceleration | Behaviour::Braking => {
            format!(
                "{} {} and {}",
                plural(training.phases, &format!("{} phase", behaviour.name())),
                training.extent.words(),
                plural(training.points, "point")
            )
        }
        Behaviour::Cruise | Behaviour::Following => {
            plural(training.phases, &format!("stretch of {}", behaviour.name()))
        }
        Behaviour::SpeedAhead => format!(
            "{}, {}",
            plural(training.phases, "drive"),
            plural(training.points, "moment")
        ),
        Behaviour::Trip => plural(training.phases, "drive"),
    };
    let mut text = format!(
        "{} fitted to {what} of {}",
        file.model.kind().name(),
        plural(training.inputs.len(), "drive"),
    );
    if !training.prior_inputs.is_empty() {
        let _ = write!(
            text,
            " and {} of other drivers (weight {})",
            training.prior_inputs.len(),
            training.prior_weight
        );
    }
    let _ = writeln!(
        text,
        ", written to {}\n{}",
        args.output.display(),
        model_words(&file.model)
    );
    if let Some(sum) = residuals {
        let _ = writeln!(
            text,
            "residual sum of squares {sum:.2} (m/s²)² over the points"
        );
    }
    text
}
