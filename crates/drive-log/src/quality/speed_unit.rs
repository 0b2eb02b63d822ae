//! Speeds in another unit than their header says.

use super::Checked;
use super::motion::{Span, spans};
use super::power::{Load, Usual, loads};
use crate::statistics::{correlation, near, quantile, slope};
use crate::{Action, Channel, FindingKind, RawLog};

/// Speeds that are read in the wrong unit, and how many times too large they are then, from the
/// largest.
pub(super) const MISTAKES: [Mistake; 6] = [
    (3.6, "km/h read as m/s"),
    (1.0 / 0.44704, "mph read as m/s"),
    (1.609_344, "km/h read as mph"),
    (1.0 / 1.609_344, "mph read as km/h"),
    (0.44704, "m/s read as mph"),
    (1.0 / 3.6, "m/s read as km/h"),
];

/// A factor and what it stands for.
pub(super) type Mistake = (f64, &'static str);

/// A car this fast moves, m/s; seconds in motion that say something.
const MOVING_MPS: f64 = 1.0;
const SECONDS: usize = 120;

/// What a hundredth of the time exceeds with no car on the road: 252 km/h, at which most fast cars
/// are held, m/s; full throttle of the fastest, m/s² and W/kg.
const TOP_MPS: f64 = 70.0;
const FULL_PULL_MPS2: f64 = 5.0;
const FULL_PULL_W_PER_KG: f64 = 300.0;

/// Beyond this not even racing cars come, m/s.
const RACING_MPS: f64 = 100.0;

/// What the fastest tenth of the time in motion is of the limit: between jams all along and a driver
/// whom no camera has seen. Alone, a jam is told from a unit below the last figure.
const LIMIT_SHARE: (f64, f64) = (0.5, 1.6);
const JAM_SHARE: f64 = 0.36;

/// Ordinary drives: what a hundredth of the time exceeds, m/s² (0.8 to 3.5 in 70 recorded drives),
/// and the share of the limit.
const PULL_MPS2: Usual = Usual(1.8, 0.35);
const SHARE: Usual = Usual(1.0, 0.25);

/// In usual factors: how far off the ordinary a drive may be in the likeliest unit, how much farther
/// it must be in the next one, and from where on a figure is odd.
const ORDINARY: f64 = 2.0;
const CLEARLY: f64 = 1.0;
const ODD: f64 = 1.8;

/// `dv/dt` and an acceleration in the log have a common factor, with this correlation and within
/// this tolerance.
const FOLLOWS: f64 = 0.9;
const TOLERANCE: f64 = 0.08;

/// What the rest of a recording says about its speeds.
struct Witnesses {
    top_mps: f64,
    pull_mps2: f64,
    pull_w_per_kg: f64,
    limit_share: Option<f64>,
    /// `dv/dt` over the acceleration in the log, and whether that is an accelerometer.
    ratio: Option<(f64, bool)>,
    loads: Vec<Load>,
}

/// What says that a speed is not `k` times too large.
enum Objection {
    /// No car does this.
    Motion(String),
    /// The speed limit is far off.
    Limit(String),
    /// An acceleration or the battery power is another than the speed's.
    Measured(String),
}

/// Converts a speed whose unit is another one beyond doubt; refuses one that is impossible where the
/// unit cannot be told; reports one that is doubtful.
pub(super) fn convert(checked: &mut Checked) {
    let Some(witnesses) = Witnesses::hear(&checked.log) else {
        return;
    };
    let objections = witnesses.objections(1.0);
    let possible: Vec<Mistake> = MISTAKES
        .into_iter()
        .filter(|(factor, _)| witnesses.objections(*factor).is_empty())
        .collect();
    let likely = witnesses.likely(&possible);
    if objections.is_empty() {
        report_odd(checked, &witnesses.odd(), likely);
    } else if !witnesses.is_a_jam(&objections) {
        decide(checked, &witnesses, &objections, likely, &possible);
    }
}

/// Reports a speed that two figures make unlikely, where another unit makes the drive ordinary.
fn report_odd(checked: &mut Checked, odd: &[String], likely: Option<Mistake>) {
    if let Some(unit) = likely.filter(|_| odd.len() > 1) {
        let detail = format!("{}: {}", odd.join("; "), asked(&[unit]));
        report(checked, Action::Kept, detail);
    }
}

fn decide(
    checked: &mut Checked,
    witnesses: &Witnesses,
    objections: &[Objection],
    likely: Option<Mistake>,
    possible: &[Mistake],
) {
    let texts: Vec<&str> = objections.iter().map(Objection::text).collect();
    let why = texts.join("; ");
    let measured = objections
        .iter()
        .any(|o| matches!(o, Objection::Measured(_)));
    let motion = objections
        .iter()
        .filter(|o| matches!(o, Objection::Motion(_)))
        .count();
    let by_limit = motion > 0 && motion < objections.len();
    match likely {
        Some((factor, unit)) if measured || by_limit => {
            rescale(checked, 1.0 / factor);
            let detail = format!("{why}: {unit}, divided by {factor:.4}");
            report(checked, Action::Scaled, detail);
        }
        _ => {
            let is_impossible = measured || motion > 1 || witnesses.top_mps > RACING_MPS;
            let action = if is_impossible {
                Action::Refused
            } else {
                Action::Kept
            };
            report(checked, action, format!("{why}: {}", asked(possible)));
        }
    }
}

/// What may be meant, and what to do.
fn asked(possible: &[Mistake]) -> String {
    let units: Vec<&str> = possible.iter().map(|(_, unit)| *unit).collect();
    if units.is_empty() {
        return "check the unit of the speed".to_owned();
    }
    format!(
        "perhaps {}; name the unit in the header or a layout",
        units.join(", or ")
    )
}

fn rescale(checked: &mut Checked, factor: f64) {
    if let Some(values) = checked.log.channels.get_mut(&Channel::Speed) {
        values.iter_mut().for_each(|v| *v *= factor);
    }
}

fn report(checked: &mut Checked, action: Action, detail: String) {
    let samples = 0..checked.log.len();
    checked.report(FindingKind::Unit, Channel::Speed, &samples, action, detail);
}

impl Objection {
    fn text(&self) -> &str {
        let (Self::Motion(text) | Self::Limit(text) | Self::Measured(text)) = self;
        text
    }
}

impl Witnesses {
    /// `None` if the car hardly moves.
    fn hear(log: &RawLog) -> Option<Self> {
        let spans: Vec<Span> = spans(log)
            .into_iter()
            .filter(|span| span.speed_mps > MOVING_MPS)
            .collect();
        if spans.len() < SECONDS {
            return None;
        }
        let high =
            |of: fn(&Span) -> f64| quantile(&mut spans.iter().map(of).collect::<Vec<f64>>(), 0.99);
        Some(Self {
            top_mps: high(|span| span.speed_mps)?,
            pull_mps2: high(|span| span.accel_mps2)?,
            pull_w_per_kg: high(Span::inertia)?,
            limit_share: limit_share(log, &spans),
            ratio: ratio(log, &spans),
            loads: loads(log, &spans),
        })
    }

    /// All that says that the speed is not `k` times too large.
    fn objections(&self, k: f64) -> Vec<Objection> {
        let motion = self.against_motion(k).map(Objection::Motion);
        let limit = self.against_limit(k).map(Objection::Limit);
        let measured = [self.against_ratio(k), self.against_load(k)];
        let measured = measured.into_iter().flatten().map(Objection::Measured);
        motion.chain(limit).chain(measured).collect()
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

    /// An acceleration that was computed from the speed has its unit, and says nothing.
    fn against_ratio(&self, k: f64) -> Option<String> {
        let (ratio, is_sensor) = self.ratio?;
        let says_nothing = near(ratio, 1.0, TOLERANCE) && !is_sensor;
        (!says_nothing && !near(ratio, k, TOLERANCE))
            .then(|| format!("dv/dt is {ratio:.3} times the acceleration in the log"))
    }

    fn against_load(&self, k: f64) -> Option<String> {
        let car = Load::fit(&self.loads, k)?;
        let is_possible = car.is_possible(self.top_mps / k, self.pull_mps2 / k);
        (!is_possible).then(|| format!("speed and battery power are those of {car}"))
    }

    /// The only possible unit, or the one in which the drive is clearly the most ordinary.
    fn likely(&self, possible: &[Mistake]) -> Option<Mistake> {
        let oddity = |k: f64| {
            self.figures(k)
                .iter()
                .map(|(off, _)| off * off)
                .sum::<f64>()
        };
        let mut ranked: Vec<(f64, Mistake)> = possible
            .iter()
            .map(|unit| (oddity(unit.0).sqrt(), *unit))
            .collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        match ranked.as_slice() {
            [(_, unit)] => Some(*unit),
            [(best, unit), (next, _), ..] => {
                (*best <= ORDINARY && next - best >= CLEARLY).then_some(*unit)
            }
            [] => None,
        }
    }

    /// The figures that are odd if the speed is what its header says.
    fn odd(&self) -> Vec<String> {
        let figures = self.figures(1.0).into_iter();
        figures
            .filter(|(off, _)| off.abs() >= ODD)
            .map(|(_, text)| text)
            .collect()
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
    fn is_a_jam(&self, objections: &[Objection]) -> bool {
        let is_jam = |share| (JAM_SHARE..1.0).contains(&share);
        matches!(objections, [Objection::Limit(_)]) && self.limit_share.is_some_and(is_jam)
    }
}

fn of_limit(share: f64) -> String {
    format!("a tenth of the time over {share:.2} of the speed limit")
}

/// What the fastest tenth of the time in motion reaches of the limit.
pub(super) fn limit_share(log: &RawLog, spans: &[Span]) -> Option<f64> {
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

/// How many times `dv/dt` is the acceleration in the log, if that follows it by the factor of a
/// mistake or none.
fn ratio(log: &RawLog, spans: &[Span]) -> Option<(f64, bool)> {
    let channels = [Channel::Accelerometer, Channel::Accel];
    channels.into_iter().find_map(|channel| {
        let values = log.channel(channel)?;
        let pair = |span: &Span| Some((span.accel_mps2, span.mean(values)?));
        let pairs: Vec<(f64, f64)> = spans.iter().filter_map(pair).collect();
        if pairs.len() < SECONDS || correlation(&pairs) < FOLLOWS {
            return None;
        }
        let ratio = 1.0 / slope(&pairs);
        let is_unit = |factor: f64| near(ratio, factor, TOLERANCE);
        let is_known = is_unit(1.0) || MISTAKES.iter().any(|(factor, _)| is_unit(*factor));
        is_known.then_some((ratio, channel == Channel::Accelerometer))
    })
}
