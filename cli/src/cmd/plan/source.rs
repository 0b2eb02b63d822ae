//! What is planned for: a road file, a log, or a problem on a grid of its own.

use std::path::Path;

use anyhow::{Context as _, bail};
use assistance::{RoadSettings, planned_road};
use driver_model::road::{DrawnRoad, RoadFile};
use ev_energy::{DEFAULT_SLOPE_BANDWIDTH_M, Vehicle};
use speed_plan::{Case, Columns, Envelope};

use super::{PlanArgs, leader};
use crate::cmd::motions::motions;
use crate::cmd::phases::vehicle;
use crate::flags::{Context, LogArgs, ReadingArgs};
use crate::inputs::files::FileInputs;
use crate::inputs::{self, Inputs};
use crate::output;

/// The layout where none is named.
const AUTO: &str = "auto";

/// The car where none is named.
const DEFAULT_VEHICLE: &str = "b250e";

pub(super) struct Source {
    pub(super) vehicle: Vehicle,
    pub(super) envelope: Envelope,
    pub(super) columns: Columns,
    /// The road that the columns are of; a stated problem has none.
    pub(super) road: Option<RoadFile>,
    /// Arrival that the source has of its own, s.
    pub(super) arrival_s: Option<f64>,
    pub(super) findings: Vec<String>,
    pub(super) inputs: SourceInputs,
}

pub(super) enum SourceInputs {
    Files(FileInputs),
    Logs(Inputs),
}

impl Source {
    pub(super) fn read(args: &PlanArgs, context: &Context) -> anyhow::Result<Self> {
        match (&args.case, &args.road[..]) {
            (Some(case), []) => of_case(args, case),
            (Some(_), [_, ..]) => bail!("--case is a problem of its own; give no road beside it"),
            (None, []) => bail!("give a road file, a log, or --case FILE.json"),
            (None, [_, _, ..]) => bail!(
                "{} roads or logs were given; a plan is for one (--potential takes several logs)",
                args.road.len()
            ),
            (None, [road]) if is_road_file(road) => {
                of_logs_only(args, road)?;
                let file = RoadFile::read(road)?;
                let name = road.display().to_string();
                let inputs = SourceInputs::Files(FileInputs::read([road.clone()])?);
                of_road(args, file, &name, None, inputs, context)
            }
            (None, [log]) => of_log(args, log, context),
        }
    }
}

fn is_road_file(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default();
    extension.eq_ignore_ascii_case("toml") || extension.eq_ignore_ascii_case("json")
}

/// Refuses flags that say how a log is read.
fn of_logs_only(args: &PlanArgs, path: &Path) -> anyhow::Result<()> {
    let given = [
        ("--layout", args.layout != AUTO),
        ("--limit-map", args.limit_map.is_some()),
    ];
    match given.iter().find(|(_, given)| *given) {
        Some((flag, _)) => bail!("{flag} is for logs; `{}` is none", path.display()),
        None => Ok(()),
    }
}

pub(super) fn text_of(path: &Path) -> anyhow::Result<String> {
    std::fs::read_to_string(path).with_context(|| format!("cannot read `{}`", path.display()))
}

fn of_case(args: &PlanArgs, path: &Path) -> anyhow::Result<Source> {
    let given = [
        ("--vehicle", args.vehicle.is_some()),
        ("--accel", args.accel.is_some()),
        ("--signals", args.signals.is_some()),
        ("--leader", args.leader.is_some()),
        ("--slowest", args.slowest.is_some()),
    ];
    if let Some((flag, _)) = given.iter().find(|(_, given)| *given) {
        bail!("{flag} is for roads; `{}` says it itself", path.display());
    }
    of_logs_only(args, path)?;
    let name = path.display().to_string();
    let text = text_of(path)?;
    let case = Case::from_json(&text, &name)?;
    Ok(Source {
        vehicle: case.vehicle,
        envelope: case.envelope,
        columns: case.columns,
        road: None,
        arrival_s: case.latest_arrival_s,
        findings: Vec::new(),
        inputs: SourceInputs::Files(FileInputs::read([path.to_path_buf()])?),
    })
}

fn of_log(args: &PlanArgs, path: &Path, context: &Context) -> anyhow::Result<Source> {
    let logs = LogArgs {
        logs: vec![path.to_path_buf()],
        reading: ReadingArgs {
            layout: args.layout.clone(),
            limit_map: args.limit_map.clone(),
            ..ReadingArgs::default()
        },
    };
    let inputs = inputs::load_once(&logs, context)?;
    if inputs.len() != 1 {
        bail!(
            "{} drives were given; a plan is for one (`drivekit road` draws one road out of several drives)",
            inputs.len()
        );
    }
    let motions = motions(&inputs, DEFAULT_SLOPE_BANDWIDTH_M)?;
    let drawn = DrawnRoad::of_drives(&motions)?;
    let arrival_s = motions.iter().map(driver_model::Motion::duration_s).sum();
    let name = inputs.first().map(inputs::Input::label).unwrap_or_default();
    let mut source = of_road(
        args,
        drawn.road,
        &name,
        Some(arrival_s),
        SourceInputs::Logs(inputs),
        context,
    )?;
    source.findings.splice(0..0, drawn.findings);
    Ok(source)
}

fn of_road(
    args: &PlanArgs,
    mut file: RoadFile,
    name: &str,
    arrival_s: Option<f64>,
    inputs: SourceInputs,
    context: &Context,
) -> anyhow::Result<Source> {
    if let Some(path) = &args.signals {
        file = file.with_signals_of_json(&text_of(path)?, &path.display().to_string())?;
    }
    if let Some(path) = &args.leader {
        file.leader = leader::read(path)?;
        file = file.checked(&path.display().to_string())?;
    }
    let mut settings = RoadSettings::default();
    if let Some(slowest_kmh) = args.slowest {
        settings.slowest_mps = slowest_kmh / 3.6;
    }
    let (road, findings) = planned_road(&file, &settings);
    if road.limits.is_empty() {
        bail!("{name}: the road has no speed limits; give `limits`, the first at position 0");
    }
    let envelope = match args.accel {
        Some([min, max]) => Envelope::constant(min, max)?,
        None => Envelope::default(),
    };
    Ok(Source {
        vehicle: chosen_vehicle(args, context)?,
        envelope,
        columns: road.columns().with_context(|| name.to_owned())?,
        road: Some(file),
        arrival_s,
        findings,
        inputs,
    })
}

/// The vehicle that is named, or the one where none is.
pub(super) fn chosen_vehicle(args: &PlanArgs, context: &Context) -> anyhow::Result<Vehicle> {
    let chosen = args.vehicle.as_deref().unwrap_or_else(|| {
        output::note(
            context,
            &format!("no --vehicle: the plan is for `{DEFAULT_VEHICLE}`"),
        );
        DEFAULT_VEHICLE
    });
    vehicle(chosen)
}
