//! The tables of an evaluation for people.

use std::fmt::Write as _;

use driver_eval::behaviour::{BehaviourEvaluation, WholeEvaluation};
use driver_eval::cruise::CruiseEvaluation;
use driver_eval::following::{FollowingEvaluation, PairedDrivers};
use driver_eval::phase::{Evaluation, LearningPoint, PairedComparison, Summary};
use driver_model::{DriveBehaviour, ModelKind, PhaseKind};
use report::terminal::{Table, number};

use crate::words::plural;

/// What was asked for, as the headings of tables say it.
pub(super) struct Heading {
    pub(super) unit: &'static str,
    pub(super) min_duration_s: f64,
    pub(super) min_gain_kmh: f64,
    /// Full width.
    pub(super) band_kmh: f64,
    /// In words.
    pub(super) vehicle: String,
}

pub(super) fn render(
    heading: &Heading,
    trips: &[DriveBehaviour],
    findings: &BehaviourEvaluation,
) -> String {
    let mut text = String::new();
    for evaluation in findings.phases() {
        if !text.is_empty() {
            text.push('\n');
        }
        text.push_str(&models(heading, trips, evaluation));
        text.push_str(&paired(evaluation));
        text.push_str(&bands(evaluation));
    }
    for evaluation in findings.whole.kinds() {
        text.push_str(&whole(heading, evaluation));
    }
    if let Some(evaluation) = &findings.cruise {
        text.push_str(&cruise(evaluation));
    }
    if let Some((evaluation, _)) = &findings.following {
        text.push_str(&following(evaluation));
    }
    if let Some(points) = &findings.learning
        && !points.is_empty()
    {
        text.push_str(&learning(points));
    }
    text
}

fn models(heading: &Heading, trips: &[DriveBehaviour], evaluation: &Evaluation) -> String {
    let influenced: usize = trips
        .iter()
        .map(|t| match evaluation.kind {
            PhaseKind::Braking => t.lead_influenced.braking,
            _ => t.lead_influenced.acceleration,
        })
        .sum();
    let held_out = heading.unit;
    let mut text = format!(
        "{}, {} of at least {} s and {} km/h, leave one {held_out} out",
        plural(trips.len(), "drive"),
        plural(
            evaluation.phases.len(),
            &format!("{} phase", evaluation.kind.name())
        ),
        heading.min_duration_s,
        heading.min_gain_kmh,
    );
    if influenced > 0 {
        let _ = write!(
            text,
            " (left out under a leader's influence: {influenced} more)"
        );
    }
    text.push_str("\n\n");
    text.push_str(&model_table(heading, evaluation).render());
    let _ = writeln!(
        text,
        "\nΔE: measured minus predicted battery energy per phase ({}); end: predicted minus measured final speed.",
        heading.vehicle
    );
    for (kind, summary) in evaluation.models.iter().zip(&evaluation.summaries) {
        if summary.fallback_phases > 0 {
            let _ = writeln!(
                text,
                "{kind}: {} in speed groups without training phases; the nearest group's parameter was used.",
                plural(summary.fallback_phases, "phase")
            );
        }
    }
    text
}

fn model_table(heading: &Heading, evaluation: &Evaluation) -> Table {
    let band = format!("in ±{} km/h %", number(0.5 * heading.band_kmh, 1));
    let mut table = Table::new([
        "model",
        "knows",
        "RMSE km/h",
        "median",
        &band,
        "√SSE/n km/h",
        "ΔE kJ mean",
        "median",
        "|ΔE| kJ",
        "end km/h",
        "fit s",
        "predict s",
    ]);
    for baselines in [false, true] {
        if baselines {
            table.heading("baselines");
        }
        for (kind, summary) in evaluation.models.iter().zip(&evaluation.summaries) {
            if kind.is_baseline() == baselines {
                table.row(row(*kind, summary));
            }
        }
    }
    table
}

fn row(kind: ModelKind, summary: &Summary) -> [String; 12] {
    let figures = &summary.figures;
    let energy = &figures.energy_error_j;
    [
        kind.name().to_owned(),
        summary.knows.to_owned(),
        number(figures.rmse_mps * 3.6, 2),
        number(figures.rmse_median_mps * 3.6, 2),
        number(figures.in_band_pct, 1),
        number(figures.sqrt_sse_per_sample_mps * 3.6, 3),
        number(energy.mean / 1e3, 2),
        number(energy.median / 1e3, 2),
        number(energy.mean_abs / 1e3, 2),
        number(figures.final_speed_error_mps * 3.6, 2),
        number(summary.fit_seconds, 3),
        number(summary.predict_seconds, 3),
    ]
}

/// The best model against every other.
fn paired(evaluation: &Evaluation) -> String {
    let best = evaluation
        .models
        .iter()
        .zip(&evaluation.summaries)
        .min_by(|a, b| a.1.figures.rmse_mps.total_cmp(&b.1.figures.rmse_mps));
    let Some((&best, _)) = best else {
        return String::new();
    };
    let pairs: Vec<_> = evaluation
        .paired
        .iter()
        .filter_map(|pair| pair.seen_from(best))
        .collect();
    let Some(units) = pairs.first().map(|pair| pair.units) else {
        return String::new();
    };
    let mut table = Table::new([
        "against",
        "RMSE km/h",
        "95 % from",
        "to",
        "better in",
        "verdict",
    ]);
    for pair in pairs {
        table.row(paired_row(&pair));
    }
    format!(
        "\n{best} less the other models, mean over phases, intervals over {units} held-out units\n\n{}",
        table.render()
    )
}

