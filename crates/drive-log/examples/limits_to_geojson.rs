//! A map out of drives that know their positions and speed limits: a line for every run of one limit.
//!
//! ```text
//! cargo run --release --example limits_to_geojson -- monday.csv tuesday.csv > map.geojson
//! drivekit inspect wednesday.csv --limit-map map.geojson
//! ```

#![allow(clippy::print_stdout)]

use std::path::Path;

use drive_log::{Channel, LayoutChoice, Preparation, Smoothing};

/// Points of a line, in samples of a second.
const SPACING: usize = 2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let preparation = Preparation {
        step_s: 1.0,
        smooth: Smoothing::None,
        ..Preparation::default()
    };
    let mut lines = Vec::new();
    for path in std::env::args().skip(1) {
        let file = drive_log::read_file(Path::new(&path), &LayoutChoice::Auto)?;
        for log in file.logs {
            for piece in drive_log::prepare(log, &preparation)?.pieces {
                lines.extend(lines_of(&piece));
            }
        }
    }
    let lines = lines.join(",\n");
    println!("{{\"type\":\"FeatureCollection\",\"features\":[\n{lines}\n]}}");
    Ok(())
}

fn lines_of(piece: &drive_log::DriveLog) -> Vec<String> {
    let channels = [Channel::Longitude, Channel::Latitude, Channel::SpeedLimit];
    let [Some(east), Some(north), Some(limit)] = channels.map(|channel| piece.channel(channel))
    else {
        return Vec::new();
    };
    let is_known = |k: &usize| east[*k].is_finite() && north[*k].is_finite() && limit[*k] > 0.0;
    let known: Vec<usize> = (0..piece.len()).step_by(SPACING).filter(is_known).collect();
    let runs = known.chunk_by(|a, b| b - a == SPACING && (limit[*a] - limit[*b]).abs() < 0.01);
    let line = |run: &[usize]| {
        let points = run
            .iter()
            .map(|&k| format!("[{:.7},{:.7}]", east[k], north[k]));
        let points = points.collect::<Vec<_>>().join(",");
        let kmh = (3.6 * limit[run[0]]).round();
        format!(
            r#"{{"type":"Feature","properties":{{"maxspeed":"{kmh}"}},"geometry":{{"type":"LineString","coordinates":[{points}]}}}}"#
        )
    };
    runs.filter(|run| run.len() > 1).map(line).collect()
}
