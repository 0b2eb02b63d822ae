//! `drivekit road`: a road out of drives, a track or a map.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;
use driver_model::road::{DrawnRoad, RoadFile};
use ev_energy::DEFAULT_SLOPE_BANDWIDTH_M;
use report::terminal::{Table, number};
use serde::Serialize;

use super::motions::motions;
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs;
use crate::inputs::files::FileInputs;
use crate::output;
use crate::render::json::{Document, Listing};
use crate::require::{KnownFigures, RequireArgs};

/// A road out of drives along it, a GPX track, or GeoJSON lines
///
/// Logs of one or several drives of the same road give its limits, stops, slow points and elevation: the medians of the drives, and of stops and
/// slow points those that more than half of the drives have. A GPX track gives length and elevation. GeoJSON lines that join end to end, as
/// OpenStreetMap's tools export them, give also `maxspeed` and stop signs. What was assumed or left out is listed. The road is a TOML or JSON
/// file to be completed by hand.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit road drive.csv -o road.toml                       limits, stops, slow points and elevation of a drive
  drivekit road monday.csv tuesday.csv -o commute.toml       what the drives share
  drivekit road drive.csv --limit-map map.geojson -o road.toml
  drivekit road track.gpx -o road.toml                       length and elevation
  drivekit road ways.geojson -o road.json                    OpenStreetMap ways with maxspeed and stop signs")]
pub(crate) struct RoadArgs {
    #[command(flatten)]
    #[serde(flatten)]
    logs: LogArgs,
    /// Road file to write
    #[arg(long, short, value_name = "FILE.toml|json")]
    #[serde(skip)]
    output: PathBuf,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

pub(crate) fn run(args: &RoadArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require
        .check(&KnownFigures::new(include_str!("../figures/road.txt")))?;
    let logs = &args.logs.logs;
    let Some(track) = logs.iter().find(|path| Kind::of(path).is_some()) else {
        let inputs = inputs::load_once(&args.logs, context)?;
        let drawn = DrawnRoad::of_drives(&motions(&inputs, DEFAULT_SLOPE_BANDWIDTH_M)?)?;
        let outcome = finish(args, context, &inputs, &drawn)?;
        return Ok(inputs::outcome(&inputs).and(outcome));
    };
    if logs.len() > 1 {
        bail!(
            "`{}` and {} other files: a road is drawn out of one track or map, or out of logs; name one kind",
            track.display(),
            logs.len() - 1
        );
    }
    if args.logs.reading.limit_map.is_some() {
        bail!("--limit-map is for logs; `{}` is none", track.display());
    }
    let inputs = FileInputs::read([track.clone()])?;
    finish(args, context, &inputs, &of_track(track)?)
}

/// What is no log.
#[derive(Clone, Copy)]
enum Kind {
    Gpx,
    GeoJson,
}

impl Kind {
    fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "gpx" => Some(Self::Gpx),
            "geojson" | "json" => Some(Self::GeoJson),
            _ => None,
        }
    }
}

fn of_track(path: &Path) -> anyhow::Result<DrawnRoad> {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read `{name}`"))?;
    Ok(match Kind::of(path) {
        Some(Kind::Gpx) => DrawnRoad::of_gpx(&text, &name)?,
        _ => DrawnRoad::of_geojson(&text, &name)?,
    })
}

fn finish<'a>(
    args: &'a RoadArgs,
    context: &Context,
    inputs: impl Into<Listing<'a>>,
    drawn: &DrawnRoad,
) -> anyhow::Result<Outcome> {
    let mut document = Document::new("road", args, inputs, drawn);
    let outcome = document.judged(&args.require)?;
    write(&args.output, &drawn.road)?;
    output::note(
        context,
        &format!("road written to {}", args.output.display()),
    );
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&text(drawn))?,
    }
    Ok(outcome)
}

fn write(path: &Path, road: &RoadFile) -> anyhow::Result<()> {
    let extension = path.extension().unwrap_or_default();
    let text = match extension.eq_ignore_ascii_case("json") {
        true => road.to_json()? + "\n",
        false => road.to_toml()?,
    };
    output::write_file(path, |out| Ok(out.write_all(text.as_bytes())?))
}

fn text(drawn: &DrawnRoad) -> String {
    let road = &drawn.road;
    let kmh = |speed_mps: f64| format!("{} km/h", number(3.6 * speed_mps, 1));
    let mut places: Vec<(f64, String)> = vec![
        (0.0, format!("start at {}", kmh(road.start_speed_mps))),
        (road.length_m, format!("end at {}", kmh(road.end_speed_mps))),
    ];
    let limits = road.limits.iter();
    places.extend(limits.map(|l| (l.position_m, format!("limit {}", kmh(l.limit_mps)))));
    let stops = road.stops.iter();
    places.extend(stops.map(|s| (s.position_m, format!("stop of {} s", number(s.dwell_s, 1)))));
    let slow = road.slow_points.iter().flatten();
    places.extend(slow.map(|p| (p.position_m, format!("slow point, {}", kmh(p.speed_mps)))));
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut table = Table::new(["m", "road"]);
    for (position_m, what) in places {
        table.row([number(position_m, 1), what]);
    }
    let mut text = format!(
        "{} km, {}\n\n",
        number(road.length_m / 1e3, 3),
        height(road)
    );
    text += &table.render();
    if !drawn.findings.is_empty() {
        text.push('\n');
    }
    for finding in &drawn.findings {
        text += &format!("  {finding}\n");
    }
    text
}

fn height(road: &RoadFile) -> String {
    let heights_m = road.elevation.iter().map(|at| at.elevation_m);
    let lowest_m = heights_m.clone().fold(f64::INFINITY, f64::min);
    let highest_m = heights_m.fold(f64::NEG_INFINITY, f64::max);
    match road.elevation.is_empty() {
        true => "level".to_owned(),
        false => format!(
            "between {} and {} m of elevation",
            number(lowest_m, 1),
            number(highest_m, 1)
        ),
    }
}
