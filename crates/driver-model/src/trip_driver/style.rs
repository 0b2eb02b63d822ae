//! How far a driver's trips stray from the speed that he is expected to have, and how hard he speeds up and brakes.

use serde::{Deserialize, Serialize};

use super::law::{ACCEL_MPS2, BRAKING_MPS2};
use super::recording::{RecordedTrip, interpolated};
use super::{FreeRun, TripDriver, within};
use crate::Error;
use crate::road::{Road, RoadKnowledge};
use crate::statistics::quantile;

/// Half of the band around the expected speed holds this share of what was driven.
const BAND_SHARE: f64 = 0.9;

/// Places are compared this far apart, m.
const PLACE_SPACING_M: f64 = 20.0;

/// Fewer places of a kind tell nothing.
const LEAST_PLACES: usize = 30;

/// Below this the car is about to stop, where every speed is near to every other, m/s.
const SLOWEST_MPS: f64 = 1.0;

/// Trips are held out in so many folds at most.
const MOST_FOLDS: usize = 5;

/// Gentler than this is steady, m/s².
const STEADY_MPS2: f64 = 0.1;

/// Sampling of the runs that are compared, s.
const STEP_S: f64 = 0.5;

/// Accelerations are means over so long, s.
const ACCEL_STEP_S: f64 = 0.5;

/// Speeds whose accelerations are taken together, m/s, and the fewest of them that tell something.
const BIN_MPS: f64 = 5.0;
const LEAST_ACCELS: usize = 40;
const ACCEL_SHARE: f64 = 0.95;

/// Half-widths that a fit is kept in, m/s.
const HALF_WIDTH_MPS: std::ops::RangeInclusive<f64> = 0.0..=100.0;

/// What trips kept back tell of a driver besides his expected speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Style {
    /// Where the driver speeds up; `None` where too few places were seen.
    pub speeding_up: Option<Spread>,
    /// Where he brakes.
    pub braking: Option<Spread>,
    /// Where he keeps his speed.
    pub steady: Option<Spread>,
    /// Over the speed, in ascending order; empty where too little was seen.
    pub accelerations: Vec<AccelAtSpeed>,
}

/// Deviations of trips kept back from the expected speed at the same place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spread {
    /// Nine of ten are no larger.
    pub half_width_mps: f64,
    /// Places that were compared.
    pub places: usize,
}

/// How hard a driver speeds up and brakes around a speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AccelAtSpeed {
    /// The speed.
    pub speed_mps: f64,
    /// 95th percentile of accelerations.
    pub accel_mps2: f64,
    /// 95th percentile of decelerations, above 0.
    pub decel_mps2: f64,
}

/// Half-width of the band around a driver's expected speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfWidth {
    /// The half-width.
    pub mps: f64,
    /// Whether it is of trips kept back, otherwise it is assumed.
    pub is_fitted: bool,
}

impl Style {
    pub(super) fn check(&self) -> Result<(), Error> {
        for spread in [self.speeding_up, self.braking, self.steady]
            .into_iter()
            .flatten()
        {
            within("half_width_mps", spread.half_width_mps, &HALF_WIDTH_MPS)?;
        }
        let mut above_mps = 0.0;
        for at in &self.accelerations {
            within("speed_mps", at.speed_mps, &(above_mps..=200.0))?;
            within("accel_mps2", at.accel_mps2, &ACCEL_MPS2)?;
            within("decel_mps2", at.decel_mps2, &BRAKING_MPS2)?;
            above_mps = at.speed_mps + 1e-3;
        }
        Ok(())
    }
}

impl TripDriver {
    /// What trips kept back tell of the driver; `None` where he was learnt from one trip, or was not fitted.
    #[must_use]
    pub fn style(&self) -> Option<&Style> {
        self.style.as_ref()
    }

    /// Half of the band that holds nine of ten of the driver's speeds, around an expected speed with its acceleration. Where too few
    /// places of the kind were seen it is assumed: 12 % of the speed, at least 1.5 m/s.
    #[must_use]
    pub fn half_width(&self, speed_mps: f64, accel_mps2: f64) -> HalfWidth {
        let spread = self.style.as_ref().and_then(|style| match accel_mps2 {
            a if a > STEADY_MPS2 => style.speeding_up,
            a if a < -STEADY_MPS2 => style.braking,
            _ => style.steady,
        });
        HalfWidth {
            mps: spread.map_or((0.12 * speed_mps).max(1.5), |spread| spread.half_width_mps),
            is_fitted: spread.is_some(),
        }
    }

