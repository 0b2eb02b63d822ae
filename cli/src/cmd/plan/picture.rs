//! What was planned as pictures: `--plot` and `--report`.

use std::path::PathBuf;

use anyhow::bail;
use assistance::{Effort, RunDocument};
use clap::Args;
use report::picture::{self, PlanPicture, RoadRun, SignalTimes};
use serde::Serialize;

use super::Body;
use crate::flags::Context;
use crate::output;
use crate::render::json::Document;

/// Files with pictures of a plan.
#[derive(Debug, Args)]
pub(super) struct PictureArgs {
    /// Draw speed, limits, signals and elevation over the road, or energy over time of --frontier
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    /// Write one self-contained page with pictures, the energy budget and what was assumed
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
}

impl PictureArgs {
    /// Writes what is asked for.
    pub(super) fn write(
        &self,
        document: &Document<impl Serialize, Body>,
        context: &Context,
    ) -> anyhow::Result<()> {
        let body = &document.body;
        if let (Some(obstacle), true) = (&body.obstacle, self.plot.is_some()) {
            bail!("there is no plan to draw: {}", obstacle.words);
        }
        let count = body.plans.len();
        if count > 1 && (self.plot.is_some() || self.report.is_some()) {
            output::note(context, &format!("the first of {count} plans is drawn"));
        }
        if let Some(path) = &self.plot {
            let svg = drawn(body)?;
            output::write_file(path, |out| Ok(out.write_all(svg.as_bytes())?))?;
            output::note(context, &format!("picture written to {}", path.display()));
        }
        if let Some(path) = &self.report {
            let page = report::PLAN.filled(&serde_json::to_value(document)?);
            output::write_page(path, &page, context)?;
        }
        Ok(())
    }
}

fn drawn(body: &Body) -> anyhow::Result<String> {
    let (plan, own) = (body.plans.first().map(|plan| &plan.run), body.own.as_ref());
    let elevation_m = plan.map(elevation_m).unwrap_or_default();
    let of_plan = plan.map(|plan| {
        format!(
            ", {:.3} kWh in {:.1} s",
            plan.energy_j / ev_energy::JOULES_PER_KWH,
            plan.time_s
        )
    });
    let title = format!("{}{}", body.vehicle, of_plan.unwrap_or_default());
    Ok(picture::plan_over_road(&PlanPicture {
        title: &title,
        plan: plan.map(run),
        own: own.map(run),
        limit_mps: plan.map_or(&[], |plan| &plan.nodes.limit_mps),
        elevation_m: &elevation_m,
        signals: plan.map(signals).unwrap_or_default(),
        frontier: body
            .frontier
            .iter()
            .map(|point| (point.time_s, point.energy_j))
            .collect(),
        own_point: own.map(|own| (own.time_s, own.energy_j)),
    })?)
}

fn run(plan: &RunDocument) -> RoadRun<'_> {
    let nodes = &plan.nodes;
    RoadRun {
        position_m: &nodes.position_m,
        speed_mps: &nodes.speed_mps,
        time_s: nodes
            .arrival_s
            .iter()
            .zip(&nodes.stood_s)
            .map(|(arrival_s, stood_s)| [*arrival_s, arrival_s + stood_s])
            .collect(),
        effort: nodes.effort.iter().copied().map(effort).collect(),
    }
}

fn effort(effort: Effort) -> picture::Effort {
    match effort {
        Effort::Drives => picture::Effort::Drives,
        Effort::Coasts => picture::Effort::Coasts,
        Effort::Regenerates => picture::Effort::Regenerates,
        Effort::BrakesByFriction => picture::Effort::BrakesByFriction,
    }
}

fn signals(plan: &RunDocument) -> Vec<SignalTimes<'_>> {
    plan.signals
        .iter()
        .map(|signal| SignalTimes {
            position_m: signal.position_m,
            green_s: &signal.green_s,
        })
        .collect()
}

/// Elevation above the start at every node; none on a level road.
fn elevation_m(plan: &RunDocument) -> Vec<f64> {
    let nodes = &plan.nodes;
    if nodes.slope_rad.iter().all(|slope| *slope == 0.0) {
        return Vec::new();
    }
    let steps = nodes.position_m.windows(2).zip(&nodes.slope_rad);
    let climbs = steps.scan(0.0, |elevation_m, (ends, slope_rad)| {
        *elevation_m += (ends[1] - ends[0]) * slope_rad.tan();
        Some(*elevation_m)
    });
    std::iter::once(0.0).chain(climbs).collect()
}
