//! What the rest of a recording says about its speeds.

use super::super::distance;
use super::super::motion::{MOVING_MPS, STANDSTILL_MPS, Span, spans};
use super::super::power::{Car, Load, Usual, loads};
use super::super::speed_mistake::{MISTAKES, Mistake};
use crate::statistics::{correlation, near, quantile, slope};
use crate::{Channel, RawLog};

/// Seconds in motion that say something.
const SECONDS: usize = 120;

/// What a hundredth of the time exceeds with no car on the road: 252 km/h, at which most fast cars
/// are held, m/s; full throttle of the fastest, m/s² and W/kg.
const TOP_MPS: f64 = 70.0;
const FULL_PULL_MPS2: f64 = 5.0;
const FULL_PULL_W_PER_KG: f64 = 300.0;

/// What the fastest tenth of the time in motion is of the limit: between jams all along and a driver
/// whom no camera has seen. Alone, a jam is told from a unit below the last figure.
const LIMIT_SHARE: (f64, f64) = (0.5, 1.6);
const JAM_SHARE: f64 = 0.36;

/// Ordinary drives: what a hundredth of the time exceeds, m/s² (0.8 to 3.5 in 70 recorded drives),
/// and the share of the limit.
const PULL_MPS2: Usual = Usual(1.8, 0.35);
const SHARE: Usual = Usual(1.0, 0.25);

/// From where on a figure is odd, in usual factors; and where a drive that starts is so sluggish that this alone is odd: below 0.63
/// m/s² for a hundredth of the time, or 0.96 where it never goes faster than the last, m/s.
const ODD: f64 = 1.8;
const SLUGGISH: f64 = 3.0;
const SLOW_MPS: f64 = 10.0;

/// Seconds in motion in which an ordinary driver has accelerated once.
const LONG: usize = 400;

/// From where on a car is odd, and up to where it is ordinary; a unit that is rare.
const ODD_CAR: f64 = 2.5;
const ORDINARY_CAR: f64 = 1.2;
const KNOTS: Mistake = (1.0 / 1.852, "knots read as km/h");

/// `dv/dt` and an acceleration in the log have a common factor, with this correlation; a factor is one of units within this
/// tolerance.
const FOLLOWS: f64 = 0.9;
const TOLERANCE: f64 = 0.08;

/// What the rest of a recording says about its speeds.
#[derive(Clone)]
pub(super) struct Witnesses {
    pub(super) top_mps: f64,
    pub(super) pull_mps2: f64,
    pull_w_per_kg: f64,
    starts: bool,
    limit_share: Option<f64>,
    ratios: Vec<Ratio>,
    loads: Vec<Load>,
}

/// How many times a figure of the speed is what another channel says.
#[derive(Clone, Copy)]
struct Ratio {
    channel: Channel,
    factor: f64,
}

/// Who says that a speed is not `k` times too large.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Witness {
    /// No car does this.
    Motion,
    /// The speed limit is far off.
    Limit,
    /// An acceleration, a way or the battery power is another than the speed's.
    Measured(Channel),
}

/// What a witness says against a unit.
pub(super) struct Objection {
    pub(super) witness: Witness,
    pub(super) text: String,
}

impl Witnesses {
    /// `None` if the car hardly moves.
    pub(super) fn hear(log: &RawLog) -> Option<Self> {
        let all = spans(log);
        let driven = distance::ratio(log, &all).map(|factor| Ratio {
            channel: Channel::Distance,
            factor,
        });
        let spans: Vec<Span> = all
            .into_iter()
            .filter(|span| span.speed_mps > MOVING_MPS)
            .collect();
        if spans.len() < SECONDS {
            return None;
        }
        let high =
            |of: fn(&Span) -> f64| quantile(&mut spans.iter().map(of).collect::<Vec<f64>>(), 0.99);
        let ratios = accel_ratio(log, &spans).into_iter().chain(driven);
        Some(Self {
            top_mps: high(|span| span.speed_mps)?,
            pull_mps2: high(|span| span.accel_mps2)?,
            pull_w_per_kg: high(Span::inertia)?,
            starts: spans.len() >= LONG && log.speed_mps().iter().any(|v| v.abs() < STANDSTILL_MPS),
            limit_share: limit_share(log, &spans),
            ratios: ratios.filter(Ratio::is_known).collect(),
            loads: loads(log, &spans),
        })
    }

    /// How many times a figure of the speed is what a channel says.
    pub(super) fn factor(&self, channel: Channel) -> Option<f64> {
        let ratio = self.ratios.iter().find(|ratio| ratio.channel == channel)?;
        Some(ratio.factor)
    }

