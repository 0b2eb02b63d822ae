//! What no road has is refused with its place, its value and what would do.

use std::f64::consts::FRAC_PI_2;

use super::text::in_either;
use super::{FASTEST_MPS, Green, RoadFile, Signal, not_a_road};
use crate::Error;
use crate::road::limit::LIMIT_MPS;
use crate::road::{HIGHEST_M, STANDSTILL_MPS};

const LENGTH_M: std::ops::RangeInclusive<f64> = 1.0..=1e6;

const MOST_ENTRIES: usize = 1_000_000;

/// Longest times, s: thirty years.
const LONGEST_S: f64 = 1e9;

/// Longest stand, s: eleven days.
const LONGEST_STAND_S: f64 = 1e6;

/// Times from one green to the next, s: up to a day.
const CYCLE_S: std::ops::RangeInclusive<f64> = 1.0..=86_400.0;

/// Green windows of one signal, at most.
const MOST_WINDOWS: usize = 10_000;

impl RoadFile {
    /// Refuses what no road has; `file` names it in errors.
    ///
    /// # Errors
    /// [`Error::RoadValue`] for positions off the road or out of order and for values out of range, [`Error::Road`] for elevation and slope at once,
    /// and for more than a million entries.
    pub fn checked(self, file: &str) -> Result<Self, Error> {
        let check = Check {
            file,
            length_m: self.length_m,
        };
        check.value(
            "length_m",
            self.length_m,
            LENGTH_M.contains(&self.length_m),
            || "a road has 1 m to 1000 km; split a longer one".to_owned(),
        )?;
        let ends = [
            ("start_speed", self.start_speed_mps),
            ("end_speed", self.end_speed_mps),
        ];
        for (key, speed_mps) in ends {
            check.speed(
                key,
                speed_mps,
                0.0,
                FASTEST_MPS,
                "a speed from 0 to 3600 km/h",
            )?;
        }
        check.entries(&self)?;
        check.speeds(&self)?;
        check.profile(&self)?;
        check.curves(&self)?;
        check.signals(&self.signals)?;
        check.leader(&self)?;
        Ok(self)
    }
}

struct Check<'a> {
    file: &'a str,
    length_m: f64,
}

