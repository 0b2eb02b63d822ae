//! From a tracker's clock to the session's: when was a pose true?

/// By how much two clocks may drift apart, in s per s.
const DRIFT: f64 = 1e-3;
/// A pose later than this at its arrival is not used, in s.
const OLDEST_S: f64 = 1.0;
/// A packet may be quicker by this than any before, in s.
const EARLY_S: f64 = 0.05;
/// Different stamps in a row that contradict the clock and not each other, after which the clock has jumped.
const AGREEING: u32 = 5;
/// By how much they may differ from the first of them, in s.
const AGREEMENT_S: f64 = 0.1;

/// Offset between two clocks, from the packets that were the quickest.
///
/// Arrival less stamp is the offset of the clocks plus the delay of the packet. Its least value counts as the offset, and rises with
/// what clocks can drift; so what is left is the delay beyond the quickest packet's, also if all packets become slow.
#[derive(Debug, Clone, Default)]
pub(super) struct StampMap {
    last: Option<Last>,
    strange: Option<Strange>,
}

#[derive(Debug, Clone, Copy)]
struct Last {
    offset_s: f64,
    arrival_s: f64,
    /// The newest stamp
    stamp_s: f64,
}

/// Stamps that contradict the clock.
#[derive(Debug, Clone, Copy)]
struct Strange {
    first_difference_s: f64,
    stamp_s: f64,
    count: u32,
}

/// What a stamp means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Stamping {
    /// This time on the session's clock
    At(f64),
    /// The same, after the tracker's clock was found to have jumped
    Jumped(f64),
    /// This time, too long ago to act on
    Late(f64),
    /// Nothing
    Contradicts,
}

impl StampMap {
    /// The time on the session's clock at which a stamp was made; without one, the time of arrival.
    pub(super) fn at(&mut self, arrival_s: f64, stamp_s: Option<f64>) -> Stamping {
        let Some(stamp_s) = stamp_s else {
            return Stamping::At(arrival_s);
        };
        let difference_s = arrival_s - stamp_s;
        let Some(last) = &mut self.last else {
            self.restart(arrival_s, stamp_s);
            return Stamping::At(arrival_s);
        };
        last.offset_s += DRIFT * (arrival_s - last.arrival_s).max(0.0);
        last.arrival_s = last.arrival_s.max(arrival_s);
        let delay_s = difference_s - last.offset_s;
        let backwards = stamp_s < last.stamp_s;
        if (-EARLY_S..=OLDEST_S).contains(&delay_s) && !(backwards && delay_s > EARLY_S) {
            last.offset_s = last.offset_s.min(difference_s);
            last.stamp_s = last.stamp_s.max(stamp_s);
            self.strange = None;
            return Stamping::At(arrival_s - delay_s.max(0.0));
        }
        if delay_s > 0.0 && !backwards {
            // Very late, and in order: a queue somewhere, and no other clock.
            self.strange = None;
            return Stamping::Late(arrival_s - delay_s);
        }
        self.doubt(arrival_s, stamp_s)
    }

    /// A clock that has jumped goes on: a packet that repeats itself does not count.
    fn doubt(&mut self, arrival_s: f64, stamp_s: f64) -> Stamping {
        let difference_s = arrival_s - stamp_s;
        let first = Strange {
            first_difference_s: difference_s,
            stamp_s,
            count: 1,
        };
        let strange = match self.strange {
            Some(strange) => {
                let agrees = (difference_s - strange.first_difference_s).abs() <= AGREEMENT_S;
                if !agrees || stamp_s < strange.stamp_s {
                    first
                } else {
                    let goes_on = stamp_s > strange.stamp_s;
                    Strange {
                        stamp_s,
                        count: strange.count + u32::from(goes_on),
                        ..strange
                    }
                }
            }
            None => first,
        };
        self.strange = Some(strange);
        if strange.count < AGREEING {
            return Stamping::Contradicts;
        }
        self.restart(arrival_s, stamp_s);
        Stamping::Jumped(arrival_s)
    }

