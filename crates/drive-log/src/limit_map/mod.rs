//! Speed limits of a map, found along a drive by its positions.

mod geojson_ways;
mod lines;
mod matching;
#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests;

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fmt;
use std::ops::RangeInclusive;
use std::path::Path;

use rstar::RTree;
use rstar::primitives::{GeomWithData, Line};
use serde::Serialize;

use crate::collection::SourcedDrive;
use crate::longitude::turned_deg;
use crate::{Channel, Error};
pub use lines::{MapLines, MapPoint, PointKind, Way, great_circle_m, place};

/// Limits on roads: to 400 km/h.
const LIMIT_MPS: RangeInclusive<f64> = 0.5..=400.0 / 3.6;

/// Mean radius of the earth, m.
const EARTH_RADIUS_M: f64 = 6_371_008.8;

/// Positions are the same to the seventh digit, as OpenStreetMap keeps them.
const PLACES_PER_DEG: f64 = 1e7;
const PLACES_AROUND: i64 = 3_600_000_000;

/// More ways than this meet nowhere.
const MOST_AT_A_PLACE: usize = 64;

/// Ways with speed limits, as maps have them.
#[derive(Debug, Clone)]
pub struct LimitMap {
    plane: Plane,
    ways: Vec<Way>,
    pieces: RTree<Piece>,
    /// For each way those that it shares a position with, ascending.
    meeting: Vec<Vec<usize>>,
    not_understood: usize,
}

/// One straight piece of a way, with the number of the way.
type Piece = GeomWithData<Line<[f64; 2]>, usize>;

/// How much of a drive a map knows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct LimitMatch {
    /// Time on ways with a limit.
    pub with_limit_s: f64,
    /// Time on ways whose limit the map does not say.
    pub without_limit_s: f64,
    /// Time away from all ways.
    pub off_map_s: f64,
    /// Time without a position.
    pub no_position_s: f64,
    /// Time with a limit from the map and one that was recorded.
    pub compared_s: f64,
    /// Part of it in which both are the same to 1 km/h.
    pub agreeing_s: f64,
}

/// A map as a document lists it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LimitMapUse {
    /// The file, as it was named.
    pub path: String,
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
    /// Lines.
    pub ways: usize,
    /// Limits whose value is no number with a unit, or none that a road has.
    pub not_understood: usize,
    /// How much of the drives it knows.
    #[serde(flatten)]
    pub known: LimitMatch,
}

impl LimitMapUse {
    /// Reads a map and gives drives its limits.
    ///
    /// # Errors
    /// [`Error::Read`] where the file cannot be read, and those of [`LimitMap::from_geojson`] and [`LimitMap::lay_under`].
    pub fn of_file(path: &Path, drives: &mut [SourcedDrive]) -> Result<Self, Error> {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|problem| Error::Read {
            path: path.to_owned(),
            problem,
        })?;
        let map = LimitMap::from_geojson(&name, &text)?;
        Ok(Self {
            sha256: crate::sha256(text.as_bytes()),
            path: name,
            ways: map.ways(),
            not_understood: map.not_understood(),
            known: map.lay_under(drives)?,
        })
    }
}

/// What was found, in a sentence.
impl fmt::Display for LimitMapUse {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known = &self.known;
        let pct = |part_s: f64, of_s: f64| 100.0 * part_s / of_s.max(f64::MIN_POSITIVE);
        let of_time = |part_s| pct(part_s, known.duration_s());
        write!(
            f,
            "speed limits of `{}` for {:.1} % of the time; there it counts before what was recorded. {:.1} % are on lines without a limit, {:.1} % \
             off every line, {:.1} % without a position",
            self.path,
            of_time(known.with_limit_s),
            of_time(known.without_limit_s),
            of_time(known.off_map_s),
            of_time(known.no_position_s),
        )?;
        if known.with_limit_s <= 0.0 {
            let why = if known.no_position_s >= known.duration_s() {
                "logs need latitude_deg and longitude_deg"
            } else if known.without_limit_s > 0.0 {
                "the lines under the drives have no `maxspeed`"
            } else {
                "the map is of another place, or has latitude before longitude"
            };
            write!(f, "; it gave nothing: {why}")?;
        }
        if known.compared_s > 0.0 {
            let agreeing = pct(known.agreeing_s, known.compared_s);
            write!(
                f,
                "; map and log agree in {agreeing:.1} % of the time in which both know a limit"
            )?;
        }
        if self.not_understood > 0 {
            write!(
                f,
                "; limits that are no speed of a road and were not used: {}",
                self.not_understood
            )?;
        }
        Ok(())
    }
}

