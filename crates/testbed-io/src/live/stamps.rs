//! From the tracker's clock to the session's: when was a pose true?

/// Spans of which the least delay is kept, in s.
const BUCKET_S: f64 = 5.0;
/// A pose that seems to be older than this at its arrival is not believed, in s.
const OLDEST_S: f64 = 1.0;
/// Stamps that are off by the same amount in a row, after which the clock has jumped and not the network been slow.
const AGREEING: u32 = 5;
/// By how much they may differ from each other, in s.
const AGREEMENT_S: f64 = 0.1;

/// Offset between two clocks, from the packets that were the quickest.
///
/// Arrival less stamp is the offset of the clocks plus the delay of the packet. Its least value over 5 to 10 s counts as the
/// offset, so that what is left is the delay beyond the quickest packet's.
#[derive(Debug, Clone, Default)]
pub(super) struct StampMap {
    /// Least differences of the last two spans, and the end of the present one
    least_s: Option<[f64; 2]>,
    until_s: f64,
    strange: Option<(f64, u32)>,
}

/// What a stamp means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Stamping {
    /// This time on the session's clock
    At(f64),
    /// The same, after the tracker's clock was found to have jumped
    Jumped(f64),
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
        let Some(least_s) = self.least_s else {
            self.restart(arrival_s, difference_s);
            return Stamping::At(arrival_s);
        };
        let offset_s = least_s[0].min(least_s[1]);
        let delay_s = difference_s - offset_s;
        if delay_s.abs() <= OLDEST_S {
            self.strange = None;
            self.lower(arrival_s, difference_s);
            return Stamping::At(arrival_s - delay_s.max(0.0));
        }
        let agreeing = match self.strange {
            Some((last_s, count)) if (difference_s - last_s).abs() <= AGREEMENT_S => count + 1,
            _ => 1,
        };
        self.strange = Some((difference_s, agreeing));
        if agreeing < AGREEING {
            return Stamping::Contradicts;
        }
        self.restart(arrival_s, difference_s);
        Stamping::Jumped(arrival_s)
    }

    fn restart(&mut self, arrival_s: f64, difference_s: f64) {
        self.least_s = Some([difference_s; 2]);
        self.until_s = arrival_s + BUCKET_S;
        self.strange = None;
    }

    fn lower(&mut self, arrival_s: f64, difference_s: f64) {
        let Some([before_s, present_s]) = &mut self.least_s else {
            return;
        };
        if arrival_s >= self.until_s {
            (*before_s, *present_s) = (*present_s, difference_s);
            self.until_s = arrival_s + BUCKET_S;
        }
        *present_s = present_s.min(difference_s);
    }
}