    fn restart(&mut self, arrival_s: f64, stamp_s: f64) {
        self.last = Some(Last {
            offset_s: arrival_s - stamp_s,
            arrival_s,
            stamp_s,
        });
        self.strange = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 0.02;

    /// How old the pose of each packet is said to be, for stamps and delays over time; none where it is not used.
    fn ages_s(
        stamp_s: impl Fn(f64) -> f64,
        delay_s: impl Fn(f64) -> f64,
        until_s: f64,
    ) -> Vec<(f64, Option<f64>)> {
        let mut map = StampMap::default();
        let steps = 0..(until_s / PERIOD_S) as u32;
        steps
            .map(|step| {
                let time_s = f64::from(step) * PERIOD_S;
                let arrival_s = time_s + delay_s(time_s);
                let age_s = match map.at(arrival_s, Some(stamp_s(time_s))) {
                    Stamping::At(at_s) | Stamping::Jumped(at_s) => Some(arrival_s - at_s),
                    Stamping::Late(_) | Stamping::Contradicts => None,
                };
                (time_s, age_s)
            })
            .collect()
    }

    #[test]
    fn latency_that_creeps_up_is_known() {
        for growth in [0.01, 0.03] {
            for (time_s, age_s) in ages_s(|t| t + 500.0, |t| growth * t, 120.0) {
                if let Some(age_s) = age_s {
                    assert!(growth * time_s - age_s <= 1.2e-3 * time_s + 1e-9);
                }
            }
        }
    }

    #[test]
    fn latency_that_steps_up_is_known_or_the_pose_not_used() {
        for step_s in [0.2, 0.6, 0.95, 1.5, 3.0] {
            let delay_s = |t: f64| if t < 10.0 { 0.0 } else { step_s };
            for (time_s, age_s) in ages_s(|t| t, delay_s, 60.0) {
                let known = age_s.is_none_or(|age_s| age_s >= delay_s(time_s) - 0.06);
                assert!(known, "{step_s}: {age_s:?} at {time_s}");
            }
        }
    }

    #[test]
    fn a_clock_that_jumps_is_followed_within_a_tenth_of_a_second() {
        for jump_s in [-3600.0, -2.0, -0.5, -0.25, 0.25, 0.5, 2.0, 3600.0] {
            let stamp_s = |t: f64| if t < 10.0 { t } else { t + jump_s };
            let ages_s = ages_s(stamp_s, |_| 0.0, 20.0);
            let unused = ages_s.iter().filter(|(_, age_s)| age_s.is_none()).count();
            assert!(unused <= 4, "{jump_s}: {unused}");
            assert!(
                ages_s
                    .iter()
                    .all(|(_, age_s)| age_s.is_none_or(|age_s| age_s < 0.06))
            );
        }
    }

    #[test]
    fn a_packet_that_repeats_itself_grows_old() {
        for (time_s, age_s) in ages_s(|t| t.min(5.0), |_| 0.0, 30.0) {
            let known = age_s.is_none_or(|age_s| age_s >= time_s - 5.0 - 0.03 * time_s);
            assert!(known, "{age_s:?} at {time_s}");
        }
    }

    #[test]
    fn a_single_wrong_stamp_changes_nothing() {
        for wrong_s in [-1e9, -0.9, -0.2, 0.2, 0.9, 1e9] {
            let stamp_s = |t: f64| {
                if (t - 10.0).abs() < 1e-6 {
                    t + wrong_s
                } else {
                    t
                }
            };
            for (time_s, age_s) in ages_s(stamp_s, |_| 0.0, 20.0) {
                let right = age_s.is_none() || age_s.is_some_and(|age_s| age_s < 0.011);
                assert!(
                    right || (time_s - 10.0).abs() < 1e-6,
                    "{wrong_s}: {age_s:?} at {time_s}"
                );
            }
        }
    }
}
