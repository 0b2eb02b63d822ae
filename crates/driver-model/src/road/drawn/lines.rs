//! Lines of a map chained into one road, with their limits and what stands on them.

use std::collections::{BTreeMap, BTreeSet};

use drive_log::limit_map::{MapLines, PointKind, Way, great_circle_m, place};

use super::track::Track;
use super::{Ends, counted, places};
use crate::road::{LimitFrom, RoadStop};

/// How long a car stands at a stop sign, s.
const STOP_SIGN_S: f64 = 2.0;

/// A line of the road, and whether the road leads against it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Link {
    way: usize,
    against: bool,
}

impl Link {
    /// Position where the road enters the line.
    fn start_deg(self, ways: &[Way]) -> [f64; 2] {
        let positions_deg = &ways[self.way].positions_deg;
        positions_deg[if self.against {
            positions_deg.len() - 1
        } else {
            0
        }]
    }

    fn end_deg(self, ways: &[Way]) -> [f64; 2] {
        self.turned().start_deg(ways)
    }

    fn turned(self) -> Self {
        Self {
            against: !self.against,
            ..self
        }
    }
}

/// A position in words.
pub(super) fn named(position_deg: [f64; 2]) -> String {
    format!(
        "{:.6}° east, {:.6}° north",
        position_deg[0], position_deg[1]
    )
}

/// Ends of lines by place: each the link that leaves there.
type Leaving = BTreeMap<[i64; 2], Vec<Link>>;

/// The lines in the order of the road, or why they are none.
pub(super) fn chained(ways: &[Way], findings: &mut Vec<String>) -> Result<Vec<Link>, String> {
    let mut leaving = Leaving::new();
    for way in 0..ways.len() {
        for against in [false, true] {
            let link = Link { way, against };
            leaving
                .entry(place(link.start_deg(ways)))
                .or_default()
                .push(link);
        }
    }
    let chain = match ways {
        [_] => vec![Link {
            way: 0,
            against: false,
        }],
        ways => {
            no_branch(ways, &leaving)?;
            let first = Link {
                way: 0,
                against: false,
            };
            let last = walked(ways, &leaving, first.turned())?.last().copied();
            walked(ways, &leaving, last.map_or(first, Link::turned))?
        }
    };
    if chain.len() < ways.len() {
        return Err(apart(ways, &leaving, &chain));
    }
    directed(ways, chain, findings)
}

fn no_branch(ways: &[Way], leaving: &Leaving) -> Result<(), String> {
    let Some(links) = leaving.values().find(|links| links.len() > 2) else {
        return Ok(());
    };
    Err(format!(
        "{} ends of lines meet at {}, so that the way is not known; keep the lines of one way",
        links.len(),
        named(links[0].start_deg(ways))
    ))
}

/// From a line on to where no other goes on.
fn walked(ways: &[Way], leaving: &Leaving, first: Link) -> Result<Vec<Link>, String> {
    let mut chain = vec![first];
    let mut last = first;
    loop {
        let here = leaving.get(&place(last.end_deg(ways)));
        let next = here
            .into_iter()
            .flatten()
            .find(|link| **link != last.turned());
        let Some(&next) = next else {
            return Ok(chain);
        };
        if chain.len() == ways.len() || next.way == first.way {
            return Err(format!(
                "the lines close, so that the road has no start; take out one line at {}",
                named(first.start_deg(ways))
            ));
        }
        chain.push(next);
        last = next;
    }
}

/// Why some lines are not in the chain.
fn apart(ways: &[Way], leaving: &Leaving, chain: &[Link]) -> String {
    let inside: BTreeSet<usize> = chain.iter().map(|link| link.way).collect();
    let loose = leaving.values().filter(|links| links.len() == 1).flatten();
    let loose = loose
        .filter(|link| !inside.contains(&link.way))
        .map(|link| link.start_deg(ways));
    let loose: Vec<[f64; 2]> = loose.collect();
    let of_chain = chain.iter().flat_map(|link| &ways[link.way].positions_deg);
    let passed: BTreeSet<[i64; 2]> = of_chain.map(|position| place(*position)).collect();
    if let Some(branch) = loose.iter().find(|end| passed.contains(&place(**end))) {
        return format!(
            "a line branches off within another at {}; take it out, or split the other there",
            named(*branch)
        );
    }
    let (Some(first), Some(last)) = (chain.first(), chain.last()) else {
        return "no lines".to_owned();
    };
    let ends = [first.start_deg(ways), last.end_deg(ways)];
    let gaps = loose
        .iter()
        .flat_map(|far| ends.map(|near| (great_circle_m(near, *far), near, *far)));
    match gaps.min_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((gap_m, near, far)) => format!(
            "the lines do not join: {gap_m:.1} m from {} to {}; add the line between, or take out what is not of the road",
            named(near),
            named(far)
        ),
        None => "some lines close and are not of the road; take them out".to_owned(),
    }
}

/// The other way round where one-way streets want it.
fn directed(
    ways: &[Way],
    chain: Vec<Link>,
    findings: &mut Vec<String>,
) -> Result<Vec<Link>, String> {
    let closed = |link: &&Link| !ways[link.way].open[usize::from(link.against)];
    let Some(forbidden) = chain.iter().find(closed).copied() else {
        return Ok(chain);
    };
    let turned: Vec<Link> = chain.into_iter().rev().map(Link::turned).collect();
    if let Some(other) = turned.iter().find(closed) {
        return Err(format!(
            "one-way lines of opposite directions, from {} and from {}; keep those of one direction",
            named(forbidden.end_deg(ways)),
            named(other.end_deg(ways))
        ));
    }
    findings.push("it leads against the first line, since lines are one-way".to_owned());
    Ok(turned)
}

