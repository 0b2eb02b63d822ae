//! What models say, in sentences.

use std::fmt::Write as _;

use driver_model::cruise::CruiseModel;
use driver_model::following::FollowingModel;
use driver_model::phase_model::{ConditionedProfile, StepResponse, TransitionPoint};
use driver_model::speed_ahead::DirectModel;
use driver_model::trip_driver::TripDriver;
use driver_model::{Behaviour, DriverChannel, DriverModel, ModelFile, PhaseModel, TrainingRecord};
use serde_json::Value;

use crate::words::{listed, plural};

/// Where a model learnt from speeds that were smoothed otherwise than those of this configuration: what to make of its bands.
#[must_use]
pub fn reading_words(file: &ModelFile, config: &Value) -> Option<String> {
    let [then, now] = file.configured_otherwise(&["smooth", "raw"], config)?;
    Some(format!(
        "the model learnt from logs read {then}, and these are read {now}: its bands and intervals are not those of such speeds"
    ))
}

/// What the parameters mean.
#[must_use]
pub fn model_words(model: &DriverModel) -> String {
    match model {
        DriverModel::Acceleration(model) => phase_words("accelerates", model),
        DriverModel::Braking(model) => phase_words("brakes", model),
        DriverModel::Cruise(model) => cruise_words(model),
        DriverModel::Following(model) => following_words(model),
        DriverModel::SpeedAhead(model) => ahead_words(model),
        DriverModel::Trip(driver) => trip_words(driver),
    }
}

/// What a model was fitted to, what of it it knew `before`, and what its parameters mean.
#[must_use]
pub fn fitted_words(
    file: &ModelFile,
    before: Option<&TrainingRecord>,
    residual_sum_of_squares: Option<f64>,
) -> String {
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
    if let Some(before) = before {
        let _ = write!(
            text,
            "\n{} of {} were remembered, {} of {} are new",
            plural(before.phases, "phase"),
            plural(before.inputs.len(), "drive"),
            training.phases - before.phases,
            plural(training.inputs.len() - before.inputs.len(), "drive"),
        );
    }
    let _ = writeln!(text, "\n{}", model_words(&file.model));
    if let Some(sum) = residual_sum_of_squares {
        let _ = writeln!(
            text,
            "residual sum of squares {sum:.2} (m/s²)² over the points"
        );
    }
    text
}

fn ahead_words(model: &DirectModel) -> String {
    let (first, last) = model
        .horizons_s()
        .fold((f64::INFINITY, 0.0_f64), |(a, b), h| (a.min(h), b.max(h)));
    let mut text = format!(
        "Predicts the speed {first} to {last} s ahead of drives sampled every {} s, at {} horizons from {} predictors.",
        model.step_s(),
        model.horizons_s().count(),
        model.predictors(),
    );
    if !model.channels().is_empty() {
        let (told, all) = model.drives();
        let _ = write!(
            text,
            "\nIt is told {}, which {told} of {all} drives had; drives without are predicted from speed and limits alone.",
            channels(model.channels()),
        );
    }
    let unfinished = model.unfinished_s().count();
    if unfinished > 0 {
        let _ = write!(
            text,
            "\nAt {unfinished} horizons the solver stopped before the optimum."
        );
    }
    text
}

fn trip_words(driver: &TripDriver) -> String {
    let (speeds_up, brakes) = (driver.acceleration(), driver.braking());
    let unrest = match driver.unrest_mps2() {
        unrest_mps2 if unrest_mps2 > 0.0 => format!(
            "\nAround the planned speed it rises and falls by {unrest_mps2:.2} m/s² all the time, so that whole trips cost what they did."
        ),
        _ => String::new(),
    };
    format!(
        "Speeds up with at most {:.2} m/s² and slows down with at most {:.2} m/s²; from 50 km/h to a stop it brakes with {:.2} m/s².{unrest}",
        speeds_up.max_mps2,
        brakes.max_mps2,
        brakes.mps2(50.0 / 3.6),
    )
}

fn cruise_words(model: &CruiseModel) -> String {
    let bias = model.bias.map_or_else(
        || "No log had speed limits; the speed is expected to stay.".to_owned(),
        |bias| {
            format!(
                "This driver cruises at the limit {:+.1} km/h, with {:.1} km/h from one stretch to the next.",
                3.6 * bias.mean_mps,
                3.6 * bias.spread_mps
            )
        },
    );
    format!(
        "{bias}\nWithin a stretch speed varies by {:.2} km/h (standard deviation) with a correlation time of {:.1} s.",
        3.6 * model.deviation_mps,
        model.correlation_time_s
    )
}

