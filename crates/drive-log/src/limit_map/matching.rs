//! The way under each position: the likeliest sequence of ways (after P. Newson and J. Krumm, Hidden Markov map matching through noise and
//! sparseness, 2009), told apart by distance and direction and by whether they meet.

use std::collections::BTreeMap;

use rstar::PointDistance as _;

use super::{LIMIT_MPS, LimitMap, LimitMatch};
use crate::{Channel, DriveLog};

/// Positions nearer to each other than this tell no direction, m; farther ones tell nothing of what lies between.
const SPACING_M: f64 = 10.0;
const BREAK_M: f64 = 300.0;

/// Ways farther away are none, m, and the deviation of a receiver.
const REACH_M: f64 = 40.0;
const DEVIATION_M: f64 = 8.0;

/// Negative logarithms of likelihoods: of driving at a right angle to a way, of going on to a way that does not meet the last one, or that
/// does, and of no way at all.
const ACROSS: f64 = 8.0;
const JUMP: f64 = 8.0;
const TURN: f64 = 1.0;
const NO_WAY: f64 = 10.0;

/// No crossing has more pieces near a position, and no more of what it may be on need to be told apart.
const MOST_PIECES: usize = 2000;
const MOST_STATES: usize = 40;

/// Limits that differ by less are the same: 1 km/h.
const SAME_MPS: f64 = 1.0 / 3.6;

/// What a position may be on: a way and whether it is driven against its line; `None` is no way.
type On = Option<(usize, bool)>;

/// Something that a position may be on, with the least cost of everything up to there and what that came from.
#[derive(Clone, Copy)]
struct State {
    on: On,
    cost: f64,
    before: usize,
}

/// Positions far enough from each other to tell a direction, and which of them counts for each sample.
struct Fixes {
    m: Vec<[f64; 2]>,
    of_sample: Vec<Option<usize>>,
}

impl LimitMap {
    /// The limit at every sample of a drive: that of the map, or where it has none the recorded one; NaN where neither is known.
    #[must_use]
    pub fn limits_along(&self, log: &DriveLog) -> (Vec<f64>, LimitMatch) {
        let fixes = self.fixes(log);
        let on = self.likeliest(&fixes.m);
        let recorded = log.channel(Channel::SpeedLimit);
        let mut limits_mps = recorded.map_or_else(|| vec![f64::NAN; log.len()], <[f64]>::to_vec);
        let (mut known, step_s) = (LimitMatch::default(), log.step_s());
        for (limit_mps, fix) in limits_mps.iter_mut().zip(&fixes.of_sample) {
            let Some(fix) = *fix else {
                known.no_position_s += step_s;
                continue;
            };
            let Some((way, against)) = on[fix] else {
                known.off_map_s += step_s;
                continue;
            };
            let Some(of_map_mps) = self.ways[way].limits_mps[usize::from(against)] else {
                known.without_limit_s += step_s;
                continue;
            };
            known.with_limit_s += step_s;
            if LIMIT_MPS.contains(limit_mps) {
                known.compared_s += step_s;
                let is_same = (*limit_mps - of_map_mps).abs() < SAME_MPS;
                known.agreeing_s += if is_same { step_s } else { 0.0 };
            }
            *limit_mps = of_map_mps;
        }
        (limits_mps, known)
    }

    fn fixes(&self, log: &DriveLog) -> Fixes {
        let mut fixes = Fixes {
            m: Vec::new(),
            of_sample: vec![None; log.len()],
        };
        let channels = (Channel::Longitude, Channel::Latitude);
        let (Some(east), Some(north)) = (log.channel(channels.0), log.channel(channels.1)) else {
            return fixes;
        };
        for (sample, (&east, &north)) in east.iter().zip(north).enumerate() {
            // A receiver without a fix reports zeros.
            if !east.is_finite() || !north.is_finite() || (east == 0.0 && north == 0.0) {
                continue;
            }
            let here = self.plane.m([east, north]);
            if fixes
                .m
                .last()
                .is_none_or(|last| distance_m(*last, here) >= SPACING_M)
            {
                fixes.m.push(here);
            }
            fixes.of_sample[sample] = Some(fixes.m.len() - 1);
        }
        fixes
    }

