//! What a robot may do so that errors within their stated bounds cannot take it out of its lane.
//!
//! *The guarantee* of docs/methods/control.md. With `V` the largest speed of a wheel, `w` its relative error, `l` between the wheels,
//! `a` to the point of interest, `ε` and `ε_ψ` the noise, `A` the oldest pose that is acted on and `T` the period:
//!
//! ```text
//! turn rate  Δω = 2 w V/l                      of two wheels that are off in opposite ways
//! heading    Δψ = 2 ε_ψ + (A + T) Δω
//! place      e0 = 2 (ε + a ε_ψ) + V A (2 ε_ψ + Δω A/2)
//! ẏ          e1 = V Δψ + a Δω
//! ÿ          e2 = V Δω
//! margin     e0 + e1 (k1 + k2)/(k1 k2) + e2/(k1 k2)
//! turning    V κ + Δω + k1 Δψ                  at most the largest turn rate, in a bend of curvature κ
//! heading    (T + motors) (V/a + k1 + k2)      at most one: between samples it settles without overshooting
//! ```
//!
//! `ÿ + (k1 + k2) ẏ + k1 k2 y ≤ k1 k2 (d − margin)` holds for what the controller believes, hence with `d` for what is true, and then
//! `y ≤ d` is kept. Noise counts twice, because real noise exceeds a bound that was read off its standard deviation.

use crate::cbf::LaneBarrier;
use crate::error::Error;
use crate::lateral::Deviation;
use crate::path::Path;
use crate::settings::ControllerSettings;
use crate::unicycle::Body;

/// Share of the half width that margins may take at most: a robot at its limit has the rest to move in.
const MOST_OF_LANE: f64 = 0.8;
/// Share of the radius of the tightest bend that rows let the point of interest use.
const MOST_OF_BEND: f64 = 0.7;
/// What is left of the tightest bend at least, in m.
const LEAST_BEND_M: f64 = 2e-3;
/// How often noise is counted.
const NOISE_PEAKS: f64 = 2.0;
/// `(T + motors) (k1 + k2)` at most: what rows of a held command have to leave of the lane in a period.
const MOST_DECAY: f64 = 0.5;
/// Share of the stated wheel speed below which a scenario is refused.
const LEAST_SPEED_SHARE: f64 = 0.02;

/// The limits of one controller, and how they came about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Speed of each wheel, in m/s: the body's, or what fits the lane
    pub wheel_speed_mps: f64,
    /// Taken off the half width of the lane for errors, in m
    pub lane_margin_m: f64,
    /// What rows keep the point of interest within, in m: what the margin leaves, or the tightest bend
    pub half_width_m: f64,
    /// What would have to be taken off it at the body's wheel speed, in m
    pub margin_at_full_speed_m: f64,
    /// Up to which speed of the wheels the robot turns fast enough, back before the edge and round the tightest bend, errors and all, in m/s
    pub agile_mps: f64,
    /// Up to which speed of the wheels the heading settles between samples and does not overshoot, in m/s
    pub settling_mps: f64,
    /// `k1` and `k2` of exponential rows, else the lane's rate, in 1/s: as set, or as slow as the period asks for
    pub lane_rates_1ps: [f64; 2],
}

impl Limits {
    /// Time in which motors follow a command, in s.
    pub const MOTORS_S: f64 = 0.02;

    /// # Errors
    ///
    /// A lane that is too narrow for the errors at any speed.
    pub(crate) fn new(
        path: &Path,
        body: &Body,
        settings: &ControllerSettings,
        hold_s: f64,
    ) -> Result<Self, Error> {
        let errors = Errors::new(body, settings, hold_s);
        let half_width_m = settings.lane.half_width_m;
        let room_m = MOST_OF_LANE * half_width_m;
        let agile_mps = errors.agile_mps().min(errors.turning_mps(path)?);
        let settling_mps = errors.settling_mps()?;
        let full_mps = body.max_wheel_speed_mps.min(agile_mps).min(settling_mps);
        let margin_at_full_speed_m = errors.margin_m(full_mps);
        let at = |wheel_speed_mps| {
            let lane_margin_m = errors.margin_m(wheel_speed_mps);
            Self {
                wheel_speed_mps,
                lane_margin_m,
                half_width_m: (half_width_m - lane_margin_m).min(errors.bend_m(path)),
                margin_at_full_speed_m,
                agile_mps,
                settling_mps,
                lane_rates_1ps: errors.rates_1ps,
            }
        };
        if margin_at_full_speed_m <= room_m || !errors.are_any() {
            return Ok(at(full_mps));
        }
        let least_mps = LEAST_SPEED_SHARE * full_mps;
        if errors.margin_m(least_mps) > room_m {
            return Err(too_narrow(
                half_width_m,
                errors.margin_m(least_mps),
                least_mps,
            ));
        }
        Ok(at(errors.fastest_mps([least_mps, full_mps], room_m)))
    }
}

