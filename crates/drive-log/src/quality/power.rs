//! What car a battery power belongs to.

use std::fmt;

use super::motion::{GRAVITY_MPS2, Span};
use crate::{Channel, RawLog};

/// Seconds without braking that tell a car.
const SECONDS: usize = 120;

/// Seconds that tell two cars from each other.
const FEW_SECONDS: usize = 60;

/// Braking takes the friction brakes along, which no battery feels, m/s².
pub(super) const NOT_BRAKING_MPS2: f64 = -0.2;

/// Rolling resistance as an acceleration, m/s²: a coefficient of 0.01.
pub(super) const ROLLING_MPS2: f64 = 0.1;

/// Density of air, kg/m³.
const AIR_KG_PER_M3: f64 = 1.2;

/// Road vehicles: a motorcycle to a lorry with trailer, kg; the slimmest to the bluntest, m². Below
/// the speed, m/s, it may be a bicycle.
const MASS_KG: (f64, f64) = (200.0, 40_000.0);
const DRAG_AREA_M2: (f64, f64) = (0.25, 10.0);

/// A car with the drag of no car is at least this light, if its speed is what is wrong, kg.
const SLIM_KG: f64 = 500.0;

/// The lightest vehicles on four wheels, with a driver, kg.
const LIGHTEST_KG: f64 = 350.0;
const BICYCLE_MPS: f64 = 20.0;

/// Over this mass, kg, only tractors are as slow, m/s, and as sluggish, m/s².
const LORRY_KG: f64 = 6000.0;
const LORRY_MPS: f64 = 12.0;
const LORRY_MPS2: f64 = 0.7;

/// Passenger cars, losses of the drive included: 1486 to 1974 kg in 33 trips of a BMW i3.
const MASS: Usual = Usual(1700.0, 0.4);
const DRAG_AREA: Usual = Usual(0.65, 0.5);

/// Standard errors that a figure must be off; they are of samples that hang together.
const ERRORS: f64 = 10.0;

/// Share of the variance of the power that a car must explain to be told.
const EXPLAINED: f64 = 0.5;

/// What is usual: a middle, and the logarithm of a usual factor off it.
pub(super) struct Usual(pub(super) f64, pub(super) f64);

impl Usual {
    /// How many usual factors a value is off the middle; far off for what is not positive.
    pub(super) fn off(&self, value: f64) -> f64 {
        (value.max(1e-3 * self.0) / self.0).ln() / self.1
    }
}

/// A second: speed, acceleration and battery power.
#[derive(Clone)]
pub(super) struct Load {
    speed_mps: f64,
    accel_mps2: f64,
    power_w: f64,
}

/// A car, with the standard errors of its figures.
pub(super) struct Car {
    pub(super) mass_kg: f64,
    pub(super) drag_area_m2: f64,
    mass_error_kg: f64,
    drag_error_m2: f64,
}

/// The seconds with volts and amps.
pub(super) fn loads(log: &RawLog, spans: &[Span]) -> Vec<Load> {
    if log.channel(Channel::BatteryVoltage).is_none() {
        return Vec::new();
    }
    let load = |span: &Span| {
        Some(Load {
            speed_mps: span.speed_mps,
            accel_mps2: span.accel_mps2,
            power_w: span.battery(log)?,
        })
    };
    spans.iter().filter_map(load).collect()
}

impl Load {
    /// The same, if the speed changes so many times as fast.
    pub(super) fn at_pace(&self, times: f64) -> Self {
        Self {
            accel_mps2: times * self.accel_mps2,
            ..self.clone()
        }
    }

    /// Fits `P = P₀ + m v (dv/dt + 0.1) + ½ ρ A v³` where the car does not brake, the speeds being
    /// `k` times too large. `None` where the seconds do not tell.
    pub(super) fn fit(loads: &[Self], k: f64) -> Option<Car> {
        Self::fit_of(loads, k, SECONDS)
    }

    /// The same of fewer seconds, to be compared with another.
    pub(super) fn fit_few(loads: &[Self], k: f64) -> Option<Car> {
        Self::fit_of(loads, k, FEW_SECONDS)
    }

    fn fit_of(loads: &[Self], k: f64, least: usize) -> Option<Car> {
        let rows: Vec<([f64; 3], f64)> = loads
            .iter()
            .map(|load| (load.speed_mps / k, load.accel_mps2 / k, load.power_w))
            .filter(|(_, a, _)| *a > NOT_BRAKING_MPS2)
            .map(|(v, a, p)| ([1.0, v * (a + ROLLING_MPS2), v * v * v], p))
            .collect();
        if rows.len() < least {
            return None;
        }
        let inverse = inverse(&normal(&rows))?;
        let fitted = fitted(&inverse, &rows);
        let n = rows.len() as f64;
        let mean_w = rows.iter().map(|(_, p)| p).sum::<f64>() / n;
        let total: f64 = rows.iter().map(|(_, p)| (p - mean_w).powi(2)).sum();
        let rest: f64 = rows
            .iter()
            .map(|(x, p)| (p - dot(x, &fitted)).powi(2))
            .sum();
        if rest > (1.0 - EXPLAINED) * total {
            return None;
        }
        let error = |i: usize| (rest / n * inverse[i][i]).sqrt();
        let area = 2.0 / AIR_KG_PER_M3;
        let car = Car {
            mass_kg: fitted[1],
            drag_area_m2: area * fitted[2],
            mass_error_kg: error(1),
            drag_error_m2: area * error(2),
        };
        (car.mass_kg > ERRORS * car.mass_error_kg).then_some(car)
    }
}

