use driver_model::LeftOut;
use driver_model::speed_ahead::{Course, DirectSettings};

use crate::{Error, HoldOut};

/// Drives of an evaluation, and how they are held out.
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryData {
    /// All drives.
    pub courses: Vec<Course>,
    /// Their units.
    pub hold_out: HoldOut,
}

impl TrajectoryData {
    /// Takes the drives of every log; logs with the same name of unit are held out together.
    #[must_use]
    pub fn new(courses_of_logs: Vec<Vec<Course>>, unit_names: &[String]) -> Self {
        let counts = courses_of_logs.iter().map(Vec::len);
        let names = unit_names.iter().zip(counts);
        let names: Vec<&String> = names
            .flat_map(|(name, n)| std::iter::repeat_n(name, n))
            .collect();
        Self {
            hold_out: HoldOut::by_unit(&names),
            courses: courses_of_logs.into_iter().flatten().collect(),
        }
    }

    /// The drives that an evaluation at these horizons can use, see [`DirectSettings::usable`], and the others with the reason.
    /// Units of which no drive is left are none.
    ///
    /// # Errors
    /// As [`DirectSettings::usable`].
    pub fn usable(self, settings: &DirectSettings) -> Result<(Self, Vec<LeftOut>), Error> {
        let numbered = self.hold_out.unit_of().iter().copied().zip(self.courses);
        let (usable, left_out) = settings.usable_of_units(numbered.collect())?;
        let name_of = |(unit, _): &(usize, Course)| self.hold_out.units()[*unit].as_str();
        let names: Vec<&str> = usable.iter().map(name_of).collect();
        let hold_out = HoldOut::by_unit(&names);
        let courses = usable.into_iter().map(|(_, course)| course).collect();
        Ok((Self { courses, hold_out }, left_out))
    }

    /// Whether the drives know their speed limits.
    #[must_use]
    pub fn has_limits(&self) -> bool {
        self.courses.iter().all(|course| course.limit_mps.is_some())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn course(name: &str, seconds: usize, has_limits: bool) -> Course {
        let n = 10 * seconds;
        Course {
            name: name.to_owned(),
            step_s: 0.1,
            speed_mps: vec![10.0; n],
            distance_m: (0..n).map(|k| k as f64).collect(),
            limit_mps: has_limits.then(|| vec![14.0; n]),
            slope_rad: None,
        }
    }

    fn data(courses: Vec<Course>) -> TrajectoryData {
        let units: Vec<String> = courses.iter().map(|course| course.name.clone()).collect();
        TrajectoryData::new(courses.into_iter().map(|c| vec![c]).collect(), &units)
    }

    #[test]
    fn short_drives_and_a_few_without_limits_are_left_out_with_their_units() {
        let drives = vec![
            course("a", 100, true),
            course("short", 15, true),
            course("no limit", 100, false),
            course("b", 100, true),
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
            course("a", 100, true),
            course("b", 100, false),
            course("c", 100, false),
        ];
        let (usable, left_out) = data(drives).usable(&DirectSettings::default()).unwrap();
        assert_eq!((usable.hold_out.units().len(), left_out.len()), (3, 0));
        assert!(
            usable
                .courses
                .iter()
                .all(|course| course.limit_mps.is_none())
        );
    }

    #[test]
    fn one_unit_with_limits_does_not_cost_the_only_other_one() {
        let drives = vec![course("a", 100, true), course("b", 50, false)];
        let (usable, left_out) = data(drives).usable(&DirectSettings::default()).unwrap();
        assert_eq!((usable.hold_out.units().len(), left_out.len()), (2, 0));
        assert!(!usable.has_limits());
        let fitted = vec![course("a", 100, true), course("b", 50, false)];
        let (courses, left_out) = DirectSettings::default().usable(fitted).unwrap();
        assert_eq!((courses.len(), left_out.len()), (1, 1));
    }

    #[test]
    fn drives_of_which_none_will_do_are_named_with_the_reason() {
        let error = data(vec![course("a", 8, true), course("b", 9, false)])
            .usable(&DirectSettings::default())
            .unwrap_err();
        let text = error.to_string();
        assert!(
            text.contains("a: not longer") && text.contains("b: not longer"),
            "{text}"
        );
    }
}
