use driver_model::speed_ahead::DirectSettings;
use driver_model::{DriverChannel, LeftOut, Motion};

use crate::{Error, HoldOut};

/// Drives of an evaluation, and how they are held out.
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryData {
    /// All drives.
    pub motions: Vec<Motion>,
    /// Their units.
    pub hold_out: HoldOut,
}

impl TrajectoryData {
    /// Drives with the same name of unit are held out together; `unit_names` has one for every drive, whatever its pieces.
    #[must_use]
    pub fn new(motions: Vec<Motion>, unit_names: &[String]) -> Self {
        Self {
            hold_out: HoldOut::of_motions(&motions, unit_names),
            motions,
        }
    }

    /// The drives that an evaluation at these horizons can use, see [`DirectSettings::usable`], and the others with the reason.
    /// Units of which no drive is left are none.
    ///
    /// # Errors
    /// As [`DirectSettings::usable`].
    pub fn usable(self, settings: &DirectSettings) -> Result<(Self, Vec<LeftOut>), Error> {
        let numbered = self.hold_out.unit_of().iter().copied().zip(self.motions);
        let (usable, left_out) = settings.usable_of_units(numbered.collect())?;
        let name_of = |(unit, _): &(usize, Motion)| self.hold_out.units()[*unit].as_str();
        let names: Vec<&str> = usable.iter().map(name_of).collect();
        let hold_out = HoldOut::by_unit(&names);
        let motions = usable.into_iter().map(|(_, motion)| motion).collect();
        Ok((Self { motions, hold_out }, left_out))
    }

    /// Whether the drives know their speed limits.
    #[must_use]
    pub fn has_limits(&self) -> bool {
        self.motions
            .iter()
            .all(|motion| motion.limit_mps().is_some())
    }
}

impl TrajectoryData {
    /// What the drives know of what the driver does, see [`DirectSettings::known_channels`].
    #[must_use]
    pub fn channels(&self, settings: &DirectSettings) -> Vec<DriverChannel> {
        settings.known_channels(&self.motions.iter().collect::<Vec<_>>())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::collections::BTreeMap;

    use drive_log::{Channel, DriveLog};

    use super::*;

    fn motion(name: &str, seconds: usize, has_limits: bool) -> Motion {
        let n = 10 * seconds;
        let mut channels = BTreeMap::from([(Channel::Speed, vec![10.0; n])]);
        if has_limits {
            channels.insert(Channel::SpeedLimit, vec![14.0; n]);
        }
        let log = DriveLog::new(name, 0.0, 0.1, channels).unwrap();
        Motion::of_log(&log, 100.0).unwrap()
    }

    fn data(motions: Vec<Motion>) -> TrajectoryData {
        let units: Vec<String> = motions
            .iter()
            .map(|motion| motion.name().to_owned())
            .collect();
        TrajectoryData::new(motions, &units)
    }

    #[test]
    fn short_drives_and_a_few_without_limits_are_left_out_with_their_units() {
        let drives = vec![
            motion("a", 100, true),
            motion("short", 15, true),
            motion("no limit", 100, false),
            motion("b", 100, true),
        ];
        let (usable, left_out) = data(drives)
            .usable(&DirectSettings::at(&[5.0, 10.0]))
            .unwrap();
        assert_eq!(usable.hold_out.units(), ["a", "b"]);
        assert_eq!(usable.hold_out.unit_of(), [0, 1]);
        assert!(usable.has_limits());
        let names: Vec<&str> = left_out.iter().map(|l| l.log.as_str()).collect();
        assert_eq!(names, ["short", "no limit"]);
        assert!(left_out[0].reason.contains("10 s ahead"), "{left_out:?}");
    }

    #[test]
    fn a_few_drives_with_limits_do_not_cost_the_others() {
        let drives = vec![
            motion("a", 100, true),
            motion("b", 100, false),
            motion("c", 100, false),
        ];
        let (usable, left_out) = data(drives).usable(&DirectSettings::default()).unwrap();
        assert_eq!((usable.hold_out.units().len(), left_out.len()), (3, 0));
        assert!(
            usable
                .motions
                .iter()
                .all(|motion| motion.limit_mps().is_none())
        );
    }

    #[test]
    fn one_unit_with_limits_does_not_cost_the_only_other_one() {
        let drives = vec![motion("a", 100, true), motion("b", 50, false)];
        let (usable, left_out) = data(drives).usable(&DirectSettings::default()).unwrap();
        assert_eq!((usable.hold_out.units().len(), left_out.len()), (2, 0));
        assert!(!usable.has_limits());
        let fitted = vec![motion("a", 100, true), motion("b", 50, false)];
        let (motions, left_out) = DirectSettings::default().usable(fitted).unwrap();
        assert_eq!((motions.len(), left_out.len()), (1, 1));
    }

    #[test]
    fn drives_of_which_none_will_do_are_named_with_the_reason() {
        let error = data(vec![motion("a", 8, true), motion("b", 9, false)])
            .usable(&DirectSettings::default())
            .unwrap_err();
        let text = error.to_string();
        assert!(
            text.contains("a: not longer") && text.contains("b: not longer"),
            "{text}"
        );
    }
}
