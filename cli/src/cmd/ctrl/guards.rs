//! Guards that settings lack, for people who are about to drive real robots with them.

use unicycle_cbf::ControllerSettings;
use unicycle_cbf::cbf::LaneBarrier;

/// A line for each guard of the hardened preset that these settings do not have, but for the watchdog, which every session has, and one that says how to get them all.
pub(crate) fn missing(settings: &ControllerSettings) -> Vec<String> {
    let own = &settings.hardening;
    let exponential = matches!(settings.lane.barrier, LaneBarrier::Exponential { .. });
    let guards = [
        (
            own.predict,
            "no prediction: it takes a robot to be where it was when the pose was made",
        ),
        (
            own.sampling_margin,
            "no margin for what happens between two steps",
        ),
        (
            own.position_noise_m > 0.0 && own.heading_noise_rad > 0.0,
            "no margin for noise of the poses",
        ),
        (
            own.wheel_error > 0.0,
            "no margin for wheels that are not as fast as they are told",
        ),
        (
            own.wheel_rows,
            "no rows for the wheels' limits: commands are clipped afterwards, which voids the guarantee",
        ),
        (
            own.cautious_leader,
            "no allowance for a robot ahead that has stopped since it was seen",
        ),
        (
            own.regards_every_robot(),
            "no rows for the bodies of other robots: it knows the one before it in the list, as a point",
        ),
        (
            own.max_course_angle_rad.is_some(),
            "no limit on the angle to the path: it may turn round",
        ),
        (
            exponential,
            "the thesis's lane barrier, which a robot outside its lane may not come back from",
        ),
        (
            !own.start_at_desired_speed,
            "it starts at the desired speed, as if it drove already, and not at rest",
        ),
    ];
    let missing = guards.into_iter().filter(|(there, _)| !there);
    let mut lines: Vec<String> = missing.map(|(_, what)| what.to_owned()).collect();
    if !lines.is_empty() {
        lines.push("`--preset hardened` gives every guard".to_owned());
    }
    lines
}

#[cfg(test)]
mod tests {
    use unicycle_cbf::{Preset, Testbed};

    use super::missing;

    #[test]
    fn every_guard_that_is_missing_has_a_line() -> Result<(), unicycle_cbf::Error> {
        for testbed in Testbed::ALL {
            let settings = |preset| {
                testbed
                    .scenario("on-off", preset)
                    .map(|spec| spec.controller)
            };
            assert!(missing(&settings(Preset::Hardened)?).is_empty());
            assert_eq!(missing(&settings(Preset::Thesis)?).len(), 11);
        }
        let mut settings = Testbed::Khepera
            .scenario("on-off", Preset::Hardened)?
            .controller;
        settings.hardening.predict = false;
        let lines = missing(&settings);
        assert!(
            lines.len() == 2 && lines[0].contains("no prediction"),
            "{lines:?}"
        );
        Ok(())
    }
}
