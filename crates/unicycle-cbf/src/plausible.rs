//! Numbers that no small robot has, as they come from files in another unit.

use std::f64::consts::TAU;

use crate::error::{Error, Plain};
use crate::scenario::{PathSpec, RobotSpec, ScenarioSpec};
use crate::settings::ControllerSettings;
use crate::unicycle::Body;

/// Most of a robot's lengths, in m.
const LENGTH_M: f64 = 2.0;
/// Distance of the wheels that a robot may have, in m.
const WHEEL_BASE_M: [f64; 2] = [0.001, LENGTH_M];
/// Most of half a lane's width, in m.
const HALF_WIDTH_M: f64 = 10.0;
/// Most of speeds, in m/s, and of acceleration, in m/s².
const SPEED_MPS: f64 = 10.0;
const ACCELERATION_MPS2: f64 = 1000.0;
/// How much faster than its wheels a robot may be wanted to go, and how often as fast as they turn it it may turn.
const TIMES: f64 = 10.0;
/// Turn rates up to here are believed of any robot, in rad/s.
const TURN_RATE_RAD_S: f64 = 20.0;
/// Between the lightest and the heaviest body, in kg for each m³ of a cube that holds it.
const DENSITY_KGPM3: [f64; 2] = [0.5, 2e4];
/// Least and most of `I_z`, as a share of `m r²`, which is that of a hoop.
const OF_HOOP: [f64; 2] = [1e-3, 4.0];
/// How many wheel bases the radius of a polar path has at most, and how many a path of points reaches.
const RADIUS_IN_BASES: f64 = 1000.0;
const REACH_IN_BASES: f64 = 5000.0;
/// Most of a place, in m: coordinates of maps are smaller.
const PLACE_M: f64 = 1e7;
/// Most of the noise of poses, in m and rad.
const NOISE_M: f64 = 0.2;
const NOISE_RAD: f64 = 0.3;
/// Oldest pose that robots may be driven on, in s.
const AGE_S: f64 = 10.0;

const LENGTHS: &str = "lengths are in m: were mm or cm meant?";
const SPEEDS: &str = "speeds are in m/s: were mm/s or cm/s meant?";
const ANGLES: &str = "angles are in rad: were degrees meant?";

impl ScenarioSpec {
    /// # Errors
    ///
    /// The first number that is likely to be in another unit.
    pub(crate) fn check_units(&self) -> Result<(), Error> {
        within(
            "rate_hz",
            self.rate_hz,
            [1.0, 1000.0],
            "it counts poses and commands per second: was the time between two meant?",
        )?;
        self.body.check_units()?;
        self.path.check_units(&self.body)?;
        self.controller.check_units()?;
        let is_loop = !matches!(self.path, PathSpec::Straight { .. });
        let robots = self.robots.iter().enumerate();
        for (robot, own) in robots {
            own.check_units(robot, &self.body, is_loop)?;
        }
        Ok(())
    }
}

/// Where a number is beyond what is believed; what is no number or not positive is refused elsewhere.
fn at_most(name: &'static str, value: f64, most: f64, help: &'static str) -> Result<(), Error> {
    if value.abs() > most {
        return Err(Error::Unit {
            name,
            value,
            believed: format!("up to {}", rounded(most)),
            help,
        });
    }
    Ok(())
}

fn within(
    name: &'static str,
    value: f64,
    [least, most]: [f64; 2],
    help: &'static str,
) -> Result<(), Error> {
    if value > 0.0 && !(least..=most).contains(&value) {
        return Err(Error::Unit {
            name,
            value,
            believed: format!("from {} to {}", rounded(least), rounded(most)),
            help,
        });
    }
    Ok(())
}

/// To three digits.
fn rounded(value: f64) -> f64 {
    let scale = 10.0_f64.powi(2 - value.abs().log10().floor() as i32);
    (value * scale).round() / scale
}

impl Body {
    fn check_units(&self) -> Result<(), Error> {
        let lengths = [
            ("body.wheel_base_m", self.wheel_base_m),
            ("body.offset_m", self.offset_m),
            ("body.radius_m", self.radius_m()),
        ];
        for (name, value_m) in lengths {
            at_most(name, value_m, LENGTH_M, LENGTHS)?;
        }
        within(
            "body.wheel_base_m",
            self.wheel_base_m,
            WHEEL_BASE_M,
            LENGTHS,
        )?;
        let speed_mps = self.max_wheel_speed_mps;
        at_most("body.max_wheel_speed_mps", speed_mps, SPEED_MPS, SPEEDS)?;
        at_most(
            "body.max_wheel_acceleration_mps2",
            self.wheel_acceleration_mps2(),
            ACCELERATION_MPS2,
            "accelerations are in m/s²: were mm/s² meant?",
        )?;
        let by_wheels_rad_s = 2.0 * speed_mps / self.wheel_base_m;
        at_most(
            "body.max_turn_rate_rad_s",
            self.max_turn_rate_rad_s,
            TURN_RATE_RAD_S.max(TIMES * by_wheels_rad_s),
            "turn rates are in rad/s: were degrees meant? Where only the wheels limit it, give twice their speed by their distance",
        )?;
        self.check_radius()?;
        self.check_mass()
    }

    fn check_radius(&self) -> Result<(), Error> {
        let (radius_m, half_m) = (self.radius_m(), 0.5 * self.wheel_base_m);
        if radius_m >= (1.0 - 1e-9) * half_m {
            return Ok(());
        }
        Err(Error::Contradiction {
            what: format!(
                "`body.radius_m` is {radius_m}, and the wheels stand out of it: it is that of the circle about the middle of the axle that holds \
                 the whole robot, hence half of `wheel_base_m`, {half_m}, at least; both are in m"
            ),
        })
    }

