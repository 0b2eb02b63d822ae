use super::InteriorPoint;
use super::task::TimeBound;
use crate::tridiagonal::{Tridiagonal, solve_dense};

/// A Newton step.
#[derive(Debug, Default)]
pub(super) struct Direction {
    pub(super) z: Vec<f64>,
    pub(super) waits: Vec<f64>,
    /// New multipliers of the time bounds.
    pub(super) multipliers: Vec<f64>,
    /// Half of it is what the quadratic model gains, J.
    pub(super) decrement_j: f64,
}

#[derive(Default)]
pub(super) struct Newton {
    matrix: Tridiagonal,
    gradient: Vec<f64>,
}

impl Newton {
    pub(super) fn direction(&mut self, ip: &InteriorPoint) -> Direction {
        let nodes = ip.z.len();
        self.assemble(ip);
        self.matrix.factorise();
        let mut step = self.gradient.iter().map(|g| -g).collect::<Vec<_>>();
        self.matrix.solve(&mut step);

        let mu = ip.barrier_j;
        // Waits are diagonal.
        let wait_h: Vec<f64> = ip.waits.iter().map(|w| w.multiplier / w.slack).collect();
        let wait_g: Vec<f64> = ip
            .task
            .waits
            .iter()
            .zip(&ip.waits)
            .map(|(node, wait)| {
                ip.problem.standing_power_w(*node) + ip.task.price_w - mu / wait.slack
            })
            .collect();
        let mut waits: Vec<f64> = wait_g.iter().zip(&wait_h).map(|(g, h)| -g / h).collect();

        let borders: Vec<Vec<f64>> = ip
            .task
            .time_bounds
            .iter()
            .map(|bound| {
                let mut gradient = vec![0.0; nodes];
                for k in 0..bound.node {
                    gradient[k] += ip.steps[k].time_gradient[0];
                    gradient[k + 1] += ip.steps[k].time_gradient[1];
                }
                for (g, fixed) in gradient.iter_mut().zip(&ip.fixed) {
                    *g = if *fixed { 0.0 } else { bound.sign() * *g };
                }
                gradient
            })
            .collect();
        let wait_border = |bound: &TimeBound, wait: usize| {
            if bound.includes_wait_at(ip.task.waits[wait]) {
                bound.sign()
            } else {
                0.0
            }
        };
        let solved: Vec<Vec<f64>> = borders
            .iter()
            .map(|border| {
                let mut x = border.clone();
                self.matrix.solve(&mut x);
                x
            })
            .collect();
        let count = borders.len();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut schur = vec![0.0; count * count];
        let mut multipliers = vec![0.0; count];
        for i in 0..count {
            let bound = &ip.task.time_bounds[i];
            let pair = ip.times[i];
            let residual = bound.sign() * (ip.passing_time(bound) - bound.time_s) + pair.slack;
            for j in 0..=i {
                let other = &ip.task.time_bounds[j];
                let by_waits: f64 = (0..waits.len())
                    .map(|w| wait_border(bound, w) * wait_border(other, w) / wait_h[w])
                    .sum();
                schur[i * count + j] = dot(&borders[i], &solved[j]) + by_waits;
                schur[j * count + i] = schur[i * count + j];
            }
            schur[i * count + i] += pair.slack / pair.multiplier;
            let by_waits: f64 = (0..waits.len())
                .map(|w| wait_border(bound, w) * waits[w])
                .sum();
            multipliers[i] = dot(&borders[i], &step) + by_waits + residual + mu / pair.multiplier;
        }
        if !solve_dense(&mut schur, &mut multipliers) {
            multipliers = ip.times.iter().map(|pair| pair.multiplier).collect();
        }
        for (multiplier, solved) in multipliers.iter().zip(&solved) {
            for (step, solved) in step.iter_mut().zip(solved) {
                *step -= multiplier * solved;
            }
        }
        for (w, wait) in waits.iter_mut().enumerate() {
            let bounds = ip.task.time_bounds.iter().zip(&multipliers);
            let pull: f64 = bounds.map(|(bound, m)| wait_border(bound, w) * m).sum();
            *wait -= pull / wait_h[w];
        }
        // Slope of the merit along the step, at the new multipliers.
        let mut slope = dot(&self.gradient, &step) + dot(&wait_g, &waits);
        for (i, multiplier) in multipliers.iter().enumerate() {
            let bound = &ip.task.time_bounds[i];
            let by_waits: f64 = (0..waits.len())
                .map(|w| wait_border(bound, w) * waits[w])
                .sum();
            slope += multiplier * (dot(&borders[i], &step) + by_waits);
        }
        Direction {
            z: step,
            waits,
            multipliers,
            decrement_j: -slope,
        }
    }

    fn assemble(&mut self, ip: &InteriorPoint) {
        let nodes = ip.z.len();
        let mu = ip.barrier_j;
        self.matrix.clear(nodes);
        self.gradient.clear();
        self.gradient.resize(nodes, 0.0);
        let price = ip.prices(ip.times.iter().map(|pair| pair.multiplier));
        for (k, (step, price_w)) in ip.steps.iter().zip(&price).enumerate() {
            let e = step.energy_hessian;
            let t = step.time_hessian;
            let mut h = semidefinite([0, 1, 2].map(|i| e[i] + price_w * t[i]));
            let mut g =
                [0, 1].map(|i| step.energy_gradient[i] + ip.task.price_w * step.time_gradient[i]);
            for bound in ip.bounds[k]
                .iter()
                .filter(|bound| bound.active && bound.slack > 0.0)
            {
                let weight = bound.multiplier / bound.slack;
                let [g0, g1] = bound.gradient;
                h[0] += weight * g0 * g0;
                h[1] += weight * g0 * g1;
                h[2] += weight * g1 * g1;
                g[0] -= mu / bound.slack * g0;
                g[1] -= mu / bound.slack * g1;
            }
            self.matrix.diagonal[k] += h[0];
            self.matrix.diagonal[k + 1] += h[2];
            self.matrix.off[k] = h[1];
            self.gradient[k] += g[0];
            self.gradient[k + 1] += g[1];
        }
        for k in 0..nodes {
            if ip.fixed[k] {
                self.matrix.diagonal[k] = 1.0;
                self.gradient[k] = 0.0;
                if k > 0 {
                    self.matrix.off[k - 1] = 0.0;
                }
                if k + 1 < nodes {
                    self.matrix.off[k] = 0.0;
                }
                continue;
            }
            let room = [
                ip.z[k] - ip.reachable.low[k],
                ip.reachable.high[k] - ip.z[k],
            ];
            let [low, high] = ip.speed_multiplier[k];
            self.matrix.diagonal[k] += low / room[0] + high / room[1] + 1e-12;
            self.gradient[k] += mu / room[1] - mu / room[0];
        }
    }
}

/// The nearest positive semidefinite matrix to `[00, 01, 11]`.
#[inline(always)]
fn semidefinite(h: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = h;
    if a >= 0.0 && c >= 0.0 && a * c >= b * b {
        return h;
    }
    let (middle, half) = (0.5 * (a + c), 0.5 * (a - c));
    let radius = (half * half + b * b).sqrt();
    let larger = middle + radius;
    if larger <= 0.0 {
        return [0.0; 3];
    }
    // larger · v vᵀ with the unit eigenvector v: (I + [half, b; b, −half]/radius)/2.
    let scale = 0.5 * larger / radius;
    [scale * (radius + half), scale * b, scale * (radius - half)]
}
