//! What a run does otherwise than its scenario says, or takes where it says nothing.

use std::fmt::{Display, Formatter};

use unicycle_cbf::{Demands, ScenarioSpec};

/// One such thing, with its numbers; its text is a sentence.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Adaptation {
    /// The radius of bodies is not given
    Radius {
        /// In its place, in m
        taken_m: f64,
    },
    /// How fast wheels change their speed is not given
    WheelAcceleration {
        /// In its place, in m/s²
        taken_mps2: f64,
    },
    /// Nothing is said of guards
    Unguarded,
    /// A robot starts outside its lane
    StartsOutside {
        /// The largest start beside the path, in m
        start_m: f64,
        /// Half width of the lane, in m
        half_width_m: f64,
    },
    /// A robot starts within its lane and beyond what rows keep
    StartsBeyondRows {
        /// The largest start beside the path, in m
        start_m: f64,
        /// Within which rows keep robots, in m
        kept_within_m: f64,
    },
    /// Wheels are too sluggish for their full speed
    Agility {
        /// In m/s²
        acceleration_mps2: f64,
        /// In rad/s
        turn_rate_rad_s: f64,
        /// Up to which the robot turns fast enough, in m/s
        agile_mps: f64,
        /// What wheels can do, in m/s
        limit_mps: f64,
    },
    /// A command is held for too long for full speed
    Settling {
        /// Commands per second
        rate_hz: f64,
        /// From the axle to the point of interest, in m
        offset_m: f64,
        /// Up to which the heading settles, in m/s
        settling_mps: f64,
        /// What wheels can do, in m/s
        limit_mps: f64,
    },
    /// Wheels go slower than they can, so that stated errors fit the lane
    Slowed {
        /// As driven, in m/s
        driven_mps: f64,
        /// What wheels can do, in m/s
        limit_mps: f64,
        /// What errors would take of the half width at that, in m
        margin_at_full_speed_m: f64,
        /// In m
        half_width_m: f64,
        /// What they take, in m
        margin_m: f64,
    },
    /// The lane is wider than the path's tightest bend
    TightBend {
        /// Its radius, in m
        bend_m: f64,
        /// Within which robots are kept, in m; none where the nearest point of the path may jump
        kept_within_m: Option<f64>,
    },
    /// Rates of the lane are lower than set
    LaneRates {
        /// In 1/s
        driven_1ps: f64,
        /// In 1/s
        set_1ps: f64,
        /// Commands per second
        rate_hz: f64,
    },
    /// The standstill gap is larger than set
    Standstill {
        /// In m
        driven_m: f64,
        /// In m
        set_m: f64,
    },
    /// The path meets itself
    Crossings {
        /// At so many places
        count: usize,
    },
    /// The headway is measured along the path, and not as a chord
    AlongPath,
    /// Robots stay nearer to the path's direction than set
    CourseAngle {
        /// In rad
        driven_rad: f64,
        /// In rad
        set_rad: f64,
    },
}

impl Adaptation {
    /// All of a scenario with these demands.
    #[must_use]
    pub fn all(spec: &ScenarioSpec, demands: &Demands) -> Vec<Self> {
        let several = spec.robots.len() > 1;
        let mut all = Vec::new();
        all.extend(taken(spec));
        all.extend(starts_outside(demands));
        all.extend(starts_beyond_rows(demands));
        all.extend(agility(spec, demands));
        all.extend(settling(spec, demands));
        all.extend(slowed(demands));
        all.extend(tight_bend(demands));
        all.extend(lane_rates(spec, demands));
        if several {
            all.extend(of_several(demands));
        }
        all.extend(course_angle(demands));
        all
    }
}

fn taken(spec: &ScenarioSpec) -> impl Iterator<Item = Adaptation> {
    let body = &spec.body;
    let radius = body.radius_m.is_none().then(|| Adaptation::Radius {
        taken_m: body.radius_m(),
    });
    let is_asked = spec.controller.hardening.wheel_rows;
    let acceleration = body.max_wheel_acceleration_mps2.is_none() && is_asked;
    let acceleration = acceleration.then(|| Adaptation::WheelAcceleration {
        taken_mps2: body.wheel_acceleration_mps2(),
    });
    let unguarded = spec.controller.hardening.is_left_out();
    let unguarded = unguarded.then_some(Adaptation::Unguarded);
    radius.into_iter().chain(acceleration).chain(unguarded)
}

