use super::TripDriver;
use crate::road::{Road, SlowPoint};
use crate::{Error, error};

/// More samples are refused: 11 days at 10 Hz.
const MOST_SAMPLES: f64 = 1e7;

/// A predicted trip on a uniform time grid that begins at 0.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeRun {
    /// Distance of two samples.
    pub step_s: f64,
    /// Speed, at least 0.
    pub speed_mps: Vec<f64>,
    /// Distance from the start.
    pub position_m: Vec<f64>,
    /// Slope of the road there; `None` on a level road.
    pub slope_rad: Option<Vec<f64>>,
    /// When the trip is over, the stop at its end included.
    pub end_s: f64,
    /// By which the driver's speed rises and falls around this one, see [`restless`](super::restless).
    pub unrest_mps2: f64,
}

impl TripDriver {
    /// Drives a road to its end, or for `duration_s`.
    ///
    /// # Errors
    /// [`Error::Option`] for a step that is not positive or gives more than 10⁷ samples, or a duration that is not positive.
    pub fn drive(
        &self,
        road: &Road,
        step_s: f64,
        duration_s: Option<f64>,
    ) -> Result<FreeRun, Error> {
        let duration_s = duration_s.unwrap_or(f64::MAX);
        for (name, value) in [("step_s", step_s), ("duration_s", duration_s)] {
            error::at_least(name, value, f64::MIN_POSITIVE, "above 0 s")?;
        }
        let clock = Clock::of(road, self.speeds_mps(road));
        let run = clock.sampled(road, step_s, duration_s)?;
        Ok(FreeRun {
            unrest_mps2: self.unrest_mps2(),
            ..run
        })
    }

    /// Speed at every node of a road; the square of it is linear in between.
    #[must_use]
    pub fn speeds_mps(&self, road: &Road) -> Vec<f64> {
        let mut cap_mps = road.cap_mps().to_vec();
        road.cap_at(&self.expected_slowdowns(road), &mut cap_mps);
        self.plan(road, &cap_mps)
    }

    /// The slowdowns that are put in on a road whose slow points are not known.
    #[must_use]
    pub fn expected_slowdowns(&self, road: &Road) -> Vec<SlowPoint> {
        let stretches = road.stretches().unwrap_or_default();
        self.slowdowns().expected(stretches)
    }
}

/// When the car is where.
pub(super) struct Clock {
    pub(super) speed_mps: Vec<f64>,
    pub(super) arrival_s: Vec<f64>,
}

impl Clock {
    /// Two nodes in a row at which the car stands would take for ever; stops are 5 m apart.
    pub(super) fn of(road: &Road, speed_mps: Vec<f64>) -> Self {
        let mut arrival_s = vec![0.0; speed_mps.len()];
        for (node, pair) in (1..).zip(speed_mps.windows(2)) {
            let travel_s = 2.0 * road.spacing_m() / (pair[0] + pair[1]);
            arrival_s[node] = arrival_s[node - 1] + road.dwell_s()[node - 1] + travel_s;
        }
        Self {
            speed_mps,
            arrival_s,
        }
    }

    fn end_s(&self, road: &Road) -> f64 {
        let last = self.arrival_s.len() - 1;
        self.arrival_s[last] + road.dwell_s()[last]
    }

    fn sampled(&self, road: &Road, step_s: f64, duration_s: f64) -> Result<FreeRun, Error> {
        let end_s = self.end_s(road).min(duration_s);
        let samples = (end_s / step_s + 1e-9).floor() + 1.0;
        if samples > MOST_SAMPLES {
            return Err(Error::Option {
                name: "step_s",
                value: step_s,
                expected: "a step that gives at most 10⁷ samples",
            });
        }
        let mut run = FreeRun {
            step_s,
            speed_mps: Vec::with_capacity(samples as usize),
            position_m: Vec::with_capacity(samples as usize),
            slope_rad: road
                .slope_rad()
                .map(|_| Vec::with_capacity(samples as usize)),
            end_s,
            unrest_mps2: 0.0,
        };
        let mut node = 0;
        for sample in 0..samples as usize {
            let t_s = sample as f64 * step_s;
            while self
                .arrival_s
                .get(node + 1)
                .is_some_and(|next_s| *next_s <= t_s)
            {
                node += 1;
            }
            let (speed_mps, position_m) = self.at(road, node, t_s);
            run.speed_mps.push(speed_mps);
            run.position_m.push(position_m);
            if let (Some(sampled), Some(slope_rad)) = (&mut run.slope_rad, road.slope_rad()) {
                let next_rad = slope_rad[(node + 1).min(slope_rad.len() - 1)];
                let share = position_m / road.spacing_m() - node as f64;
                sampled.push(slope_rad[node] + share * (next_rad - slope_rad[node]));
            }
        }
        Ok(run)
    }

    /// Speed and position at a time not before the arrival at `node` and not after that at the next one.
    fn at(&self, road: &Road, node: usize, t_s: f64) -> (f64, f64) {
        let spacing_m = road.spacing_m();
        let (v, start_m) = (self.speed_mps[node], node as f64 * spacing_m);
        let moving_s = t_s - self.arrival_s[node] - road.dwell_s()[node];
        let Some(next) = self.speed_mps.get(node + 1) else {
            return (v, start_m);
        };
        if moving_s <= 0.0 {
            return (v, start_m);
        }
        let accel_mps2 = (next * next - v * v) / (2.0 * spacing_m);
        let speed_mps = (v + accel_mps2 * moving_s).clamp(v.min(*next), v.max(*next));
        let travelled_m = 0.5 * (v + speed_mps) * moving_s;
        (speed_mps, start_m + travelled_m.min(spacing_m))
    }
}
