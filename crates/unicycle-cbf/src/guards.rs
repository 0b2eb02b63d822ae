//! Guards that settings lack, for people who are about to drive real robots with them.

use strum::Display;

use crate::cbf::LaneBarrier;
use crate::settings::ControllerSettings;

/// A guard of [`Preset::Hardened`](crate::Preset::Hardened) that settings do not have; its text says what is missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Display)]
#[non_exhaustive]
pub enum MissingGuard {
    /// [`Hardening::predict`](crate::settings::Hardening::predict)
    #[strum(
        to_string = "no prediction: it takes a robot to be where it was when the pose was made"
    )]
    Prediction,
    /// [`Hardening::sampling_margin`](crate::settings::Hardening::sampling_margin)
    #[strum(to_string = "no margin for what happens between two steps")]
    SamplingMargin,
    /// Bounds on the noise of positions and headings
    #[strum(to_string = "no margin for noise of the poses")]
    NoiseMargin,
    /// [`Hardening::wheel_error`](crate::settings::Hardening::wheel_error)
    #[strum(to_string = "no margin for wheels that are not as fast as they are told")]
    WheelMargin,
    /// [`Hardening::wheel_rows`](crate::settings::Hardening::wheel_rows)
    #[strum(
        to_string = "no rows for the wheels' limits: commands are clipped afterwards, which voids the guarantee"
    )]
    WheelRows,
    /// [`Hardening::cautious_leader`](crate::settings::Hardening::cautious_leader)
    #[strum(to_string = "no allowance for a robot ahead that has stopped since it was seen")]
    CautiousLeader,
    /// [`Hardening::every_robot`](crate::settings::Hardening::every_robot)
    #[strum(
        to_string = "no rows for the bodies of other robots: it knows the one before it in the list, as a point"
    )]
    EveryRobot,
    /// [`Hardening::max_course_angle_rad`](crate::settings::Hardening::max_course_angle_rad)
    #[strum(to_string = "no limit on the angle to the path: it may turn round")]
    CourseAngle,
    /// Exponential rows of the lane
    #[strum(
        to_string = "the thesis's lane barrier, which a robot outside its lane may not come back from"
    )]
    ExponentialLane,
    /// A start at rest
    #[strum(to_string = "it starts at the desired speed, as if it drove already, and not at rest")]
    StartAtRest,
}

impl ControllerSettings {
    /// The guards that these settings lack, but for the watchdog, which every session has.
    #[must_use]
    pub fn missing_guards(&self) -> Vec<MissingGuard> {
        let own = &self.hardening;
        let has_noise = own.position_noise_m > 0.0 && own.heading_noise_rad > 0.0;
        let is_exponential = matches!(self.lane.barrier, LaneBarrier::Exponential { .. });
        let guards = [
            (own.predict, MissingGuard::Prediction),
            (own.sampling_margin, MissingGuard::SamplingMargin),
            (has_noise, MissingGuard::NoiseMargin),
            (own.wheel_error > 0.0, MissingGuard::WheelMargin),
            (own.wheel_rows, MissingGuard::WheelRows),
            (own.cautious_leader, MissingGuard::CautiousLeader),
            (own.regards_every_robot(), MissingGuard::EveryRobot),
            (
                own.max_course_angle_rad.is_some(),
                MissingGuard::CourseAngle,
            ),
            (is_exponential, MissingGuard::ExponentialLane),
            (!own.start_at_desired_speed, MissingGuard::StartAtRest),
        ];
        let missing = guards.into_iter().filter(|(there, _)| !there);
        missing.map(|(_, guard)| guard).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::MissingGuard;
    use crate::{Error, Preset, Testbed};

    #[test]
    fn every_guard_that_is_missing_is_named() -> Result<(), Error> {
        for &testbed in Testbed::ALL {
            let settings = |preset| {
                let spec = testbed.scenario("on-off", preset);
                spec.map(|spec| spec.controller)
            };
            assert!(settings(Preset::Hardened)?.missing_guards().is_empty());
            assert_eq!(settings(Preset::Thesis)?.missing_guards().len(), 10);
        }
        let mut settings = Testbed::Khepera
            .scenario("on-off", Preset::Hardened)?
            .controller;
        settings.hardening.predict = false;
        assert_eq!(settings.missing_guards(), [MissingGuard::Prediction]);
        let text = MissingGuard::Prediction.to_string();
        assert!(text.contains("no prediction"), "{text}");
        Ok(())
    }
}
