//! `drivekit plan LOG... --potential`: what recorded trips could have cost.

use std::fmt::Write as _;

use assistance::{
    Bound, NotPlanned, Potential, PotentialSettings, RecordedMotion, potential_of_pieces,
};
use driver_model::Motion;
use driver_model::motion::drives;
use driver_model::statistics::quantile;
use ev_energy::{CalibrationRecord, DEFAULT_SLOPE_BANDWIDTH_M, JOULES_PER_KWH, StepModel};
use rayon::prelude::*;
use report::terminal::{Table, number};
use serde::Serialize;
use speed_plan::Settings;

use super::PlanArgs;
use super::source::chosen_vehicle;
use crate::cmd::motions::motions;
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs, OnError, ReadingArgs};
use crate::inputs::{self, Input};
use crate::output;
use crate::progress::Progress;
use crate::render::json::Document;
use crate::require::KnownFigures;
use crate::words::plural;

#[derive(Serialize)]
struct Body {
    vehicle: String,
    /// How far to trust it.
    calibration: Option<CalibrationRecord>,
    /// What the figures mean.
    assumptions: Vec<String>,
    trips: Vec<Trip>,
    total: Total,
}

#[derive(Serialize)]
struct Trip {
    path: String,
    name: String,
    status: Status,
    /// Why there is no plan.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
    #[serde(flatten)]
    figures: Option<Figures>,
    /// What was found on the way.
    findings: Vec<String>,
}

#[derive(Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
enum Status {
    Planned,
    NotPlanned,
}

#[derive(Serialize)]
struct Figures {
    distance_m: f64,
    time_s: f64,
    own_energy_j: f64,
    plan_energy_j: f64,
    saving_pct: f64,
    gap_pct: f64,
    bound: Bound,
    faster_than_limit_s: f64,
    limited_s: f64,
}

impl From<&Potential> for Figures {
    fn from(found: &Potential) -> Self {
        Self {
            distance_m: found.distance_m,
            time_s: found.time_s,
            own_energy_j: found.own_energy_j,
            plan_energy_j: found.plan_energy_j,
            saving_pct: found.saving_pct(),
            gap_pct: found.gap_pct(),
            bound: found.bound,
            faster_than_limit_s: found.faster_than_limit_s,
            limited_s: found.limited_s,
        }
    }
}

/// All trips that were planned.
#[derive(Serialize)]
struct Total {
    trips: usize,
    not_planned: usize,
    #[serde(flatten)]
    figures: Option<Figures>,
    /// Of the trips, each with the same weight.
    median_saving_pct: Option<f64>,
    quartiles_saving_pct: Option<[f64; 2]>,
}

pub(super) fn run(args: &PlanArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require.check(&KnownFigures::new(include_str!(
        "../../figures/plan-potential.txt"
    )))?;
    let vehicle = chosen_vehicle(args, context)?;
    let model = super::model(args, &vehicle)?;
    let logs = LogArgs {
        logs: args.road.clone(),
        reading: ReadingArgs {
            layout: args.layout.clone(),
            limit_map: args.limit_map.clone(),
            on_error: OnError::Skip,
            ..ReadingArgs::default()
        },
    };
    let inputs = inputs::load_once(&logs, context)?;
    let motions = motions(&inputs, DEFAULT_SLOPE_BANDWIDTH_M)?;
    let search = Settings {
        max_gap_pct: args.max_gap,
        budget_s: Some(args.budget),
    };
    let progress = Progress::new(context, "planning", inputs.len());
    let pairs: Vec<(&Input, &[Motion])> = inputs.iter().zip(drives(&motions)).collect();
    let found: Vec<Result<Potential, NotPlanned>> = pairs
        .par_iter()
        .map(|(_, pieces)| {
            let found = of_pieces(pieces, &model, &search);
            progress.step();
            found
        })
        .collect();
    drop(progress);
    let total = Total::of(&found);
    let all_planned = total.not_planned == 0;
    let body = Body {
        vehicle: vehicle.spec().name.clone(),
        calibration: vehicle.spec().calibration,
        assumptions: assumptions(&model),
        trips: pairs
            .iter()
            .zip(&found)
            .map(|((input, pieces), found)| Trip::of(input, pieces, found))
            .collect(),
        total,
    };
    let mut document = Document::new("plan-potential", args, &inputs, body);
    let judged = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&text(&document.body))?,
    }
    let planned = if all_planned {
        Outcome::Done
    } else {
        Outcome::Negative
    };
    Ok(inputs::outcome(&inputs).and(planned).and(judged))
}

/// A drive in pieces is planned piece by piece.
fn of_pieces(
    pieces: &[Motion],
    model: &StepModel,
    search: &Settings,
) -> Result<Potential, NotPlanned> {
    let pieces = pieces.iter().map(RecordedMotion::from);
    potential_of_pieces(pieces, model, &PotentialSettings::default(), search)
}

impl Trip {
    fn of(input: &Input, pieces: &[Motion], found: &Result<Potential, NotPlanned>) -> Self {
        let (figures, reason) = match found {
            Ok(found) => (Some(Figures::from(found)), None),
            Err(reason) => (None, Some(reason.to_string())),
        };
        Self {
            path: input.path.clone(),
            name: input.drive.name.clone(),
            status: match figures {
                Some(_) => Status::Planned,
                None => Status::NotPlanned,
            },
            reason,
            findings: findings(pieces, figures.as_ref()),
            figures,
        }
    }
}