/// All positions, those where lines meet once.
pub(super) fn track(ways: &[Way], chain: &[Link]) -> Track {
    let mut track = Track::default();
    for link in chain {
        let way = &ways[link.way];
        let unknown = vec![f64::NAN; way.positions_deg.len()];
        let elevation_m = if way.elevation_m.is_empty() {
            &unknown
        } else {
            &way.elevation_m
        };
        let points = way
            .positions_deg
            .iter()
            .copied()
            .zip(elevation_m.iter().copied());
        let mut points: Vec<([f64; 2], f64)> = points.collect();
        if link.against {
            points.reverse();
        }
        let met = usize::from(!track.positions_deg.is_empty());
        for (position_deg, elevation_m) in points.into_iter().skip(met) {
            track.positions_deg.push(position_deg);
            track.elevation_m.push(elevation_m);
        }
    }
    track
}

/// Where each line begins in the track.
fn starts<'a>(ways: &'a [Way], chain: &'a [Link]) -> impl Iterator<Item = usize> + 'a {
    chain.iter().scan(0, |start, link| {
        let here = *start;
        *start += ways[link.way].positions_deg.len() - 1;
        Some(here)
    })
}

/// Limits of the lines; one without has that of the line before, or at the start the first.
pub(super) fn limits(
    map: &MapLines,
    chain: &[Link],
    places_m: &[f64],
    findings: &mut Vec<String>,
) -> Vec<LimitFrom> {
    if map.not_understood > 0 {
        findings.push(format!(
            "limits that are no speed with a unit, such as `DE:urban` or `none`, and were not used: {}",
            map.not_understood
        ));
    }
    let of_link = |link: &Link| map.ways[link.way].limits_mps[usize::from(link.against)];
    let Some(first_mps) = chain.iter().find_map(of_link) else {
        findings.push("no limits: no line has a `maxspeed` that is a speed".to_owned());
        return Vec::new();
    };
    let starts: Vec<usize> = starts(&map.ways, chain).collect();
    let ends = starts[1..].iter().copied().chain([places_m.len() - 1]);
    let (mut limits, mut limit_mps, mut filled_m) = (Vec::<LimitFrom>::new(), first_mps, 0.0);
    for ((link, &start), end) in chain.iter().zip(&starts).zip(ends) {
        match of_link(link) {
            Some(known_mps) => limit_mps = known_mps,
            None => filled_m += places_m[end] - places_m[start],
        }
        if limits
            .last()
            .is_none_or(|last| last.limit_mps.to_bits() != limit_mps.to_bits())
        {
            limits.push(LimitFrom {
                position_m: places_m[start],
                limit_mps,
            });
        }
    }
    if filled_m > 0.0 {
        findings.push(format!(
            "{filled_m:.0} m have no limit: that of the line before is held there, at the start the first"
        ));
    }
    limits
}

/// Stop signs on the road; what else stands there is mentioned.
pub(super) fn stops(
    map: &MapLines,
    chain: &[Link],
    track: &Track,
    places_m: &[f64],
    findings: &mut Vec<String>,
) -> Vec<RoadStop> {
    let mut of_place: BTreeMap<[i64; 2], (f64, bool)> = BTreeMap::new();
    for (link, start) in chain.iter().zip(starts(&map.ways, chain)) {
        let vertices = start..start + map.ways[link.way].positions_deg.len();
        let positions_deg = &track.positions_deg[vertices.clone()];
        for (position_deg, place_m) in positions_deg.iter().zip(&places_m[vertices]) {
            of_place
                .entry(place(*position_deg))
                .or_insert((*place_m, link.against));
        }
    }
    let (mut stops_m, mut signals_m, mut signs_m, mut others) =
        (Vec::new(), Vec::new(), Vec::new(), 0);
    for point in &map.points {
        let on_road = of_place.get(&place(point.position_deg));
        match (
            on_road.filter(|(_, against)| point.valid[usize::from(*against)]),
            point.kind,
        ) {
            (None, _) => others += 1,
            (Some((place_m, _)), PointKind::Stop) => stops_m.push(*place_m),
            (Some((place_m, _)), PointKind::TrafficSignals) => signals_m.push(*place_m),
            (Some((place_m, _)), PointKind::GiveWay) => signs_m.push(*place_m),
        }
    }
    let ends = Ends {
        length_m: places_m.last().copied().unwrap_or(0.0),
        start_speed_mps: 0.0,
        end_speed_mps: 0.0,
    };
    stops_m.retain(|place_m| !ends.stands_at(*place_m));
    for positions_m in [&mut stops_m, &mut signals_m, &mut signs_m] {
        positions_m.sort_by(f64::total_cmp);
        positions_m.dedup();
    }
    mention(&stops_m, "stop sign", "taken as 2 s of standing", findings);
    let cure = "without times left out; add them as `signals` with `green_s`";
    mention(&signals_m, "traffic signal", cure, findings);
    mention(
        &signs_m,
        "give-way sign",
        "left out, since nobody has to stop there",
        findings,
    );
    if others > 0 {
        let others = counted(others, "point");
        findings.push(format!(
            "not on the road, or for the other direction: {others} left out"
        ));
    }
    let stop = |position_m| RoadStop {
        position_m,
        dwell_s: STOP_SIGN_S,
    };
    stops_m.into_iter().map(stop).collect()
}

fn mention(positions_m: &[f64], what: &str, done: &str, findings: &mut Vec<String>) {
    if !positions_m.is_empty() {
        let number = counted(positions_m.len(), what);
        findings.push(format!("{number} {} {done}", places(positions_m)));
    }
}
