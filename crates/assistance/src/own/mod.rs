//! The driver's own way over a road, and plans that keep to it.

#[cfg(test)]
mod tests;

use driver_model::road::{Road, RoadFile, RoadStop};
use driver_model::trip_driver::TripDriver;
use serde::Serialize;
use speed_plan::{Columns, Envelope, EnvelopePoint, Problem, Run};

use crate::Error;

/// Stops nearer to each other than this are one, m.
const STOP_SPACING_M: f64 = 5.0;

/// Accelerations of a driver of whom none were seen are those of his laws, at these speeds, m/s.
const LAW_SPEEDS_MPS: [f64; 9] = [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0];

/// No driver's limits of acceleration are narrower, m/s².
const GENTLEST_MPS2: f64 = 0.3;

/// Accelerations of plans that do not keep to the driver's, where his own are not stronger, m/s².
const FREE_MPS2: [f64; 2] = [-2.5, 1.5];

/// Below the own speed by this share a plan is still as fast, but for rounding.
const ROUNDING: f64 = 1e-9;

/// How closely a plan keeps to the driver's own way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Style {
    /// Not at all.
    Free,
    /// Within this many half-widths of the driver's band.
    Within(f64),
}

impl Serialize for Style {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Free => serializer.serialize_str("free"),
            Self::Within(half_widths) => serializer.serialize_f64(*half_widths),
        }
    }
}

/// Where a driver's band comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Band {
    /// Trips that were kept back.
    Fitted,
    /// At least at some places it is assumed.
    Assumed,
}

/// A driver's own way over the nodes of a road.
#[derive(Debug, Clone)]
pub struct OwnWay {
    /// What he drives, red lights included.
    pub run: Run,
    /// Where his band comes from.
    pub band: Band,
    /// Speed at every node if no light were red, m/s.
    speed_mps: Vec<f64>,
    half_width_mps: Vec<f64>,
    envelope: Envelope,
}

/// How far what is driven is from the driver's own way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StyleDistance {
    /// Root mean square over the road of the difference to the own speed, m/s.
    pub rms_mps: f64,
    /// Share of the road inside the driver's band, %.
    pub inside_band_pct: f64,
    /// Where the band comes from.
    pub band: Band,
    /// 95th percentile over the road of accelerations, m/s².
    pub accel_p95_mps2: f64,
    /// That of the own way, m/s².
    pub own_accel_p95_mps2: f64,
    /// 95th percentile over the road of decelerations, m/s².
    pub decel_p95_mps2: f64,
    /// That of the own way, m/s².
    pub own_decel_p95_mps2: f64,
}

impl OwnWay {
    /// The way over the road of a problem: as fast as the driver wants to be, within limits and his own accelerations. At a light that is red when he
    /// comes he stops, and waits. He knows nothing of a leader.
    ///
    /// # Errors
    /// [`Error::Driver`] for a road without limits, [`Error::OwnWay`] and [`Error::Red`] where he cannot drive it.
    pub fn new(driver: &TripDriver, file: &RoadFile, problem: &Problem) -> Result<Self, Error> {
        let envelope = envelope(driver)?;
        let road = DriversRoad {
            driver,
            file,
            problem,
            envelope: &envelope,
        };
        let free = road.run(&[])?;
        let mut way = Self {
            band: Band::Fitted,
            half_width_mps: Vec::with_capacity(problem.nodes()),
            run: road.at_green(free.clone())?,
            speed_mps: free.speed_mps,
            envelope,
        };
        for node in 0..problem.nodes() {
            let width =
                driver.half_width(way.speed_mps[node], accel_at(problem, &way.speed_mps, node));
            way.half_width_mps.push(width.mps);
            if !width.is_fitted {
                way.band = Band::Assumed;
            }
        }
        Ok(way)
    }

    /// The road of a plan in a style: with the driver's band as its limits.
    ///
    /// # Errors
    /// [`Error::Style`] for a style out of range.
    pub fn columns(&self, columns: &Columns, style: Style) -> Result<Columns, Error> {
        let mut columns = columns.clone();
        let Style::Within(half_widths) = style else {
            return Ok(columns);
        };
        if !(0.0..=100.0).contains(&half_widths) {
            return Err(Error::Style { value: half_widths });
        }
        for (node, own_mps) in self.speed_mps.iter().enumerate() {
            let reach_mps = half_widths * self.half_width_mps[node];
            let (min, max) = (columns.min_mps[node], columns.max_mps[node]);
            let max_mps = max.min(own_mps + reach_mps).max(min);
            columns.max_mps[node] = max_mps;
            let lowest_mps = (own_mps - reach_mps) * (1.0 - ROUNDING);
            columns.min_mps[node] = min.max(lowest_mps).min(max_mps);
        }
        Ok(columns)
    }

