use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::rise_time::nearest;
use super::{SpeedGroup, StepCharacteristics, StepResponse};
use crate::{Error, PhaseCurve, TrainingSet};

/// The step response of one speed group.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupResponse {
    /// The group.
    pub group: SpeedGroup,
    /// Most common order, with the mean constants of the phases that have it.
    pub response: StepResponse,
    /// Phases that those constants are the mean of.
    pub phases: usize,
    /// Phases thrown away because they have another order, or distinct constants where equal ones are more common.
    pub other_form: usize,
    /// Phases thrown away because no response has their characteristics.
    pub unidentified: usize,
}

/// Step response of the most common order per speed group (thesis 3.3, transition-point method).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TransitionPoint {
    /// Groups in which a phase was identified, at least one, sorted by group.
    pub groups: Vec<GroupResponse>,
    /// Phases of groups in which none was identified.
    pub lost: usize,
}

/// An order, and whether its constants are distinct.
type Form = (u8, bool);

fn form(response: StepResponse) -> Form {
    let distinct = matches!(response, StepResponse::Distinct { .. });
    (response.order(), distinct)
}

/// Characteristics and response of one phase, braking in reversed time.
#[must_use]
pub fn identify(curve: &PhaseCurve) -> Option<(StepCharacteristics, Option<StepResponse>)> {
    let outline = curve.outline();
    let characteristics = StepCharacteristics::of(outline.step_s, &curve.rising_speed_mps())?;
    Some((characteristics, StepResponse::identify(&characteristics)))
}

impl TransitionPoint {
    /// Identifies every phase and takes, per group, the most common form and the mean of its constants.
    ///
    /// The order comes first: of equally common ones the lower. Where it is 2, distinct or equal constants, whichever is more
    /// common, equal ones of a draw.
    ///
    /// # Errors
    /// [`Error::TooFewPhases`] where no phase is identified.
    pub fn fit(training: &TrainingSet<'_>) -> Result<Self, Error> {
        super::need_phases("transition-point", &training.phases)?;
        let mut members = BTreeMap::<SpeedGroup, Vec<(Option<StepResponse>, f64)>>::new();
        for phase in &training.phases {
            let response = identify(phase.curve).and_then(|(_, response)| response);
            let group = phase.curve.outline().rising().group();
            members
                .entry(group)
                .or_default()
                .push((response, phase.weight));
        }
        let (mut groups, mut lost) = (Vec::new(), 0);
        for (group, responses) in members {
            match GroupResponse::of(group, &responses) {
                Some(response) => groups.push(response),
                None => lost += responses.len(),
            }
        }
        if groups.is_empty() {
            return Err(Error::TooFewPhases {
                model: "transition-point",
                found: 0,
                needed: 1,
                unit: "phases that a step response of order 2 to 10 can have",
            });
        }
        Ok(Self { groups, lost })
    }

    /// The response for a phase, from its group or else from the nearest one; the flag says which.
    ///
    /// Nearest as in [`super::RiseTime::constant_for`].
    #[must_use]
    pub fn response_for(&self, group: SpeedGroup) -> (StepResponse, bool) {
        let keys = self.groups.iter().map(|g| (g.group, g.phases));
        let found = nearest(keys, group).and_then(|k| self.groups.get(k));
        let none = StepResponse::Equal {
            order: 2,
            time_constant_s: f64::NAN,
        };
        found.map_or((none, false), |g| (g.response, g.group == group))
    }

    /// Phases that no constant is a mean of.
    #[must_use]
    pub fn thrown_away(&self) -> usize {
        let in_groups = self.groups.iter().map(|g| g.other_form + g.unidentified);
        in_groups.sum::<usize>() + self.lost
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        super::rise_time::check_groups("transition-point", self.groups.iter().map(|g| g.group))?;
        self.groups.iter().try_for_each(|g| {
            super::parameter(
                "transition-point",
                "order",
                f64::from(g.response.order()),
                g.response.is_sane(),
                "2 to 10, with constants above 0",
            )
        })
    }
}

