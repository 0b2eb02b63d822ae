//! Whether two recordings are of one drive, whatever their units, columns, clocks and sampling.

use std::collections::{BTreeMap, BTreeSet};

use crate::{Channel, Drive, DriveLog};

/// Seconds of a drive at least, moving ones among them, and the spread of their speeds, for which its speed tells it from
/// others: two drives at one constant speed are alike.
const SHORTEST_S: usize = 20;
const SHORTEST_MOVING_S: usize = 15;
const LEAST_SPREAD_MPS: f64 = 1.0;

/// Faster is moving.
const MOVING_MPS: f64 = 0.5;

/// Two speeds are equal within half a km/h and a little, and where the car accelerates within a tenth of a second more.
const TOLERANCE_MPS: f64 = 0.15;
const TOLERANCE_S: f64 = 0.1;

/// Share of the moving seconds that must be equal, and of the shorter drive that must lie in the longer.
const EQUAL_SHARE: f64 = 0.95;

/// Clocks differ by at most this after whole seconds are taken off.
const LONGEST_SHIFT_S: f64 = 1.5;

/// A drive's speed rises through these levels at moments that are its own.
const LEVELS_MPS: [f64; 8] = [3.0, 7.0, 11.0, 15.0, 20.0, 25.0, 30.0, 35.0];

/// The speed must have been this much lower before.
const HYSTERESIS_MPS: f64 = 1.0;

/// What one drive is to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kinship {
    /// Both are the same drive.
    Same,
    /// The drive lies within the other, which is longer.
    PartOf,
    /// The other lies within the drive.
    Holds,
}

/// Drives to be told from further ones.
#[derive(Debug, Default)]
pub struct DriveIndex<'d> {
    drives: BTreeMap<usize, (&'d Drive, Seconds)>,
    /// By whole seconds: the numbers, and how far the drives go, in m.
    by_duration: BTreeMap<i64, Vec<(usize, f64)>>,
    /// Four rises in a row, by level and distance, with the second of the first.
    by_rises: BTreeMap<Rises, Vec<(usize, i64)>>,
}

/// Levels of four rises, and the seconds between them.
type Rises = ([usize; 4], [i64; 3]);

impl<'d> DriveIndex<'d> {
    /// Adds a drive under a number of its own.
    pub fn insert(&mut self, number: usize, drive: &'d Drive) {
        let speeds = Seconds::of(drive, Channel::Speed);
        let duration_s = speeds.values.len() as i64;
        let alike = self.by_duration.entry(duration_s).or_default();
        alike.push((number, speeds.sum()));
        for (rises, at_s) in speeds.rises() {
            self.by_rises.entry(rises).or_default().push((number, at_s));
        }
        self.drives.insert(number, (drive, speeds));
    }

    /// What `drive` is to those of the index that hold it, lie in it, or are the same: their numbers, in order.
    #[must_use]
    pub fn kin(&self, drive: &Drive) -> Vec<(usize, Kinship)> {
        let speeds = Seconds::of(drive, Channel::Speed);
        let mut kin = BTreeMap::new();
        for (number, lag_s) in self.candidates(&speeds) {
            let (other, other_speeds) = &self.drives[&number];
            if kin.contains_key(&number) {
                continue;
            }
            let found = speeds.kinship(other_speeds, lag_s);
            if let Some(kinship) = found
                && !contradict(drive, other, lag_s)
            {
                kin.insert(number, kinship);
            }
        }
        kin.into_iter().collect()
    }

    /// Drives that start together and are equally long, and those whose speed rises in the same rhythm, with the seconds
    /// by which they start later.
    fn candidates(&self, speeds: &Seconds) -> BTreeSet<(usize, i64)> {
        let duration_s = speeds.values.len() as i64;
        let alike = self.by_duration.range(duration_s - 2..=duration_s + 2);
        let distance_m = speeds.sum();
        let as_far = |(_, other_m): &&(usize, f64)| {
            (other_m - distance_m).abs() <= (1.0 - EQUAL_SHARE) * distance_m.max(*other_m)
        };
        let alike = alike.flat_map(|(_, drives)| drives).filter(as_far);
        let mut candidates: BTreeSet<(usize, i64)> = alike.map(|(n, _)| (*n, 0)).collect();
        for ((levels, gaps_s), at_s) in speeds.rises() {
            for near_s in neighbours(gaps_s) {
                let found = self.by_rises.get(&(levels, near_s)).into_iter().flatten();
                candidates.extend(found.map(|&(number, other_s)| (number, at_s - other_s)));
            }
        }
        candidates
    }
}

