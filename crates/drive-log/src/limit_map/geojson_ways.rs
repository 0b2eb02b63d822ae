//! Lines with limits out of GeoJSON (RFC 7946), with OpenStreetMap's tags.

use geojson::{Feature, GeoJson, GeometryValue, JsonObject, JsonValue};

use super::LIMIT_MPS;
use super::lines::{MapLines, MapPoint, PointKind, Way};
use crate::Error;

const KNOT_MPS: f64 = 1852.0 / 3600.0;
const MILE_PER_HOUR_MPS: f64 = 1609.344 / 3600.0;

/// Where tools put the tags of a way that are not at the top.
const TOGETHER: [&str; 2] = ["tags", "other_tags"];

impl MapLines {
    /// Reads GeoJSON (RFC 7946) as [`LimitMap::from_geojson`](super::LimitMap::from_geojson) does, and takes lines without properties as well.
    ///
    /// # Errors
    /// [`Error::Lines`], with the name of the file, for text that is no GeoJSON, without a line, or with an impossible position.
    pub fn from_geojson(name: &str, text: &str) -> Result<Self, Error> {
        parsed(text)
            .and_then(lines_of)
            .map_err(|reason| Error::Lines {
                file: name.to_owned(),
                reason,
            })
    }
}

/// The ways of a map with limits, and how many limits were no number; or what is wrong with the text.
pub(super) fn read(text: &str) -> Result<(Vec<Way>, usize), String> {
    let map = match parsed(text)? {
        GeoJson::Geometry(_) => return Err("lines without properties have no limits".to_owned()),
        map => lines_of(map)?,
    };
    Ok((map.ways, map.not_understood))
}

fn parsed(text: &str) -> Result<GeoJson, String> {
    let parsed = text.trim_start_matches('\u{feff}').parse();
    parsed.map_err(|error| format!("not GeoJSON: {error}"))
}

fn lines_of(map: GeoJson) -> Result<MapLines, String> {
    let features = match map {
        GeoJson::FeatureCollection(collection) => collection.features,
        GeoJson::Feature(feature) => vec![feature],
        GeoJson::Geometry(geometry) => vec![Feature {
            geometry: Some(geometry),
            ..Feature::default()
        }],
    };
    let mut map = MapLines::default();
    for feature in &features {
        let tags = Tags(feature);
        let plain = tags.limit("maxspeed", &mut map.not_understood);
        let forward = tags.limit("maxspeed:forward", &mut map.not_understood);
        let backward = tags.limit("maxspeed:backward", &mut map.not_understood);
        let way = Way {
            limits_mps: [forward.or(plain), backward.or(plain)],
            open: match tags.text("oneway").as_deref() {
                Some("yes" | "true" | "1") => [true, false],
                Some("-1" | "reverse") => [false, true],
                _ => [true, true],
            },
            ..Way::default()
        };
        for line in lines(feature) {
            map.ways.push(Way {
                positions_deg: positions(line)?,
                elevation_m: elevations(line),
                ..way.clone()
            });
        }
        map.points.extend(point(feature, &tags)?);
    }
    map.ways.retain(|way| way.positions_deg.len() >= 2);
    if map.ways.is_empty() {
        return Err("it has no line (LineString or MultiLineString)".to_owned());
    }
    Ok(map)
}

/// A node of OpenStreetMap that makes drivers stop.
fn point(feature: &Feature, tags: &Tags) -> Result<Option<MapPoint>, String> {
    let Some(GeometryValue::Point { coordinates }) = feature.geometry.as_ref().map(|g| &g.value)
    else {
        return Ok(None);
    };
    let (kind, own) = match tags.text("highway").as_deref() {
        Some("traffic_signals") => (PointKind::TrafficSignals, "traffic_signals:direction"),
        Some("stop") => (PointKind::Stop, "direction"),
        Some("give_way") => (PointKind::GiveWay, "direction"),
        _ => return Ok(None),
    };
    let valid = match tags.text(own).as_deref() {
        Some("forward") => [true, false],
        Some("backward") => [false, true],
        _ => [true, true],
    };
    Ok(Some(MapPoint {
        position_deg: position(coordinates.as_slice())?,
        kind,
        valid,
    }))
}