    fn check_mass(&self) -> Result<(), Error> {
        let (mass_kg, radius_m) = (self.mass_kg, self.radius_m());
        if mass_kg.is_nan() || mass_kg <= 0.0 {
            return Ok(());
        }
        let cube_m3 = (2.0 * radius_m).powi(3);
        let masses_kg = DENSITY_KGPM3.map(|density_kgpm3| density_kgpm3 * cube_m3);
        within(
            "body.mass_kg",
            mass_kg,
            masses_kg,
            "for a body of this `radius_m`; masses are in kg: were g meant?",
        )?;
        let hoop_kgm2 = mass_kg * radius_m * radius_m;
        within(
            "body.inertia_kgm2",
            self.inertia_kgm2,
            OF_HOOP.map(|share| share * hoop_kgm2),
            "for this `mass_kg` and `radius_m`; it is in kg m², about the vertical axis: were kg cm² or g m² meant?",
        )
    }
}

impl PathSpec {
    fn check_units(&self, body: &Body) -> Result<(), Error> {
        let bases_m = |count: f64| count * body.wheel_base_m;
        match self {
            Self::Straight {
                x_m,
                y_m,
                heading_rad,
            } => {
                at_most("path.x_m", *x_m, PLACE_M, LENGTHS)?;
                at_most("path.y_m", *y_m, PLACE_M, LENGTHS)?;
                at_most("path.heading_rad", *heading_rad, TAU, ANGLES)
            }
            Self::Polar {
                radius_m,
                amplitude_m,
                ..
            } => {
                let most_m = bases_m(RADIUS_IN_BASES);
                at_most("path.radius_m", *radius_m, most_m, LENGTHS)?;
                at_most("path.amplitude_m", *amplitude_m, most_m, LENGTHS)
            }
            Self::Closed { points_m } => {
                let first = points_m.first().copied().unwrap_or_default();
                let far_m = points_m
                    .iter()
                    .flat_map(|point| [point[0] - first[0], point[1] - first[1]]);
                let far_m = far_m.map(f64::abs).fold(0.0, f64::max);
                at_most(
                    "path.points_m, from the first point on,",
                    far_m,
                    bases_m(REACH_IN_BASES),
                    LENGTHS,
                )
            }
        }
    }
}

impl ControllerSettings {
    fn check_units(&self) -> Result<(), Error> {
        let (headway, lane, own) = (&self.headway, &self.lane, &self.hardening);
        at_most(
            "lane.half_width_m",
            lane.half_width_m,
            HALF_WIDTH_M,
            LENGTHS,
        )?;
        let lengths = [
            (
                "headway.standstill_m",
                headway.standstill_m,
                10.0 * LENGTH_M,
            ),
            ("headway.clearance_m", headway.clearance_m, LENGTH_M),
            ("headway.margin_m", headway.margin_m, LENGTH_M),
            ("lane.margin_m", lane.margin_m, HALF_WIDTH_M),
            ("hardening.position_noise_m", own.position_noise_m, NOISE_M),
        ];
        for (name, value_m, most_m) in lengths {
            at_most(name, value_m, most_m, LENGTHS)?;
        }
        let angles = [
            (
                "hardening.heading_noise_rad",
                Some(own.heading_noise_rad),
                NOISE_RAD,
            ),
            (
                "hardening.max_course_angle_rad",
                own.max_course_angle_rad,
                TAU,
            ),
        ];
        for (name, value_rad, most_rad) in angles {
            at_most(name, value_rad.unwrap_or(0.0), most_rad, ANGLES)?;
        }
        let seconds = "times are in s: were ms meant?";
        at_most("headway.time_s", headway.time_s, 100.0, seconds)?;
        let age_s = own.max_pose_age_s.unwrap_or(0.0);
        at_most("hardening.max_pose_age_s", age_s, AGE_S, seconds)?;
        let share = "it is a share: were percent meant?";
        at_most("hardening.wheel_error", own.wheel_error, 0.5, share)
    }
}

impl RobotSpec {
    fn check_units(&self, robot: usize, body: &Body, is_loop: bool) -> Result<(), Error> {
        let refuse = |what: String| Err(Error::Start { robot, what });
        let reach_m = REACH_IN_BASES * body.wheel_base_m;
        if !is_loop && self.start.abs() > reach_m {
            return refuse(format!(
                "has `start` {:e}; on a straight path it is in m, from {2:.0} to {1:.0}, {REACH_IN_BASES} times `wheel_base_m`: were mm or cm meant?",
                self.start, reach_m, -reach_m
            ));
        }
        if is_loop && self.start.abs() > 1.0 {
            return refuse(format!(
                "has `start` {}; on a closed path it is in revolutions, from -1 to 1: were degrees or m meant?",
                Plain(self.start)
            ));
        }
        if self.start_deviation_m.abs() > HALF_WIDTH_M {
            return refuse(format!(
                "starts {} m beside the path, and {HALF_WIDTH_M} m are the most; {LENGTHS}",
                Plain(self.start_deviation_m)
            ));
        }
        let most_mps = SPEED_MPS.min(TIMES * body.max_wheel_speed_mps);
        let mut speeds_mps = self.desired_speed_mps.iter().map(|[_, mps]| *mps);
        if let Some(speed_mps) = speeds_mps.find(|mps| mps.abs() > most_mps) {
            return refuse(format!(
                "is wanted to go at {} m/s, and its wheels go at {} m/s; {SPEEDS}",
                Plain(speed_mps),
                body.max_wheel_speed_mps
            ));
        }
        Ok(())
    }
}
