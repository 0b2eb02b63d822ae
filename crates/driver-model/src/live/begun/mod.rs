//! How a phase that has just begun will go, from the phases that began like it.

mod precedent;
mod spread;

use serde::Serialize;

use crate::motion::samples_in;
use crate::{BEGUN_S, Error, Phase, PhaseKind, PhaseMemory, PhaseModel, error};
pub use precedent::Beginning;
use precedent::{Case, Features, SECONDS, cases, distance, later_gains_mps, scales};
use spread::{Curves, quantile};

/// Fewer similar phases make no band.
const LEAST_CASES: usize = 10;

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

impl BegunPhases {
    /// Of what a model was fitted to. The band is stretched until it holds its share of the remembered phases of a drive, predicted from those of
    /// the other drives.
    ///
    /// # Errors
    /// [`Error::TooFewPhases`] where the memory holds too few phases, [`Error::Option`] for a coverage that is none or too few similar phases.
    pub fn new(
        model: PhaseModel,
        memory: &PhaseMemory,
        settings: &BegunSettings,
    ) -> Result<Self, Error> {
        let similar = settings.similar as f64;
        error::at_least("similar", similar, LEAST_CASES as f64, "at least 10")?;
        if !(settings.coverage > 0.0 && settings.coverage < 1.0) {
            return Err(Error::Option {
                name: "coverage",
                value: settings.coverage,
                expected: "between 0 and 1",
            });
        }
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
            let stretched =
                |width_mps: f64| self.stretch[second - 1] * width_mps.max(LEAST_WIDTH_MPS);
            let expected_mps = now_mps + median_mps;
            Some(Second {
                after_s: second as f64,
                speed_mps: expected_mps.max(0.0),
                low_mps: (expected_mps - stretched(median_mps - low_mps)).max(0.0),
                high_mps: (expected_mps + stretched(high_mps - median_mps)).max(0.0),
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
            .map(|case| (distance(&features, &case.features, &self.scales), case))
            .collect();
        by_distance.sort_by(|a, b| a.0.total_cmp(&b.0));
        by_distance.into_iter().map(|(_, case)| case).collect()
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

/// What is stretched is at least this wide to either side: models that are not told where a phase ends say the same for all that are similar.
const LEAST_WIDTH_MPS: f64 = 0.1;

const LEAST_STRETCH: f64 = 0.2;
const MOST_STRETCH: f64 = 100.0;