/// Each of the gaps may be rounded the other way.
fn neighbours(gaps_s: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (0..27).map(move |k| {
        let [a, b, c] = gaps_s;
        [a + k % 3 - 1, b + k / 3 % 3 - 1, c + k / 9 - 1]
    })
}

/// Mean of a channel in each second since the start of a drive, NaN where it is not known.
#[derive(Debug)]
struct Seconds {
    values: Vec<f64>,
}

impl Seconds {
    /// A gap, however long, is one second.
    fn of(drive: &Drive, channel: Channel) -> Self {
        let mut values = Vec::new();
        for piece in &drive.pieces {
            values.push(f64::NAN);
            values.extend(means(piece, channel));
        }
        Self { values }
    }

    /// Every four rises in a row and the second of the first.
    fn rises(&self) -> impl Iterator<Item = (Rises, i64)> {
        let mut rises: Vec<(f64, usize)> = Vec::new();
        for (level, &level_mps) in LEVELS_MPS.iter().enumerate() {
            rises.extend(self.rises_through(level_mps).map(|at_s| (at_s, level)));
        }
        rises.sort_by(|a, b| a.0.total_cmp(&b.0));
        let fours: Vec<(Rises, i64)> = rises
            .windows(4)
            .map(|four| {
                let gap = |k: usize| (four[k + 1].0 - four[k].0).round() as i64;
                let levels = [0, 1, 2, 3].map(|k: usize| four[k].1);
                ((levels, [0, 1, 2].map(gap)), four[0].0.round() as i64)
            })
            .collect();
        fours.into_iter()
    }

    fn rises_through(&self, level_mps: f64) -> impl Iterator<Item = f64> {
        let mut was_lower = false;
        self.values
            .windows(2)
            .enumerate()
            .filter_map(move |(k, pair)| {
                was_lower |= pair[0] < level_mps - HYSTERESIS_MPS;
                let rises = was_lower && pair[0] < level_mps && pair[1] >= level_mps;
                was_lower &= !rises;
                rises.then(|| k as f64 + (level_mps - pair[0]) / (pair[1] - pair[0]))
            })
    }

    fn sum(&self) -> f64 {
        self.values.iter().filter(|v| v.is_finite()).sum()
    }

    fn recorded_s(&self) -> usize {
        self.values.iter().filter(|v| v.is_finite()).count()
    }

    /// Seconds of both in the same second, with the acceleration; the other starts `lag_s` later.
    fn pairs(&self, other: &Self, lag_s: i64) -> impl Iterator<Item = Pair> {
        let at = |k: i64| {
            usize::try_from(k)
                .ok()
                .and_then(|k| self.values.get(k))
                .copied()
        };
        let seconds = other.values.iter().enumerate();
        seconds.filter_map(move |(k, &other)| {
            let k = k as i64 + lag_s;
            let value = at(k)?;
            let rate = 0.5 * (at(k + 1).unwrap_or(value) - at(k - 1).unwrap_or(value));
            let pair = Pair { value, other, rate };
            (value + other + rate).is_finite().then_some(pair)
        })
    }