fn starts_outside(demands: &Demands) -> Option<Adaptation> {
    let is_outside = demands.largest_start_m >= demands.half_width_m;
    is_outside.then_some(Adaptation::StartsOutside {
        start_m: demands.largest_start_m,
        half_width_m: demands.half_width_m,
    })
}

fn starts_beyond_rows(demands: &Demands) -> Option<Adaptation> {
    let (start_m, kept_within_m) = (demands.largest_start_m, demands.kept_within_m);
    let is_beyond = start_m > kept_within_m && start_m < demands.half_width_m;
    (demands.is_guaranteed && is_beyond).then_some(Adaptation::StartsBeyondRows {
        start_m,
        kept_within_m,
    })
}

fn agility(spec: &ScenarioSpec, demands: &Demands) -> Option<Adaptation> {
    let agile_mps = demands.agile_wheel_speed_mps?;
    (agile_mps < demands.wheel_limit_mps).then(|| Adaptation::Agility {
        acceleration_mps2: spec.body.wheel_acceleration_mps2(),
        turn_rate_rad_s: spec.body.max_turn_rate_rad_s,
        agile_mps,
        limit_mps: demands.wheel_limit_mps,
    })
}

fn settling(spec: &ScenarioSpec, demands: &Demands) -> Option<Adaptation> {
    let settling_mps = demands.settling_wheel_speed_mps?;
    (settling_mps < demands.wheel_limit_mps).then_some(Adaptation::Settling {
        rate_hz: spec.rate_hz,
        offset_m: spec.body.offset_m,
        settling_mps,
        limit_mps: demands.wheel_limit_mps,
    })
}

fn slowed(demands: &Demands) -> Option<Adaptation> {
    let errors_fit = demands.margin_m >= demands.margin_at_full_speed_m;
    let is_slowed = demands.driven_wheel_limit_mps < demands.wheel_limit_mps && !errors_fit;
    is_slowed.then_some(Adaptation::Slowed {
        driven_mps: demands.driven_wheel_limit_mps,
        limit_mps: demands.wheel_limit_mps,
        margin_at_full_speed_m: demands.margin_at_full_speed_m,
        half_width_m: demands.half_width_m,
        margin_m: demands.margin_m,
    })
}

fn tight_bend(demands: &Demands) -> Option<Adaptation> {
    let bend_m = demands.tight_bend_m?;
    let kept_m = demands.kept_within_m;
    Some(Adaptation::TightBend {
        bend_m,
        kept_within_m: (kept_m < bend_m).then_some(kept_m),
    })
}

fn lane_rates(spec: &ScenarioSpec, demands: &Demands) -> Option<Adaptation> {
    let [set_1ps, driven_1ps] = demands.lane_rate_1ps;
    (driven_1ps < set_1ps).then_some(Adaptation::LaneRates {
        driven_1ps,
        set_1ps,
        rate_hz: spec.rate_hz,
    })
}

fn of_several(demands: &Demands) -> impl Iterator<Item = Adaptation> {
    let is_wider = demands.driven_standstill_m > demands.standstill_m;
    let standstill = is_wider.then_some(Adaptation::Standstill {
        driven_m: demands.driven_standstill_m,
        set_m: demands.standstill_m,
    });
    let count = demands.crossings;
    let crossings = (count > 0).then_some(Adaptation::Crossings { count });
    let along_path = demands.along_path_instead.then_some(Adaptation::AlongPath);
    [standstill, crossings, along_path].into_iter().flatten()
}

fn course_angle(demands: &Demands) -> Option<Adaptation> {
    let [set_rad, driven_rad] = demands.course_angle_rad?;
    (driven_rad < set_rad).then_some(Adaptation::CourseAngle {
        driven_rad,
        set_rad,
    })
}

