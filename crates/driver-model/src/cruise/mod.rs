//! How a driver holds a speed: an offset from the limit with correlated variation.
//!
//! Within a stretch of cruising under the limit `L` the speed is `v(t) = L + β + b + x(t)`: the driver's bias `β`, an offset
//! `b ~ N(0, σ_b²)` that differs from stretch to stretch, and an Ornstein–Uhlenbeck process `x` with the deviation `σ` and the
//! correlation time `τ`, `E[x(t)x(t + h)] = σ² e^(−h/τ)`. From the speed at its beginning, `μ = L + β`,
//!
//! ```text
//! E[v(t)|v0] = μ + ρ(t)(v0 − μ)           ρ(t) = (σ_b² + σ² e^(−t/τ))/(σ_b² + σ²)
//! Var[v(t)|v0] = (σ_b² + σ²)(1 − ρ(t)²)
//! ```
//!
//! Without a limit `μ` is unknown, which is `σ_b → ∞`: `E[v(t)|v0] = v0` and `Var = 2σ²(1 − e^(−t/τ))`.

mod errors;
mod stretch;

pub use errors::CruiseErrors;
pub use stretch::{CruiseSettings, CruiseStretch, cruise_stretches};

use serde::{Deserialize, Serialize};

use crate::Error;

/// The bias, its spread and the variation of the speed while cruising.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CruiseModel {
    /// Bias to the limit `β` and its spread between stretches `σ_b`; `None` where no stretch has a limit.
    pub bias: Option<Bias>,
    /// `σ`.
    pub deviation_mps: f64,
    /// `τ`.
    pub correlation_time_s: f64,
    /// Stretches it was fitted to.
    pub stretches: usize,
}

/// Offset from the limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bias {
    /// Mean `β`.
    pub mean_mps: f64,
    /// Standard deviation between stretches `σ_b`.
    pub spread_mps: f64,
    /// Stretches with a limit.
    pub stretches: usize,
}

/// Lags of the variogram, in s. Below some seconds speed follows the pedal with a lag, which the model does not have.
const LAGS_S: [f64; 9] = [2.0, 4.0, 6.0, 8.0, 10.0, 15.0, 20.0, 25.0, 30.0];

/// Range of the correlation time; longer ones cannot be told from stretches of some ten seconds.
const SHORTEST_S: f64 = 0.2;
const LONGEST_S: f64 = 120.0;

impl CruiseModel {
    /// Fits bias and variation.
    ///
    /// `σ` and `τ` are the least-squares fit of `2σ²(1 − e^(−h/τ))` to the variogram `E[(v(t + h) − v(t))²]` for `h` from 2 to
    /// 30 s, which needs no mean and therefore no limit. `σ_b²` is the variance of the stretches' means less what the process
    /// itself contributes to it.
    ///
    /// # Errors
    /// [`Error::TooFewStretches`] without a stretch.
    pub fn fit(stretches: &[&CruiseStretch]) -> Result<Self, Error> {
        let variogram = variogram(stretches);
        if variogram.is_empty() {
            return Err(Error::TooFewStretches {
                found: stretches.len(),
                needed: 1,
                unit: "stretches of cruising without a vehicle ahead",
            });
        }
        let (deviation_mps, correlation_time_s) = fit_variogram(&variogram);
        Ok(Self {
            bias: bias(stretches, deviation_mps, correlation_time_s),
            deviation_mps,
            correlation_time_s,
            stretches: stretches.len(),
        })
    }

    /// `√(2σ²/τ)`, the deviation after a second, where the correlation time is longer than the stretches tell: only this, the
    /// pace of a random walk, is determined then.
    #[must_use]
    pub fn random_walk_mps(&self) -> Option<f64> {
        let is_one = self.correlation_time_s > 0.99 * LONGEST_S;
        is_one.then(|| self.deviation_mps * (2.0 / self.correlation_time_s).sqrt())
    }

    /// Expected speed at `t_s` after a stretch began at `start_speed_mps`.
    #[must_use]
    pub fn speed_mps(&self, start_speed_mps: f64, limit_mps: Option<f64>, t_s: f64) -> f64 {
        match (limit_mps, self.bias) {
            (Some(limit), Some(bias)) => {
                let level = limit + bias.mean_mps;
                level + self.correlation(bias.spread_mps, t_s) * (start_speed_mps - level)
            }
            _ => start_speed_mps,
        }
    }

    /// Standard deviation of the speed around what is expected.
    #[must_use]
    pub fn std_mps(&self, limit_mps: Option<f64>, t_s: f64) -> f64 {
        let variance = self.deviation_mps.powi(2);
        match (limit_mps, self.bias) {
            (Some(_), Some(bias)) => {
                let rho = self.correlation(bias.spread_mps, t_s);
                ((bias.spread_mps.powi(2) + variance) * (1.0 - rho * rho))
                    .max(0.0)
                    .sqrt()
            }
            _ => (2.0 * variance * -(-t_s / self.correlation_time_s).exp_m1()).sqrt(),
        }
    }

