use driver_model::road::{Green, RoadFile, SlopeAt};
use speed_plan::{Leader, Road};

/// Signals are passed this long after they turn green, and before they turn red, s.
const SIGNAL_MARGIN_S: f64 = 1.0;

/// Cycles of signals are laid out for this long, s.
const HORIZON_S: f64 = 4.0 * 3600.0;

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
        let (windows, dropped) = windows(&signal.green);
        if dropped > 0 {
            findings.push(format!(
                "signal at {:.0} m: {dropped} green windows are shorter than the margins of {SIGNAL_MARGIN_S} s on both sides and are left out",
                signal.position_m
            ));
        }
        (signal.position_m, windows)
    });
    let signals = signals.collect();
    if let Some(limit) = file.limits.first()
        && file.start_speed_mps > limit.limit_mps
    {
        findings.push(format!(
            "the start at {:.1} km/h is above the limit of {:.1} km/h: the plan brakes down to it",
            3.6 * file.start_speed_mps,
            3.6 * limit.limit_mps
        ));
    }
    if file.elevation.is_empty() && file.slope.is_empty() {
        findings.push("the road has neither elevation nor slope and is taken as level".to_owned());
    }
    let elevation: Vec<(f64, f64)> = file
        .elevation
        .iter()
        .map(|at| (at.position_m, at.elevation_m))
        .collect();
    let slow_points = file.slow_points.iter().flatten();
    let road = Road {
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
    (road, findings)
}

/// Green windows within their margins, and how many had no room for them.
fn windows(green: &Green) -> (Vec<[f64; 2]>, usize) {
    let whole: Vec<[f64; 2]> = match green {
        Green::Windows { green_s } => green_s.clone(),
        Green::Cycle {
            cycle_s,
            green_from_s,
            green_s,
        } => {
            let first = (-green_from_s / cycle_s).floor() - 1.0;
            let count = (HORIZON_S / cycle_s).ceil() + 2.0;
            (0..count as usize)
                .map(|k| green_from_s + (first + k as f64) * cycle_s)
                .map(|from_s| [from_s, from_s + green_s])
                .collect()
        }
    };
    let count = whole.len();
    let within: Vec<[f64; 2]> = whole
        .into_iter()
        .map(|[from_s, to_s]| [from_s + SIGNAL_MARGIN_S, to_s - SIGNAL_MARGIN_S])
        .filter(|[from_s, to_s]| from_s < to_s)
        .collect();
    let dropped = count - within.len();
    (within, dropped)
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
