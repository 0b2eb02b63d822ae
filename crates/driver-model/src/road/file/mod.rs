//! Roads as files: TOML or JSON, by hand or drawn out of drives and tracks.

mod check;
#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests;
mod text;

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{LimitFrom, NODE_SPACING_M, RoadMap, RoadStop, SlopeAt, SlowPoint};
use crate::Error;
use text::{RoadText, without_mark};

/// Sideways acceleration at which curves are driven, m/s².
const CURVE_MPS2: f64 = 2.0;

/// A road as a file states it; positions from its start, in order.
///
/// What [`read`](Self::read), [`from_toml`](Self::from_toml) and [`from_json`](Self::from_json) return has been checked; who changes a
/// field has it checked anew by [`checked`](Self::checked).
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct RoadFile {
    /// Length, 1 m to 1000 km.
    pub length_m: f64,
    /// Speed at the start.
    pub start_speed_mps: f64,
    /// Speed at the end.
    pub end_speed_mps: f64,
    /// Limits from where they begin; before the first there is none.
    pub limits: Vec<LimitFrom>,
    /// Stops.
    pub stops: Vec<RoadStop>,
    /// Slow points such as turns; `None` where they are unknown.
    pub slow_points: Option<Vec<SlowPoint>>,
    /// Curves.
    pub curves: Vec<Curve>,
    /// Elevation, linear in between and constant beyond; empty on a level road, or where the slope is given.
    pub elevation: Vec<ElevationAt>,
    /// Slope, linear in between and constant beyond; empty on a level road, or where the elevation is given.
    pub slope: Vec<SlopeAt>,
    /// Traffic signals.
    pub signals: Vec<Signal>,
    /// Where a vehicle ahead is; empty without one.
    pub leader: Vec<LeaderAt>,
}

/// A stretch of constant radius.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// Where it begins.
    pub from_m: f64,
    /// Where it ends.
    pub to_m: f64,
    /// Its radius.
    pub radius_m: f64,
}

/// Elevation at a position.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElevationAt {
    /// Where.
    pub position_m: f64,
    /// The elevation.
    pub elevation_m: f64,
}

/// Traffic signals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Signal {
    /// Where.
    pub position_m: f64,
    /// When they may be passed.
    #[serde(flatten)]
    pub green: Green,
}

/// When signals are green; times from the start of the trip.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Green {
    /// In windows.
    Windows {
        /// From and to, in order.
        green_s: Vec<[f64; 2]>,
    },
    /// Again and again.
    Cycle {
        /// Time from one green to the next.
        cycle_s: f64,
        /// When one of them begins.
        green_from_s: f64,
        /// How long each lasts.
        green_s: f64,
    },
}

/// Place of a vehicle ahead at a time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeaderAt {
    /// When, from the start of the trip.
    pub time_s: f64,
    /// Where.
    pub position_m: f64,
}

impl RoadFile {
    /// Reads a road, TOML or JSON by the ending of the file's name.
    ///
    /// # Errors
    /// [`Error::Road`] for a file that cannot be read or is of another kind, otherwise as [`from_toml`](Self::from_toml).
    pub fn read(path: &Path) -> Result<Self, Error> {
        let file = path.display().to_string();
        let extension = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
        let parse = match extension.as_ref().and_then(|ending| ending.to_str()) {
            Some("toml") => Self::from_toml,
            Some("json") => Self::from_json,
            _ => return Err(not_a_road(&file, "name a road `.toml` or `.json`")),
        };
        let text = std::fs::read_to_string(path);
        let text = text.map_err(|error| not_a_road(&file, format!("cannot read it: {error}")))?;
        parse(&text, &file)
    }

