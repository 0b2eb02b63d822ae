//! Lines with limits out of GeoJSON (RFC 7946), with OpenStreetMap's tags.

use geojson::{Feature, GeoJson, GeometryValue, JsonObject, JsonValue};

use super::{LIMIT_MPS, Way};

const KNOT_MPS: f64 = 1852.0 / 3600.0;
const MILE_PER_HOUR_MPS: f64 = 1609.344 / 3600.0;

/// Where tools put the tags of a way that are not at the top.
const TOGETHER: [&str; 2] = ["tags", "other_tags"];

/// The ways, and how many limits were no number; or what is wrong with the text.
pub(super) fn read(text: &str) -> Result<(Vec<Way>, usize), String> {
    let features = match text.trim_start_matches('\u{feff}').parse::<GeoJson>() {
        Ok(GeoJson::FeatureCollection(collection)) => collection.features,
        Ok(GeoJson::Feature(feature)) => vec![feature],
        Ok(GeoJson::Geometry(_)) => {
            return Err("lines without properties have no limits".to_owned());
        }
        Err(error) => return Err(format!("not GeoJSON: {error}")),
    };
    let (mut ways, mut not_understood) = (Vec::new(), 0);
    for feature in features {
        let tags = Tags(&feature);
        let plain = tags.limit("maxspeed", &mut not_understood);
        let forward = tags.limit("maxspeed:forward", &mut not_understood);
        let backward = tags.limit("maxspeed:backward", &mut not_understood);
        let way = Way {
            positions_deg: Vec::new(),
            limits_mps: [forward.or(plain), backward.or(plain)],
            open: match tags.text("oneway").as_deref() {
                Some("yes" | "true" | "1") => [true, false],
                Some("-1" | "reverse") => [false, true],
                _ => [true, true],
            },
        };
        for line in lines(&feature) {
            let positions_deg = line.iter().map(|p| position(p.as_slice()));
            ways.push(Way {
                positions_deg: positions_deg.collect::<Result<_, _>>()?,
                ..way.clone()
            });
        }
    }
    ways.retain(|way| way.positions_deg.len() >= 2);
    if ways.is_empty() {
        return Err("it has no line (LineString or MultiLineString)".to_owned());
    }
    Ok((ways, not_understood))
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