fn too_tight(bend_m: f64, noise_m: f64) -> Error {
    Error::DoesNotFit {
        what: format!(
            "the path is too tight: the radius of its tightest bend is {:.1} mm, of which {:.0} % have to be more than {:.1} mm and twice the noise of poses, \
             {:.1} mm; does it turn back on itself? give it rounder bends",
            1e3 * bend_m,
            100.0 * MOST_OF_BEND,
            1e3 * LEAST_BEND_M,
            1e3 * noise_m,
        ),
    }
}

fn too_slow(body: &Body, needed_rad_s: f64, least_mps: f64) -> Error {
    Error::DoesNotFit {
        what: format!(
            "the robot turns too slowly: for the tightest bend and the errors of headings and wheels that `hardening` states it has to turn by \
             {needed_rad_s:.3} rad/s even with wheels at {least_mps:.3} m/s, and `max_turn_rate_rad_s` is {:.3}; state smaller `heading_noise_rad`, \
             `wheel_error` or `max_pose_age_s`, or give the path rounder bends",
            body.max_turn_rate_rad_s,
        ),
    }
}

fn too_seldom(body: &Body, hold_s: f64, settling_mps: f64) -> Error {
    Error::DoesNotFit {
        what: format!(
            "commands are held for too long: with a point of interest {:.1} mm ahead of the axle and {:.1} Hz the heading settles at {settling_mps:.4} m/s \
             at most, which is less than {:.0} % of what wheels can do, {:.3} m/s; raise `rate_hz` or `offset_m`",
            1e3 * body.offset_m,
            1.0 / hold_s,
            100.0 * LEAST_SPEED_SHARE,
            body.max_wheel_speed_mps,
        ),
    }
}

fn too_narrow(half_width_m: f64, margin_m: f64, least_mps: f64) -> Error {
    Error::DoesNotFit {
        what: format!(
            "the lane is too narrow: the errors of poses and wheels that `hardening` states take {:.1} mm off its half width of {:.1} mm even \
             with wheels at {least_mps:.3} m/s, and {:.0} % may go; widen `lane.half_width_m`, or state smaller `position_noise_m`, \
             `heading_noise_rad`, `wheel_error`, `max_pose_age_s` or `lane.margin_m`",
            1e3 * margin_m,
            1e3 * half_width_m,
            100.0 * MOST_OF_LANE,
        ),
    }
}

/// What may be wrong, as stated.
struct Errors<'a> {
    body: &'a Body,
    settings: &'a ControllerSettings,
    hold_s: f64,
    rates_1ps: [f64; 2],
}

impl<'a> Errors<'a> {
    fn new(body: &'a Body, settings: &'a ControllerSettings, hold_s: f64) -> Self {
        let lane = &settings.lane;
        let rates_1ps = match lane.barrier {
            LaneBarrier::Exponential { rate_1ps } => [rate_1ps, lane.rate_1ps],
            LaneBarrier::Quadratic { .. } | LaneBarrier::Braking { .. } => [lane.rate_1ps; 2],
        };
        let mut errors = Self {
            body,
            settings,
            hold_s,
            rates_1ps,
        };
        if errors.is_exponential() && settings.hardening.sampling_margin {
            let decay = (hold_s + Limits::MOTORS_S) * (rates_1ps[0] + rates_1ps[1]);
            let share = (MOST_DECAY / decay).min(1.0);
            errors.rates_1ps = rates_1ps.map(|rate| share * rate);
        }
        errors
    }

    fn is_exponential(&self) -> bool {
        matches!(self.settings.lane.barrier, LaneBarrier::Exponential { .. })
    }

    /// Wheels that change by `α` in opposite ways move the point of interest across by `2 a α/l`; half of that is for other things. At
    /// the edge `k1 ẏ` is needed, and `ẏ` is at most the speed.
    fn agile_mps(&self) -> f64 {
        if !self.is_exponential() || !self.settings.hardening.wheel_rows {
            return f64::INFINITY;
        }
        let body = self.body;
        let across_mps2 = body.offset_m * body.wheel_acceleration_mps2() / body.wheel_base_m;
        across_mps2 / self.rates_1ps[0]
    }

