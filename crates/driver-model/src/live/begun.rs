//! How a phase that has just begun will go, from the phases that began like it.

use serde::Serialize;

use crate::motion::samples_in;
use crate::{
    BEGUN_S, DriverInput, Error, Onset, Phase, PhaseCurve, PhaseKind, PhaseMemory, PhaseModel,
};

/// Seconds that are looked ahead at most.
const SECONDS: usize = 10;

/// Fewer similar phases make no band.
const LEAST_CASES: usize = 10;

/// Start speed, early gain, the onset, and what the driver does.
const FEATURES: usize = 11;

/// A curve that misses the early gain by so much counts 0.6 times; chosen on the drives of `bmw-i3`.
const EARLY_MISS_MPS: f64 = 0.4;

/// However much a curve misses it, it counts so many times.
const LEAST_SHARE: f64 = 1e-6;

/// How much a distance in each counts beside the others; chosen on the drives of `bmw-i3`.
const WEIGHTS: [f64; FEATURES] = [1.0, 2.0, 0.5, 0.5, 0.25, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5];

type Features = [f64; FEATURES];

/// How similar phases become a band.
#[derive(Debug, Clone, PartialEq)]
pub struct BegunSettings {
    /// Similar phases; 50, chosen on the drives of `bmw-i3`.
    pub similar: usize,
    /// Share that the band is to hold; 0.9.
    pub coverage: f64,
    /// Remembered phases by which the band is stretched, at most, of each second; 200.
    pub judges: usize,
}

impl Default for BegunSettings {
    fn default() -> Self {
        Self {
            similar: 50,
            coverage: 0.9,
            judges: 200,
        }
    }
}

/// What is known of a phase that has lasted [`BEGUN_S`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beginning {
    /// Speed at its first sample.
    pub start_speed_mps: f64,
    /// Change since then.
    pub early_gain_mps: f64,
    /// How it was entered.
    pub onset: Option<Onset>,
    /// What the driver did as it began.
    pub input: DriverInput,
}

impl Case {
    fn lasts(&self, second: usize) -> bool {
        self.later_gain_mps.len() >= second
    }
}

impl Beginning {
    /// Speed when it has lasted [`BEGUN_S`].
    fn now_mps(&self) -> f64 {
        self.start_speed_mps + self.early_gain_mps
    }

    /// Of a recorded phase; `None` for one that ended sooner.
    #[must_use]
    pub fn of(curve: &PhaseCurve) -> Option<Self> {
        Some(Self::new(&curve.outline(), curve.early_gain_mps()?))
    }

    fn new(outline: &Phase, early_gain_mps: f64) -> Self {
        Self {
            start_speed_mps: outline.start_speed_mps,
            early_gain_mps,
            onset: outline.onset,
            input: outline.input,
        }
    }

    fn features(&self) -> Features {
        let onset = self.onset.map_or([f64::NAN; 3], Onset::values);
        let input = self.input.values().map(|value| value.unwrap_or(f64::NAN));
        let [accel, jerk, previous] = onset;
        let [pedal, change, slow_change, brake, torque, accelerometer] = input;
        [
            self.start_speed_mps,
            self.early_gain_mps,
            accel,
            jerk,
            previous,
            pedal,
            change,
            slow_change,
            brake,
            torque,
            accelerometer,
        ]
    }
}

/// What becomes of a phase that has begun.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Forecast {
    /// Seconds from [`BEGUN_S`] after the begin on, as many as enough remembered phases lasted.
    pub seconds: Vec<Second>,
    /// Share of similar phases that came to count, by the rules of the model.
    pub counts_pct: f64,
    /// Median of the whole duration of similar phases.
    pub duration_s: f64,
    /// Speed at the end with the median change of speed of similar phases.
    pub end_speed_mps: f64,
}

/// One second, if the phase still goes on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Second {
    /// After [`BEGUN_S`].
    pub after_s: f64,
    /// Median.
    pub speed_mps: f64,
    /// Lower end of the band.
    pub low_mps: f64,
    /// Upper end of the band.
    pub high_mps: f64,
    /// Share of similar phases that still went on.
    pub going_on_pct: f64,
}

/// The phases that a model remembers, as precedents of one that begins.
#[derive(Debug, Clone)]
pub struct BegunPhases {
    model: PhaseModel,
    settings: BegunSettings,
    step_s: f64,
    scales: Features,
    cases: Vec<Case>,
    /// Factors of the half-widths, by second.
    stretch: [f64; SECONDS],
}

