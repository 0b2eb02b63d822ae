use std::fmt::Write as _;

use driver_model::energy::Measured;
use ev_energy::{JOULES_PER_KWH, TripEnergy};
use report::terminal::{Table, number};

use super::body::{Body, Entry, Totals};
use crate::words::plural;

/// Tables of the logs, of their budgets and of the totals.
pub(super) fn text(body: &Body) -> String {
    let several = body.totals.len() > 1;
    let name = |log: &str, vehicle: &str| {
        if several {
            format!("{log} ({vehicle})")
        } else {
            log.to_owned()
        }
    };
    let mut trips = trip_table();
    let mut budgets = budget_table();
    for entry in &body.logs {
        let name = name(entry.name, entry.vehicle);
        trips.row(trip_row(name.clone(), entry));
        budgets.row(budget_row(name, &entry.energy.modelled));
    }
    let mut text = trips.render();
    if body.logs.len() > body.totals.len() {
        for Totals {
            vehicle, totals, ..
        } in &body.totals
        {
            budgets.row(budget_row(name("all", vehicle), &totals.modelled));
        }
    }
    let _ = write!(text, "\n{}\n{}", budgets.render(), totals(body).render());
    for Totals {
        vehicle,
        calibration,
        ..
    } in &body.totals
    {
        if let Some(record) = calibration {
            let _ = writeln!(
                text,
                "\n{vehicle}: calibrated with {}; a trip that it has not seen is off by {:.1} % on average.",
                plural(record.trips, "trip"),
                record.held_out_mean_abs_error_pct
            );
        }
    }
    text
}

fn trip_table() -> Table {
    Table::new([
        "log",
        "km",
        "°C",
        "kWh/100 km",
        "terminal kWh",
        "measured kWh",
        "error %",
        "power RMSE kW",
        "by slope kWh",
        "slope from",
        "auxiliaries W",
        "limited s",
    ])
}

fn trip_row(name: String, entry: &Entry) -> [String; 12] {
    let energy = &entry.energy;
    let Measured {
        measured_terminal_energy_j,
        error_pct,
        power_rmse_w,
    } = energy.measured;
    let limited = &energy.modelled.limited;
    [
        name,
        number(energy.modelled.distance_m / 1e3, 2),
        number(energy.ambient_degc, 1),
        number(energy.consumption_kwh_per_100km, 2),
        kwh(energy.modelled.terminal_energy_j),
        number(measured_terminal_energy_j.map(|e| e / JOULES_PER_KWH), 3),
        number(error_pct, 1),
        number(power_rmse_w.map(|p| p / 1e3), 2),
        kwh(energy.slope.energy_j),
        energy.slope.source.name().to_owned(),
        number(energy.auxiliaries.mean_w, 0),
        number(limited.torque_s + limited.battery_s, 1),
    ]
}

fn budget_table() -> Table {
    Table::new([
        "budget in kWh",
        "inertia",
        "rolling",
        "aero",
        "grade",
        "gear loss",
        "motor loss",
        "auxiliary",
        "battery loss",
        "brakes",
        "cells",
        "(regenerated)",
    ])
}

fn budget_row(name: String, energy: &TripEnergy) -> [String; 12] {
    let b = &energy.budget;
    [
        name,
        kwh(b.inertia_j),
        kwh(b.rolling_j),
        kwh(b.aero_j),
        kwh(b.grade_j),
        kwh(b.gear_loss_j),
        kwh(b.motor_loss_j),
        kwh(b.auxiliary_j),
        kwh(b.battery_loss_j),
        kwh(b.friction_brake_j),
        kwh(energy.battery_energy_j),
        kwh(b.regenerated_j),
    ]
}

fn totals(body: &Body) -> Table {
    let mut table = Table::new([
        "all logs",
        "trips",
        "km",
        "kWh/100 km",
        "at the wall",
        "terminal kWh",
        "measured kWh",
        "total error %",
        "mean |error| %",
        "median RMSE kW",
    ]);
    for Totals {
        vehicle, totals, ..
    } in &body.totals
    {
        table.row([
            (*vehicle).to_owned(),
            totals.trips.to_string(),
            number(totals.modelled.distance_m / 1e3, 1),
            number(totals.consumption_kwh_per_100km, 2),
            number(totals.modelled.wall_kwh_per_100km(), 2),
            kwh(totals.modelled.terminal_energy_j),
            number(
                totals
                    .measured_terminal_energy_j
                    .map(|e| e / JOULES_PER_KWH),
                3,
            ),
            number(totals.error_pct, 2),
            number(totals.mean_abs_error_pct, 2),
            number(totals.median_power_rmse_w.map(|p| p / 1e3), 2),
        ]);
    }
    table
}

fn kwh(energy_j: f64) -> String {
    number(energy_j / JOULES_PER_KWH, 3)
}