fn findings(pieces: &[Motion], figures: Option<&Figures>) -> Vec<String> {
    let mut findings = Vec::new();
    if pieces.len() > 1 {
        findings.push(format!(
            "the drive is in {} pieces, planned one by one",
            pieces.len()
        ));
    }
    if pieces.iter().any(|piece| piece.slope_rad().is_none()) {
        findings.push("no elevation and no slope: a level road".to_owned());
    }
    let with_limits = pieces.iter().filter(|piece| piece.limit_mps().is_some());
    let with_limits = with_limits.count();
    if 0 < with_limits && with_limits < pieces.len() {
        findings.push(format!(
            "limits are known in {with_limits} of {} pieces",
            pieces.len()
        ));
    }
    let Some(figures) = figures else {
        return findings;
    };
    if figures.faster_than_limit_s > 0.0 {
        findings.push(format!(
            "faster than the limit for {:.0} s: the plan may be as fast there",
            figures.faster_than_limit_s
        ));
    }
    if figures.limited_s > 0.0 {
        findings.push(format!(
            "for {:.1} s the recorded motion asks for more than motor or battery of the model give; it is charged all the same",
            figures.limited_s
        ));
    }
    findings
}

impl Total {
    fn of(found: &[Result<Potential, NotPlanned>]) -> Self {
        let planned: Vec<&Potential> = found
            .iter()
            .filter_map(|found| found.as_ref().ok())
            .collect();
        let mut sum = Potential::default();
        planned.iter().for_each(|one| sum += **one);
        let mut savings_pct: Vec<f64> = planned.iter().map(|one| one.saving_pct()).collect();
        savings_pct.sort_by(f64::total_cmp);
        let at = |share| quantile(&savings_pct, share);
        Self {
            trips: planned.len(),
            not_planned: found.len() - planned.len(),
            figures: (!planned.is_empty()).then(|| Figures::from(&sum)),
            median_saving_pct: at(0.5),
            quartiles_saving_pct: at(0.25).zip(at(0.75)).map(|(low, high)| [low, high]),
        }
    }
}

fn assumptions(model: &StepModel) -> Vec<String> {
    let PotentialSettings {
        window_m,
        prominence_mps,
        min_mps2,
        accel_quantile,
        ..
    } = PotentialSettings::default();
    vec![
        "own energy is that of the same model on the recorded motion, not the measured one".to_owned(),
        "an upper bound: what traffic, signals and bends forced on the driver counts as the driver's choice, and the plan knows the whole road beforehand".to_owned(),
        format!(
            "same stops, dwells and arrival; lows {prominence_mps} m/s below the highs beside them passed no faster than recorded, elsewhere no faster than the fastest recorded within {window_m} m to either side, nor than a recorded limit where the driver kept it"
        ),
        format!(
            "braking with up to {} m/s², acceleration to the {:.1}th percentile of each trip",
            -min_mps2,
            100.0 * accel_quantile
        ),
        format!(
            "auxiliaries of {:.0} W, no heating; the car warm, {}, its battery at nominal voltage",
            model.auxiliary_power_w(),
            match model.weather() {
                Some(weather) => format!("air of {} °C", weather.temperature_degc),
                None => "the air of its road load".to_owned(),
            }
        ),
    ]
}

fn text(body: &Body) -> String {
    let mut table = Table::new([
        "log", "km", "min", "own kWh", "plan kWh", "saving %", "gap %",
    ]);
    let row = |name: String, figures: Option<&Figures>| {
        let value = |of: fn(&Figures) -> f64, digits| number(figures.map(of), digits);
        [
            name,
            value(|f| f.distance_m / 1e3, 2),
            value(|f| f.time_s / 60.0, 1),
            value(|f| f.own_energy_j / JOULES_PER_KWH, 3),
            value(|f| f.plan_energy_j / JOULES_PER_KWH, 3),
            value(|f| f.saving_pct, 1),
            value(|f| f.gap_pct, 4),
        ]
    };
    for trip in &body.trips {
        table.row(row(trip.name.clone(), trip.figures.as_ref()));
    }
    table.row(row("all planned".to_owned(), body.total.figures.as_ref()));
    let mut text = format!(
        "{}, what they could have cost with {}\n\n{}\n",
        plural(body.trips.len(), "trip"),
        body.vehicle,
        table.render()
    );
    for trip in &body.trips {
        for finding in trip
            .reason
            .iter()
            .map(|reason| format!("not planned: {reason}"))
            .chain(trip.findings.iter().cloned())
        {
            let _ = writeln!(text, "{}: {finding}", trip.name);
        }
    }
    let total = &body.total;
    if let (Some(figures), Some(median), Some([low, high])) = (
        &total.figures,
        total.median_saving_pct,
        total.quartiles_saving_pct,
    ) {
        let _ = writeln!(
            text,
            "\n{:.1} % of all energy; per trip {median:.1} % in the median, quartiles {low:.1} and {high:.1} %",
            figures.saving_pct
        );
    }
    if total.not_planned > 0 {
        let _ = writeln!(
            text,
            "{} could not be planned and {} in no total",
            plural(total.not_planned, "trip"),
            if total.not_planned == 1 { "is" } else { "are" }
        );
    }
    for assumption in &body.assumptions {
        let _ = writeln!(text, "- {assumption}");
    }
    if let Some(record) = &body.calibration {
        let _ = writeln!(
            text,
            "- the car is calibrated with {}; a trip that it has not seen is off by {:.1} % on average",
            plural(record.trips, "trip"),
            record.held_out_mean_abs_error_pct
        );
    }
    text
}