    /// Accelerations of a plan in a style: the driver's own, or none that he would complain of.
    ///
    /// # Errors
    /// [`Error::Plan`] for limits that are none.
    pub fn envelope(&self, style: Style) -> Result<Envelope, Error> {
        let Style::Free = style else {
            return Ok(self.envelope.clone());
        };
        let [min, max] = FREE_MPS2;
        let points = self.envelope.points().iter().map(|point| EnvelopePoint {
            min_mps2: point.min_mps2.min(min),
            max_mps2: point.max_mps2.max(max),
            ..*point
        });
        let points: Vec<EnvelopePoint> = points.collect();
        let is_free = |point: &EnvelopePoint| [point.min_mps2, point.max_mps2] == FREE_MPS2;
        Ok(if points.iter().all(is_free) {
            Envelope::constant(min, max)?
        } else {
            Envelope::new(points)?
        })
    }

    /// How far a motion over the same nodes is from the own way, red lights aside.
    #[must_use]
    pub fn distance(&self, problem: &Problem, run: &Run) -> StyleDistance {
        let positions = &problem.columns().position_m;
        let (mut squares, mut inside_m, mut length_m) = (0.0, 0.0, 0.0);
        for (step, ends_m) in positions.windows(2).enumerate() {
            let apart_m = ends_m[1] - ends_m[0];
            for node in [step, step + 1] {
                let off_mps = (run.speed_mps[node] - self.speed_mps[node]).abs();
                squares += 0.5 * apart_m * off_mps * off_mps;
                if off_mps <= self.half_width_mps[node] + 1e-9 {
                    inside_m += 0.5 * apart_m;
                }
            }
            length_m += apart_m;
        }
        let [accel, decel] = accel_p95_mps2(problem, &run.speed_mps);
        let [own_accel, own_decel] = accel_p95_mps2(problem, &self.speed_mps);
        StyleDistance {
            rms_mps: (squares / length_m).sqrt(),
            inside_band_pct: 100.0 * inside_m / length_m,
            band: self.band,
            accel_p95_mps2: accel,
            own_accel_p95_mps2: own_accel,
            decel_p95_mps2: decel,
            own_decel_p95_mps2: own_decel,
        }
    }
}

struct DriversRoad<'a> {
    driver: &'a TripDriver,
    file: &'a RoadFile,
    problem: &'a Problem<'a>,
    envelope: &'a Envelope,
}

impl DriversRoad<'_> {
    /// The own way with stops at some signals.
    fn run(&self, stood: &[usize]) -> Result<Run, Error> {
        let columns = self.problem.columns();
        let mut map = self.file.to_map("the road")?;
        // Where no slow points are known the plan knows none either.
        map.slow_points.get_or_insert_default();
        let mut stops_m: Vec<f64> = stood.iter().map(|node| columns.position_m[*node]).collect();
        if self.file.end_speed_mps <= 0.0 {
            stops_m.push(self.file.length_m);
        }
        for position_m in stops_m {
            let is_near = |stop: &RoadStop| (stop.position_m - position_m).abs() < STOP_SPACING_M;
            if !map.stops.iter().any(is_near) {
                map.stops.push(RoadStop {
                    position_m,
                    dwell_s: 0.0,
                });
            }
        }
        map.stops
            .sort_by(|a, b| a.position_m.total_cmp(&b.position_m));
        let road = Road::new(map)?;
        let squares: Vec<f64> = self
            .driver
            .speeds_mps(&road)
            .into_iter()
            .map(|speed_mps| speed_mps * speed_mps)
            .collect();
        let mut columns = columns.clone();
        columns.signals.clear();
        columns.earliest_s.clear();
        for node in 0..columns.position_m.len() {
            let own_mps = at(&squares, columns.position_m[node]).sqrt();
            let (min, max) = (columns.min_mps[node], columns.max_mps[node]);
            let stands = stood.contains(&node);
            columns.max_mps[node] = if stands {
                0.0
            } else {
                max.min(own_mps.max(min))
            };
            columns.min_mps[node] = if stands { 0.0 } else { min };
        }
        let model = self.problem.model().clone();
        let problem = Problem::new(model, self.envelope.clone(), columns)?;
        Run::fastest(&problem).map_err(Error::OwnWay)
    }

    /// The same with a stop at every light that is red when he comes.
    fn at_green(&self, free: Run) -> Result<Run, Error> {
        let columns = self.problem.columns();
        let (mut run, mut stood, mut waits) = (free, Vec::new(), Vec::new());
        for signal in &columns.signals {
            let node = signal.node;
            let is_green = |time_s: f64| {
                let windows = &signal.green_s;
                windows
                    .iter()
                    .any(|[from_s, to_s]| *from_s <= time_s && time_s <= *to_s)
            };
            let leaving_s = |run: &Run| run.arrival_s[node] + run.stood_s[node];
            if is_green(leaving_s(&run)) {
                continue;
            }
            if run.speed_mps[node] > 0.0 {
                stood.push(node);
                run = self.run(&stood)?.with_stands(self.problem, &waits);
            }
            let ready_s = leaving_s(&run);
            if is_green(ready_s) {
                continue;
            }
            let next = signal.green_s.iter().find(|[from_s, _]| *from_s >= ready_s);
            let Some([from_s, _]) = next else {
                return Err(Error::Red {
                    position_m: columns.position_m[node],
                    arrival_s: ready_s,
                });
            };
            waits.push((node, from_s - ready_s));
            run = run.with_stands(self.problem, &waits);
        }
        Ok(run)
    }
}