    /// Reads a road from TOML; `file` names the text in errors.
    ///
    /// # Errors
    /// [`Error::Road`] with line and column for text that is no road, [`Error::RoadValue`] for a value that no road has.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, Error> {
        let parsed: RoadText = toml::from_str(text).map_err(|e| not_a_road(file, e.to_string()))?;
        parsed.road(file)?.checked(file)
    }

    /// The same from JSON.
    ///
    /// # Errors
    /// As [`from_toml`](Self::from_toml).
    pub fn from_json(text: &str, file: &str) -> Result<Self, Error> {
        let parsed: RoadText = serde_json::from_str(without_mark(text))
            .map_err(|e| not_a_road(file, e.to_string()))?;
        parsed.road(file)?.checked(file)
    }

    /// With other signals, from a JSON list of them; `file` names it in errors.
    ///
    /// # Errors
    /// As [`from_json`](Self::from_json).
    pub fn with_signals_of_json(mut self, text: &str, file: &str) -> Result<Self, Error> {
        self.signals = text::signals(text, file)?;
        self.checked(file)
    }

    /// As TOML that [`from_toml`](Self::from_toml) reads back unchanged. Speeds are in km/h, unless that would change them.
    ///
    /// # Errors
    /// [`Error::Road`] where a value has no TOML form; what was checked has one.
    pub fn to_toml(&self) -> Result<String, Error> {
        let written = RoadText::of(self).to_toml();
        written.map_err(|error| not_a_road("the road", error.to_string()))
    }

    /// As JSON that [`from_json`](Self::from_json) reads back unchanged.
    ///
    /// # Errors
    /// As [`to_toml`](Self::to_toml).
    pub fn to_json(&self) -> Result<String, Error> {
        let written = serde_json::to_string_pretty(&RoadText::of(self));
        written.map_err(|error| not_a_road("the road", error.to_string()))
    }

    /// Slope over the road, linear in between: of elevations the mean between each and the next. Empty on a level road.
    #[must_use]
    pub fn slope(&self) -> Vec<SlopeAt> {
        let mean = |pair: &[ElevationAt]| {
            let run_m = pair[1].position_m - pair[0].position_m;
            let slope_rad = ((pair[1].elevation_m - pair[0].elevation_m) / run_m).atan();
            [pair[0], pair[1]].map(|end| SlopeAt {
                position_m: end.position_m,
                slope_rad,
            })
        };
        let of_elevation = self.elevation.windows(2).flat_map(mean);
        self.slope.iter().copied().chain(of_elevation).collect()
    }

    /// The road as trip drivers know it: without end speed, signals and leader; curves are slow points at every metre. `file` names it in
    /// errors.
    ///
    /// # Errors
    /// [`Error::Road`] without a limit at the start, by which trip drivers choose their speed.
    pub fn to_map(&self, file: &str) -> Result<RoadMap, Error> {
        if self
            .limits
            .first()
            .is_none_or(|first| first.position_m > 0.0)
        {
            let reason = "no limit at the start, by which trip drivers choose their speed; give `limits` from position 0 on";
            return Err(not_a_road(file, reason));
        }
        let mut slow_points = self.slow_points.clone();
        if !self.curves.is_empty() {
            let points = slow_points.get_or_insert_default();
            points.extend(self.curves.iter().flat_map(Curve::slow_points));
            points.sort_by(|a, b| a.position_m.total_cmp(&b.position_m));
        }
        Ok(RoadMap {
            length_m: self.length_m,
            start_speed_mps: self.start_speed_mps,
            limits: self.limits.clone(),
            stops: self.stops.clone(),
            slow_points,
            slope: self.slope(),
        })
    }
}

impl Curve {
    fn slow_points(&self) -> impl Iterator<Item = SlowPoint> {
        let speed_mps = (CURVE_MPS2 * self.radius_m).sqrt();
        let steps = ((self.to_m - self.from_m) / NODE_SPACING_M).ceil();
        let (from_m, to_m) = (self.from_m, self.to_m);
        let spacing_m = (to_m - from_m) / steps;
        (0..=steps as usize).map(move |k| SlowPoint {
            position_m: (from_m + k as f64 * spacing_m).min(to_m),
            speed_mps: speed_mps.clamp(super::STANDSTILL_MPS, FASTEST_MPS),
        })
    }
}

/// No car is faster, m/s.
const FASTEST_MPS: f64 = 1e3;

pub(in crate::road) fn not_a_road(file: &str, reason: impl Into<String>) -> Error {
    Error::Road {
        file: file.to_owned(),
        reason: reason.into(),
    }
}
