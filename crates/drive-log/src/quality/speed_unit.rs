//! Speeds in another unit than their header says.

use super::Checked;
use super::motion::{Span, spans};
use super::power::{Load, loads};
use super::statistics::{correlation, near, quantile, slope};
use crate::{Action, Channel, FindingKind, RawLog};

/// Speeds that are read in the wrong unit, and how many times too large they are then,
/// from the largest.
pub(super) const MISTAKES: [(f64, &str); 6] = [
    (3.6, "km/h read as m/s"),
    (1.0 / 0.44704, "mph read as m/s"),
    (1.609_344, "km/h read as mph"),
    (1.0 / 1.609_344, "mph read as km/h"),
    (0.44704, "m/s read as mph"),
    (1.0 / 3.6, "m/s read as km/h"),
];

/// A car this fast moves, m/s; seconds in motion that say something.
const MOVING_MPS: f64 = 1.0;
const SECONDS: usize = 120;

/// What a hundredth of the time exceeds with no car on the road: 252 km/h, at which most fast cars
/// are held, m/s; full throttle of the fastest, m/s² and W/kg.
const TOP_MPS: f64 = 70.0;
const PULL_MPS2: f64 = 5.0;
const PULL_W_PER_KG: f64 = 300.0;

/// Beyond this not even racing cars come, m/s.
const RACING_MPS: f64 = 100.0;

/// What the fastest tenth of the time, in motion under a limit, is of that limit: between jams all
/// along and a driver whom no camera has seen. Alone, only less than the third figure is told.
const LIMIT_SHARE: (f64, f64) = (0.5, 1.6);
const JAM_SHARE: f64 = 0.36;

/// `dv/dt` and an acceleration in the log have a common factor, with this correlation and within
/// this tolerance.
const FOLLOWS: f64 = 0.9;
const TOLERANCE: f64 = 0.08;

/// What the rest of a recording says about its speeds, were they `k` times too large.
struct Witnesses {
    top_mps: f64,
    pull_mps2: f64,
    pull_w_per_kg: f64,
    limit_share: Option<f64>,
    /// `dv/dt` over the acceleration in the log, and whether that is an accelerometer.
    ratio: Option<(f64, bool)>,
    loads: Vec<Load>,
}

/// Who objects to a factor, and what it says.
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
    let possible: Vec<(f64, &str)> = MISTAKES
        .into_iter()
        .filter(|(factor, _)| witnesses.objections(*factor).is_empty())
        .collect();
    if objections.is_empty() || witnesses.is_a_jam(&objections) {
        return;
    }
    let measured = objections
        .iter()
        .any(|o| matches!(o, Objection::Measured(_)));
    let moved = objections
        .iter()
        .filter(|o| matches!(o, Objection::Motion(_)))
        .count();
    let texts: Vec<&str> = objections.iter().map(Objection::text).collect();
    let why = texts.join("; ");
    match possible.as_slice() {
        [(factor, unit)] if measured || objections.len() > 1 => {
            rescale(checked, 1.0 / factor);
            report(
                checked,
                Action::Scaled,
                format!("{why}: {unit}, divided by {factor:.4}"),
            );
        }
        _ if measured || moved > 1 || witnesses.top_mps > RACING_MPS => {
            report(
                checked,
                Action::Refused,
                format!("{why}: {}", asked(&possible)),
            );
        }
        _ => report(
            checked,
            Action::Kept,
            format!("{why}: {}", asked(&possible)),
        ),
    }
}

/// What may be meant.
fn asked(possible: &[(f64, &str)]) -> String {
    let units: Vec<&str> = possible.iter().map(|(_, unit)| *unit).collect();
    if units.is_empty() {
        "check the unit of the speed".to_owned()
    } else {
        format!(
            "perhaps {}; name the unit in the header or a layout",
            units.join(", or ")
        )
    }
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
        let high = |share: f64, of: fn(&Span) -> f64| {
            quantile(&mut spans.iter().map(of).collect::<Vec<f64>>(), share)
        };
        Some(Self {
            top_mps: high(0.99, |span| span.speed_mps)?,
            pull_mps2: high(0.99, |span| span.accel_mps2)?,
            pull_w_per_kg: high(0.99, Span::inertia)?,
            limit_share: limit_share(log, &spans),
            ratio: ratio(log, &spans),
            loads: loads(log, &spans),
        })
    }

    fn objections(&self, k: f64) -> Vec<Objection> {
        let limit_share = self.limit_share.map(|share| share / k);
        [
            (self.top_mps / k > TOP_MPS).then(|| {
                let top_mps = self.top_mps / k;
                Objection::Motion(format!("{top_mps:.0} m/s for a hundredth of the time"))
            }),
            (self.pull_mps2 / k > PULL_MPS2 || self.pull_w_per_kg / (k * k) > PULL_W_PER_KG).then(
                || {
                    let (a, p) = (self.pull_mps2 / k, self.pull_w_per_kg / (k * k));
                    Objection::Motion(format!(
                        "gathers speed at {a:.1} m/s² or {p:.0} W/kg for a hundredth of the time"
                    ))
                },
            ),
            limit_share
                .filter(|share| !(LIMIT_SHARE.0..=LIMIT_SHARE.1).contains(share))
                .map(|share| {
                    Objection::Limit(format!(
                        "a tenth of the time over {share:.2} of the speed limit"
                    ))
                }),
            self.against_ratio(k),
            self.against_load(k),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// An acceleration that was computed from the speed has its unit, and says nothing.
    fn against_ratio(&self, k: f64) -> Option<Objection> {
        let (ratio, is_sensor) = self.ratio?;
        let says_nothing = near(ratio, 1.0, TOLERANCE) && !is_sensor;
        (!says_nothing && !near(ratio, k, TOLERANCE)).then(|| {
            Objection::Measured(format!(
                "dv/dt is {ratio:.3} times the acceleration in the log"
            ))
        })
    }

    fn against_load(&self, k: f64) -> Option<Objection> {
        let car = Load::fit(&self.loads, k)?;
        (!car.is_possible(self.top_mps / k)).then(|| {
            Objection::Measured(format!(
                "speed and battery power are those of a car of {:.0} kg with a drag area of {:.2} m²",
                car.mass_kg, car.drag_area_m2
            ))
        })
    }

    /// Slow in relation to the limit alone, as in a jam.
    fn is_a_jam(&self, objections: &[Objection]) -> bool {
        matches!(objections, [Objection::Limit(_)])
            && self
                .limit_share
                .is_some_and(|share| (JAM_SHARE..1.0).contains(&share))
    }
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

/// How many times `dv/dt` is the acceleration in the log, if that follows it, and by one of the
/// mistakes or not at all.
fn ratio(log: &RawLog, spans: &[Span]) -> Option<(f64, bool)> {
    [Channel::Accelerometer, Channel::Accel]
        .into_iter()
        .find_map(|channel| {
            let values = log.channel(channel)?;
            let pair = |span: &Span| Some((span.accel_mps2, span.mean(values)?));
            let pairs: Vec<(f64, f64)> = spans.iter().filter_map(pair).collect();
            if pairs.len() < SECONDS || correlation(&pairs) < FOLLOWS {
                return None;
            }
            let ratio = 1.0 / slope(&pairs);
            let is_unit = |factor: f64| near(ratio, factor, TOLERANCE);
            let known = is_unit(1.0) || MISTAKES.iter().any(|(factor, _)| is_unit(*factor));
            known.then_some((ratio, channel == Channel::Accelerometer))
        })
}
