//! Roads of positions in order: GPX tracks and routes, lines of GeoJSON.

use drive_log::limit_map::{MapLines, great_circle_m};

use super::gpx;
use super::lines;
use super::profile;
use super::{DrawnRoad, counted};
use crate::Error;
use crate::road::RoadFile;
use crate::road::file::not_a_road;

/// Positions of a recorded track nearer than this to the last one are passed over, m: a receiver that stands wanders.
const LEAST_STEP_M: f64 = 5.0;

/// Gaps of a track up to this are bridged by a straight line, m.
const LARGEST_GAP_M: f64 = 300.0;

/// Positions along a road.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Track {
    /// Degrees east and north.
    pub(super) positions_deg: Vec<[f64; 2]>,
    /// As many elevations, NaN where unknown.
    pub(super) elevation_m: Vec<f64>,
}

impl DrawnRoad {
    /// The road of the track of a GPX file, or of its route; `file` names it in errors. Distances are those of great circles between positions
    /// at least 5 m apart (of routes all), elevations are smoothed as those of logs. GPX has no limits.
    ///
    /// # Errors
    /// [`Error::Road`] for a text that is no GPX, has no track or several, or one with gaps over 300 m; [`Error::RoadValue`] for a road that is
    /// too short or too long.
    pub fn of_gpx(text: &str, file: &str) -> Result<Self, Error> {
        let mut findings = Vec::new();
        let track = gpx::read(text).and_then(|gpx| the_one(gpx, &mut findings));
        let track = track.map_err(|reason| not_a_road(file, reason))?;
        findings.push("no limits: GPX has none".to_owned());
        let road = profiled(&track, &track.places_m(), file, &mut findings)?;
        Ok(Self {
            road: road.rounded().checked(file)?,
            findings,
        })
    }

    /// The road of lines of GeoJSON that join end to end in any order, with the `maxspeed` of each and the stop signs at their points, as
    /// OpenStreetMap's tools export them; `file` names it in errors. It leads the way of the first line, unless one-way streets forbid it.
    ///
    /// # Errors
    /// [`drive_log::Error::Lines`] for a text that is no GeoJSON, [`Error::Road`] for lines that do not join, branch or close,
    /// [`Error::RoadValue`] for a road that is too short or too long.
    pub fn of_geojson(text: &str, file: &str) -> Result<Self, Error> {
        let map = MapLines::from_geojson(file, text)?;
        let mut findings = Vec::new();
        let chain = lines::chained(&map.ways, &mut findings);
        let chain = chain.map_err(|reason| not_a_road(file, reason))?;
        let track = lines::track(&map.ways, &chain);
        let places_m = track.places_m();
        let profile = profiled(&track, &places_m, file, &mut findings)?;
        let road = RoadFile {
            limits: lines::limits(&map, &chain, &places_m, &mut findings),
            stops: lines::stops(&map, &chain, &track, &places_m, &mut findings),
            ..profile
        };
        Ok(Self {
            road: road.rounded().checked(file)?,
            findings,
        })
    }
}

impl Track {
    /// Distance of each position from the first.
    fn places_m(&self) -> Vec<f64> {
        let steps_m = self
            .positions_deg
            .windows(2)
            .map(|ends| great_circle_m(ends[0], ends[1]));
        let places_m = steps_m.scan(0.0, |place_m, step_m| {
            *place_m += step_m;
            Some(*place_m)
        });
        std::iter::once(0.0).chain(places_m).collect()
    }

    /// Without positions that are near to the last one; the end stays.
    fn thinned(&self) -> Self {
        let last = self.positions_deg.len().saturating_sub(1);
        let mut thinned = Self::default();
        let points = self.positions_deg.iter().zip(&self.elevation_m);
        for (number, (&position_deg, &elevation_m)) in points.enumerate() {
            let is_near = thinned
                .positions_deg
                .last()
                .is_some_and(|before| great_circle_m(*before, position_deg) < LEAST_STEP_M);
            if !is_near || number == last {
                thinned.positions_deg.push(position_deg);
                thinned.elevation_m.push(elevation_m);
            }
        }
        thinned
    }
}

/// A road of the length and with the elevations of a track.
fn profiled(
    track: &Track,
    places_m: &[f64],
    file: &str,
    findings: &mut Vec<String>,
) -> Result<RoadFile, Error> {
    let length_m = places_m.last().copied().unwrap_or(0.0);
    let road = RoadFile::of_length(length_m).checked(file)?;
    let missing = track.elevation_m.iter().filter(|m| !m.is_finite()).count();
    let elevation = profile::of_track(length_m, places_m, &track.elevation_m)?;
    if elevation.is_empty() {
        findings.push("no elevations: a level road".to_owned());
    } else if missing > 0 {
        let points = counted(track.elevation_m.len(), "point");
        findings.push(format!(
            "{missing} of {points} have no elevation and are bridged"
        ));
    }
    Ok(RoadFile { elevation, ..road })
}

/// The track, or the route where there is none.
fn the_one(gpx: gpx::Gpx, findings: &mut Vec<String>) -> Result<Track, String> {
    let is_line = |track: &Track| track.positions_deg.len() > 1;
    let mut tracks: Vec<Vec<Track>> = gpx.tracks;
    for segments in &mut tracks {
        segments.retain(|segment| !segment.positions_deg.is_empty());
    }
    tracks.retain(|segments| segments.len() > 1 || segments.iter().any(is_line));
    let mut routes: Vec<Track> = gpx.routes.into_iter().filter(is_line).collect();
    match (tracks.len(), routes.len()) {
        (1, _) => Ok(joined(&tracks.remove(0), findings)?.thinned()),
        (0, 1) => Ok(routes.remove(0)),
        (0, 0) => Err(
            "no track and no route of two points or more; export the way that was driven"
                .to_owned(),
        ),
        (0, n) => Err(format!("{n} routes; keep one, the road")),
        (n, _) => Err(format!("{n} tracks; keep one, the road")),
    }
}

/// Segments after each other.
fn joined(segments: &[Track], findings: &mut Vec<String>) -> Result<Track, String> {
    let mut track = Track::default();
    let mut bridged_m = 0.0;
    for segment in segments {
        if let (Some(&from), Some(&to)) =
            (track.positions_deg.last(), segment.positions_deg.first())
        {
            let gap_m = great_circle_m(from, to);
            if gap_m > LARGEST_GAP_M {
                return Err(format!(
                    "a gap of {gap_m:.0} m between the segments of the track, from {} to {}; fill it, or give one segment",
                    lines::named(from),
                    lines::named(to)
                ));
            }
            bridged_m += gap_m;
        }
        track.positions_deg.extend(&segment.positions_deg);
        track.elevation_m.extend(&segment.elevation_m);
    }
    if segments.len() > 1 {
        findings.push(format!(
            "{} joined by straight lines of {bridged_m:.0} m in all",
            counted(segments.len(), "segment")
        ));
    }
    Ok(track)
}