/// A remembered phase.
#[derive(Debug, Clone)]
struct Case {
    drive: usize,
    weight: f64,
    counts: bool,
    features: Features,
    beginning: Beginning,
    gain_mps: f64,
    samples: usize,
    /// Change since the early gain, second by second, as long as it lasted.
    later_gain_mps: Vec<f64>,
}

impl BegunPhases {
    /// Of what a model was fitted to. The band is stretched until it holds its share of the remembered phases of a drive, predicted from those of
    /// the other drives.
    ///
    /// # Errors
    /// [`Error::TooFewPhases`] where the memory holds too few phases.
    pub fn new(
        model: PhaseModel,
        memory: &PhaseMemory,
        settings: &BegunSettings,
    ) -> Result<Self, Error> {
        let cases = cases(memory);
        let (Some(step_s), true) = (memory.step_s(), cases.len() >= LEAST_CASES) else {
            return Err(Error::TooFewPhases {
                model: model.kind().name(),
                found: cases.len(),
                needed: LEAST_CASES,
                unit: match memory.kind() {
                    PhaseKind::Braking => "remembered braking phases",
                    _ => "remembered acceleration phases",
                },
            });
        };
        let mut begun = Self {
            scales: scales(&cases),
            stretch: [1.0; SECONDS],
            settings: settings.clone(),
            model,
            step_s,
            cases,
        };
        begun.stretch = begun.stretches();
        Ok(begun)
    }

    /// What becomes of a phase that begins like this.
    #[must_use]
    pub fn forecast(&self, beginning: &Beginning) -> Forecast {
        let sorted = self.by_similarity(beginning, None);
        let similar = &sorted[..self.settings.similar.min(sorted.len())];
        let share = |counts: &dyn Fn(&Case) -> bool| {
            let weight = |cases: &mut dyn Iterator<Item = &&Case>| -> f64 {
                cases.map(|case| case.weight).sum()
            };
            let some = weight(&mut similar.iter().filter(|case| counts(case)));
            100.0 * some / weight(&mut similar.iter())
        };
        let median = |of: &dyn Fn(&Case) -> f64| {
            let pairs = similar.iter().map(|case| (of(case), case.weight));
            quantile(&mut pairs.collect::<Vec<_>>(), 0.5)
        };
        let now_mps = beginning.now_mps();
        let mut curves = Curves::of(self, beginning);
        let seconds = (1..=SECONDS).map_while(|second| {
            let (low_mps, median_mps, high_mps) = curves.spread_mps(&sorted, second)?;
            let stretch = self.stretch[second - 1];
            Some(Second {
                after_s: second as f64,
                speed_mps: (now_mps + median_mps).max(0.0),
                low_mps: (now_mps + median_mps - stretch * (median_mps - low_mps)).max(0.0),
                high_mps: (now_mps + median_mps + stretch * (high_mps - median_mps)).max(0.0),
                going_on_pct: share(&|case| case.lasts(second)),
            })
        });
        Forecast {
            seconds: seconds.collect(),
            counts_pct: share(&|case| case.counts),
            duration_s: median(&|case| (case.samples - 1) as f64) * self.step_s,
            end_speed_mps: (beginning.start_speed_mps + median(&|case| case.gain_mps)).max(0.0),
        }
    }

    /// How the speed of all remembered phases that still went on had changed since [`BEGUN_S`], second by second: the tails of the coverage.
    /// This is the band without similarity.
    #[must_use]
    pub fn changes_of_all_mps(&self) -> Vec<(f64, f64)> {
        let tail = 0.5 * (1.0 - self.settings.coverage);
        let gains = |second: usize| -> Vec<(f64, f64)> {
            let cases = self.cases.iter();
            let gain = |case: &Case| Some((*case.later_gain_mps.get(second)?, case.weight));
            cases.filter_map(gain).collect()
        };
        let enough = (0..SECONDS)
            .map(gains)
            .take_while(|g| g.len() >= LEAST_CASES);
        enough
            .map(|mut g| (quantile(&mut g, tail), quantile(&mut g, 1.0 - tail)))
            .collect()
    }

    /// The phases of other drives than this one, the most similar first.
    fn by_similarity(&self, beginning: &Beginning, drive: Option<usize>) -> Vec<&Case> {
        let features = beginning.features();
        let known = self.cases.iter().filter(|case| Some(case.drive) != drive);
        let mut by_distance: Vec<(f64, &Case)> = known
            .map(|case| (self.distance(&features, &case.features), case))
            .collect();
        by_distance.sort_by(|a, b| a.0.total_cmp(&b.0));
        by_distance.into_iter().map(|(_, case)| case).collect()
    }

