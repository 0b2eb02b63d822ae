//! The built-in scenarios: the five runs of the thesis (Table 4.1) and those that go beyond it.

use serde::Serialize;
use strum::{EnumMessage, EnumString, IntoStaticStr, VariantArray};

use crate::cbf::LaneBarrier;
use crate::error::Error;
use crate::lateral::Deviation;
use crate::radii;
use crate::scenario::{PathSpec, RobotSpec, ScenarioSpec, Tracker};
use crate::settings::{
    ControllerSettings, Distance, Hardening, HeadwaySettings, LaneSettings, Preset,
};
use crate::unicycle::{Body, Centripetal};

/// The robots that the thesis used.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Serialize,
    EnumMessage,
    EnumString,
    IntoStaticStr,
    VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Testbed {
    /// Khepera III under OptiTrack, 50 Hz
    Khepera,
    /// Robotarium, 30 Hz
    Robotarium,
}

impl Testbed {
    /// All of them.
    pub const ALL: &'static [Self] = Self::VARIANTS;

    /// As in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Names of its scenarios, those of the thesis first.
    #[must_use]
    pub fn scenarios(self) -> &'static [&'static str] {
        match self {
            Self::Khepera => &["on-off", "decay", "straight", "chain", "brake", "stop"],
            Self::Robotarium => &[
                "on-off", "decay", "track", "straight", "chain", "brake", "stop",
            ],
        }
    }

    /// Figures of the thesis that show a scenario.
    #[must_use]
    pub fn figures(self, scenario: &str) -> &'static [&'static str] {
        match (self, scenario) {
            (Self::Khepera, "on-off") => &["4.2", "4.3", "4.4", "4.5"],
            (Self::Khepera, "decay") => &["4.6", "4.7", "4.8"],
            (Self::Robotarium, "on-off") => &["4.9", "4.10", "4.11"],
            (Self::Robotarium, "decay") => &["4.12", "4.13"],
            (Self::Robotarium, "track") => &["4.14", "4.15"],
            _ => &[],
        }
    }

    /// Poses and commands per second.
    #[must_use]
    pub fn rate_hz(self) -> f64 {
        match self {
            Self::Khepera => 50.0,
            Self::Robotarium => 30.0,
        }
    }

    /// What has to stay free between two bodies, in m. On the Robotarium points 25 mm ahead of the axles have to be 0.135 m apart.
    fn clearance_m(self) -> f64 {
        match self {
            Self::Khepera => HeadwaySettings::CLEARANCE_M,
            Self::Robotarium => 0.025,
        }
    }

    /// The robot.
    #[must_use]
    pub fn body(self) -> Body {
        match self {
            Self::Khepera => Body {
                offset_m: 0.05,
                mass_kg: 0.69,
                inertia_kgm2: 1.5e-3,
                centripetal: Centripetal::Printed,
                wheel_base_m: 0.0885,
                radius_m: Some(radii::KHEPERA_M),
                max_wheel_speed_mps: 0.3148,
                max_turn_rate_rad_s: 2.2763,
                max_wheel_acceleration_mps2: Some(5.0),
            },
            Self::Robotarium => Body {
                offset_m: 0.04,
                mass_kg: 0.06,
                inertia_kgm2: 1e-4,
                centripetal: Centripetal::Printed,
                wheel_base_m: 0.11,
                radius_m: Some(radii::ROBOTARIUM_M),
                max_wheel_speed_mps: 0.2,
                max_turn_rate_rad_s: 0.4 / 0.11,
                max_wheel_acceleration_mps2: Some(5.0),
            },
        }
    }

    /// A built-in scenario of 60 s.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownScenario`] with the names that there are.
    pub fn scenario(self, name: &str, preset: Preset) -> Result<ScenarioSpec, Error> {
        if !self.scenarios().contains(&name) {
            return Err(Error::UnknownScenario {
                name: name.to_owned(),
                known: self.scenarios().join(", "),
            });
        }
        let course = self.course(name);
        Ok(ScenarioSpec {
            name: name.to_owned(),
            testbed: self.name().to_owned(),
            rate_hz: self.rate_hz(),
            duration_s: 60.0,
            path: course.path.clone(),
            body: self.body(),
            controller: self.controller(&course, preset),
            robots: self.robots(name, &course),
        })
    }

    /// Table 4.1; `track` is the row of Fig. 4.15, and the Robotarium's `decay`, which has no row, uses that of Fig. 4.11.
    fn course(self, name: &str) -> CourseForm {
        let narrow = CourseForm {
            path: PathSpec::Polar {
                radius_m: 0.25,
                amplitude_m: 0.06,
                periods: 3,
            },
            half_width_m: 0.04,
            headway_s: 3.0,
            speeds_mps: [0.05, 0.075],
            lead: 0.25,
        };
        let wide = CourseForm {
            path: PathSpec::Polar {
                radius_m: 0.25,
                amplitude_m: 0.1,
                periods: 2,
            },
            half_width_m: 0.15,
            headway_s: 1.8,
            speeds_mps: [0.1, 0.2],
            lead: 0.4,
        };
        let large = CourseForm {
            path: PathSpec::Polar {
                radius_m: 0.9,
                amplitude_m: 0.23,
                periods: 3,
            },
            lead: 0.25,
            ..wide.clone()
        };
        match (self, name) {
            (_, "straight") => CourseForm {
                path: PathSpec::Straight {
                    x_m: 0.0,
                    y_m: 0.0,
                    heading_rad: 0.0,
                },
                lead: 0.6,
                ..wide
            },
            (Self::Khepera, _) => large,
            (Self::Robotarium, "on-off" | "decay") => narrow,
            (Self::Robotarium, "chain") => CourseForm { lead: 0.25, ..wide },
            (Self::Robotarium, _) => wide,
        }
    }

    fn robots(self, name: &str, course: &CourseForm) -> Vec<RobotSpec> {
        let [ahead_mps, behind_mps] = course.speeds_mps;
        let robot = RobotSpec::steady;
        let mut leader = robot(course.lead, ahead_mps);
        let mut follower = robot(0.0, behind_mps);
        match (self, name) {
            (Self::Khepera, "on-off") => {
                follower.tracker = Tracker::Off {
                    from_s: 20.0,
                    to_s: 45.0,
                };
            }
            (Self::Robotarium, "on-off") => {
                follower.tracker = Tracker::Off {
                    from_s: 10.0,
                    to_s: 42.0,
                };
            }
            (_, "decay") => {
                follower.tracker = Tracker::Decay {
                    from_s: 10.0,
                    rate_1ps: 0.0,
                    weight: 1e-6,
                };
            }
            (_, "brake") => {
                leader.desired_speed_mps.extend([
                    [20.0, 0.2 * ahead_mps],
                    [35.0, ahead_mps],
                    [45.0, 0.0],
                    [50.0, ahead_mps],
                ]);
            }
            (_, "stop") => leader.stops_s = vec![[15.0, 22.0], [35.0, 50.0]],
            (Self::Khepera, "chain") => {
                let starts = [0.75, 0.6, 0.45, 0.3, 0.15];
                let robots = starts.iter().map(|start| robot(*start, behind_mps));
                return std::iter::once(robot(0.9, ahead_mps))
                    .chain(robots)
                    .collect();
            }
            (_, "chain") => {
                return vec![
                    robot(0.75, 0.5 * ahead_mps),
                    robot(0.4, ahead_mps),
                    robot(0.0, ahead_mps),
                ];
            }
            _ => {}
        }
        vec![leader, follower]
    }

    fn controller(self, course: &CourseForm, preset: Preset) -> ControllerSettings {
        preset.applied_to(&self.thesis(course), &self.body())
    }

    /// The one whose robots have the wheel base that is nearest to this body's.
    fn like(body: &Body) -> Self {
        let off_m = |testbed: Self| (testbed.body().wheel_base_m - body.wheel_base_m).abs();
        if off_m(Self::Khepera) < off_m(Self::Robotarium) {
            Self::Khepera
        } else {
            Self::Robotarium
        }
    }

    /// The thesis's lane barrier, and the margins that are taken off headway and lane by hand, in m.
    fn by_hand(self) -> (LaneBarrier, [f64; 2]) {
        match self {
            Self::Khepera => (LaneBarrier::QUADRATIC, [5e-3, 0.0]),
            Self::Robotarium => (LaneBarrier::BRAKING, [3e-3, 1e-3]),
        }
    }

    /// The thesis's program with parameters that work: it does not name `a`, `m`, `I_z`, `a_max`, `γ` and all weights.
    fn thesis(self, course: &CourseForm) -> ControllerSettings {
        let weights = match self {
            Self::Khepera => [1.0, 1.0, 1e5, 1.0, 1e3],
            Self::Robotarium => [1.0, 1.0, 1e5, 0.1, 1e6],
        };
        let (barrier, margins) = self.by_hand();
        ControllerSettings {
            convergence_1ps: [1.0; 3],
            weights,
            headway: HeadwaySettings {
                time_s: course.headway_s,
                standstill_m: 0.0,
                clearance_m: self.clearance_m(),
                distance: Distance::Chord,
                rate_1ps: 1.0,
                margin_m: margins[0],
            },
            lane: LaneSettings {
                half_width_m: course.half_width_m,
                barrier,
                deviation: Deviation::Radial,
                rate_1ps: barrier.usual_rate_1ps(),
                margin_m: margins[1],
            },
            hardening: Hardening::NONE,
            literal: Vec::new(),
        }
    }
}

