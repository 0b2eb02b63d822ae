//! What trips cost beyond evenly driven ones.

use std::ops::RangeInclusive;

use ev_energy::{Trip, Vehicle};

use super::TripDriver;
use super::recording::RecordedTrip;
use crate::Error;
use crate::road::{Road, RoadKnowledge};

/// Range that is searched, and how often it is halved.
pub(super) const UNREST_MPS2: RangeInclusive<f64> = 0.0..=3.0;
const BISECTIONS: usize = 14;

/// A car between small and large stands for all: the same unrest costs others about as much more.
const VEHICLE: &str = "b250e";

/// Energies are compared on this grid: finer ones would charge the noise of the recorded speed.
const GRID_S: f64 = 1.0;

/// A speed that rises and falls by this acceleration around the given one, from sample to sample. Where the car is slower than that it
/// does not.
///
/// ```
/// let speed_mps = driver_model::trip_driver::restless(&[10.0; 4], 1.0, 0.4);
/// assert_eq!(speed_mps, [10.2, 9.8, 10.2, 9.8]);
/// ```
#[must_use]
pub fn restless(speed_mps: &[f64], step_s: f64, unrest_mps2: f64) -> Vec<f64> {
    let swing_mps = 0.5 * unrest_mps2 * step_s;
    let swung = |(k, &speed_mps): (usize, &f64)| match speed_mps > 2.0 * swing_mps {
        true if k % 2 == 0 => speed_mps + swing_mps,
        true => speed_mps - swing_mps,
        false => speed_mps,
    };
    speed_mps.iter().enumerate().map(swung).collect()
}

impl TripDriver {
    /// The same driver with the unrest at which free runs over the roads of these trips, whose slowdowns are not known, cost what the
    /// trips did; none where the plain plan costs as much. Trips that are no road tell nothing.
    pub(super) fn with_unrest_of(self, recordings: &[&RecordedTrip]) -> Result<Self, Error> {
        let vehicle = Vehicle::builtin(VEHICLE)?;
        let cost_j = |speed_mps: &[f64], slope_rad: Option<&[f64]>| -> Result<f64, Error> {
            let trip = Trip {
                step_s: GRID_S,
                speed_mps,
                slope_rad,
                ..Trip::default()
            };
            Ok(vehicle.trip_energy(&trip)?.terminal_energy_j)
        };
        let (mut measured_j, mut runs) = (0.0, Vec::new());
        for trip in recordings {
            let Ok(road) = Road::of_trip(trip, RoadKnowledge::Stops) else {
                continue;
            };
            let (speed_mps, slope_rad) = trip.on_grid(GRID_S);
            measured_j += cost_j(&speed_mps, slope_rad.as_deref())?;
            runs.push(self.drive(&road, GRID_S, None)?);
        }
        let costs_less = |unrest_mps2: f64| -> Result<bool, Error> {
            let cost_j = runs.iter().map(|run| {
                let speed_mps = restless(&run.speed_mps, GRID_S, unrest_mps2);
                cost_j(&speed_mps, run.slope_rad.as_deref())
            });
            Ok(cost_j.sum::<Result<f64, Error>>()? < measured_j)
        };
        let (mut low, mut high) = (*UNREST_MPS2.start(), *UNREST_MPS2.end());
        if !costs_less(low)? {
            return Ok(self);
        }
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if costs_less(middle)? {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(Self {
            unrest_mps2: low,
            ..self
        })
    }
}
