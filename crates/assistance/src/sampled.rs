use std::fmt::Write as _;

use ev_energy::{Error, StepModel, Trip};
use speed_plan::{Problem, Run};

/// Sampling interval, s; the last is stretched to end with the plan.
const STEP_S: f64 = 0.1;

/// Accelerations are averaged over half a second before they are differentiated.
const JERK_SAMPLES: usize = 5;

/// A plan as a log would record it, at 10 Hz.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledPlan {
    /// Sampling interval, s.
    pub step_s: f64,
    /// Speed, m/s.
    pub speed_mps: Vec<f64>,
    /// Position, m.
    pub position_m: Vec<f64>,
    /// Slope angle, rad.
    pub slope_rad: Vec<f64>,
    /// Higher of the limits of the nodes around, m/s.
    pub limit_mps: Vec<f64>,
}

impl SampledPlan {
    /// Samples a motion: between nodes the acceleration is constant.
    #[must_use]
    pub fn new(problem: &Problem, run: &Run) -> Self {
        Self::every(STEP_S, problem, run)
    }

    fn every(step_s: f64, problem: &Problem, run: &Run) -> Self {
        let columns = problem.columns();
        let count = (run.time_s / step_s).round().max(1.0);
        let step_s = run.time_s / count;
        let mut sampled = Self {
            step_s,
            speed_mps: Vec::new(),
            position_m: Vec::new(),
            slope_rad: Vec::new(),
            limit_mps: Vec::new(),
        };
        let last = problem.nodes() - 2;
        let mut node = 0;
        for sample in 0..=count as usize {
            let time_s = sample as f64 * step_s;
            while node < last && run.arrival_s[node + 1] <= time_s {
                node += 1;
            }
            // Where the car stands, time passes at the node.
            let moves_s = time_s - run.arrival_s[node] - run.stood_s[node];
            let since_s = moves_s.max(0.0);
            let (v0, v1) = (run.speed_mps[node], run.speed_mps[node + 1]);
            let length_m = columns.position_m[node + 1] - columns.position_m[node];
            let takes_s = 2.0 * length_m / (v0 + v1);
            let share = (since_s / takes_s).min(1.0);
            let speed = v0 + share * (v1 - v0);
            sampled.speed_mps.push(speed);
            sampled
                .position_m
                .push(columns.position_m[node] + 0.5 * (v0 + speed) * share * takes_s);
            sampled.slope_rad.push(if moves_s < 0.0 {
                problem.node_slope_rad(node)
            } else {
                columns.slope_rad[node]
            });
            sampled
                .limit_mps
                .push(f64::max(columns.max_mps[node], columns.max_mps[node + 1]));
        }
        sampled
    }

    /// Energy from the cells of the same motion, J: an independent check of the plan's.
    ///
    /// # Errors
    /// As [`ev_energy::Vehicle::trip_energy`].
    pub fn energy_j(&self, model: &StepModel) -> Result<f64, Error> {
        let vehicle = model.vehicle();
        let extra_w = model.auxiliary_power_w() - vehicle.spec().auxiliary_power_w;
        let extra_w = vec![extra_w; self.speed_mps.len()];
        let trip = Trip {
            step_s: self.step_s,
            speed_mps: &self.speed_mps,
            slope_rad: Some(&self.slope_rad),
            extra_aux_power_w: Some(&extra_w),
            weather: model.weather(),
            ..Trip::default()
        };
        Ok(vehicle.trip_energy(&trip)?.battery_energy_j)
    }

    /// As a log of time, speed, limit and slope.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut text = String::from("time_s,speed_mps,speed_limit_mps,grade_rad\n");
        let channels = self
            .speed_mps
            .iter()
            .zip(&self.limit_mps)
            .zip(&self.slope_rad);
        for (k, ((speed, limit), slope)) in channels.enumerate() {
            let time_s = k as f64 * self.step_s;
            // Writing to a string does not fail.
            let _ = writeln!(text, "{time_s:.6},{speed:.6},{limit:.3},{slope:.6}");
        }
        text
    }

    /// 95th percentile and largest magnitude of the jerk of means of half a second, m/s³.
    #[must_use]
    pub fn jerk_mps3(&self) -> [f64; 2] {
        let accel: Vec<f64> = self
            .speed_mps
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) / self.step_s)
            .collect();
        let means: Vec<f64> = accel
            .chunks(JERK_SAMPLES)
            .map(|chunk| chunk.iter().sum::<f64>() / chunk.len() as f64)
            .collect();
        let between_s = JERK_SAMPLES as f64 * self.step_s;
        let mut jerk: Vec<f64> = means
            .windows(2)
            .map(|pair| ((pair[1] - pair[0]) / between_s).abs())
            .collect();
        jerk.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let index = (jerk.len().saturating_sub(1) as f64 * share).round() as usize;
            jerk.get(index).copied().unwrap_or(0.0)
        };
        [at(0.95), at(1.0)]
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]

    use ev_energy::{RoadStep, Vehicle};
    use speed_plan::{Answer, Demand, Envelope, Road, Settings, plan};

    use super::*;

    /// What a motion takes beyond the sum of its steps, J, if each is driven in many parts of even time.
    fn within_steps_j(problem: &Problem, run: &Run) -> f64 {
        const PARTS: usize = 100;
        let steps = run.speed_mps.windows(2).zip(problem.steps()).enumerate();
        let in_parts = steps.map(|(k, (ends, step))| {
            let part_s = 2.0 * step.length_m() / (ends[0] + ends[1]) / PARTS as f64;
            let speed = |part: usize| ends[0] + part as f64 / PARTS as f64 * (ends[1] - ends[0]);
            let parts = (0..PARTS).map(|part| {
                let (from, to) = (speed(part), speed(part + 1));
                let length_m = 0.5 * (from + to) * part_s;
                let road = RoadStep::new(length_m, problem.columns().slope_rad[k]);
                problem.model().energy_j(&road, from, to)
            });
            parts.sum::<f64>() - run.step_energy_j[k]
        });
        in_parts.sum()
    }

    #[test]
    fn what_sampling_finds_besides_lies_within_the_steps_between_nodes() {
        let road = Road {
            length_m: 3000.0,
            limits: vec![(0.0, 14.0), (1000.0, 28.0), (2000.0, 14.0)],
            stops: vec![(600.0, 30.0)],
            elevation: vec![(0.0, 0.0), (600.0, 20.0), (1500.0, 0.0), (3000.0, 30.0)],
            ..Road::default()
        };
        let car = Vehicle::builtin("b250e").unwrap();
        let columns = road.columns().unwrap();
        let problem = Problem::new(StepModel::new(&car), Envelope::default(), columns).unwrap();
        for price_w in [0.0, 3e3, 1e4] {
            let answer = plan(&problem, Demand::Price(price_w), &Settings::default()).unwrap();
            let Answer::Plan(plan) = answer else {
                panic!("{answer:?}");
            };
            let scale_j = plan.run.energy_scale_j();
            let within_pct = 100.0 * within_steps_j(&problem, &plan.run) / scale_j;
            let error_pct = |step_s| {
                let sampled = SampledPlan::every(step_s, &problem, &plan.run);
                let sampled_j = sampled.energy_j(problem.model()).unwrap();
                100.0 * (sampled_j - plan.run.energy_j) / scale_j
            };
            let (coarse, fine) = (error_pct(0.1), error_pct(0.01));
            assert!(coarse.abs() < 0.08, "{price_w} W: {coarse} %");
            assert!(
                (fine - within_pct).abs() < 0.01,
                "{price_w} W: {fine} %, {within_pct} %"
            );
        }
    }
}
