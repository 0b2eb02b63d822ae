//! The tables of a trajectory evaluation for people.

use std::fmt::Write as _;

use driver_eval::speed_ahead::{HorizonRow, TrajectoryEvaluation, TrialResult};
use driver_eval::trajectory::{FreeRuns, Trajectories};
use driver_eval::trip_driver::{FreeRunEvaluation, PercentErrors};
use report::terminal::{Table, number};

use crate::cmd::evaluate::text::Heading;
use crate::words::plural;

pub(super) fn render(heading: &Heading, trajectories: &Trajectories) -> String {
    let evaluation = &trajectories.speed_ahead;
    let mut text = format!(
        "{}, {}; every unit is held out once, in {} folds\n\n",
        plural(trajectories.data.motions.len(), "drive"),
        plural(
            evaluation.rows.first().map_or(0, |row| row.origins),
            "moment"
        ),
        trajectories.folds,
    );
    text.push_str(&horizons(evaluation));
    text.push_str(&intervals(evaluation));
    text.push_str(&verdicts(evaluation));
    if !evaluation.trials.is_empty() {
        text.push_str(&trials(heading, evaluation));
    }
    if let Some(runs) = &trajectories.free_runs {
        text.push_str(&free_run(runs));
    }
    text
}

/// Root mean square errors, at most as many columns as fit a screen.
fn horizons(evaluation: &TrajectoryEvaluation) -> String {
    let mut text = String::from("Root mean square error of the speed ahead, m/s\n\n");
    let mut header = vec!["model".to_owned()];
    header.extend(evaluation.horizons_s.iter().map(|h| format!("{h} s")));
    header.extend(["90 % band holds".to_owned(), "fit s".to_owned()]);
    let mut table = Table::with_columns(header);
    let row = |row: &HorizonRow| {
        let mut cells = vec![row.model.clone()];
        cells.extend(
            row.figures
                .iter()
                .map(|figures| number(figures.rmse_mps, 3)),
        );
        let interval = row.figures.last().and_then(|figures| figures.interval);
        let holds = interval.map(|interval| format!("{} %", number(interval.coverage_pct, 1)));
        cells.push(holds.unwrap_or_default());
        cells.push(number(row.fit_seconds, 1));
        cells
    };
    type Group = (&'static str, fn(&HorizonRow) -> bool);
    let groups: [Group; 3] = [
        ("models", |row| !row.baseline && !row.foresees),
        ("baselines", |row| row.baseline),
        (
            "trials, which know limits and standstill of the next 5 s",
            |row| row.foresees,
        ),
    ];
    for (heading, of_group) in groups {
        let mut members = evaluation
            .rows
            .iter()
            .filter(|row| of_group(row))
            .peekable();
        if members.peek().is_some() {
            table.heading(heading);
        }
        for model in members {
            table.add(row(model));
        }
    }
    text.push_str(&table.render());
    if !evaluation.channels.is_empty() {
        let names = evaluation.channels.iter().map(|c| c.channel().name());
        let names: Vec<&str> = names.collect();
        let _ = writeln!(text, "+channels: told of {} as well.", names.join(", "));
    }
    for row in evaluation.rows.iter().filter(|row| row.unfinished > 0) {
        let _ = writeln!(
            text,
            "{}: {} stopped before the optimum.",
            row.model,
            plural(row.unfinished, "regression")
        );
    }
    text
}

/// How intervals that know the moment do beside those of one width, at the horizons nearest to 5 and 10 s.
fn intervals(evaluation: &TrajectoryEvaluation) -> String {
    let mut table = Table::new([
        "model",
        "ahead",
        "90 % holds",
        "± m/s",
        "score m/s",
        "one width: holds",
        "± m/s",
        "score m/s",
        "score",
        "95 % from m/s",
        "to",
    ]);
    let rows = evaluation.rows.iter().filter(|row| !row.foresees);
    for (row, k) in rows.flat_map(|row| evaluation.shown_horizons().map(move |k| (row, k))) {
        let Some((moment, one)) = row.figures[k].interval.zip(row.figures[k].one_width) else {
            continue;
        };
        let between = row.figures[k].score_difference_interval_mps;
        let change_pct = 100.0 * (moment.score_mps / one.score_mps - 1.0);
        table.row([
            row.model.clone(),
            format!("{} s", evaluation.horizons_s[k]),
            format!("{} %", number(moment.coverage_pct, 1)),
            number(moment.half_width_mps, 2),
            number(moment.score_mps, 2),
            format!("{} %", number(one.coverage_pct, 1)),
            number(one.half_width_mps, 2),
            number(one.score_mps, 2),
            format!("{change_pct:+.1} %"),
            number(between.map(|b| b.0), 2),
            number(between.map(|b| b.1), 2),
        ]);
    }
    if table.is_empty() {
        return String::new();
    }
    format!(
        "\nIntervals of 90 %: of the moment, and of one width (interval score: width and penalty, less is better)\n\n{}",
        table.render()
    )
}

fn verdicts(evaluation: &TrajectoryEvaluation) -> String {
    if evaluation.verdicts.is_empty() {
        return String::new();
    }
    let mut table = Table::new([
        "ahead",
        "model",
        "baseline",
        "RMSE difference m/s",
        "against persistence",
        "over units",
    ]);
    for verdict in &evaluation.verdicts {
        let mut horizons = evaluation.horizons_s.iter();
        let k = horizons.position(|horizon_s| horizon_s.total_cmp(&verdict.horizon_s).is_eq());
        let mut rows = evaluation.rows.iter();
        let row = rows.find(|row| row.model == verdict.model);
        let skill = row.zip(k).map(|(row, k)| row.figures[k].skill_pct);
        table.row([
            format!("{} s", verdict.horizon_s),
            verdict.model.clone(),
            verdict.baseline.clone(),
            number(verdict.difference_mps, 4),
            format!("{} %", number(skill.map(|skill| -skill), 1)),
            verdict.verdict.name().to_owned(),
        ]);
    }
    format!("\nBest model against best baseline\n\n{}", table.render())
}

fn trials(heading: &Heading, evaluation: &TrajectoryEvaluation) -> String {
    let mut text = format!(
        "\nTrials of the thesis (Table 4.1): whole trips from their limits; energy of {}\n\n",
        heading.vehicle
    );
    let band = format!("in ±{} km/h %", number(0.5 * heading.band_kmh, 1));
    let mut table = Table::new([
        "trial",
        "E MJ",
        "ΔE MJ",
        "√SSE/n v km/h",
        "√SSE/n a m/s²",
        &band,
        "RMSE km/h",
        "distance off %",
    ]);
    for result in &evaluation.trials {
        let Some(summary) = result.summary() else {
            continue;
        };
        let megajoules = |energy_j: Option<f64>| {
            energy_j.map_or_else(|| "–".to_owned(), |j| number(j * 1e-6, 3))
        };
        table.row([
            result.trial.number().to_string(),
            megajoules(summary.energy_j),
            megajoules(summary.energy_difference_j),
            number(summary.sqrt_sse_speed_mps * 3.6, 3),
            number(summary.sqrt_sse_accel_mps2, 4),
            number(summary.in_band_pct, 1),
            number(summary.rmse_mps * 3.6, 2),
            number(summary.abs_distance_error_pct, 1),
        ]);
    }
    text.push_str(&table.render());
    if let Some(summary) = evaluation.trials.first().and_then(TrialResult::summary) {
        let _ = writeln!(
            text,
            "\nMeasured: {} MJ on {}. ΔE: measured minus predicted. The rest are means over drives.\n\
             A window of limits is one of time: it knows what limits the car will have reached 5 s later.",
            number(summary.measured_energy_j * 1e-6, 3),
            plural(summary.trips, "drive"),
        );
    }
    text
}

fn free_run(runs: &FreeRuns) -> String {
    let mut text = String::from(
        "\nFree run: whole trips from road and driver alone, up to 15 min; mean, mean magnitude and largest error, %\n\n",
    );
    let mut table = Table::new([
        "the road knows",
        "trips",
        "distance",
        "energy",
        "time, equal distance",
        "energy, equal distance",
    ]);
    let errors = |errors: Option<PercentErrors>| match errors {
        Some(e) => format!(
            "{} / {} / {}",
            number(e.mean_pct, 1),
            number(e.mean_abs_pct, 1),
            number(e.max_abs_pct, 1)
        ),
        None => "–".to_owned(),
    };
    let mut row = |knows: &str, evaluation: &FreeRunEvaluation| {
        let summary = evaluation.summary;
        table.row([
            knows.to_owned(),
            summary.trips.to_string(),
            errors(Some(summary.distance)),
            errors(summary.energy),
            errors(Some(summary.time_at_distance)),
            errors(summary.energy_at_distance),
        ]);
    };
    row("limits, stops", &runs.expected);
    row("also where the driver slowed down", &runs.known);
    text.push_str(&table.render());
    text + "\n" + &runs.in_words()
}
