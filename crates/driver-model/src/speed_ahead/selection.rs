//! Which drives the speed ahead can be learnt from and judged on.

use super::DirectSettings;
use super::direct::LEAST_PAST_S;
use crate::{Error, LeftOut, Motion};

/// Where drives with speed limits are less of the time than this, no limits are used: the others would be too much to lose.
const LEAST_WITH_LIMITS: f64 = 0.5;

/// Why a drive is left out where the others know their limits.
const NO_LIMITS: &str = "no speed limits, which the others have";

/// A drive with the number of its unit.
type OfUnit = (usize, Motion);

impl DirectSettings {
    /// The drives that are long enough for the longest horizon. Where those with speed limits are half of their time, the others
    /// are left out as well; where they are less, no drive keeps its limits, and models do without.
    ///
    /// # Errors
    /// [`Error::NothingUsable`] where no drive is left, [`Error::Option`] for settings out of range, [`Error::Steps`] for drives of
    /// different sampling intervals.
    pub fn usable(&self, motions: Vec<Motion>) -> Result<(Vec<Motion>, Vec<LeftOut>), Error> {
        let numbered = motions.into_iter().map(|motion| (0, motion)).collect();
        let (usable, left_out) = self.usable_of_units(numbered)?;
        Ok((
            usable.into_iter().map(|(_, motion)| motion).collect(),
            left_out,
        ))
    }

    /// The same of drives with the number of their unit: limits that only one unit has do not cost the others.
    ///
    /// # Errors
    /// As [`usable`](Self::usable).
    pub fn usable_of_units(
        &self,
        motions: Vec<OfUnit>,
    ) -> Result<(Vec<OfUnit>, Vec<LeftOut>), Error> {
        self.check()?;
        let (mut usable, mut left_out) = (Vec::new(), Vec::new());
        for (unit, motion) in motions {
            match self.too_short(&motion) {
                Some(reason) => left_out.push(LeftOut::new(motion.name(), reason)),
                None => usable.push((unit, motion)),
            }
        }
        with_or_without_limits(&mut usable, &mut left_out);
        if usable.is_empty() {
            let task = "the speed ahead";
            return Err(Error::NothingUsable { task, left_out });
        }
        same_step(usable.iter().map(|(_, motion)| motion))?;
        Ok((usable, left_out))
    }

    pub(super) fn longest_s(&self) -> f64 {
        self.horizons_s.iter().copied().fold(0.0, f64::max)
    }

    /// Why a drive has no moment, `None` where it has one.
    fn too_short(&self, motion: &Motion) -> Option<String> {
        let longest_s = self.longest_s();
        let needed = motion.samples_in(LEAST_PAST_S) + motion.samples_in(longest_s);
        (motion.len() <= needed)
            .then(|| format!("not longer than {LEAST_PAST_S} s of past and {longest_s} s ahead"))
    }
}

/// Leaves out the drives without limits, or all limits: where the drives with limits are few, or are of one unit, which leaves nothing
/// to learn from when it is held out.
fn with_or_without_limits(usable: &mut Vec<(usize, Motion)>, left_out: &mut Vec<LeftOut>) {
    let time_s = |(_, motion): &(usize, Motion)| motion.len() as f64 * motion.step_s();
    let has_limits = |(_, motion): &(usize, Motion)| motion.limit_mps().is_some();
    let all_s: f64 = usable.iter().map(time_s).sum();
    let with_limits: Vec<_> = usable.iter().filter(|c| has_limits(c)).collect();
    let with_limits_s: f64 = with_limits.iter().map(|c| time_s(c)).sum();
    let one_unit = |units: &[&(usize, Motion)]| units.windows(2).all(|pair| pair[0].0 == pair[1].0);
    let costs_the_rest = one_unit(&with_limits) && !one_unit(&usable.iter().collect::<Vec<_>>());
    if with_limits_s < LEAST_WITH_LIMITS * all_s || costs_the_rest {
        let all = std::mem::take(usable).into_iter();
        usable.extend(all.map(|(unit, motion)| (unit, motion.without_limits())));
        return;
    }
    usable.retain(|motion| {
        if !has_limits(motion) {
            left_out.push(LeftOut::new(motion.1.name(), NO_LIMITS));
        }
        has_limits(motion)
    });
}

/// Refuses drives of different sampling intervals.
fn same_step<'a>(mut motions: impl Iterator<Item = &'a Motion> + Clone) -> Result<(), Error> {
    let expected_s = motions.clone().next().map_or(1.0, Motion::step_s);
    match motions.find(|motion| (motion.step_s() - expected_s).abs() > 1e-9) {
        None => Ok(()),
        Some(other) => Err(Error::Steps {
            log: other.name().to_owned(),
            found_s: other.step_s(),
            expected_s,
        }),
    }
}