    /// The sequence with the least cost (Viterbi).
    fn likeliest(&self, fixes_m: &[[f64; 2]]) -> Vec<On> {
        let mut states: Vec<Vec<State>> = Vec::with_capacity(fixes_m.len());
        for (k, &here) in fixes_m.iter().enumerate() {
            let far = |other: [f64; 2]| distance_m(other, here) > BREAK_M;
            let before = k.checked_sub(1).map(|k| fixes_m[k]).filter(|m| !far(*m));
            let after = fixes_m.get(k + 1).copied().filter(|m| !far(*m));
            let along = direction(before.unwrap_or(here), after.unwrap_or(here));
            let mut now = self.candidates(here, along);
            if let (Some(earlier), true) = (states.last(), before.is_some()) {
                for state in &mut now {
                    let (cost, before) = self.cheapest(earlier, state.on);
                    state.cost += cost;
                    state.before = before;
                }
            } else if let Some(earlier) = states.last() {
                let (cost, before) = least(earlier.iter().map(|state| state.cost));
                for state in &mut now {
                    state.cost += cost;
                    state.before = before;
                }
            }
            states.push(now);
        }
        let mut on = vec![None; states.len()];
        let Some(last) = states.last() else {
            return on;
        };
        let (_, mut state) = least(last.iter().map(|state| state.cost));
        for (k, states) in states.iter().enumerate().rev() {
            on[k] = states[state].on;
            state = states[state].before;
        }
        on
    }

    /// What a position driven in this direction may be on, with what that alone costs: the cheapest, where there are many.
    fn candidates(&self, here_m: [f64; 2], along: Option<[f64; 2]>) -> Vec<State> {
        let mut costs: BTreeMap<(usize, bool), f64> = BTreeMap::new();
        let near = self
            .pieces
            .locate_within_distance(here_m, REACH_M * REACH_M);
        for piece in near.take(MOST_PIECES) {
            let way = piece.data;
            let line = direction(piece.geom().from, piece.geom().to);
            let off = piece.geom().distance_2(&here_m) / (2.0 * DEVIATION_M * DEVIATION_M);
            for against in [false, true] {
                if !self.ways[way].open[usize::from(against)] {
                    continue;
                }
                let cosine = line.zip(along).map_or(1.0, |(line, along)| {
                    let cosine = line[0] * along[0] + line[1] * along[1];
                    if against { -cosine } else { cosine }
                });
                let cost = off + ACROSS * (1.0 - cosine);
                let least = costs.entry((way, against)).or_insert(cost);
                *least = least.min(cost);
            }
        }
        let ways = costs.into_iter().map(|(on, cost)| (Some(on), cost));
        let mut states: Vec<State> = std::iter::once((None, NO_WAY))
            .chain(ways)
            .map(|(on, cost)| State {
                on,
                cost,
                before: 0,
            })
            .collect();
        states.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        states.truncate(MOST_STATES);
        states
    }

    /// What coming here costs from where it costs least.
    fn cheapest(&self, earlier: &[State], on: On) -> (f64, usize) {
        least(earlier.iter().map(|before| {
            let change = match (before.on, on) {
                (before, on) if before == on => 0.0,
                (Some((before, _)), Some((way, _))) if before != way && self.meet(before, way) => {
                    TURN
                }
                (Some(_), Some(_)) => JUMP,
                _ => TURN,
            };
            before.cost + change
        }))
    }

    fn meet(&self, a: usize, b: usize) -> bool {
        self.meeting[a].binary_search(&b).is_ok()
    }
}

/// The least of some costs, and which it is.
fn least(costs: impl Iterator<Item = f64>) -> (f64, usize) {
    let numbered = costs.enumerate().map(|(number, cost)| (cost, number));
    numbered
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((0.0, 0))
}

fn distance_m(a: [f64; 2], b: [f64; 2]) -> f64 {
    f64::hypot(b[0] - a[0], b[1] - a[1])
}

/// Unit vector; `None` between equal places.
fn direction(from: [f64; 2], to: [f64; 2]) -> Option<[f64; 2]> {
    let length = distance_m(from, to);
    (length > 0.0).then(|| [(to[0] - from[0]) / length, (to[1] - from[1]) / length])
}
