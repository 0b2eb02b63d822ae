//! A road out of drives along it.

use drive_log::Channel;

use super::profile::{self, climbed, elevations_of, grid_m};
use super::shared::{Place, shared};
use super::{DrawnRoad, Ends, counted, places};
use crate::motion;
use crate::road::file::not_a_road;
use crate::road::limit::is_same_limit;
use crate::road::{ElevationAt, LimitFrom, RoadFile, RoadStop, STANDSTILL_MPS, SlowPoint};
use crate::statistics::{mean, median};
use crate::trip_driver::RecordedTrip;
use crate::{Error, Motion};

/// Drives whose length differs by more than this share from the median are of another road.
const OTHER_LENGTH: f64 = 0.05;

/// A drive, with what its places are multiplied by to be those of the road.
struct Along<'a> {
    motion: &'a Motion,
    trip: RecordedTrip,
    scale: f64,
}

impl DrawnRoad {
    /// The road of one or several drives: places of each drive are stretched to the median length. Limits are at each place the median of the
    /// drives, of two in the middle the lower; stops and slow points are those that more than half of the drives have, with the medians of
    /// position, dwell and speed; elevation is the mean of what the drives climb.
    ///
    /// # Errors
    /// [`Error::Broken`] for a drive in pieces, [`Error::NotOneRoad`] for drives over 5 % longer or shorter than the median, [`Error::Road`]
    /// without a drive, [`Error::RoadValue`] for one that is too short or too long.
    pub fn of_drives(motions: &[Motion]) -> Result<Self, Error> {
        let drives: Vec<&Motion> = motion::drives(motions)
            .map(whole)
            .collect::<Result<_, _>>()?;
        let trips: Vec<RecordedTrip> = drives
            .iter()
            .map(|motion| RecordedTrip::of_any(motion))
            .collect::<Result<_, _>>()?;
        let lengths_m: Vec<f64> = trips.iter().map(|trip| trip.map().length_m).collect();
        let Some(length_m) = median(lengths_m.clone()) else {
            return Err(not_a_road(
                "the road",
                "no drive to draw it out of; give logs",
            ));
        };
        same_length(&drives, &lengths_m, length_m)?;
        let name = match &drives[..] {
            [one] => one.drive().to_owned(),
            drives => format!("the road of {} drives", drives.len()),
        };
        RoadFile::of_length(length_m).checked(&name)?;
        let along: Vec<Along> = drives
            .into_iter()
            .zip(trips)
            .map(|(motion, trip)| Along {
                motion,
                scale: length_m / trip.map().length_m.max(f64::MIN_POSITIVE),
                trip,
            })
            .collect();
        let mut findings = Vec::new();
        let start_speed_mps =
            middle_speed(along.iter().map(|drive| drive.trip.speed_mps().first()));
        let end_speed_mps = middle_speed(along.iter().map(|drive| drive.trip.speed_mps().last()));
        let ends = Ends {
            length_m,
            start_speed_mps,
            end_speed_mps,
        };
        let road = RoadFile {
            start_speed_mps,
            end_speed_mps,
            limits: limits(&along, length_m, &mut findings),
            stops: stops(&along, &ends, &mut findings),
            slow_points: Some(slow_points(&along, length_m, &mut findings)),
            elevation: elevation(&along, length_m, &mut findings),
            ..RoadFile::of_length(length_m)
        };
        Ok(Self {
            road: road.rounded().checked(&name)?,
            findings,
        })
    }
}

/// The one piece of a drive.
fn whole(pieces: &[Motion]) -> Result<&Motion, Error> {
    match pieces {
        [motion] => Ok(motion),
        pieces => Err(Error::Broken {
            log: motion::name(pieces).to_owned(),
            pieces: pieces.len(),
        }),
    }
}

fn same_length(drives: &[&Motion], lengths_m: &[f64], median_m: f64) -> Result<(), Error> {
    let is_other = |length_m: f64| (length_m - median_m).abs() > OTHER_LENGTH * median_m;
    let others = drives
        .iter()
        .zip(lengths_m)
        .filter(|(_, length_m)| is_other(**length_m));
    let others: Vec<(String, f64)> = others
        .map(|(motion, length_m)| (motion.drive().to_owned(), *length_m))
        .collect();
    match others.is_empty() {
        true => Ok(()),
        false => Err(Error::NotOneRoad { median_m, others }),
    }
}

/// The middle one of the drives' speeds, of two the lower; standstill is 0.
fn middle_speed<'a>(speeds_mps: impl Iterator<Item = Option<&'a f64>>) -> f64 {
    let speeds_mps = speeds_mps.flatten().copied();
    lower_median(
        speeds_mps
            .map(|v| if v < STANDSTILL_MPS { 0.0 } else { v })
            .collect(),
    )
}

fn lower_median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values
        .get(values.len().saturating_sub(1) / 2)
        .copied()
        .unwrap_or(0.0)
}