fn positions(line: &[geojson::Position]) -> Result<Vec<[f64; 2]>, String> {
    line.iter().map(|p| position(p.as_slice())).collect()
}

/// Third numbers; empty where no position has one.
fn elevations(line: &[geojson::Position]) -> Vec<f64> {
    if line.iter().all(|p| p.len() < 3) {
        return Vec::new();
    }
    let third = |p: &geojson::Position| p.as_slice().get(2).copied().unwrap_or(f64::NAN);
    line.iter().map(third).collect()
}

fn lines(feature: &Feature) -> Vec<&[geojson::Position]> {
    match feature.geometry.as_ref().map(|geometry| &geometry.value) {
        Some(GeometryValue::LineString { coordinates }) => vec![coordinates],
        Some(GeometryValue::MultiLineString { coordinates }) => {
            coordinates.iter().map(Vec::as_slice).collect()
        }
        _ => Vec::new(),
    }
}

fn position(numbers: &[f64]) -> Result<[f64; 2], String> {
    match *numbers {
        [east, north, ..] if east.abs() <= 180.0 && north.abs() <= 90.0 => Ok([east, north]),
        _ => Err(format!(
            "{numbers:?} is no position in degrees east and north"
        )),
    }
}

struct Tags<'a>(&'a Feature);

impl Tags<'_> {
    fn text(&self, key: &str) -> Option<String> {
        let properties = self.0.properties.as_ref()?;
        let together = || TOGETHER.iter().find_map(|of| properties.get(*of));
        let value = match JsonObject::get(properties, key) {
            Some(value) => value,
            None => match together()? {
                JsonValue::Object(tags) => tags.get(key)?,
                JsonValue::String(tags) => return of_hstore(tags, key),
                _ => return None,
            },
        };
        match value {
            JsonValue::String(text) => Some(text.trim().to_owned()),
            JsonValue::Null => None,
            other => Some(other.to_string()),
        }
    }

    fn limit(&self, key: &str, not_understood: &mut usize) -> Option<f64> {
        let text = self.text(key).filter(|text| !text.is_empty())?;
        let limit_mps = limit_mps(&text);
        *not_understood += usize::from(limit_mps.is_none());
        limit_mps
    }
}

/// The value of a key in `"maxspeed"=>"50","oneway"=>"yes"`, as GDAL writes what it has no field for.
fn of_hstore(tags: &str, key: &str) -> Option<String> {
    let (_, after) = tags.split_once(&format!("\"{key}\"=>\""))?;
    Some(after.split('"').next()?.trim().to_owned())
}

/// Kilometres per hour, unless a unit follows.
fn limit_mps(text: &str) -> Option<f64> {
    let unit_at = text
        .find(|c: char| !c.is_ascii_digit() && c != '.')
        .unwrap_or(text.len());
    let (number, unit) = text.split_at(unit_at);
    let number: f64 = number.parse().ok()?;
    let limit_mps = match unit.trim() {
        "" | "km/h" | "kmh" | "kph" => number / 3.6,
        "mph" => number * MILE_PER_HOUR_MPS,
        "knots" => number * KNOT_MPS,
        _ => return None,
    };
    LIMIT_MPS.contains(&limit_mps).then_some(limit_mps)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_are_found_where_gdal_puts_them() {
        let tags = r#""oneway"=>"yes","maxspeed"=>"30 mph""#;
        assert_eq!(of_hstore(tags, "maxspeed").as_deref(), Some("30 mph"));
        assert_eq!(of_hstore(tags, "speed"), None);
        assert_eq!(
            of_hstore("\"maxspeed\"=>\"", "maxspeed").as_deref(),
            Some("")
        );
    }

    #[test]
    fn limits_have_units_and_words_are_none() {
        let kmh = |text| limit_mps(text).map(|mps| (3.6 * mps * 100.0).round() / 100.0);
        assert_eq!(kmh("50"), Some(50.0));
        assert_eq!(kmh("7.5 km/h"), Some(7.5));
        assert_eq!(kmh("30 mph"), Some(48.28));
        for word in [
            "none", "DE:urban", "signals", "50;30", "", "-5", "0", "1e9", "50 30",
        ] {
            assert_eq!(kmh(word), None, "{word}");
        }
    }
}