    /// Mean square over the features that the beginning knows; one that a case does not know counts as its mean.
    fn distance(&self, beginning: &Features, case: &Features) -> f64 {
        let mut sum = 0.0;
        for feature in 0..FEATURES {
            let apart = (beginning[feature] - case[feature]) / self.scales[feature];
            if apart.is_finite() {
                sum += WEIGHTS[feature] * apart * apart;
            } else if beginning[feature].is_finite() {
                sum += WEIGHTS[feature];
            }
        }
        sum
    }

    /// The early gain, and the change of speed since then, second by second, as the model has it for the gain and the duration of another phase.
    fn curve(&self, beginning: &Beginning, case: &Case) -> Vec<f64> {
        let start_mps = beginning.start_speed_mps;
        let end_mps = start_mps + case.gain_mps;
        let speed_mps = self.model.predict(&Phase {
            start_speed_mps: start_mps,
            end_speed_mps: if case.gain_mps < 0.0 {
                end_mps.max(0.0)
            } else {
                end_mps
            },
            step_s: self.step_s,
            samples: case.samples,
            onset: beginning.onset,
            input: beginning.input,
        });
        let begun = samples_in(BEGUN_S, self.step_s);
        let early_mps = speed_mps.get(begun).map(|v| v - start_mps);
        let later = later_gains_mps(&speed_mps, self.step_s);
        early_mps.into_iter().chain(later).collect()
    }

    /// By how much the band has to be stretched at every second, so that it holds its share of the phases of drives that it is not made from:
    /// the quantile of split conformal prediction.
    fn stretches(&self) -> [f64; SECONDS] {
        let highest = self
            .cases
            .iter()
            .map(|case| case.weight)
            .fold(0.0, f64::max);
        let is_own = |case: &&Case| case.weight >= highest;
        let own: Vec<&Case> = self.cases.iter().filter(is_own).collect();
        let one_drive = own.iter().all(|case| case.drive == own[0].drive);
        std::array::from_fn(|k| {
            let second = k + 1;
            let lasting: Vec<&&Case> = own.iter().filter(|case| case.lasts(second)).collect();
            let every = lasting.len().div_ceil(self.settings.judges.max(1)).max(1);
            let judges = lasting.into_iter().step_by(every);
            let mut scores: Vec<f64> = judges
                .filter_map(|case| {
                    let others =
                        self.by_similarity(&case.beginning, (!one_drive).then_some(case.drive));
                    let mut curves = Curves::of(self, &case.beginning);
                    let (low, median, high) = curves.spread_mps(&others, second)?;
                    let error_mps = case.later_gain_mps[k] - median;
                    let width_mps = if error_mps < 0.0 {
                        median - low
                    } else {
                        high - median
                    };
                    Some(error_mps.abs() / width_mps.max(LEAST_WIDTH_MPS))
                })
                .collect();
            scores.sort_by(f64::total_cmp);
            let needed = self.settings.coverage * (scores.len() + 1) as f64;
            let reached = scores.get((needed.ceil() as usize).saturating_sub(1));
            let stretch = reached.or(scores.last());
            stretch.map_or(1.0, |s| s.clamp(LEAST_STRETCH, MOST_STRETCH))
        })
    }
}

/// The curves of similar phases, each made once.
struct Curves<'a> {
    begun: &'a BegunPhases,
    beginning: &'a Beginning,
    by_place: Vec<Vec<f64>>,
}

impl<'a> Curves<'a> {
    fn of(begun: &'a BegunPhases, beginning: &'a Beginning) -> Self {
        Self {
            begun,
            beginning,
            by_place: Vec::new(),
        }
    }

