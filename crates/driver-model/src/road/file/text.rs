//! The keys of a road file, where they are not those of the road: units to choose from.

use serde::{Deserialize, Serialize};

use super::{Curve, ElevationAt, Green, LeaderAt, RoadFile, Signal, not_a_road};
use crate::Error;
use crate::road::{LimitFrom, RoadStop, SlopeAt, SlowPoint};

#[derive(Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RoadText {
    length_m: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    start_speed_kmh: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    start_speed_mps: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    end_speed_kmh: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    end_speed_mps: Option<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    limits: Vec<LimitText>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    stops: Vec<RoadStop>,
    #[serde(skip_serializing_if = "Option::is_none")]
    slow_points: Option<Vec<SlowText>>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    curves: Vec<Curve>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    elevation: Vec<ElevationAt>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    slope: Vec<SlopeText>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    signals: Vec<SignalText>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    leader: Vec<LeaderAt>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LimitText {
    position_m: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    limit_kmh: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limit_mps: Option<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SlowText {
    position_m: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    speed_kmh: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    speed_mps: Option<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SlopeText {
    position_m: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    slope_rad: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    grade_pct: Option<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SignalText {
    position_m: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    cycle_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    green_from_s: Option<f64>,
    green_s: GreenText,
}

#[derive(Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected `green_s` as windows [[from, to], …] in s, or as one number with `cycle_s` and `green_from_s`"
)]
enum GreenText {
    Windows(Vec<[f64; 2]>),
    Lasting(f64),
}

impl RoadText {
    pub(super) fn road(self, file: &str) -> Result<RoadFile, Error> {
        let named = |reason| not_a_road(file, reason);
        let start_speed = ["start_speed_kmh", "start_speed_mps"];
        let start_mps = speed_mps("", start_speed, self.start_speed_kmh, self.start_speed_mps);
        let end_speed = ["end_speed_kmh", "end_speed_mps"];
        let end_mps = speed_mps("", end_speed, self.end_speed_kmh, self.end_speed_mps);
        let slow_points = self.slow_points;
        let slow_points = slow_points.map(|points| each("slow_points", points, SlowText::point));
        Ok(RoadFile {
            length_m: self.length_m,
            start_speed_mps: start_mps.map_err(named)?.unwrap_or(0.0),
            end_speed_mps: end_mps.map_err(named)?.unwrap_or(0.0),
            limits: each("limits", self.limits, LimitText::limit).map_err(named)?,
            stops: self.stops,
            slow_points: slow_points.transpose().map_err(named)?,
            curves: self.curves,
            elevation: self.elevation,
            slope: each("slope", self.slope, SlopeText::slope).map_err(named)?,
            signals: each("signals", self.signals, SignalText::signal).map_err(named)?,
            leader: self.leader,
        })
    }

    pub(super) fn of(road: &RoadFile) -> Self {
        let (start_speed_kmh, start_speed_mps) = in_either(road.start_speed_mps);
        let (end_speed_kmh, end_speed_mps) = in_either(road.end_speed_mps);
        let slow_points = road.slow_points.as_ref();
        Self {
            length_m: road.length_m,
            start_speed_kmh,
            start_speed_mps,
            end_speed_kmh,
            end_speed_mps,
            limits: road.limits.iter().map(LimitText::of).collect(),
            stops: road.stops.clone(),
            slow_points: slow_points.map(|points| points.iter().map(SlowText::of).collect()),
            curves: road.curves.clone(),
            elevation: road.elevation.clone(),
            slope: road.slope.iter().map(SlopeText::of).collect(),
            signals: road.signals.iter().map(SignalText::of).collect(),
            leader: road.leader.clone(),
        }
    }

    /// Every entry of a list has a line.
    pub(super) fn to_toml(&self) -> Result<String, toml::ser::Error> {
        let plain = Self {
            length_m: self.length_m,
            start_speed_kmh: self.start_speed_kmh,
            start_speed_mps: self.start_speed_mps,
            end_speed_kmh: self.end_speed_kmh,
            end_speed_mps: self.end_speed_mps,
            ..Self::default()
        };
        let mut text = toml::to_string(&plain)?;
        list(&mut text, "limits", &self.limits)?;
        list(&mut text, "stops", &self.stops)?;
        match self.slow_points.as_deref() {
            Some([]) => text += "slow_points = []\n",
            points => list(&mut text, "slow_points", points.unwrap_or_default())?,
        }
        list(&mut text, "curves", &self.curves)?;
        list(&mut text, "elevation", &self.elevation)?;
        list(&mut text, "slope", &self.slope)?;
        list(&mut text, "signals", &self.signals)?;
        list(&mut text, "leader", &self.leader)?;
        Ok(text)
    }
}

/// Signals of a JSON list.
pub(super) fn signals(text: &str, file: &str) -> Result<Vec<Signal>, Error> {
    let parsed: Vec<SignalText> = serde_json::from_str(without_mark(text))
        .map_err(|error| not_a_road(file, format!("{error}; give a list of signals")))?;
    each("signals", parsed, SignalText::signal).map_err(|reason| not_a_road(file, reason))
}

/// Without the byte order mark that some editors write.
pub(super) fn without_mark(text: &str) -> &str {
    text.trim_start_matches('\u{feff}')
}

fn list<T: Serialize>(text: &mut String, key: &str, entries: &[T]) -> Result<(), toml::ser::Error> {
    if entries.is_empty() {
        return Ok(());
    }
    *text += &format!("{key} = [\n");
    for entry in entries {
        let mut line = String::new();
        entry.serialize(toml::ser::ValueSerializer::new(&mut line))?;
        *text += &format!("    {line},\n");
    }
    *text += "]\n";
    Ok(())
}

/// Each entry of a list as the road has it; `convert` is told the entry's name.
fn each<T, U>(
    key: &str,
    entries: Vec<T>,
    convert: fn(T, &str) -> Result<U, String>,
) -> Result<Vec<U>, String> {
    let numbered = entries.into_iter().enumerate();
    numbered
        .map(|(number, entry)| convert(entry, &format!("{key}[{number}]: ")))
        .collect()
}

impl LimitText {
    fn limit(self, entry: &str) -> Result<LimitFrom, String> {
        let keys = ["limit_kmh", "limit_mps"];
        Ok(LimitFrom {
            position_m: self.position_m,
            limit_mps: given(
                entry,
                keys,
                speed_mps(entry, keys, self.limit_kmh, self.limit_mps)?,
            )?,
        })
    }

    fn of(limit: &LimitFrom) -> Self {
        let (limit_kmh, limit_mps) = in_either(limit.limit_mps);
        Self {
            position_m: limit.position_m,
            limit_kmh,
            limit_mps,
        }
    }
}

impl SlowText {
    fn point(self, entry: &str) -> Result<SlowPoint, String> {
        let keys = ["speed_kmh", "speed_mps"];
        Ok(SlowPoint {
            position_m: self.position_m,
            speed_mps: given(
                entry,
                keys,
                speed_mps(entry, keys, self.speed_kmh, self.speed_mps)?,
            )?,
        })
    }

    fn of(point: &SlowPoint) -> Self {
        let (speed_kmh, speed_mps) = in_either(point.speed_mps);
        Self {
            position_m: point.position_m,
            speed_kmh,
            speed_mps,
        }
    }
}

impl SlopeText {
    fn slope(self, entry: &str) -> Result<SlopeAt, String> {
        let keys = ["slope_rad", "grade_pct"];
        once(entry, keys, self.slope_rad, self.grade_pct)?;
        let of_grade = self.grade_pct.map(|grade_pct| (grade_pct / 100.0).atan());
        Ok(SlopeAt {
            position_m: self.position_m,
            slope_rad: given(entry, keys, self.slope_rad.or(of_grade))?,
        })
    }

    fn of(slope: &SlopeAt) -> Self {
        Self {
            position_m: slope.position_m,
            slope_rad: Some(slope.slope_rad),
            grade_pct: None,
        }
    }
}

impl SignalText {
    fn signal(self, entry: &str) -> Result<Signal, String> {
        let green = match (self.green_s, self.cycle_s, self.green_from_s) {
            (GreenText::Windows(green_s), None, None) => Green::Windows { green_s },
            (GreenText::Lasting(green_s), Some(cycle_s), Some(green_from_s)) => Green::Cycle {
                cycle_s,
                green_from_s,
                green_s,
            },
            (GreenText::Windows(_), ..) => {
                return Err(format!(
                    "{entry}windows of green and `cycle_s` or `green_from_s`; give either windows, or a cycle with `green_s` as a number"
                ));
            }
            (GreenText::Lasting(green_s), ..) => {
                return Err(format!(
                    "{entry}green_s = {green_s} is of a cycle that lacks `cycle_s` or `green_from_s`; give both, or windows [[from, to], …]"
                ));
            }
        };
        Ok(Signal {
            position_m: self.position_m,
            green,
        })
    }

    fn of(signal: &Signal) -> Self {
        let (cycle_s, green_from_s, green_s) = match signal.green.clone() {
            Green::Windows { green_s } => (None, None, GreenText::Windows(green_s)),
            Green::Cycle {
                cycle_s,
                green_from_s,
                green_s,
            } => (
                Some(cycle_s),
                Some(green_from_s),
                GreenText::Lasting(green_s),
            ),
        };
        Self {
            position_m: signal.position_m,
            cycle_s,
            green_from_s,
            green_s,
        }
    }
}

/// A speed that is given in km/h or m/s.
fn speed_mps(
    entry: &str,
    keys: [&str; 2],
    kmh: Option<f64>,
    mps: Option<f64>,
) -> Result<Option<f64>, String> {
    once(entry, keys, kmh, mps)?;
    Ok(mps.or(kmh.map(|kmh| kmh / 3.6)))
}

fn once(
    entry: &str,
    keys: [&str; 2],
    first: Option<f64>,
    second: Option<f64>,
) -> Result<(), String> {
    match (first, second) {
        (Some(a), Some(b)) => Err(format!(
            "{entry}{} = {a} and {} = {b} are the same thing twice; give one of them",
            keys[0], keys[1]
        )),
        _ => Ok(()),
    }
}

fn given(entry: &str, keys: [&str; 2], value: Option<f64>) -> Result<f64, String> {
    let missing = || format!("{entry}it has no value; give {} or {}", keys[0], keys[1]);
    value.ok_or_else(missing)
}

/// In km/h, rounded, if that reads back the same, else in m/s.
pub(super) fn in_either(mps: f64) -> (Option<f64>, Option<f64>) {
    let kmh = (mps * 3.6 * 1e6).round() / 1e6;
    match (kmh / 3.6).to_bits() == mps.to_bits() {
        true => (Some(kmh), None),
        false => (None, Some(mps)),
    }
}
