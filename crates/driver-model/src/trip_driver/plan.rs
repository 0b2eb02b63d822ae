use super::TripDriver;
use crate::road::Road;
use crate::road::limit::is_same_limit;

/// Drops of the wanted speed up to this are no event, m/s.
const LEAST_DROP_MPS: f64 = 0.01;

impl TripDriver {
    /// Speed at every node of a road, and the square of it is piecewise linear in between.
    pub(super) fn plan(&self, road: &Road, cap_mps: &[f64]) -> Vec<f64> {
        let wanted_mps = self.wanted_at(road.limit_mps());
        let mut ceiling = Ceiling::under(&wanted_mps, cap_mps, road.spacing_m());
        for (node, limited) in (1..).zip(wanted_mps.windows(2)) {
            let (before, wanted) = (limited[0], limited[1]);
            let drops = wanted < before - LEAST_DROP_MPS;
            for speed in [drops.then_some(wanted), Some(cap_mps[node])]
                .into_iter()
                .flatten()
            {
                // False for the infinite cap of most nodes.
                if before - speed > LEAST_DROP_MPS {
                    ceiling.brake(node, speed, self.braking().mps2(before - speed));
                }
            }
        }
        let mut square = ceiling.square;
        square[0] = square[0].min(road.start_speed_mps().powi(2));
        for node in 1..square.len() {
            if square[node] > square[node - 1] {
                let accel_mps2 = self
                    .acceleration()
                    .mps2(square[node - 1].sqrt(), wanted_mps[node - 1]);
                let reached = square[node - 1] + 2.0 * accel_mps2 * road.spacing_m();
                square[node] = square[node].min(reached);
            }
        }
        square.into_iter().map(f64::sqrt).collect()
    }

    fn wanted_at(&self, limit_mps: &[f64]) -> Vec<f64> {
        let mut last = (f64::NAN, f64::NAN);
        limit_mps
            .iter()
            .map(|&limit| {
                if !is_same_limit(last.0, limit) {
                    last = (limit, self.wanted().mps(limit));
                }
                last.1
            })
            .collect()
    }
}

/// Squared speeds that wanted speeds, caps and braking for what follows allow.
struct Ceiling {
    square: Vec<f64>,
    /// The gentlest braking whose curve touches a node.
    braking_mps2: Vec<f64>,
    spacing_m: f64,
    highest: f64,
}

impl Ceiling {
    fn under(wanted_mps: &[f64], cap_mps: &[f64], spacing_m: f64) -> Self {
        let lower = |(wanted, cap): (&f64, &f64)| wanted.min(*cap).powi(2);
        Self {
            square: wanted_mps.iter().zip(cap_mps).map(lower).collect(),
            braking_mps2: vec![f64::INFINITY; wanted_mps.len()],
            spacing_m,
            highest: wanted_mps.iter().copied().fold(0.0, f64::max).powi(2),
        }
    }

    /// Lowers what lies before an event. Where a gentler curve is lower already, it stays the lower one all the way.
    fn brake(&mut self, event: usize, speed_mps: f64, decel_mps2: f64) {
        let end = speed_mps.powi(2);
        if end <= self.square[event] {
            self.braking_mps2[event] = self.braking_mps2[event].min(decel_mps2);
        }
        for node in (0..event).rev() {
            let allowed = end + 2.0 * decel_mps2 * self.spacing_m * (event - node) as f64;
            if allowed >= self.highest {
                break;
            }
            if allowed < self.square[node] {
                self.square[node] = allowed;
                self.braking_mps2[node] = decel_mps2;
            } else if self.braking_mps2[node] <= decel_mps2 {
                break;
            }
        }
    }
}