impl LimitMatch {
    /// All times added.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            with_limit_s: self.with_limit_s + other.with_limit_s,
            without_limit_s: self.without_limit_s + other.without_limit_s,
            off_map_s: self.off_map_s + other.off_map_s,
            no_position_s: self.no_position_s + other.no_position_s,
            compared_s: self.compared_s + other.compared_s,
            agreeing_s: self.agreeing_s + other.agreeing_s,
        }
    }

    /// Time in all.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.with_limit_s + self.without_limit_s + self.off_map_s + self.no_position_s
    }
}

impl LimitMap {
    /// Reads GeoJSON: lines with `maxspeed`, `maxspeed:forward`, `maxspeed:backward` and `oneway` as OpenStreetMap has them (km/h, or with
    /// `mph` or `knots`). Other values, such as `none`, `signals` or `DE:urban`, are no limit, see
    /// [`not_understood`](Self::not_understood); what is no line is passed over.
    ///
    /// # Errors
    /// [`Error::LimitMap`], with the name of the map, for text that is no GeoJSON, without a line, or with an impossible position.
    pub fn from_geojson(name: &str, text: &str) -> Result<Self, Error> {
        let (ways, not_understood) =
            geojson_ways::read(text).map_err(|reason| Error::LimitMap {
                map: name.to_owned(),
                reason,
            })?;
        let plane = Plane::around(ways.iter().flat_map(|way| &way.positions_deg));
        let piece = |(number, way): (usize, &Way)| -> Vec<Piece> {
            let ends = way.positions_deg.windows(2);
            let line = |ends: &[[f64; 2]]| Line::new(plane.m(ends[0]), plane.m(ends[1]));
            ends.map(|ends| GeomWithData::new(line(ends), number))
                .collect()
        };
        Ok(Self {
            plane,
            pieces: RTree::bulk_load(ways.iter().enumerate().flat_map(piece).collect()),
            meeting: meeting(&ways),
            ways,
            not_understood,
        })
    }

    /// Gives every piece of some drives the limits along it, see [`limits_along`](Self::limits_along), and says how much of them the map knows.
    ///
    /// # Errors
    /// Those of [`crate::DriveLog::with`].
    pub fn lay_under(&self, drives: &mut [SourcedDrive]) -> Result<LimitMatch, Error> {
        let mut known = LimitMatch::default();
        for piece in drives.iter_mut().flat_map(|drive| &mut drive.drive.pieces) {
            let (limits_mps, of_piece) = self.limits_along(piece);
            known = known.and(of_piece);
            if limits_mps.iter().any(|limit| limit.is_finite()) {
                *piece = piece.with(Channel::SpeedLimit, limits_mps)?;
            }
        }
        Ok(known)
    }

    /// Lines.
    #[must_use]
    pub fn ways(&self) -> usize {
        self.ways.len()
    }

    /// Limits whose value is no number with a unit.
    #[must_use]
    pub fn not_understood(&self) -> usize {
        self.not_understood
    }
}

/// For each way those that share a position with it.
fn meeting(ways: &[Way]) -> Vec<Vec<usize>> {
    let mut at: BTreeMap<[i64; 2], Vec<usize>> = BTreeMap::new();
    for (number, way) in ways.iter().enumerate() {
        for position in &way.positions_deg {
            at.entry(place(*position)).or_default().push(number);
        }
    }
    let mut meeting = vec![Vec::new(); ways.len()];
    for ways in at.values().filter(|ways| ways.len() <= MOST_AT_A_PLACE) {
        for &a in ways {
            meeting[a].extend(ways.iter().filter(|b| **b != a));
        }
    }
    for ways in &mut meeting {
        ways.sort_unstable();
        ways.dedup();
    }
    meeting
}

/// Degrees to metres around a place: to a fifteenth within 300 km of its parallel at 50° north.
#[derive(Debug, Clone, Copy)]
struct Plane {
    origin_deg: [f64; 2],
    m_per_deg: [f64; 2],
}

impl Plane {
    /// Around the middle of positions, whichever side of 180° they are on.
    fn around<'a>(positions_deg: impl Iterator<Item = &'a [f64; 2]>) -> Self {
        let mut ends = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        let mut first = None;
        for &[east, north] in positions_deg {
            let position = [turned_deg(east, *first.get_or_insert(east)), north];
            for axis in 0..2 {
                ends[0][axis] = ends[0][axis].min(position[axis]);
                ends[1][axis] = ends[1][axis].max(position[axis]);
            }
        }
        let origin_deg = [0, 1].map(|axis| 0.5 * (ends[0][axis] + ends[1][axis]));
        let m_per_deg = EARTH_RADIUS_M * PI / 180.0;
        Self {
            origin_deg,
            m_per_deg: [m_per_deg * origin_deg[1].to_radians().cos(), m_per_deg],
        }
    }

    fn m(&self, position_deg: [f64; 2]) -> [f64; 2] {
        let [east, north] = position_deg;
        let position_deg = [turned_deg(east, self.origin_deg[0]), north];
        [0, 1].map(|axis| (position_deg[axis] - self.origin_deg[axis]) * self.m_per_deg[axis])
    }
}