    /// The same driver with what trips tell of his style when each is kept back; none of a single trip.
    pub(super) fn with_style_of(self, recordings: &[&RecordedTrip]) -> Result<Self, Error> {
        let folds = MOST_FOLDS.min(recordings.len());
        if folds < 2 {
            return Ok(self);
        }
        let mut deviations = Deviations::default();
        for fold in 0..folds {
            let of_fold = |held_out: bool| {
                let trips = recordings.iter().enumerate();
                trips
                    .filter_map(move |(k, trip)| ((k % folds == fold) == held_out).then_some(*trip))
            };
            let driver = Self::fit_without_unrest(&of_fold(false).collect::<Vec<_>>())?;
            for trip in of_fold(true) {
                // A trip that is no road tells nothing.
                if let Ok(road) = Road::of_trip(trip, RoadKnowledge::StopsAndSlowdowns) {
                    deviations.add(&driver.drive(&road, STEP_S, None)?, trip);
                }
            }
        }
        let style = Style {
            speeding_up: spread(deviations.speeding_up),
            braking: spread(deviations.braking),
            steady: spread(deviations.steady),
            accelerations: accelerations(recordings),
        };
        style.check()?;
        Ok(Self {
            style: Some(style),
            ..self
        })
    }
}

#[derive(Default)]
struct Deviations {
    speeding_up: Vec<f64>,
    braking: Vec<f64>,
    steady: Vec<f64>,
}

impl Deviations {
    fn add(&mut self, run: &FreeRun, trip: &RecordedTrip) {
        let length_m = trip.length_m();
        let places = (length_m / PLACE_SPACING_M) as usize;
        for place in 1..places {
            let position_m = place as f64 * PLACE_SPACING_M;
            let index = index_at(&run.position_m, position_m);
            let own_mps = interpolated(&run.speed_mps, index);
            if own_mps < SLOWEST_MPS {
                continue;
            }
            let driven_mps = interpolated(&trip.speed_mps, index_at(&trip.distance_m, position_m));
            let around = [-1.0, 1.0].map(|side| interpolated(&run.speed_mps, index + side));
            let accel_mps2 = (around[1] - around[0]) / (2.0 * run.step_s);
            let kind = match accel_mps2 {
                a if a > STEADY_MPS2 => &mut self.speeding_up,
                a if a < -STEADY_MPS2 => &mut self.braking,
                _ => &mut self.steady,
            };
            kind.push((driven_mps - own_mps).abs());
        }
    }
}

/// Fractional index of a position among positions that do not fall.
fn index_at(positions_m: &[f64], position_m: f64) -> f64 {
    let next = positions_m.partition_point(|at| *at <= position_m);
    let Some(left) = next.checked_sub(1) else {
        return 0.0;
    };
    match positions_m.get(next) {
        Some(right) => {
            let from_m = positions_m[left];
            left as f64 + (position_m - from_m) / (right - from_m)
        }
        None => left as f64,
    }
}

fn spread(mut deviations_mps: Vec<f64>) -> Option<Spread> {
    deviations_mps.sort_by(f64::total_cmp);
    let half_width_mps = quantile(&deviations_mps, BAND_SHARE)?;
    (deviations_mps.len() >= LEAST_PLACES).then_some(Spread {
        half_width_mps,
        places: deviations_mps.len(),
    })
}

fn accelerations(recordings: &[&RecordedTrip]) -> Vec<AccelAtSpeed> {
    let mut bins: Vec<[Vec<f64>; 2]> = Vec::new();
    for trip in recordings {
        let every = trip.samples_in(ACCEL_STEP_S);
        let apart_s = every as f64 * trip.step_s;
        for (from, to) in trip
            .speed_mps
            .iter()
            .zip(&trip.speed_mps[every.min(trip.speed_mps.len())..])
        {
            let accel_mps2 = (to - from) / apart_s;
            if accel_mps2.abs() <= STEADY_MPS2 {
                continue;
            }
            // No car is faster than 1000 m/s in a recording.
            let bin = (0.5 * (from + to) / BIN_MPS) as usize;
            if bins.len() <= bin {
                bins.resize_with(bin + 1, Default::default);
            }
            bins[bin][usize::from(accel_mps2 < 0.0)].push(accel_mps2.abs());
        }
    }
    let percentile = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        quantile(values, ACCEL_SHARE).filter(|_| values.len() >= LEAST_ACCELS)
    };
    let at_bin = |(bin, [up, down]): (usize, &mut [Vec<f64>; 2])| {
        Some(AccelAtSpeed {
            speed_mps: (bin as f64 + 0.5) * BIN_MPS,
            accel_mps2: percentile(up)?.clamp(*ACCEL_MPS2.start(), *ACCEL_MPS2.end()),
            decel_mps2: percentile(down)?.clamp(*BRAKING_MPS2.start(), *BRAKING_MPS2.end()),
        })
    };
    bins.iter_mut().enumerate().filter_map(at_bin).collect()
}
