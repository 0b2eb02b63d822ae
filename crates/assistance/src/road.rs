use driver_model::road::{Green, RoadFile, SlopeAt};
use speed_plan::{Leader, Road};

/// Signals are passed this long after they turn green, and before they turn red, s.
const SIGNAL_MARGIN_S: f64 = 1.0;

/// Cycles of signals are laid out for this long beyond stands, the leader and the way to the signal at [`SLOW_MPS`], s.
const HORIZON_S: f64 = 4.0 * 3600.0;
const SLOW_MPS: f64 = 5.0;

/// Green windows of all signals, at most.
const MOST_WINDOWS: usize = 1_000_000;

/// A green that never ends, s.
const ALWAYS_S: [f64; 2] = [-1e9, 1e9];

/// A slope that changes over distance is summed in pieces of this length, m.
const PIECE_M: f64 = 10.0;

/// What a road file does not say of a trip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadSettings {
    /// Slowest speed where the car does not stand, m/s.
    pub slowest_mps: f64,
    /// Gap to a standing leader, m.
    pub standstill_gap_m: f64,
    /// Time headway to the leader, s.
    pub headway_s: f64,
}

impl Default for RoadSettings {
    fn default() -> Self {
        Self {
            slowest_mps: 0.5,
            standstill_gap_m: 2.0,
            headway_s: 1.5,
        }
    }
}

/// A road as the planner takes it, and what had to be changed or left out.
#[must_use]
pub fn planned_road(file: &RoadFile, settings: &RoadSettings) -> (Road, Vec<String>) {
    let mut findings = Vec::new();
    let signals = file.signals.iter().map(|signal| {
        let until_s = horizon_s(file, signal.position_m);
        let most = (MOST_WINDOWS / file.signals.len()).max(2);
        let at_m = signal.position_m;
        let (windows, dropped, laid_until_s) = windows(&signal.green, until_s, most);
        if dropped > 0 {
            findings.push(format!(
                "signal at {at_m:.0} m: {dropped} green windows are shorter than the margins of {SIGNAL_MARGIN_S} s on both sides and are left out"
            ));
        }
        if laid_until_s < until_s {
            findings.push(format!(
                "signal at {at_m:.0} m: its cycles are laid out for the first {laid_until_s:.0} s, after which it stays red"
            ));
        }
        (at_m, windows)
    });
    let signals = signals.collect();
    if file.elevation.is_empty() && file.slope.is_empty() {
        findings.push("the road has neither elevation nor slope and is taken as level".to_owned());
    }
    let elevation: Vec<(f64, f64)> = file
        .elevation
        .iter()
        .map(|at| (at.position_m, at.elevation_m))
        .collect();
    let slow_points = file.slow_points.iter().flatten();
    let mut road = Road {
        length_m: file.length_m,
        start_mps: file.start_speed_mps,
        end_mps: file.end_speed_mps,
        slowest_mps: settings.slowest_mps,
        limits: file
            .limits
            .iter()
            .map(|l| (l.position_m, l.limit_mps))
            .collect(),
        stops: file
            .stops
            .iter()
            .map(|s| (s.position_m, s.dwell_s))
            .collect(),
        slow_points: slow_points.map(|p| (p.position_m, p.speed_mps)).collect(),
        curves: file
            .curves
            .iter()
            .map(|c| [c.from_m, c.to_m, c.radius_m])
            .collect(),
        elevation: if file.slope.is_empty() {
            elevation
        } else {
            climbed(&file.slope, file.length_m)
        },
        signals,
        leader: (!file.leader.is_empty()).then(|| Leader {
            positions: file
                .leader
                .iter()
                .map(|at| (at.time_s, at.position_m))
                .collect(),
            standstill_gap_m: settings.standstill_gap_m,
            headway_s: settings.headway_s,
        }),
    };
    findings.extend(within_limits(&mut road));
    (road, findings)
}

/// An end above what is allowed there is lowered to it; a start gives way to it by braking. Says so.
fn within_limits(road: &mut Road) -> Vec<String> {
    // What is wrong with a road is said when its columns are laid.
    let Ok([start_mps, end_mps]) = road.end_limits_mps() else {
        return Vec::new();
    };
    let mut findings = Vec::new();
    let kmh = |mps: f64| format!("{:.1} km/h", 3.6 * mps);
    if road.start_mps > start_mps {
        findings.push(format!(
            "the start at {} is above the {} that are allowed there: the plan brakes down to them",
            kmh(road.start_mps),
            kmh(start_mps)
        ));
    }
    if road.end_mps > end_mps {
        findings.push(format!(
            "the end at {} is above the {} that are allowed there: the plan ends at these",
            kmh(road.end_mps),
            kmh(end_mps)
        ));
        road.end_mps = end_mps;
    }
    findings
}