impl Check<'_> {
    fn value(
        &self,
        place: &str,
        value: f64,
        is_good: bool,
        expected: impl FnOnce() -> String,
    ) -> Result<(), Error> {
        if is_good {
            return Ok(());
        }
        Err(Error::RoadValue {
            file: self.file.to_owned(),
            place: place.to_owned(),
            value,
            expected: expected(),
        })
    }

    fn range(&self, place: &str, value: f64, from: f64, to: f64, unit: &str) -> Result<(), Error> {
        self.value(place, value, (from..=to).contains(&value), || {
            format!("give a number from {from} to {to} {unit}")
        })
    }

    /// A speed, named in the unit that it was most likely given in.
    fn speed(
        &self,
        place: &str,
        mps: f64,
        from: f64,
        to: f64,
        expected: &str,
    ) -> Result<(), Error> {
        let (place, value) = match in_either(mps) {
            (Some(kmh), _) => (format!("{place}_kmh"), kmh),
            (None, _) => (format!("{place}_mps"), mps),
        };
        let is_good = (from..=to).contains(&mps);
        self.value(&place, value, is_good, || format!("give {expected}"))
    }

    fn entries(&self, road: &RoadFile) -> Result<(), Error> {
        let slow_points = road.slow_points.as_ref().map_or(0, Vec::len);
        let windows = road.signals.iter().map(|signal| match &signal.green {
            Green::Windows { green_s } => green_s.len(),
            Green::Cycle { .. } => 1,
        });
        for (key, entries) in [
            ("limits", road.limits.len()),
            ("stops", road.stops.len()),
            ("slow_points", slow_points),
            ("curves", road.curves.len()),
            ("elevation", road.elevation.len()),
            ("slope", road.slope.len()),
            ("signals", road.signals.len().max(windows.sum())),
            ("leader", road.leader.len()),
        ] {
            if entries > MOST_ENTRIES {
                let reason = format!(
                    "{key} has {entries} entries, at most {MOST_ENTRIES} are read; thin them out"
                );
                return Err(not_a_road(self.file, reason));
            }
        }
        Ok(())
    }

    /// Positions of a list: on the road, each beyond the one before.
    fn positions(&self, key: &str, positions_m: impl Iterator<Item = f64>) -> Result<(), Error> {
        let mut last_m = f64::NEG_INFINITY;
        for (number, position_m) in positions_m.enumerate() {
            let place = || format!("{key}[{number}].position_m");
            let length_m = self.length_m;
            if !(0.0..=length_m).contains(&position_m) {
                return self.value(&place(), position_m, false, || {
                    format!("give a position on the road, 0 to length_m = {length_m}, or lengthen the road")
                });
            }
            if position_m <= last_m {
                return self.value(&place(), position_m, false, || {
                    format!(
                        "the one before is at {last_m}; give each position once, in ascending order"
                    )
                });
            }
            last_m = position_m;
        }
        Ok(())
    }

    fn speeds(&self, road: &RoadFile) -> Result<(), Error> {
        self.positions("limits", road.limits.iter().map(|l| l.position_m))?;
        for (number, limit) in road.limits.iter().enumerate() {
            let (lowest, highest) = (*LIMIT_MPS.start(), *LIMIT_MPS.end());
            let expected = "a limit from 1.8 to 400 km/h; where the car stands is a stop";
            self.speed(
                &format!("limits[{number}].limit"),
                limit.limit_mps,
                lowest,
                highest,
                expected,
            )?;
        }
        self.positions("stops", road.stops.iter().map(|s| s.position_m))?;
        for (number, stop) in road.stops.iter().enumerate() {
            self.range(
                &format!("stops[{number}].dwell_s"),
                stop.dwell_s,
                0.0,
                LONGEST_STAND_S,
                "s",
            )?;
        }
        let slow_points = road.slow_points.as_deref().unwrap_or_default();
        self.positions("slow_points", slow_points.iter().map(|p| p.position_m))?;
        for (number, point) in slow_points.iter().enumerate() {
            let expected = "a speed from 1.08 km/h (0.3 m/s); where the car stands is a stop";
            let place = format!("slow_points[{number}].speed");
            self.speed(
                &place,
                point.speed_mps,
                STANDSTILL_MPS,
                FASTEST_MPS,
                expected,
            )?;
        }
        Ok(())
    }

    fn profile(&self, road: &RoadFile) -> Result<(), Error> {
        if !road.elevation.is_empty() && !road.slope.is_empty() {
            return Err(not_a_road(
                self.file,
                "elevation and slope say the same twice; give one of them",
            ));
        }
        self.positions("elevation", road.elevation.iter().map(|e| e.position_m))?;
        for (number, at) in road.elevation.iter().enumerate() {
            let place = format!("elevation[{number}].elevation_m");
            self.range(&place, at.elevation_m, -HIGHEST_M, HIGHEST_M, "m")?;
        }
        self.positions("slope", road.slope.iter().map(|s| s.position_m))?;
        for (number, at) in road.slope.iter().enumerate() {
            let place = format!("slope[{number}].slope_rad");
            let is_good = at.slope_rad.abs() < FRAC_PI_2;
            self.value(&place, at.slope_rad, is_good, || {
                "give an angle between -π/2 and π/2 rad, or grade_pct".to_owned()
            })?;
        }
        Ok(())
    }

    fn curves(&self, road: &RoadFile) -> Result<(), Error> {
        let mut last_m = 0.0;
        for (number, curve) in road.curves.iter().enumerate() {
            let place = |key: &str| format!("curves[{number}].{key}");
            let (from_m, to_m, length_m) = (curve.from_m, curve.to_m, self.length_m);
            self.value(&place("from_m"), from_m, (last_m..=length_m).contains(&from_m), || {
                format!("give a position from {last_m}, where the curve before ends, to length_m = {length_m}")
            })?;
            self.value(
                &place("to_m"),
                to_m,
                to_m > from_m && to_m <= length_m,
                || format!("give a position beyond from_m = {from_m}, up to length_m = {length_m}"),
            )?;
            let radius_m = curve.radius_m;
            self.value(
                &place("radius_m"),
                radius_m,
                radius_m > 0.0 && radius_m.is_finite(),
                || "give a radius over 0 m; a straight is no curve".to_owned(),
            )?;
            last_m = to_m;
        }
        Ok(())
    }

    fn signals(&self, signals: &[Signal]) -> Result<(), Error> {
        self.positions("signals", signals.iter().map(|s| s.position_m))?;
        for (number, signal) in signals.iter().enumerate() {
            match &signal.green {
                Green::Windows { green_s } => self.windows(number, green_s)?,
                &Green::Cycle {
                    cycle_s,
                    green_from_s,
                    green_s,
                } => {
                    let place = |key: &str| format!("signals[{number}].{key}");
                    let is_good = CYCLE_S.contains(&cycle_s);
                    self.value(&place("cycle_s"), cycle_s, is_good, || {
                        "give the time from one green to the next, 1 s to a day (86400 s)"
                            .to_owned()
                    })?;
                    self.range(
                        &place("green_from_s"),
                        green_from_s,
                        -LONGEST_S,
                        LONGEST_S,
                        "s",
                    )?;
                    let is_good = green_s > 0.0 && green_s <= cycle_s;
                    self.value(&place("green_s"), green_s, is_good, || {
                        format!("give how long it is green, over 0 s and up to cycle_s = {cycle_s}")
                    })?;
                }
            }
        }
        Ok(())
    }

    fn windows(&self, signal: usize, green_s: &[[f64; 2]]) -> Result<(), Error> {
        if green_s.is_empty() {
            let reason = format!(
                "signals[{signal}].green_s is empty, so that nobody could pass; give a window [from, to]"
            );
            return Err(not_a_road(self.file, reason));
        }
        if green_s.len() > MOST_WINDOWS {
            let reason = format!(
                "signals[{signal}].green_s has {} windows, at most {MOST_WINDOWS} are read; give those of this trip, or a cycle",
                green_s.len()
            );
            return Err(not_a_road(self.file, reason));
        }
        let mut last_s = -LONGEST_S;
        for (number, &[from_s, to_s]) in green_s.iter().enumerate() {
            let place = |end: usize| format!("signals[{signal}].green_s[{number}][{end}]");
            self.value(&place(0), from_s, (last_s..=LONGEST_S).contains(&from_s), || match number {
                0 => "give a time in s from the start of the trip".to_owned(),
                _ => format!("the window before ends at {last_s}; give windows in order that do not overlap"),
            })?;
            self.value(&place(1), to_s, to_s > from_s && to_s <= LONGEST_S, || {
                format!("the window begins at {from_s}; give an end after it")
            })?;
            last_s = to_s;
        }
        Ok(())
    }

    fn leader(&self, road: &RoadFile) -> Result<(), Error> {
        if road.leader.len() == 1 {
            let reason = "leader has one entry, which does not say how it drives; give its place at two times or more";
            return Err(not_a_road(self.file, reason));
        }
        let mut last = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for (number, at) in road.leader.iter().enumerate() {
            let place = |key: &str| format!("leader[{number}].{key}");
            self.range(&place("time_s"), at.time_s, -LONGEST_S, LONGEST_S, "s")?;
            self.value(&place("time_s"), at.time_s, at.time_s > last.0, || {
                format!(
                    "the time before is {}; give each time once, in ascending order",
                    last.0
                )
            })?;
            self.range(
                &place("position_m"),
                at.position_m,
                -LONGEST_S,
                LONGEST_S,
                "m",
            )?;
            self.value(&place("position_m"), at.position_m, at.position_m >= last.1, || {
                format!("it was at {} before, and a leader does not drive backwards; give places in the order of the road", last.1)
            })?;
            last = (at.time_s, at.position_m);
        }
        Ok(())
    }
}