    /// With a row of the lane active the heading decays by `V/a`, and what is done about it is held for a period: its next error is the share
    /// `1 − (T + motors) (V/a + k1 + k2)`, which is not to change its sign.
    fn settling_mps(&self) -> Result<f64, Error> {
        let hardening = &self.settings.hardening;
        if !self.is_exponential() || !hardening.wheel_rows || !hardening.sampling_margin {
            return Ok(f64::INFINITY);
        }
        let (body, [k1, k2]) = (self.body, self.rates_1ps);
        let held_s = self.hold_s + Limits::MOTORS_S;
        let settling_mps = body.offset_m * (1.0 / held_s - (k1 + k2));
        if settling_mps < LEAST_SPEED_SHARE * body.max_wheel_speed_mps {
            return Err(too_seldom(body, self.hold_s, settling_mps));
        }
        Ok(settling_mps)
    }

    /// What the turn rate allows: it is there for the tightest bend, for what wheels that are off turn the robot, and for undoing the
    /// error of the heading as fast as rows ask for, `ω_max ≥ V κ + Δω + k1 Δψ`.
    fn turning_mps(&self, path: &Path) -> Result<f64, Error> {
        let hardening = &self.settings.hardening;
        if !self.is_exponential() || !hardening.wheel_rows {
            return Ok(f64::INFINITY);
        }
        let noise_m = NOISE_PEAKS
            * (hardening.position_noise_m + self.body.offset_m * hardening.heading_noise_rad);
        let usable_m = self.bend_m(path);
        if usable_m <= noise_m.max(LEAST_BEND_M) {
            return Err(too_tight(usable_m / MOST_OF_BEND, noise_m));
        }
        let [k1, _] = self.rates_1ps;
        let age_s = hardening.max_pose_age_s.unwrap_or(0.0);
        let wheels_1pm = 2.0 * hardening.wheel_error / self.body.wheel_base_m;
        let by_speed_1pm =
            path.max_curvature_1pm() + wheels_1pm * (1.0 + k1 * (age_s + self.hold_s));
        let of_noise_rad_s = k1 * NOISE_PEAKS * hardening.heading_noise_rad;
        let turning_mps = (self.body.max_turn_rate_rad_s - of_noise_rad_s) / by_speed_1pm;
        let least_mps = LEAST_SPEED_SHARE * self.body.max_wheel_speed_mps;
        if turning_mps < least_mps {
            let needed_rad_s = of_noise_rad_s + by_speed_1pm * least_mps;
            return Err(too_slow(self.body, needed_rad_s, least_mps));
        }
        Ok(turning_mps)
    }

    /// Whether the margin is more than what was set by hand.
    fn are_any(&self) -> bool {
        self.margin_m(self.body.max_wheel_speed_mps) > self.settings.lane.margin_m
    }

    /// How far from the path places belong to one place of it.
    fn bend_m(&self, path: &Path) -> f64 {
        let radial = self.settings.lane.deviation == Deviation::Radial;
        if !self.is_exponential() || radial && matches!(path, Path::Polar(_)) {
            return f64::INFINITY;
        }
        MOST_OF_BEND / path.max_curvature_1pm()
    }

    fn margin_m(&self, wheel_speed_mps: f64) -> f64 {
        let (hardening, offset_m) = (&self.settings.hardening, self.body.offset_m);
        let age_s = hardening.max_pose_age_s.unwrap_or(0.0);
        let noise_rad = NOISE_PEAKS * hardening.heading_noise_rad;
        let noise_m = NOISE_PEAKS * hardening.position_noise_m + offset_m * noise_rad;
        let turn_rad_s = 2.0 * hardening.wheel_error * wheel_speed_mps / self.body.wheel_base_m;
        let heading_rad = noise_rad + (age_s + self.hold_s) * turn_rad_s;
        let place_m = noise_m + wheel_speed_mps * age_s * (noise_rad + 0.5 * turn_rad_s * age_s);
        let rate_mps = wheel_speed_mps * heading_rad + offset_m * turn_rad_s;
        let acceleration_mps2 = wheel_speed_mps * turn_rad_s;
        let [k1, k2] = self.rates_1ps;
        let farther_m = if self.is_exponential() {
            (rate_mps * (k1 + k2) + acceleration_mps2) / (k1 * k2)
        } else {
            0.0
        };
        self.settings.lane.margin_m + place_m + farther_m
    }

    /// The fastest wheels between two speeds whose margin fits, by bisection: it grows with the speed.
    fn fastest_mps(&self, [mut slow_mps, mut fast_mps]: [f64; 2], room_m: f64) -> f64 {
        for _ in 0..60 {
            let middle_mps = 0.5 * (slow_mps + fast_mps);
            if self.margin_m(middle_mps) <= room_m {
                slow_mps = middle_mps;
            } else {
                fast_mps = middle_mps;
            }
        }
        slow_mps
    }
}