/// Until when a plan may want to pass a position, s.
fn horizon_s(file: &RoadFile, position_m: f64) -> f64 {
    let stands_s: f64 = file.stops.iter().map(|stop| stop.dwell_s).sum();
    let led_s = file.leader.last().map_or(0.0, |at| at.time_s.max(0.0));
    HORIZON_S + stands_s + led_s + position_m / SLOW_MPS
}

/// Green windows within their margins, how many had no room for them, and until when they are laid out.
fn windows(green: &Green, until_s: f64, most: usize) -> (Vec<[f64; 2]>, usize, f64) {
    let (whole, laid_until_s) = match *green {
        Green::Windows { ref green_s } => (joined(green_s), until_s),
        Green::Cycle {
            cycle_s, green_s, ..
        } if green_s >= cycle_s => (vec![ALWAYS_S], until_s),
        Green::Cycle {
            cycle_s,
            green_from_s,
            green_s,
        } => {
            let first = (-green_from_s / cycle_s).floor() - 1.0;
            // The first two begin before the trip.
            let count = ((until_s / cycle_s).ceil() + 2.0).min(most as f64);
            let from_s = |k: usize| green_from_s + (first + k as f64) * cycle_s;
            let windows = (0..count as usize).map(|k| [from_s(k), from_s(k) + green_s]);
            (windows.collect(), from_s(count as usize))
        }
    };
    let count = whole.len();
    let within: Vec<[f64; 2]> = whole
        .into_iter()
        .map(|[from_s, to_s]| [from_s + SIGNAL_MARGIN_S, to_s - SIGNAL_MARGIN_S])
        .filter(|[from_s, to_s]| from_s < to_s)
        .collect();
    let dropped = count - within.len();
    (within, dropped, laid_until_s)
}

/// Windows of which one begins where the one before ends are one: between them the light does not change.
fn joined(green_s: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut joined: Vec<[f64; 2]> = Vec::with_capacity(green_s.len());
    for &[from_s, to_s] in green_s {
        match joined.last_mut() {
            Some(last) if from_s <= last[1] => last[1] = to_s,
            _ => joined.push([from_s, to_s]),
        }
    }
    joined
}

/// Elevation over distance of a slope that is linear between its points.
fn climbed(slope: &[SlopeAt], length_m: f64) -> Vec<(f64, f64)> {
    let at = |position_m: f64| {
        let after = slope.partition_point(|point| point.position_m <= position_m);
        match (after.checked_sub(1).map(|k| &slope[k]), slope.get(after)) {
            (Some(a), Some(b)) => {
                let share = (position_m - a.position_m) / (b.position_m - a.position_m);
                a.slope_rad + share * (b.slope_rad - a.slope_rad)
            }
            (Some(point), None) | (None, Some(point)) => point.slope_rad,
            (None, None) => 0.0,
        }
    };
    let pieces = (length_m / PIECE_M).ceil().max(1.0);
    let step_m = length_m / pieces;
    let mut elevation_m = 0.0;
    let mut points = vec![(0.0, 0.0)];
    for k in 0..pieces as usize {
        let middle_m = (k as f64 + 0.5) * step_m;
        elevation_m += at(middle_m).tan() * step_m;
        points.push(((k as f64 + 1.0) * step_m, elevation_m));
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cycle(cycle_s: f64, green_from_s: f64, green_s: f64) -> Green {
        Green::Cycle {
            cycle_s,
            green_from_s,
            green_s,
        }
    }

    #[test]
    fn a_margin_is_kept_where_the_light_changes_and_nowhere_else() {
        let touching = Green::Windows {
            green_s: vec![[0.0, 100.0], [100.0, 300.0], [301.0, 302.0]],
        };
        assert_eq!(windows(&touching, 1e4, 9), (vec![[1.0, 299.0]], 1, 1e4));
        let (always, dropped, _) = windows(&cycle(60.0, 5.0, 60.0), 1e4, 9);
        assert_eq!((always.len(), dropped), (1, 0));
        assert!(always[0][0] < -1e8 && always[0][1] > 1e8);
    }

    #[test]
    fn cycles_cover_the_trip_within_a_number_of_windows() {
        for from_s in [-1e9, -7.0, 0.0, 15.0, 1e9] {
            let (laid, _, until_s) = windows(&cycle(60.0, from_s, 30.0), 3600.0, 1000);
            assert!(laid[0][0] < 0.0 && until_s >= 3600.0, "{from_s}: {laid:?}");
            assert!(laid.len() <= 62, "{}", laid.len());
        }
        let (laid, _, until_s) = windows(&cycle(4.0, 0.0, 3.0), 1e9, 1000);
        assert!(laid.len() == 1000 && until_s < 4000.0);
    }
}
