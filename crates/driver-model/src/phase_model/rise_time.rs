use serde::{Deserialize, Serialize};

use crate::{Error, SpeedGroup, TrainingSet};

/// The constant of one group.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupConstant {
    /// The group.
    pub group: SpeedGroup,
    /// Mean `T_c` in s.
    pub time_constant_s: f64,
    /// How many phases it is the mean of.
    pub phases: usize,
}

/// Critically damped second-order step response with one mean time constant per speed group (thesis 3.3, rise-time method).
///
/// `v(t) = v0 + K (1 − (1 + t/T_c) e^(−t/T_c))` (3.44, corrected: `K = v_end − v0`), `T_c = t_r/5` (3.43).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RiseTime {
    /// Groups that had phases to learn from, at least one, sorted by group.
    pub groups: Vec<GroupConstant>,
}

impl RiseTime {
    /// `t_r/T_c` of the thesis, at which the response reaches 95.96 %.
    pub const RISE_TIME_CONSTANTS: f64 = 5.0;

    /// `t_r/T_c` at which it reaches 95 % exactly: the root of `(1 + x)e^(−x) = 0.05`.
    pub const EXACT_RISE_TIME_CONSTANTS: f64 = 4.743_864_518_390_578;

    /// Mean time constant per group, `T_c = t_r/time_constants` with [`RiseTime::RISE_TIME_CONSTANTS`] or
    /// [`RiseTime::EXACT_RISE_TIME_CONSTANTS`].
    ///
    /// # Errors
    /// [`Error::TooFewPhases`] without a phase.
    pub fn fit(training: &TrainingSet<'_>, time_constants: f64) -> Result<Self, Error> {
        super::need_phases("rise-time", &training.phases)?;
        let mut sums = std::collections::BTreeMap::<SpeedGroup, (f64, f64, usize)>::new();
        for phase in &training.phases {
            let outline = phase.curve.outline().rising();
            let sum = sums.entry(outline.group()).or_default();
            sum.0 += phase.weight * outline.duration_s() / time_constants;
            sum.1 += phase.weight;
            sum.2 += 1;
        }
        let groups = sums
            .into_iter()
            .map(|(group, (sum, weight, phases))| GroupConstant {
                group,
                time_constant_s: sum / weight,
                phases,
            })
            .collect();
        Ok(Self { groups })
    }

    /// The constant for a phase, from its group or else from the nearest one; the flag says which.
    ///
    /// Nearest: fewest bands away in start and end speed together; among equals the one with most phases, then the lowest.
    #[must_use]
    pub fn constant_for(&self, group: SpeedGroup) -> (f64, bool) {
        let keys = self.groups.iter().map(|g| (g.group, g.phases));
        let found = nearest(keys, group).and_then(|k| self.groups.get(k));
        found.map_or((f64::NAN, false), |g| (g.time_constant_s, g.group == group))
    }

    /// Speed in m/s at `t_s` seconds of a phase from `start_speed_mps` towards `end_speed_mps`.
    #[must_use]
    pub fn speed_mps(
        time_constant_s: f64,
        start_speed_mps: f64,
        end_speed_mps: f64,
        t_s: f64,
    ) -> f64 {
        let s = t_s / time_constant_s;
        start_speed_mps + (end_speed_mps - start_speed_mps) * (1.0 - (1.0 + s) * (-s).exp())
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        check_groups("rise-time", self.groups.iter().map(|g| g.group))?;
        self.groups.iter().try_for_each(|g| {
            super::parameter(
                "rise-time",
                "time_constant_s",
                g.time_constant_s,
                g.time_constant_s > 0.0,
                "finite and above 0",
            )
        })
    }
}

/// Index of the group for a phase: fewest bands away, then most phases, then the lowest.
pub(super) fn nearest(
    groups: impl Iterator<Item = (SpeedGroup, usize)>,
    group: SpeedGroup,
) -> Option<usize> {
    let by_distance = groups.enumerate().min_by_key(|&(_, (candidate, phases))| {
        (
            candidate.distance(group),
            std::cmp::Reverse(phases),
            candidate,
        )
    });
    by_distance.map(|(index, _)| index)
}

/// One to nine groups within the three bands.
pub(super) fn check_groups(
    model: &'static str,
    groups: impl ExactSizeIterator<Item = SpeedGroup>,
) -> Result<(), Error> {
    let count = groups.len();
    super::parameter(
        model,
        "groups",
        count as f64,
        (1..=9).contains(&count),
        "1 to 9 groups",
    )?;
    for group in groups {
        let highest = f64::from(group.start_band.max(group.end_band));
        super::parameter(model, "band", highest, highest <= 2.0, "0, 1 or 2")?;
    }
    Ok(())
}