/// Settings without a scenario: those of the Khepera in the thesis's first experiment, with a lane of 0.15 m to each side and a headway
/// of 1.8 s.
impl From<Preset> for ControllerSettings {
    fn from(preset: Preset) -> Self {
        let testbed = Testbed::Khepera;
        testbed.controller(&testbed.course("on-off"), preset)
    }
}

/// Path, lane, headway and speeds of leader and follower; the leader's start in revolutions or m.
#[derive(Debug, Clone)]
struct CourseForm {
    path: PathSpec,
    half_width_m: f64,
    headway_s: f64,
    speeds_mps: [f64; 2],
    lead: f64,
}

impl Preset {
    /// Settings with the lane barrier, the margins and the guards of this preset. What else they say stays: lane, headway, weights,
    /// rates. For the hardened one so do larger bounds on noise and wheels, the watchdog's time and the largest angle to the path.
    /// The thesis's barrier and margins are those of the testbed whose robots are most like this body.
    #[must_use]
    pub fn applied_to(self, settings: &ControllerSettings, body: &Body) -> ControllerSettings {
        let (barrier, margins, hardening) = match self {
            Self::Thesis => {
                let (barrier, margins) = Testbed::like(body).by_hand();
                (barrier, margins, Hardening::NONE)
            }
            Self::Hardened => (
                LaneBarrier::EXPONENTIAL,
                [2e-3, 0.1 * settings.lane.half_width_m],
                hardened(&settings.hardening),
            ),
        };
        ControllerSettings {
            headway: HeadwaySettings {
                margin_m: margins[0],
                ..settings.headway
            },
            lane: LaneSettings {
                margin_m: margins[1],
                ..settings.lane.with(barrier)
            },
            hardening,
            ..settings.clone()
        }
    }
}

fn hardened(stated: &Hardening) -> Hardening {
    Hardening {
        wheel_rows: true,
        sampling_margin: true,
        predict: true,
        position_gain: 0.35,
        heading_gain: 0.35,
        max_pose_age_s: stated.max_pose_age_s.or(Some(0.3)),
        position_noise_m: stated.position_noise_m.max(3e-3),
        heading_noise_rad: stated.heading_noise_rad.max(0.5_f64.to_radians()),
        wheel_error: stated.wheel_error.max(0.1),
        cautious_leader: true,
        every_robot: Some(true),
        max_course_angle_rad: stated.max_course_angle_rad.or(Some(80.0_f64.to_radians())),
        start_at_desired_speed: false,
    }
}