impl GroupResponse {
    fn of(group: SpeedGroup, responses: &[(Option<StepResponse>, f64)]) -> Option<Self> {
        let identified: Vec<(StepResponse, f64)> = responses
            .iter()
            .filter_map(|&(response, weight)| Some((response?, weight)))
            .collect();
        let chosen = most_common(&identified)?;
        let same: Vec<(StepResponse, f64)> = identified
            .iter()
            .copied()
            .filter(|&(response, _)| form(response) == chosen)
            .collect();
        Some(Self {
            group,
            response: mean(&same)?,
            phases: same.len(),
            other_form: identified.len() - same.len(),
            unidentified: responses.len() - identified.len(),
        })
    }
}

fn most_common(responses: &[(StepResponse, f64)]) -> Option<Form> {
    let order = heaviest(responses.iter().map(|&(r, w)| (r.order(), w)))?;
    let of_order = responses.iter().filter(|(r, _)| r.order() == order);
    let distinct = heaviest(of_order.map(|&(r, w)| (form(r).1, w)))?;
    Some((order, distinct))
}

/// The key with most weight, the lowest of equals.
fn heaviest<K: Ord>(keys: impl Iterator<Item = (K, f64)>) -> Option<K> {
    let mut weights = BTreeMap::<K, f64>::new();
    for (key, weight) in keys {
        *weights.entry(key).or_default() += weight;
    }
    let best = weights
        .into_iter()
        .reduce(|best, next| if next.1 > best.1 { next } else { best });
    best.map(|(key, _)| key)
}

/// The mean constants of responses of one form.
fn mean(responses: &[(StepResponse, f64)]) -> Option<StepResponse> {
    let total: f64 = responses.iter().map(|(_, w)| w).sum();
    let average = |of: fn(&StepResponse) -> f64| {
        responses.iter().map(|(r, w)| w * of(r)).sum::<f64>() / total
    };
    let smaller = average(|r| match *r {
        StepResponse::Distinct { t1_s, .. } => t1_s,
        StepResponse::Equal {
            time_constant_s, ..
        } => time_constant_s,
    });
    let larger = average(|r| match *r {
        StepResponse::Distinct { t2_s, .. } => t2_s,
        StepResponse::Equal {
            time_constant_s, ..
        } => time_constant_s,
    });
    let first = responses.first()?.0;
    Some(match first {
        StepResponse::Distinct { .. } => StepResponse::Distinct {
            t1_s: smaller,
            t2_s: larger,
        },
        StepResponse::Equal { order, .. } => StepResponse::Equal {
            order,
            time_constant_s: smaller,
        },
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const GROUP: SpeedGroup = SpeedGroup {
        start_band: 0,
        end_band: 0,
    };

    fn equal(order: u8, time_constant_s: f64) -> (Option<StepResponse>, f64) {
        let response = StepResponse::Equal {
            order,
            time_constant_s,
        };
        (Some(response), 1.0)
    }

    fn distinct(t1_s: f64, t2_s: f64) -> (Option<StepResponse>, f64) {
        (Some(StepResponse::Distinct { t1_s, t2_s }), 1.0)
    }

    #[test]
    fn the_majority_decides_and_the_rest_is_counted() {
        let responses = [
            equal(3, 1.0),
            equal(3, 2.0),
            equal(5, 9.0),
            (None, 1.0),
            distinct(1.0, 2.0),
        ];
        let found = GroupResponse::of(GROUP, &responses).unwrap();
        assert_eq!(found.response, equal(3, 1.5).0.unwrap());
        assert_eq!(
            (found.phases, found.other_form, found.unidentified),
            (2, 2, 1)
        );
    }

    #[test]
    fn of_order_two_the_more_common_kind_of_constants_counts() {
        let responses = [
            distinct(1.0, 3.0),
            distinct(2.0, 5.0),
            equal(2, 1.0),
            equal(4, 1.0),
            equal(4, 1.0),
        ];
        let found = GroupResponse::of(GROUP, &responses).unwrap();
        assert_eq!(found.response, distinct(1.5, 4.0).0.unwrap());
        assert_eq!((found.phases, found.other_form), (2, 3));
    }

    #[test]
    fn of_a_draw_the_lower_order_counts_and_nothing_identified_is_none() {
        let found = GroupResponse::of(GROUP, &[equal(6, 1.0), equal(4, 2.0)]).unwrap();
        assert_eq!(found.response.order(), 4);
        assert_eq!(GroupResponse::of(GROUP, &[(None, 1.0)]), None);
    }
}
