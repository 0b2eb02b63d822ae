use std::fmt::Write as _;

use assistance::{Band, Bound, PlanDocument, PlanOutcome, RoadDocument, RunDocument, Style};
use ev_energy::JOULES_PER_KWH;
use report::terminal::{Table, number};

use super::{Body, certify};

/// Kilowatt hours that are easier to read.
const PLACES: usize = 3;

/// Rows of the plan over the road, at most.
const ROWS: usize = 24;

pub(super) fn text(body: &Body) -> String {
    let road = &body.road;
    let mut text = format!(
        "{:.2} km, {}, {}, {} ({} nodes)\n",
        road.length_m / 1e3,
        crate::words::plural(road.stops, "stop"),
        crate::words::plural(road.signals, "signal"),
        body.vehicle,
        road.nodes
    );
    if let Some(obstacle) = &body.obstacle {
        let _ = writeln!(text, "\nno plan: {}", obstacle.words);
    }
    if let Some(own) = &body.own {
        let _ = writeln!(
            text,
            "\nthe driver's own way arrives after {:.1} s and takes {:.4} kWh from the cells",
            own.time_s,
            own.energy_j / JOULES_PER_KWH
        );
    }
    for plan in &body.plans {
        let _ = write!(text, "\n{}", summary(plan, road));
        text.extend(plan.certificate.as_ref().map(certify::text));
        text.push_str(&beside(plan, body.own.as_ref()));
        let _ = write!(text, "\n{}", course(&plan.run).render());
    }
    if !body.frontier.is_empty() {
        let mut table = Table::new(["arrival s", "kWh", "price W", "gap %"]);
        for point in &body.frontier {
            table.row([
                number(point.time_s, 1),
                number(point.energy_j / JOULES_PER_KWH, PLACES),
                number(point.price_w, 0),
                number(point.gap_pct, 4),
            ]);
        }
        let _ = write!(text, "\n{}", table.render());
    }
    text
}

fn summary(plan: &PlanDocument, road: &RoadDocument) -> String {
    let kwh = |energy_j: f64| energy_j / JOULES_PER_KWH;
    let mut text = format!(
        "arrives after {:.1} s (earliest {:.1} s{}){}\n",
        plan.run.time_s,
        plan.earliest_arrival_s,
        match (road.signals > 0, road.leader) {
            (true, true) => " without lights and leader",
            (true, false) => " without lights",
            (false, true) => " without the leader",
            (false, false) => "",
        },
        match plan.outcome {
            PlanOutcome::Early => ", before it has to: later would not be cheaper",
            PlanOutcome::Optimal => "",
        }
    );
    let _ = writeln!(
        text,
        "takes {:.4} kWh from the cells, {:.2} kWh/100 km at the terminals",
        kwh(plan.run.energy_j),
        plan.run.consumption_kwh_per_100km
    );
    let proof = match plan.bound {
        Bound::Proven => Some("proven"),
        Bound::Numerical => Some("searched numerically"),
        Bound::Missing => None,
    };
    let _ = match proof {
        Some(proof) => writeln!(
            text,
            "no other plan that arrives {} takes less than {:.4} kWh: a gap of {:.4} % ({proof})",
            if plan.latest_arrival_s.is_some() {
                "by then"
            } else {
                "no later"
            },
            kwh(plan.lower_bound_j),
            plan.gap_pct
        ),
        None => writeln!(
            text,
            "no bound was found: how much less another plan could take is not known"
        ),
    };
    if let Some(price_w) = plan.price_w {
        let _ = write!(
            text,
            "a second later at the end saves {:.2} kJ; ",
            price_w / 1e3
        );
    }
    let _ = writeln!(
        text,
        "sampled at 10 Hz it takes {:+.3} %; jerk {:.2} m/s³ (95 %), {:.2} m/s³ at most",
        100.0 * (plan.run.sampled_energy_j - plan.run.energy_j) / plan.run.energy_j.abs().max(1.0),
        plan.run.jerk_p95_mps3,
        plan.run.jerk_max_mps3
    );
    for signal in &plan.run.signals {
        let _ = writeln!(
            text,
            "signal at {:.0} m: {} after {:.1} s{}",
            signal.position_m,
            if signal.stood_s > 0.0 {
                "left"
            } else {
                "passed"
            },
            signal.passage_s,
            if signal.stood_s > 0.0 {
                format!(", stood {:.1} s", signal.stood_s)
            } else {
                String::new()
            }
        );
    }
    text
}

/// How a plan differs from the driver's own way.
fn beside(plan: &PlanDocument, own: Option<&RunDocument>) -> String {
    let (Some(own), Some(distance), Some(style)) = (own, &plan.style_distance, plan.style) else {
        return String::new();
    };
    let style = match style {
        Style::Free => "free of the driver's way".to_owned(),
        Style::Within(half_widths) => {
            format!("within {half_widths} half-widths of the driver's band")
        }
    };
    let band = match distance.band {
        Band::Fitted => "fitted",
        Band::Assumed => "assumed",
    };
    let saved_j = own.energy_j - plan.run.energy_j;
    let later_s = plan.run.time_s - own.time_s;
    let mut text = format!(
        "{style}: {} {:.1} % beside his own way, {}\n",
        if saved_j < 0.0 { "costs" } else { "saves" },
        100.0 * saved_j.abs() / own.energy_j.abs().max(1.0),
        if later_s.abs() < 0.05 {
            "in the same time".to_owned()
        } else {
            format!("{later_s:+.1} s later")
        }
    );
    let _ = writeln!(
        text,
        "{:.2} m/s from his speed (root mean square), {:.0} % of the road inside his band ({band}); speeds up by {:.2} (own {:.2}), brakes by {:.2} m/s² (own {:.2}, 95 %)",
        distance.rms_mps,
        distance.inside_band_pct,
        distance.accel_p95_mps2,
        distance.own_accel_p95_mps2,
        distance.decel_p95_mps2,
        distance.own_decel_p95_mps2
    );
    for saving in &plan.saves_most {
        let saved_kj = saving.saved_j / 1e3;
        let _ = writeln!(text, "- {}: saves {saved_kj:.0} kJ", saving.words);
    }
    text
}

/// Speed over the road at places that are evenly apart, and where the car stands.
fn course(run: &RunDocument) -> Table {
    let nodes = &run.nodes;
    let mut table = Table::new(["m", "km/h", "limit", "s", "wheel kN"]);
    let last = nodes.position_m.len() - 1;
    let apart_m = (nodes.position_m[last] - nodes.position_m[0]) / ROWS as f64;
    let mut next_m = nodes.position_m[0];
    for k in 0..=last {
        let stands = nodes.speed_mps[k] <= 0.0;
        if nodes.position_m[k] < next_m && !stands && k < last {
            continue;
        }
        next_m = nodes.position_m[k] + apart_m;
        let force = nodes
            .force_n
            .get(k)
            .map_or_else(|| "–".to_owned(), |force| number(force / 1e3, 2));
        table.row([
            number(nodes.position_m[k], 0),
            number(3.6 * nodes.speed_mps[k], 1),
            number(3.6 * nodes.limit_mps[k], 0),
            number(nodes.arrival_s[k], 1),
            force,
        ]);
    }
    table
}