/// A square of the speed at a position, of those a metre apart.
fn at(squares: &[f64], position_m: f64) -> f64 {
    driver_model::trip_driver::interpolated(
        squares,
        position_m / driver_model::road::NODE_SPACING_M,
    )
}

/// Mean acceleration of the steps at a node.
fn accel_at(problem: &Problem, speed_mps: &[f64], node: usize) -> f64 {
    let positions = &problem.columns().position_m;
    let (before, after) = (node.saturating_sub(1), (node + 1).min(positions.len() - 1));
    let squares = speed_mps[after].powi(2) - speed_mps[before].powi(2);
    squares / (2.0 * (positions[after] - positions[before]))
}

/// 95th percentiles over the road of accelerations and of decelerations; 0 where there are none.
fn accel_p95_mps2(problem: &Problem, speed_mps: &[f64]) -> [f64; 2] {
    let steps = problem
        .columns()
        .position_m
        .windows(2)
        .zip(speed_mps.windows(2));
    let mut accels: Vec<(f64, f64)> = steps
        .map(|(ends_m, ends_mps)| {
            let length_m = ends_m[1] - ends_m[0];
            let squares = ends_mps[1].powi(2) - ends_mps[0].powi(2);
            (squares / (2.0 * length_m), length_m)
        })
        .collect();
    accels.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    [1.0, -1.0].map(|sign| {
        let of_sign = || accels.iter().filter(|(accel, _)| sign * accel > 0.05);
        let beyond_m = 0.05 * of_sign().map(|(_, length_m)| length_m).sum::<f64>();
        let mut passed_m = 0.0;
        let found = of_sign().find(|(_, length_m)| {
            passed_m += length_m;
            passed_m >= beyond_m
        });
        found.map_or(0.0, |(accel, _)| accel.abs())
    })
}

/// The driver's own limits of acceleration: 95th percentiles over speed where they were seen, else those of his laws.
fn envelope(driver: &TripDriver) -> Result<Envelope, Error> {
    let seen = driver.style().map(|style| style.accelerations.as_slice());
    let mut points: Vec<EnvelopePoint> = seen
        .unwrap_or_default()
        .iter()
        .map(|at| EnvelopePoint {
            speed_mps: at.speed_mps,
            min_mps2: -at.decel_mps2.max(GENTLEST_MPS2),
            max_mps2: at.accel_mps2.max(GENTLEST_MPS2),
        })
        .collect();
    if points.is_empty() {
        let fastest_mps = driver
            .wanted()
            .mps(LAW_SPEEDS_MPS[LAW_SPEEDS_MPS.len() - 1]);
        points = LAW_SPEEDS_MPS
            .iter()
            .map(|&speed_mps| EnvelopePoint {
                speed_mps,
                min_mps2: -driver.braking().mps2(fastest_mps).max(GENTLEST_MPS2),
                max_mps2: driver
                    .acceleration()
                    .mps2(speed_mps, fastest_mps)
                    .max(GENTLEST_MPS2),
            })
            .collect();
    }
    Ok(Envelope::new(points)?)
}