    /// Lower tail, median and upper tail of the change of speed since the early gain after so many seconds, by the most similar phases that
    /// lasted so long, each counting as well as its curve meets the early gain; `None` where there are too few.
    fn spread_mps(&mut self, sorted: &[&Case], second: usize) -> Option<(f64, f64, f64)> {
        self.by_place.resize(sorted.len(), Vec::new());
        let lasting = sorted.iter().enumerate();
        let lasting = lasting.filter(|(_, case)| case.lasts(second));
        let mut gains = Vec::new();
        for (place, case) in lasting.take(self.begun.settings.similar) {
            if self.by_place[place].is_empty() {
                self.by_place[place] = self.begun.curve(self.beginning, case);
            }
            let curve = &self.by_place[place];
            if let (Some(early_mps), Some(gain_mps)) = (curve.first(), curve.get(second)) {
                let miss = (early_mps - self.beginning.early_gain_mps) / EARLY_MISS_MPS;
                let fits = (-0.5 * miss * miss).exp().max(LEAST_SHARE);
                gains.push((*gain_mps, case.weight * fits));
            }
        }
        if gains.len() < LEAST_CASES {
            return None;
        }
        let tail = 0.5 * (1.0 - self.begun.settings.coverage);
        let mut at = |share| quantile(&mut gains, share);
        Some((at(tail), at(0.5), at(1.0 - tail)))
    }
}

/// A narrower band cannot be stretched.
const LEAST_WIDTH_MPS: f64 = 0.01;

const LEAST_STRETCH: f64 = 0.2;
const MOST_STRETCH: f64 = 20.0;

fn cases(memory: &PhaseMemory) -> Vec<Case> {
    let (own_drives, _) = memory.drive_counts();
    let mut cases = Vec::new();
    for (drive, remembered) in memory.drives().enumerate() {
        let weight = if drive < own_drives {
            1.0
        } else {
            memory.prior_weight()
        };
        if weight <= 0.0 {
            continue;
        }
        let case = |beginning: Beginning, outline: &Phase, later_gain_mps, counts| Case {
            drive,
            weight,
            counts,
            features: beginning.features(),
            beginning,
            gain_mps: outline.gain_mps(),
            samples: outline.samples,
            later_gain_mps,
        };
        cases.extend(remembered.phases.iter().filter_map(|curve| {
            let later = later_gains_mps(curve.speed_mps(), curve.step_s());
            Some(case(Beginning::of(curve)?, &curve.outline(), later, true))
        }));
        cases.extend(remembered.short.iter().map(|short| {
            let outline = &short.outline;
            let beginning = Beginning::new(outline, short.early_gain_mps);
            // What is not remembered of it counts as a straight line.
            let begun = samples_in(BEGUN_S, outline.step_s);
            let rest = outline.samples.saturating_sub(begun + 1);
            let left_mps = outline.gain_mps() - short.early_gain_mps;
            let seconds = (1..=SECONDS).map(|s| samples_in(s as f64, outline.step_s));
            let line = seconds.take_while(|steps| *steps <= rest);
            let line = line.map(|steps| left_mps * steps as f64 / rest as f64);
            case(beginning, outline, line.collect(), false)
        }));
    }
    cases
}

/// Of a phase that lasted beyond its begin.
fn later_gains_mps(speed_mps: &[f64], step_s: f64) -> Vec<f64> {
    let begun = samples_in(BEGUN_S, step_s);
    let seconds = (1..=SECONDS).map(|second| begun + samples_in(second as f64, step_s));
    let gains = seconds.map_while(|sample| Some(speed_mps.get(sample)? - speed_mps[begun]));
    gains.collect()
}

/// Standard deviation of every feature; 1 where it does not vary.
fn scales(cases: &[Case]) -> Features {
    std::array::from_fn(|feature| {
        let known = cases
            .iter()
            .map(|case| (case.features[feature], case.weight));
        let known: Vec<(f64, f64)> = known.filter(|(value, _)| value.is_finite()).collect();
        let total: f64 = known.iter().map(|(_, weight)| weight).sum();
        let mean = known.iter().map(|(v, w)| w * v).sum::<f64>() / total;
        let variance = known
            .iter()
            .map(|(v, w)| w * (v - mean).powi(2))
            .sum::<f64>()
            / total;
        let deviation = variance.sqrt();
        if deviation > 1e-9 { deviation } else { 1.0 }
    })
}

/// The value below which this share of the weight lies, between the two nearest.
fn quantile(values: &mut [(f64, f64)], share: f64) -> f64 {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = values.iter().map(|(_, weight)| weight).sum();
    let mut below = 0.0;
    let mut before: Option<(f64, f64)> = None;
    for &(value, weight) in values.iter() {
        // Each value stands at the middle of its weight.
        let place = (below + 0.5 * weight) / total;
        if place >= share {
            return match before {
                Some((last, last_place)) if place > last_place => {
                    last + (value - last) * (share - last_place) / (place - last_place)
                }
                _ => value,
            };
        }
        before = Some((value, place));
        below += weight;
    }
    before.map_or(f64::NAN, |(value, _)| value)
}