fn paired_row(pair: &PairedComparison) -> [String; 6] {
    [
        pair.against.name().to_owned(),
        number(3.6 * pair.difference_rmse_mps, 3),
        number(3.6 * pair.low_mps, 3),
        number(3.6 * pair.high_mps, 3),
        format!("{} of {}", pair.better_units, pair.units),
        pair.verdict.name().to_owned(),
    ]
}

fn bands(evaluation: &Evaluation) -> String {
    if evaluation.bands.is_empty() {
        return String::new();
    }
    let mut table = Table::new([
        "predictive band",
        "holds %",
        "of samples %",
        "mean width km/h",
    ]);
    for (kind, levels) in &evaluation.bands {
        for level in levels {
            table.row([
                kind.name().to_owned(),
                number(level.level_pct, 0),
                number(level.inside_pct, 1),
                number(3.6 * level.mean_width_mps, 2),
            ]);
        }
    }
    format!("\n{}", table.render())
}

/// Phases from begin to end.
fn whole(heading: &Heading, evaluation: &WholeEvaluation) -> String {
    let band = format!("in ±{} km/h %", number(0.5 * heading.band_kmh, 1));
    let mut table = Table::new([
        "model",
        "knows",
        "RMSE km/h",
        "when cut",
        &band,
        "in 90 % band %",
        "less baseline",
        "95 % from",
        "to",
        "better in",
        "verdict",
    ]);
    for (model, figures) in evaluation.rows() {
        let mut cells = vec![
            model.name().to_owned(),
            figures.knows.to_owned(),
            number(3.6 * figures.rmse_mps, 2),
            number(figures.threshold_rmse_mps.map(|v| 3.6 * v), 2),
            number(figures.in_band_pct, 1),
            number(figures.in_90_pct_band_pct, 1),
        ];
        let pair = figures.against_baseline.as_ref().map(paired_row);
        cells.extend(pair.into_iter().flat_map(|pair| pair.into_iter().skip(1)));
        table.add(cells);
    }
    format!("\n{evaluation}\n\n{}", table.render())
}

fn learning(points: &[LearningPoint]) -> String {
    let mut table = Table::new(["model", "fitted to", "own trips", "RMSE km/h", "in band %"]);
    for point in points {
        table.row([
            point.model.name().to_owned(),
            point.training.name().to_owned(),
            point.own_trips.to_string(),
            number(point.rmse_mps * 3.6, 3),
            number(point.in_band_pct, 1),
        ]);
    }
    format!("\nlearning curve, acceleration\n\n{}", table.render())
}

fn cruise(evaluation: &CruiseEvaluation) -> String {
    let mut table = Table::new(["model", "stretches", "RMSE km/h", "90 % band holds %"]);
    let rows = [
        ("cruise", Some(evaluation.cruise)),
        ("hold", Some(evaluation.hold)),
        ("cruise, with a limit", evaluation.cruise_with_limit),
        ("limit", evaluation.limit),
    ];
    for (name, summary) in rows {
        if let Some(summary) = summary {
            table.row([
                name.to_owned(),
                summary.stretches.to_string(),
                number(3.6 * summary.rmse_mps, 2),
                number(summary.coverage_90_pct, 1),
            ]);
        }
    }
    let model = &evaluation.parameters;
    let bias = model.bias.map_or_else(
        || "no limits in the logs".to_owned(),
        |bias| {
            let (mean, spread) = (3.6 * bias.mean_mps, 3.6 * bias.spread_mps);
            format!("limit {mean:+.1} km/h, {spread:.1} km/h from stretch to stretch")
        },
    );
    let variation = match model.random_walk_mps() {
        Some(step_mps) => format!(
            "wanders like a random walk, {:.2} km/h in a second",
            3.6 * step_mps
        ),
        None => format!(
            "deviation {:.2} km/h, correlated over {:.1} s",
            3.6 * model.deviation_mps,
            model.correlation_time_s
        ),
    };
    format!(
        "\ncruising, {}, each held out\n\n{}\n{bias}; {variation}\n",
        plural(evaluation.folds.len(), "unit"),
        table.render(),
    )
}

fn following(evaluation: &FollowingEvaluation) -> String {
    let mut table = Table::new([
        "model",
        "gap RMSE m",
        "speed RMSE m/s",
        "of the gap %",
        "collisions",
        "fit s",
        "less for all m",
        "95 % from",
        "to",
        "better for",
    ]);
    for group in evaluation.rows() {
        table.heading(&group.heading);
        for row in group.rows {
            let against = row.against_all.as_ref();
            let metres = |of: fn(&PairedDrivers) -> f64| number(against.map(|(p, _)| of(p)), 2);
            let better = |(p, n): &(PairedDrivers, usize)| format!("{} of {n}", p.better_drivers);
            table.row([
                row.name,
                number(row.errors.gap_rmse_m, 2),
                number(row.errors.speed_rmse_mps, 3),
                number(100.0 * row.errors.gap_rmse_relative, 1),
                row.errors.collisions.to_string(),
                number(row.fit_seconds, 3),
                metres(|p| p.gap_rmse_m),
                metres(|p| p.low_m),
                metres(|p| p.high_m),
                against.map_or_else(String::new, better),
            ]);
        }
    }
    let paired = &evaluation.held_out_difference;
    format!(
        "\n{} behind a vehicle in {}\n\n{}\n\
         idm less constant-time-gap: gap RMSE {} ± {} m (standard error over stretches), better in {} of {}\n",
        plural(evaluation.stretches.len(), "stretch"),
        plural(evaluation.folds.len(), "unit"),
        table.render(),
        number(paired.gap_rmse_m, 2),
        number(paired.gap_rmse_std_error_m, 2),
        paired.idm_better,
        evaluation.stretches.len(),
    )
}
