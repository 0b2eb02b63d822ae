//! Does the tracker's clock run as fast as ours?

/// Stamps are compared with those this long ago and more, in s.
const SPAN_S: f64 = 3.0;
/// By how much stamps may fall behind over the span, in s per s: twice what [`super::stamps`] follows.
const MOST: f64 = 2e-3;
/// Spans in a row that say the same, after which it is no coincidence of delays.
const SPANS: u32 = 2;
/// By how much they may differ, as a share.
const ALIKE: f64 = 0.25;

/// Rate of a clock, from the quickest packet of each span: what a packet takes longer than others says nothing of the clock.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ClockRate {
    /// Least arrival less stamp of the span before and of this one, with the arrival
    before: Option<Quickest>,
    now: Option<Quickest>,
    until_s: f64,
    rate: f64,
    agreeing: u32,
    told: bool,
}

#[derive(Debug, Clone, Copy)]
struct Quickest {
    offset_s: f64,
    arrival_s: f64,
}

impl ClockRate {
    /// Takes the stamp of a pose in; says once what is wrong with the clock.
    pub(super) fn saw(&mut self, arrival_s: f64, stamp_s: f64) -> Option<String> {
        let offset_s = arrival_s - stamp_s;
        let own = Quickest {
            offset_s,
            arrival_s,
        };
        let Some(now) = self.now else {
            self.now = Some(own);
            self.until_s = arrival_s + SPAN_S;
            return None;
        };
        if arrival_s < self.until_s {
            if offset_s < now.offset_s {
                self.now = Some(own);
            }
            return None;
        }
        let before = self.before.replace(now);
        self.now = Some(own);
        self.until_s = arrival_s + SPAN_S;
        self.compare(before?, now)
    }

    fn compare(&mut self, before: Quickest, now: Quickest) -> Option<String> {
        let passed_s = now.arrival_s - before.arrival_s;
        let rate = (now.offset_s - before.offset_s) / passed_s;
        let alike = (rate - self.rate).abs() <= ALIKE * rate.abs();
        self.agreeing = if alike { self.agreeing + 1 } else { 1 };
        self.rate = rate;
        if self.told || rate.abs() <= MOST || self.agreeing < SPANS {
            return None;
        }
        self.told = true;
        let (way, meaning) = if rate > 0.0 {
            (
                "fall behind",
                "the tracker's clock is slow, or poses queue up for ever longer; they count as ever older, and robots stand",
            )
        } else {
            ("run ahead of", "the tracker's clock is fast")
        };
        Some(format!(
            "its stamps {way} our clock by {:.1} ms per s ({:.1} %): {meaning}; mend the clock, or send poses without stamps",
            1e3 * rate.abs(),
            100.0 * rate.abs()
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of a clock of this rate within some time, poses at 50 Hz up to 20 ms late.
    fn said(rate: f64, until_s: f64) -> Option<String> {
        let mut clock = ClockRate::default();
        (0..(50.0 * until_s) as u32).find_map(|step| {
            let sent_s = 0.02 * f64::from(step);
            let delay_s = 0.02 * f64::from(step * 7 % 11) / 11.0;
            clock.saw(sent_s + delay_s, 1e3 + rate * sent_s)
        })
    }

    #[test]
    fn a_clock_two_per_cent_slow_is_said_to_be() {
        let text = said(0.978, 12.0).unwrap_or_default();
        assert!(text.contains("behind our clock by 2"), "{text}");
        assert!(said(1.02, 12.0).is_some_and(|text| text.contains("fast")));
    }

    #[test]
    fn a_clock_of_quartz_is_not_spoken_of() {
        assert_eq!(said(1.0002, 600.0), None);
        assert_eq!(said(0.9998, 600.0), None);
    }
}