/// Coefficients of the three terms of [`Load::fit`] by pairs of terms and power, of at least a minute.
pub(super) fn usual_power(rows: &[([f64; 3], f64)]) -> Option<[f64; 3]> {
    let inverse = inverse(&normal(rows)).filter(|_| rows.len() >= FEW_SECONDS)?;
    Some(fitted(&inverse, rows))
}

/// How many times the climb of gradients, each of a span, the battery feels, and its standard error: the rest of the power is
/// fitted as in [`Load::fit`]. `None` where road and seconds do not tell.
pub(super) fn felt_climb(log: &RawLog, spans: &[Span], gradients: &[f64]) -> Option<(f64, f64)> {
    let rows: Vec<([f64; 3], f64, f64)> = spans
        .iter()
        .zip(gradients)
        .filter(|(span, gradient)| span.accel_mps2 > NOT_BRAKING_MPS2 && gradient.is_finite())
        .filter_map(|(span, gradient)| {
            let (v, a) = (span.speed_mps, span.accel_mps2);
            let x = [1.0, v * (a + ROLLING_MPS2), v * v * v];
            Some((x, GRAVITY_MPS2 * v * gradient, span.battery(log)?))
        })
        .filter(|(_, _, power_w)| power_w.is_finite())
        .collect();
    if rows.len() < SECONDS || log.channel(Channel::BatteryVoltage).is_none() {
        return None;
    }
    let rows_of = |y: fn(&([f64; 3], f64, f64)) -> f64| -> Vec<([f64; 3], f64)> {
        rows.iter().map(|row| (row.0, y(row))).collect()
    };
    let (climbs, powers) = (rows_of(|row| row.1), rows_of(|row| row.2));
    let inverse = inverse(&normal(&climbs))?;
    let (of_climb, of_power) = (fitted(&inverse, &climbs), fitted(&inverse, &powers));
    // what is left of climb and power once the rest is fitted
    let left = climbs
        .iter()
        .zip(&powers)
        .map(|((x, climb), (_, power_w))| (climb - dot(x, &of_climb), power_w - dot(x, &of_power)));
    let left: Vec<(f64, f64)> = left.collect();
    let square: f64 = left.iter().map(|(climb, _)| climb * climb).sum();
    let mass_kg = left
        .iter()
        .map(|(climb, power_w)| climb * power_w)
        .sum::<f64>()
        / square;
    let inertia_kg = of_power[1] - mass_kg * of_climb[1];
    let rest: f64 = left
        .iter()
        .map(|(climb, power_w)| (power_w - mass_kg * climb).powi(2))
        .sum();
    let error_kg = (rest / rows.len() as f64 / square).sqrt();
    (inertia_kg > 0.0).then_some((mass_kg / inertia_kg, error_kg / inertia_kg))
}

impl Car {
    /// Whether such a car may be, at this speed and acceleration.
    pub(super) fn is_possible(&self, top_mps: f64, pull_mps2: f64) -> bool {
        let mass = ERRORS * self.mass_error_kg;
        let drag = ERRORS * self.drag_error_m2;
        let too_light = top_mps > BICYCLE_MPS && self.mass_kg + mass < MASS_KG.0;
        let too_slim = top_mps > BICYCLE_MPS
            && self.mass_kg + mass < SLIM_KG
            && self.drag_area_m2 + drag < DRAG_AREA_M2.0;
        let too_large =
            self.mass_kg - mass > MASS_KG.1 || self.drag_area_m2 - drag > DRAG_AREA_M2.1;
        let too_slow =
            self.mass_kg - mass > LORRY_KG && top_mps < LORRY_MPS && pull_mps2 < LORRY_MPS2;
        !(too_light || too_slim || too_large || too_slow)
    }

    /// Lighter than any car, or as heavy as a lorry.
    pub(super) fn is_no_car(&self) -> bool {
        self.mass_kg < LIGHTEST_KG || self.mass_kg > LORRY_KG
    }

    pub(super) fn is_heavy(&self) -> bool {
        self.mass_kg > 2.0 * MASS.0
    }

    /// How far it is off a passenger car, in usual factors; the drag area may be off by its error.
    pub(super) fn oddity(&self) -> f64 {
        let error = ERRORS * self.drag_error_m2;
        let nearest_m2 = DRAG_AREA
            .0
            .max(self.drag_area_m2 - error)
            .min(self.drag_area_m2 + error);
        MASS.off(self.mass_kg).hypot(DRAG_AREA.off(nearest_m2))
    }
}

impl fmt::Display for Car {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (mass_kg, drag_area_m2) = (self.mass_kg, self.drag_area_m2);
        write!(
            f,
            "a car of {mass_kg:.0} kg with a drag area of {drag_area_m2:.2} m²"
        )
    }
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The coefficients of least squares.
fn fitted(inverse: &[[f64; 3]; 3], rows: &[([f64; 3], f64)]) -> [f64; 3] {
    let right = rows.iter().fold([0.0; 3], |sum, (x, y)| {
        std::array::from_fn(|i| sum[i] + x[i] * y)
    });
    std::array::from_fn(|i| dot(&inverse[i], &right))
}

fn normal(rows: &[([f64; 3], f64)]) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| rows.iter().map(|(x, _)| x[i] * x[j]).sum()))
}

/// By cofactors; `None` where the rows do not tell the three apart.
fn inverse(m: &[[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let cofactor = |i: usize, j: usize| {
        let at = |di: usize, dj: usize| m[(i + di) % 3][(j + dj) % 3];
        at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)
    };
    let determinant: f64 = (0..3).map(|j| m[0][j] * cofactor(0, j)).sum();
    let scale = m[0][0] * m[1][1] * m[2][2];
    // symmetric, so that cofactors need not be transposed
    (determinant > 1e-9 * scale)
        .then(|| std::array::from_fn(|i| std::array::from_fn(|j| cofactor(i, j) / determinant)))
}
