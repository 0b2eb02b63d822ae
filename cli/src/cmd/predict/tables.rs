//! Predictions for people.

use driver_eval::{
    Predicted, PredictedAhead, PredictedCruise, PredictedFollowing, PredictedPhase, PredictedTrip,
    Predictions,
};
use report::terminal::{Table, number};

pub(super) fn of(predictions: &Predictions) -> String {
    match predictions {
        Predictions::Phases(logs) => phases(logs),
        Predictions::Cruise(logs) => cruise(logs),
        Predictions::Following(logs) => following(logs),
        Predictions::SpeedAhead(logs) => speed_ahead(logs),
        Predictions::Trips(logs) => trips(logs),
    }
}

fn rows<T>(logs: &[Predicted<T>]) -> impl Iterator<Item = (&str, &T)> {
    logs.iter()
        .flat_map(|log| log.phases.iter().map(|phase| (log.name.as_str(), phase)))
}

fn phases(logs: &[Predicted<PredictedPhase>]) -> String {
    let mut table = Table::new([
        "log",
        "from s",
        "to s",
        "v0 km/h",
        "end km/h",
        "predicted",
        "RMSE km/h",
        "in band %",
    ]);
    for (log, phase) in rows(logs) {
        let predicted_end = phase.prediction.speed_mps.last().copied();
        table.row([
            log.to_owned(),
            number(phase.start_s, 1),
            number(phase.end_s, 1),
            number(phase.phase.start_speed_mps * 3.6, 1),
            number(phase.phase.end_speed_mps * 3.6, 1),
            number(predicted_end.map(|v| v * 3.6), 1),
            number(phase.prediction.rmse_mps * 3.6, 2),
            number(phase.prediction.in_band_pct, 1),
        ]);
    }
    table.render()
}

fn cruise(logs: &[Predicted<PredictedCruise>]) -> String {
    let mut table = Table::new([
        "log",
        "from s",
        "to s",
        "limit km/h",
        "v0 km/h",
        "RMSE km/h",
        "hold km/h",
        "in 90 % band %",
    ]);
    for (log, stretch) in rows(logs) {
        table.row([
            log.to_owned(),
            number(stretch.start_s, 1),
            number(stretch.end_s, 1),
            number(stretch.limit_mps.map(|v| v * 3.6), 0),
            number(stretch.start_speed_mps * 3.6, 1),
            number(stretch.rmse_mps * 3.6, 2),
            number(stretch.hold_rmse_mps * 3.6, 2),
            number(stretch.in_90_pct_band_pct, 1),
        ]);
    }
    table.render()
}

fn following(logs: &[Predicted<PredictedFollowing>]) -> String {
    let mut table = Table::new([
        "log",
        "from s",
        "to s",
        "gap RMSE m",
        "speed RMSE m/s",
        "collisions",
    ]);
    for (log, stretch) in rows(logs) {
        table.row([
            log.to_owned(),
            number(stretch.start_s, 1),
            number(stretch.end_s, 1),
            number(stretch.errors.gap_rmse_m, 2),
            number(stretch.errors.speed_rmse_mps, 3),
            stretch.errors.collisions.to_string(),
        ]);
    }
    table.render()
}

fn speed_ahead(logs: &[PredictedAhead]) -> String {
    let mut table = Table::new([
        "log",
        "moments",
        "ahead s",
        "RMSE m/s",
        "interval ± m/s",
        "inside %",
        "last prediction km/h",
    ]);
    for log in logs {
        for horizon in &log.horizons {
            table.row([
                log.name.clone(),
                log.moments_s.len().to_string(),
                horizon.horizon_s.to_string(),
                number(horizon.rmse_mps, 3),
                number(horizon.interval_mps, 2),
                number(horizon.inside_pct, 1),
                number(horizon.speed_mps.last().map(|v| v * 3.6), 1),
            ]);
        }
    }
    table.render()
}

fn trips(logs: &[PredictedTrip]) -> String {
    let mut table = Table::new(["log", "distance km", "measured s", "predicted s"]);
    for log in logs {
        table.row([
            log.name.clone(),
            number(log.distance_m * 1e-3, 2),
            number(log.measured_duration_s, 0),
            number(log.duration_s, 0),
        ]);
    }
    table.render()
}