fn limits(along: &[Along], length_m: f64, findings: &mut Vec<String>) -> Vec<LimitFrom> {
    let known: Vec<&Along> = along
        .iter()
        .filter(|drive| drive.motion.limit_mps().is_some())
        .collect();
    if known.is_empty() {
        findings
            .push("no limits: the logs have none, or for less than half of the time".to_owned());
        return Vec::new();
    }
    if known.len() < along.len() {
        findings.push(format!(
            "limits are known to {} of {}",
            known.len(),
            counted(along.len(), "drive")
        ));
    }
    let mut starts_m: Vec<f64> = known
        .iter()
        .flat_map(|drive| {
            drive
                .trip
                .map()
                .limits
                .iter()
                .map(|limit| (limit.position_m * drive.scale).min(length_m))
        })
        .chain([0.0])
        .collect();
    starts_m.sort_by(f64::total_cmp);
    starts_m.dedup();
    let ends_m = starts_m[1..].iter().copied().chain([length_m]);
    let (mut limits, mut disagreed_m) = (Vec::<LimitFrom>::new(), 0.0);
    for (&position_m, end_m) in starts_m.iter().zip(ends_m) {
        let of_drives: Vec<f64> = known
            .iter()
            .map(|drive| drive.trip.map().limit_mps(position_m / drive.scale))
            .collect();
        if of_drives
            .iter()
            .any(|limit| !is_same_limit(*limit, of_drives[0]))
        {
            disagreed_m += end_m - position_m;
        }
        let limit_mps = lower_median(of_drives);
        if limits
            .last()
            .is_none_or(|last| !is_same_limit(last.limit_mps, limit_mps))
        {
            limits.push(LimitFrom {
                position_m,
                limit_mps,
            });
        }
    }
    if disagreed_m >= 1.0 {
        findings.push(format!(
            "the drives disagree about the limit over {disagreed_m:.0} of {length_m:.0} m: a limit begins in the middle of where it begins in the drives, of two at the lower limit"
        ));
    }
    limits
}

fn stops(along: &[Along], ends: &Ends, findings: &mut Vec<String>) -> Vec<RoadStop> {
    let of_drive = |(number, drive): (usize, &Along)| -> Vec<Place> {
        let stops = drive.trip.map().stops.iter();
        let place = |stop: &RoadStop| Place {
            drive: number,
            position_m: (stop.position_m * drive.scale).min(ends.length_m),
            value: stop.dwell_s,
        };
        stops
            .map(place)
            .filter(|place| !ends.stands_at(place.position_m))
            .collect()
    };
    let places = along.iter().enumerate().flat_map(of_drive).collect();
    let (stops, alone_m) = shared(places, along.len(), |a, b| a + b);
    mention_alone("stop", &alone_m, findings);
    let stops = stops.into_iter();
    stops
        .map(|(position_m, dwell_s)| RoadStop {
            position_m,
            dwell_s,
        })
        .collect()
}

fn slow_points(along: &[Along], length_m: f64, findings: &mut Vec<String>) -> Vec<SlowPoint> {
    let of_drive = |(number, drive): (usize, &Along)| -> Vec<Place> {
        let points = drive.trip.map().slow_points.iter().flatten();
        let place = |point: &SlowPoint| Place {
            drive: number,
            position_m: (point.position_m * drive.scale).min(length_m),
            value: point.speed_mps,
        };
        points.map(place).collect()
    };
    let places = along.iter().enumerate().flat_map(of_drive).collect();
    let (points, alone_m) = shared(places, along.len(), f64::min);
    mention_alone("slow point", &alone_m, findings);
    let points = points.into_iter();
    points
        .map(|(position_m, speed_mps)| SlowPoint {
            position_m,
            speed_mps,
        })
        .collect()
}

fn mention_alone(what: &str, alone_m: &[f64], findings: &mut Vec<String>) {
    if !alone_m.is_empty() {
        findings.push(format!(
            "{} that no more than half of the drives have left out, {}",
            counted(alone_m.len(), what),
            places(alone_m)
        ));
    }
}

fn elevation(along: &[Along], length_m: f64, findings: &mut Vec<String>) -> Vec<ElevationAt> {
    let grid_m = grid_m(length_m);
    let mut climbed_m = vec![0.0; grid_m.len()];
    let (mut drives, mut starts_m) = (0, Vec::new());
    for drive in along {
        let Some(slope_rad) = drive.motion.slope_rad() else {
            continue;
        };
        let place_m: Vec<f64> = drive
            .trip
            .distance_m()
            .iter()
            .map(|m| m * drive.scale)
            .collect();
        let of_drive = climbed(&place_m, slope_rad);
        for (sum, place) in climbed_m.iter_mut().zip(&grid_m) {
            *sum += profile::at(&place_m, &of_drive, *place);
        }
        drives += 1;
        let recorded_m = drive
            .motion
            .log()
            .channel(Channel::Elevation)
            .unwrap_or_default();
        let above = recorded_m
            .iter()
            .zip(&of_drive)
            .map(|(recorded, climbed)| recorded - climbed);
        starts_m.extend(mean(above.filter(|m| m.is_finite())));
    }
    if drives == 0 {
        findings.push("no elevation and no slope in the logs: a level road".to_owned());
        return Vec::new();
    }
    if drives < along.len() {
        findings.push(format!(
            "elevation or slope are known to {drives} of {}",
            counted(along.len(), "drive")
        ));
    }
    let start_m = mean(starts_m).unwrap_or_else(|| {
        findings.push(
            "the logs have slope and no elevation: elevations count from the start".to_owned(),
        );
        0.0
    });
    climbed_m.iter_mut().for_each(|sum| *sum /= drives as f64);
    elevations_of(&grid_m, &climbed_m, start_m)
}