    /// Half-width of the band that holds nine tenths, of a normal distribution.
    #[must_use]
    pub fn half_width_90_mps(&self, limit_mps: Option<f64>, t_s: f64) -> f64 {
        const NORMAL_90: f64 = 1.644_853_626_951_473;
        NORMAL_90 * self.std_mps(limit_mps, t_s)
    }

    /// Predicts a stretch from its first speed and its limit.
    #[must_use]
    pub fn errors(&self, stretch: &CruiseStretch) -> CruiseErrors {
        CruiseErrors::of(self, stretch)
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        let bias = self.bias.unwrap_or(Bias {
            mean_mps: 0.0,
            spread_mps: 0.0,
            stretches: 0,
        });
        let values = [
            ("mean_mps", bias.mean_mps, -200.0, 200.0),
            ("spread_mps", bias.spread_mps, 0.0, 200.0),
            ("deviation_mps", self.deviation_mps, 0.0, 200.0),
            (
                "correlation_time_s",
                self.correlation_time_s,
                SHORTEST_S,
                LONGEST_S,
            ),
        ];
        for (name, value, lowest, highest) in values {
            // The fitted ends of the range come from powers.
            let slack = 1e-9 * highest;
            if !(lowest - slack..=highest + slack).contains(&value) {
                return Err(Error::Parameter {
                    model: "cruise",
                    name,
                    value,
                    expected: format!("{lowest} to {highest}"),
                });
            }
        }
        Ok(())
    }

    /// `ρ(t)`.
    fn correlation(&self, spread_mps: f64, t_s: f64) -> f64 {
        let (between, within) = (spread_mps.powi(2), self.deviation_mps.powi(2));
        let total = between + within;
        if total <= 0.0 {
            return 1.0;
        }
        (between + within * (-t_s / self.correlation_time_s).exp()) / total
    }
}

/// `(lag, mean squared difference, pairs)` for the lags that some stretch is long enough for.
fn variogram(stretches: &[&CruiseStretch]) -> Vec<(f64, f64, f64)> {
    let at = |lag_s: f64| {
        let (mut sum, mut pairs) = (0.0, 0.0);
        for stretch in stretches {
            let lag = (lag_s / stretch.step_s()).round() as usize;
            let speed = stretch.speed_mps();
            let off_grid = (lag as f64 * stretch.step_s() - lag_s).abs() > 0.01 * lag_s;
            if lag == 0 || off_grid || lag >= speed.len() {
                continue;
            }
            let squares = speed
                .iter()
                .zip(&speed[lag..])
                .map(|(a, b)| (b - a).powi(2));
            sum += squares.sum::<f64>();
            pairs += (speed.len() - lag) as f64;
        }
        (pairs > 0.0).then(|| (lag_s, sum / pairs, pairs))
    };
    LAGS_S.into_iter().filter_map(at).collect()
}

/// `σ` and `τ`: a fine grid over `ln τ`, `σ²` in closed form.
fn fit_variogram(variogram: &[(f64, f64, f64)]) -> (f64, f64) {
    let at = |tau: f64| {
        let shape = |lag: f64| -2.0 * (-lag / tau).exp_m1();
        let (mut products, mut squares) = (0.0, 0.0);
        for &(lag, gamma, pairs) in variogram {
            products += pairs * shape(lag) * gamma;
            squares += pairs * shape(lag).powi(2);
        }
        let variance = products / squares;
        let residual: f64 = variogram
            .iter()
            .map(|&(lag, gamma, pairs)| pairs * (gamma - variance * shape(lag)).powi(2))
            .sum();
        (residual, variance, tau)
    };
    let steps = 2000;
    let ratio = LONGEST_S / SHORTEST_S;
    let candidates =
        (0..=steps).map(|k| at(SHORTEST_S * ratio.powf(f64::from(k) / f64::from(steps))));
    let best = candidates.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or((0.0, SHORTEST_S), |(_, variance, tau)| {
        (variance.max(0.0).sqrt(), tau)
    })
}

fn bias(stretches: &[&CruiseStretch], deviation_mps: f64, tau_s: f64) -> Option<Bias> {
    let offsets: Vec<(f64, f64)> = stretches
        .iter()
        .filter_map(|stretch| {
            let speed = stretch.speed_mps();
            let mean = speed.iter().sum::<f64>() / speed.len() as f64;
            let duration = stretch.duration_s() / tau_s;
            // Variance of the mean of the process over the stretch.
            let own = 2.0 * (duration + (-duration).exp() - 1.0) / duration.powi(2);
            Some((mean - stretch.limit_mps()?, deviation_mps.powi(2) * own))
        })
        .collect();
    let n = offsets.len() as f64;
    if offsets.is_empty() {
        return None;
    }
    let mean_mps = offsets.iter().map(|o| o.0).sum::<f64>() / n;
    let total: f64 = offsets.iter().map(|o| (o.0 - mean_mps).powi(2)).sum();
    let own = offsets.iter().map(|o| o.1).sum::<f64>() / n;
    Some(Bias {
        mean_mps,
        spread_mps: (total / (n - 1.0).max(1.0) - own).max(0.0).sqrt(),
        stretches: offsets.len(),
    })
}