    /// The others, if a channel is not to be trusted.
    pub(super) fn without(&self, channel: Channel) -> Self {
        let mut rest = self.clone();
        rest.ratios.retain(|ratio| ratio.channel != channel);
        if channel == Channel::BatteryCurrent {
            rest.loads.clear();
        }
        rest
    }

    /// All that says that the speed is not `k` times too large.
    pub(super) fn objections(&self, k: f64) -> Vec<Objection> {
        let by = |witness| move |text| Objection { witness, text };
        let motion = self.against_motion(k).map(by(Witness::Motion));
        let limit = self.against_limit(k).map(by(Witness::Limit));
        let ratios = self.ratios.iter().filter_map(|ratio| {
            let text = ratio.against(k)?;
            Some(by(Witness::Measured(ratio.channel))(text))
        });
        let load = self.against_load(k);
        let load = load.map(by(Witness::Measured(Channel::BatteryCurrent)));
        motion.chain(limit).chain(ratios).chain(load).collect()
    }

    /// The units that nothing speaks against.
    pub(super) fn possible(&self) -> Vec<Mistake> {
        let is_possible = |unit: &Mistake| self.objections(unit.0).is_empty();
        MISTAKES.into_iter().filter(is_possible).collect()
    }

    fn against_motion(&self, k: f64) -> impl Iterator<Item = String> + use<> {
        let top_mps = self.top_mps / k;
        let pull_mps2 = self.pull_mps2 / k;
        let pull_w_per_kg = self.pull_w_per_kg / (k * k);
        let top = (top_mps > TOP_MPS).then(|| format!("over {top_mps:.0} m/s"));
        let pull = (pull_mps2 > FULL_PULL_MPS2)
            .then(|| format!("gathers speed at over {pull_mps2:.1} m/s²"));
        let power = (pull_w_per_kg > FULL_PULL_W_PER_KG)
            .then(|| format!("over {pull_w_per_kg:.0} W/kg go into the speed"));
        let hundredth = |text| format!("{text} for a hundredth of the time");
        [top, pull, power].into_iter().flatten().map(hundredth)
    }

    fn against_limit(&self, k: f64) -> Option<String> {
        let share = self.limit_share? / k;
        (!(LIMIT_SHARE.0..=LIMIT_SHARE.1).contains(&share)).then(|| of_limit(share))
    }

    fn against_load(&self, k: f64) -> Option<String> {
        let car = Load::fit(&self.loads, k)?;
        let is_possible = car.is_possible(self.top_mps / k, self.pull_mps2 / k);
        (!is_possible).then(|| format!("speed and battery power are those of {car}"))
    }

    /// What the battery says where it is that of no car.
    pub(super) fn no_car(&self) -> Option<String> {
        let car = Load::fit(&self.loads, 1.0).filter(Car::is_no_car)?;
        Some(format!(
            "speed and battery power are those of a vehicle of {:.0} kg",
            car.mass_kg
        ))
    }

    /// An odd car by its battery, and the units of the speed in which it is an ordinary one.
    pub(super) fn odd_car(&self) -> Option<(String, String)> {
        let car = Load::fit(&self.loads, 1.0).filter(|car| car.oddity() >= ODD_CAR)?;
        let ordinary = MISTAKES.into_iter().chain([KNOTS]).filter_map(|unit| {
            let oddity = Load::fit(&self.loads, unit.0)?.oddity();
            (oddity <= ORDINARY_CAR && self.objections(unit.0).is_empty())
                .then_some((oddity, unit.1))
        });
        let mut ordinary: Vec<(f64, &str)> = ordinary.collect();
        ordinary.sort_by(|a, b| a.0.total_cmp(&b.0));
        let units: Vec<&str> = ordinary.into_iter().map(|(_, unit)| unit).collect();
        let why = format!("speed and battery power are those of {car}");
        (!units.is_empty()).then(|| (why, units.join(", or ")))
    }

    /// A car twice as heavy as an ordinary one, by its battery.
    pub(super) fn heavy(&self) -> Option<String> {
        let car = Load::fit(&self.loads, 1.0).filter(Car::is_heavy)?;
        Some(format!("speed and battery power are those of {car}"))
    }

    /// How far the drive is off an ordinary one if the speed is `k` times too large, in usual factors.
    pub(super) fn oddity(&self, k: f64) -> f64 {
        let figures = self.figures(k);
        figures.iter().map(|(off, _)| off * off).sum::<f64>().sqrt()
    }