impl Display for Adaptation {
    fn fmt(&self, out: &mut Formatter<'_>) -> std::fmt::Result {
        let mm = |m: f64| 1e3 * m;
        match *self {
            Self::Radius { taken_m } => write!(
                out,
                "the body's radius is not given; {taken_m:.3} m about the middle of the axle is taken (`radius_m` under [scenario.body])"
            ),
            Self::WheelAcceleration { taken_mps2 } => write!(
                out,
                "how fast wheels change their speed is not given; {taken_mps2:.1} m/s² is taken (`max_wheel_acceleration_mps2` under [scenario.body])"
            ),
            Self::Unguarded => write!(
                out,
                "guards are not given; none is taken (`--preset hardened`, or [scenario.controller.hardening])"
            ),
            Self::StartsOutside {
                start_m,
                half_width_m,
            } => write!(
                out,
                "a robot starts {:.1} mm beside the path, outside of its lane of {:.1} mm: the run is unsafe from its start",
                mm(start_m),
                mm(half_width_m)
            ),
            Self::StartsBeyondRows {
                start_m,
                kept_within_m,
            } => write!(
                out,
                "a robot starts {:.1} mm beside the path, and rows keep it within {:.1} mm: nothing is guaranteed until it is there",
                mm(start_m),
                mm(kept_within_m)
            ),
            Self::Agility {
                acceleration_mps2,
                turn_rate_rad_s,
                agile_mps,
                limit_mps,
            } => write!(
                out,
                "wheels that change their speed by {acceleration_mps2:.2} m/s² and a turn rate of {turn_rate_rad_s:.2} rad/s turn the robot fast enough for this lane, its bends and the stated errors up to {agile_mps:.3} m/s, and not at {limit_mps:.3} m/s"
            ),
            Self::Settling {
                rate_hz,
                offset_m,
                settling_mps,
                limit_mps,
            } => write!(
                out,
                "with {rate_hz:.1} commands per second and the point of interest {:.1} mm ahead of the axle the heading settles between commands up to {settling_mps:.3} m/s, and not at {limit_mps:.3} m/s",
                mm(offset_m)
            ),
            Self::Slowed {
                driven_mps,
                limit_mps,
                margin_at_full_speed_m,
                half_width_m,
                margin_m,
            } => write!(
                out,
                "wheels go at {driven_mps:.3} m/s at most, and not at {limit_mps:.3} m/s: then the stated errors of poses and wheels would take {:.1} mm of the half width of {:.1} mm; now they take {:.1} mm",
                mm(margin_at_full_speed_m),
                mm(half_width_m),
                mm(margin_m)
            ),
            Self::TightBend {
                bend_m,
                kept_within_m,
            } => {
                let bend_mm = mm(bend_m);
                write!(
                    out,
                    "the lane is wider than the path's tightest bend, whose radius is {bend_mm:.1} mm; "
                )?;
                match kept_within_m {
                    Some(m) => write!(out, "robots are kept within {:.1} mm of the path", mm(m)),
                    None => {
                        out.write_str("on its inner side the nearest point of the path may jump")
                    }
                }
            }
            Self::LaneRates {
                driven_1ps,
                set_1ps,
                rate_hz,
            } => write!(
                out,
                "the lane's rates are {:.0} % of those set: a command is held for {:.0} ms",
                100.0 * driven_1ps / set_1ps,
                1e3 / rate_hz
            ),
            Self::Standstill { driven_m, set_m } => write!(
                out,
                "the standstill gap is {:.1} mm, and not {:.1} mm: both radii and the clearance",
                mm(driven_m),
                mm(set_m)
            ),
            Self::Crossings { count } => write!(
                out,
                "the path meets itself at {count} place(s): one robot at a time goes through, in the order in which they came"
            ),
            Self::AlongPath => out.write_str(
                "the headway is measured along the path, and not as a chord: the path meets itself",
            ),
            Self::CourseAngle {
                driven_rad,
                set_rad,
            } => write!(
                out,
                "robots stay within {:.0}° of the path's direction, and not {:.0}°, so that branches are told apart where they meet",
                driven_rad.to_degrees(),
                set_rad.to_degrees()
            ),
        }
    }
}