    fn kinship(&self, other: &Self, lag_s: i64) -> Option<Kinship> {
        let lengths_s = [self.recorded_s(), other.recorded_s()].map(|s| s as f64);
        let shorter_s = lengths_s[0].min(lengths_s[1]);
        let few = self.pairs(other, lag_s).step_by(16);
        if share(few, |pair| {
            pair.differs() <= pair.tolerance(LONGEST_SHIFT_S)
        }) < 0.7
        {
            return None;
        }
        let pairs: Vec<Pair> = self.pairs(other, lag_s).collect();
        let common_s = pairs.len() as f64;
        if pairs.len() < SHORTEST_S
            || common_s < EQUAL_SHARE * shorter_s
            || spread(pairs.iter().map(|pair| pair.value)) < LEAST_SPREAD_MPS
        {
            return None;
        }
        let shift_s = shift_s(&pairs);
        let moving: Vec<Pair> = pairs.into_iter().filter(Pair::moves).collect();
        let equal = |pair: &Pair| pair.shifted(shift_s).differs() <= pair.tolerance(TOLERANCE_S);
        if moving.len() < SHORTEST_MOVING_S || share(moving.into_iter(), equal) < EQUAL_SHARE {
            return None;
        }
        Some(
            if shorter_s >= EQUAL_SHARE * lengths_s[0].max(lengths_s[1]) {
                Kinship::Same
            } else if lengths_s[0] < lengths_s[1] {
                Kinship::PartOf
            } else {
                Kinship::Holds
            },
        )
    }
}

/// One second of two drives.
#[derive(Debug, Clone, Copy)]
struct Pair {
    value: f64,
    other: f64,
    rate: f64,
}

impl Pair {
    fn moves(&self) -> bool {
        self.value.max(self.other) > MOVING_MPS
    }

    fn differs(&self) -> f64 {
        (self.other - self.value).abs()
    }

    fn tolerance(&self, within_s: f64) -> f64 {
        TOLERANCE_MPS + within_s * self.rate.abs()
    }

    /// As if the clock of the first had been set.
    fn shifted(self, by_s: f64) -> Self {
        Self {
            value: self.value + by_s * self.rate,
            ..self
        }
    }
}

/// By how much the clocks differ beside whole seconds, by least squares.
fn shift_s(pairs: &[Pair]) -> f64 {
    let sum = |of: fn(&Pair) -> f64| pairs.iter().map(of).sum::<f64>();
    let shift_s = sum(|p| p.rate * (p.other - p.value)) / sum(|p| p.rate.powi(2));
    shift_s.clamp(-LONGEST_SHIFT_S, LONGEST_SHIFT_S)
}

fn share(pairs: impl Iterator<Item = Pair>, holds: impl Fn(&Pair) -> bool) -> f64 {
    let (mut all, mut held) = (0_u32, 0_u32);
    for pair in pairs {
        all += 1;
        held += u32::from(holds(&pair));
    }
    f64::from(held) / f64::from(all.max(1))
}

fn spread(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    (values.map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// Means over each second of a piece.
fn means(piece: &DriveLog, channel: Channel) -> Vec<f64> {
    let duration_s = piece.len() as f64 * piece.step_s();
    let mut sums = vec![(0.0, 0.0); duration_s.ceil() as usize + 1];
    let values = piece.channel(channel).unwrap_or_default().iter();
    for (i, value) in values.enumerate().filter(|(_, v)| v.is_finite()) {
        // a sample on the second, but for rounding, belongs to it
        let (sum, count) = &mut sums[(i as f64 * piece.step_s() + 1e-6) as usize];
        *sum += value;
        *count += 1.0;
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

/// Whether another channel that both have tells them apart: drives of one cycle with other cars, or in other weather.
fn contradict(drive: &Drive, other: &Drive, lag_s: i64) -> bool {
    let mut told_by = Channel::ALL.into_iter().filter(|channel| {
        !matches!(
            channel,
            Channel::Speed
                | Channel::Accel
                | Channel::Accelerometer
                | Channel::Slope
                | Channel::SpeedLimit
                | Channel::Distance
        )
    });
    told_by.any(|channel| {
        let [of_drive, of_other] = [drive, other].map(|drive| Seconds::of(drive, channel));
        let pairs: Vec<Pair> = of_drive.pairs(&of_other, lag_s).collect();
        let mut apart: Vec<f64> = pairs.iter().map(Pair::differs).collect();
        if apart.len() < SHORTEST_S {
            return false;
        }
        let middle = apart.len() / 2;
        let median = *apart.select_nth_unstable_by(middle, f64::total_cmp).1;
        median > 0.5 * spread(pairs.iter().map(|pair| pair.value)) + rounding(channel)
    })
}

/// What rounding may make of a value.
fn rounding(channel: Channel) -> f64 {
    match channel {
        Channel::AuxPower | Channel::HeatingPower | Channel::HeatingRequest => 100.0,
        _ => 1.0,
    }
}