    /// Whether, by limit and battery, the drive is as ordinary if its speed is right, and changes `k` times too fast because of the
    /// times, as if the speed is `k` times too large.
    pub(super) fn are_rather_times(&self, k: f64) -> bool {
        let mut slower = self.clone();
        slower.pull_mps2 /= k;
        slower.pull_w_per_kg /= k;
        slower
            .loads
            .iter_mut()
            .for_each(|load| *load = load.at_pace(1.0 / k));
        let at_pace = Load::fit_few(&slower.loads, 1.0);
        let cars = at_pace.zip(Load::fit_few(&self.loads, k));
        let cars = cars.map_or((0.0, 0.0), |(pace, speed)| (pace.oddity(), speed.oddity()));
        let limit = |k: f64| self.limit_share.map_or(0.0, |share| SHARE.off(share / k));
        let (times, speed) = (cars.0.hypot(limit(1.0)), cars.1.hypot(limit(k)));
        // without limit and battery both are 0, and units are mistaken more often than times
        slower.against_motion(1.0).next().is_none() && times <= speed && speed > 0.0
    }

    /// The figures that are odd if the speed is what its header says.
    pub(super) fn odd(&self) -> Vec<String> {
        let figures = self.figures(1.0).into_iter();
        figures
            .filter(|(off, _)| off.abs() >= ODD)
            .map(|(_, text)| text)
            .collect()
    }

    /// Whether a drive that starts gathers speed as slowly as no ordinary one.
    pub(super) fn is_sluggish(&self) -> bool {
        let off = PULL_MPS2.off(self.pull_mps2);
        self.starts && (off <= -SLUGGISH || self.top_mps < SLOW_MPS && off <= -ODD)
    }

    /// How far each figure is off an ordinary drive if the speed is `k` times too large, in usual
    /// factors, and in words.
    fn figures(&self, k: f64) -> Vec<(f64, String)> {
        let pull_mps2 = self.pull_mps2 / k;
        let pull = (
            PULL_MPS2.off(pull_mps2),
            format!("gathers speed at {pull_mps2:.2} m/s² at most"),
        );
        let share = self
            .limit_share
            .map(|share| (SHARE.off(share / k), of_limit(share / k)));
        let car = Load::fit(&self.loads, k).map(|car| {
            let text = format!("speed and battery power are those of {car}");
            (car.oddity(), text)
        });
        std::iter::once(pull).chain(share).chain(car).collect()
    }

    /// Slow in relation to the limit alone, as in a jam.
    pub(super) fn is_a_jam(&self, objections: &[Objection]) -> bool {
        let is_jam = |share| (JAM_SHARE..1.0).contains(&share);
        matches!(objections, [one] if one.witness == Witness::Limit)
            && self.limit_share.is_some_and(is_jam)
    }
}

impl Ratio {
    /// By the factor of a mistake, or none.
    fn is_known(&self) -> bool {
        let is_unit = |factor: f64| near(self.factor, factor, TOLERANCE);
        is_unit(1.0) || MISTAKES.iter().any(|(factor, _)| is_unit(*factor))
    }

    /// An acceleration, or a way, that was computed from the speed has its unit, and says nothing.
    fn against(&self, k: f64) -> Option<String> {
        let says_nothing =
            near(self.factor, 1.0, TOLERANCE) && self.channel != Channel::Accelerometer;
        let what = match self.channel {
            Channel::Distance => "the way that the speed makes is {} times the one in the log",
            _ => "dv/dt is {} times the acceleration in the log",
        };
        (!says_nothing && !near(self.factor, k, TOLERANCE))
            .then(|| what.replace("{}", &format!("{:.3}", self.factor)))
    }
}

fn of_limit(share: f64) -> String {
    format!("a tenth of the time over {share:.2} of the speed limit")
}

/// What the fastest tenth of the time in motion reaches of the limit.
pub(in super::super) fn limit_share(log: &RawLog, spans: &[Span]) -> Option<f64> {
    let limit_mps = log.channel(Channel::SpeedLimit)?;
    let share = |span: &Span| {
        let limit_mps = limit_mps[*span.samples.start()];
        (limit_mps > 0.0).then(|| span.speed_mps / limit_mps)
    };
    let mut shares: Vec<f64> = spans.iter().filter_map(share).collect();
    if shares.len() < SECONDS {
        return None;
    }
    quantile(&mut shares, 0.9)
}

/// How many times `dv/dt` is an acceleration in the log that follows it.
fn accel_ratio(log: &RawLog, spans: &[Span]) -> Option<Ratio> {
    let channels = [Channel::Accelerometer, Channel::Accel];
    channels.into_iter().find_map(|channel| {
        let values = log.channel(channel)?;
        let pair = |span: &Span| Some((span.accel_mps2, span.mean(values)?));
        let pairs: Vec<(f64, f64)> = spans.iter().filter_map(pair).collect();
        let follows = pairs.len() >= SECONDS && correlation(&pairs) >= FOLLOWS;
        follows.then(|| Ratio {
            channel,
            factor: 1.0 / slope(&pairs),
        })
    })
}
