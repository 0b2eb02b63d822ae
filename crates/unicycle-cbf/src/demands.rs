//! What a scenario asks of its robots, held against what they and the lane have.

use serde::Serialize;

use crate::cbf::LaneBarrier;
use crate::scenario::Scenario;

/// A scenario's demands. Lengths in m, speeds in m/s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Demands {
    /// Half width of the lane
    pub half_width_m: f64,
    /// What errors would take of it at the wheels' limit
    pub margin_at_full_speed_m: f64,
    /// What they take of it at the speed at which it is driven
    pub margin_m: f64,
    /// Within this of the path the rows keep the point of interest
    pub kept_within_m: f64,
    /// Radius of the tightest bend where the lane is wider than that, see [`Scenario::tight_bend_m`]
    pub tight_bend_m: Option<f64>,
    /// The body's wheel limit
    pub wheel_limit_mps: f64,
    /// The one that is driven with
    pub driven_wheel_limit_mps: f64,
    /// Up to which wheels change fast enough for the lane; none where nothing asks for it
    pub agile_wheel_speed_mps: Option<f64>,
    /// Up to which the heading settles between samples; none where nothing asks for it
    pub settling_wheel_speed_mps: Option<f64>,
    /// Whether the guarantee is one for these settings: exponential rows of the lane, rows of the wheels, prediction from poses that are
    /// not older than stated, and margins for the time between samples
    pub is_guaranteed: bool,
    /// The largest start beside the path
    pub largest_start_m: f64,
    /// The fastest that any robot shall go, forward or back
    pub fastest_desired_mps: f64,
    /// Way to a stand from the driven limit, with the oldest pose that is acted on and a period
    pub stopping_m: f64,
    /// `D0` as set
    pub standstill_m: f64,
    /// `D0` as driven with: at least both radii and the clearance where every robot is regarded
    pub driven_standstill_m: f64,
    /// Between the middles of two axles at least
    pub least_distance_m: f64,
    /// First rate of the lane rows as set and as driven with, in 1/s
    pub lane_rate_1ps: [f64; 2],
    /// Largest angle to the path as set and as driven with, in rad
    pub course_angle_rad: Option<[f64; 2]>,
    /// Places where the path meets itself, at each of which one robot at a time goes through
    pub crossings: usize,
    /// Whether the headway is measured along the path though the chord was asked for
    pub along_path_instead: bool,
}

impl Demands {
    /// Those of a scenario that can be driven.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        let (spec, controller) = (scenario.spec(), scenario.controller());
        let (set, driven, limits) = (&spec.controller, controller.settings(), controller.limits());
        let desired = spec
            .robots
            .iter()
            .flat_map(|robot| &robot.desired_speed_mps);
        let starts_m = spec
            .robots
            .iter()
            .map(|robot| robot.start_deviation_m.abs());
        let speed_mps = limits.wheel_speed_mps;
        let blind_s = set.hardening.max_pose_age_s.unwrap_or(0.0) + controller.hold_s();
        let braking_m = 0.5 * speed_mps * speed_mps / controller.body().wheel_acceleration_mps2();
        Self {
            half_width_m: set.lane.half_width_m,
            margin_at_full_speed_m: limits.margin_at_full_speed_m,
            margin_m: limits.lane_margin_m,
            kept_within_m: limits.half_width_m,
            tight_bend_m: scenario.tight_bend_m(),
            wheel_limit_mps: spec.body.max_wheel_speed_mps,
            driven_wheel_limit_mps: speed_mps,
            agile_wheel_speed_mps: Some(limits.agile_mps).filter(|mps| mps.is_finite()),
            settling_wheel_speed_mps: Some(limits.settling_mps).filter(|mps| mps.is_finite()),
            is_guaranteed: set.hardening.wheel_rows
                && set.hardening.predict
                && set.hardening.sampling_margin
                && set.hardening.max_pose_age_s.is_some()
                && matches!(set.lane.barrier, LaneBarrier::Exponential { .. }),
            largest_start_m: starts_m.fold(0.0, f64::max),
            fastest_desired_mps: desired.map(|[_, v]| v.abs()).fold(0.0, f64::max),
            stopping_m: blind_s * speed_mps + braking_m,
            standstill_m: set.headway.standstill_m,
            driven_standstill_m: controller.standstill_m(),
            least_distance_m: controller.least_distance_m(),
            lane_rate_1ps: [set.lane.rate_1ps, driven.lane.rate_1ps],
            course_angle_rad: set
                .hardening
                .max_course_angle_rad
                .zip(driven.hardening.max_course_angle_rad)
                .map(|(set, driven)| [set, driven]),
            crossings: controller.crossings().len(),
            along_path_instead: set.headway.distance != driven.headway.distance,
        }
    }

    /// Whether some robot shall go faster than the lane allows.
    #[must_use]
    pub fn is_slowed(&self) -> bool {
        self.driven_wheel_limit_mps < self.fastest_desired_mps
    }
}