fn following_words(model: &FollowingModel) -> String {
    match model {
        FollowingModel::Idm {
            idm,
            desired_speed_mps,
        } => format!(
            "Headway {:.2} s beside {:.1} m at standstill; accelerates with at most {:.2} m/s², brakes comfortably with {:.2} m/s²; \
             would drive {:.0} km/h alone.",
            idm.time_headway_s,
            idm.standstill_gap_m,
            idm.max_accel_mps2,
            idm.comfortable_decel_mps2,
            3.6 * desired_speed_mps
        ),
        FollowingModel::ConstantTimeGap(law) => format!(
            "Keeps {:.2} s beside {:.1} m at standstill, and takes {:.1} s to close a wrong gap.",
            law.time_gap_s,
            law.standstill_gap_m,
            1.0 / law.gap_gain_per_s
        ),
    }
}

fn phase_words(verb: &str, model: &PhaseModel) -> String {
    match model {
        PhaseModel::Inverse(m) => {
            of_speed(verb, &format!("a = 1/({:.5} v + {:.5})", m.p1, m.p2), |v| {
                1.0 / (m.p1 * v + m.p2)
            })
        }
        PhaseModel::Exponential(m) | PhaseModel::ExponentialAmplitude(m) => of_speed(
            verb,
            &format!("a = {:.4} exp(-{:.5} v) + {:.4}", m.p0, m.p1, m.p2),
            |v| m.p0 * (-m.p1 * v).exp() + m.p2,
        ),
        PhaseModel::RiseTime(m) | PhaseModel::RiseTimeExact(m) => {
            let lines = m.groups.iter().map(|g| {
                format!(
                    "{} km/h: T_c = {:.3} s ({})",
                    g.group.name(),
                    g.time_constant_s,
                    plural(g.phases, "phase")
                )
            });
            lines.collect::<Vec<_>>().join("\n")
        }
        PhaseModel::TransitionPoint(m) => transition_point(m),
        PhaseModel::Profile(m) => {
            let at = |share: f64| 100.0 * m.speed_mps(0.0, 1.0, share);
            shape(at(0.25), at(0.5), at(0.75))
        }
        PhaseModel::ProfileConditioned(m) | PhaseModel::ProfileOnset(m) => conditioned(m),
        PhaseModel::ProfilePedal(m) => format!(
            "{}\nIt is told {} as the phase begins; phases of logs without are predicted by another, with {} centres.",
            conditioned(&m.told),
            channels(&m.channels),
            m.untold.basis.centres.len()
        ),
        PhaseModel::Constant(m) => format!(
            "This driver {verb} with {:.3} m/s² at any speed.",
            m.accel_mps2
        ),
        PhaseModel::Straight => {
            "A straight line from start to end speed; no parameters.".to_owned()
        }
        PhaseModel::Smoothstep => "3s² − 2s³ from start to end speed; no parameters.".to_owned(),
    }
}

fn conditioned(model: &ConditionedProfile) -> String {
    let last = model.mean_shape.len() - 1;
    let at = |quarter: usize| 100.0 * model.mean_shape[quarter * last / 4];
    format!(
        "On average, {}\nHow it depends on the phase is a regression with {} centres.",
        shape(at(1), at(2), at(3)),
        model.basis.centres.len()
    )
}

fn channels(channels: &[DriverChannel]) -> String {
    let names: Vec<&str> = channels.iter().map(|c| c.channel().name()).collect();
    listed(&names)
}

fn of_speed(verb: &str, formula: &str, accel_mps2: impl Fn(f64) -> f64) -> String {
    let at = |kmh: f64| accel_mps2(kmh / 3.6);
    format!(
        "{formula}, v in m/s, a in m/s².\nThis driver {verb} with {:.2} m/s² at 10 km/h, {:.2} at 50 and {:.2} at 100.",
        at(10.0),
        at(50.0),
        at(100.0)
    )
}

fn shape(quarter_pct: f64, half_pct: f64, three_quarters_pct: f64) -> String {
    format!(
        "of the change of speed, {quarter_pct:.0} % come in the first quarter of the time, {half_pct:.0} % in the first half and \
         {three_quarters_pct:.0} % in three quarters."
    )
}

fn transition_point(model: &TransitionPoint) -> String {
    let lines = model.groups.iter().map(|g| {
        let response = match g.response {
            StepResponse::Distinct { t1_s, t2_s } => {
                format!("order 2, T_1 = {t1_s:.3} s, T_2 = {t2_s:.3} s")
            }
            StepResponse::Equal {
                order,
                time_constant_s,
            } => format!("order {order}, T_c = {time_constant_s:.3} s"),
        };
        format!(
            "{} km/h: {response} ({}; thrown away: {} of another form, {} not identified)",
            g.group.name(),
            plural(g.phases, "phase"),
            g.other_form,
            g.unidentified
        )
    });
    let mut lines: Vec<String> = lines.collect();
    lines.push(format!(
        "thrown away in all: {}.",
        plural(model.thrown_away(), "phase")
    ));
    lines.join("\n")
}
