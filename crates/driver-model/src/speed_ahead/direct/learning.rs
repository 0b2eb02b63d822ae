use rayon::prelude::*;
use svr::{Response, Samples};

use super::held::{Held, shares};
use super::knowledge::{Horizon, Knowledge};
use super::{DirectModel, DirectSettings, origins};
use crate::speed_ahead::boosted_trees::BoostedTrees;
use crate::speed_ahead::interval::{HeldErrors, Intervals};
use crate::speed_ahead::predictors::{Predictor, predictors, rows};
use crate::{DriverChannel, Error, ModelKind, Motion, Subject};

/// Fewer samples teach nothing.
const LEAST_SAMPLES: usize = 50;

/// Trees of a prediction.
const TREES: usize = 250;

/// Parts of the drives, each predicted from the others, for errors that intervals learn from.
const PARTS: usize = 3;

/// Share of the samples that their models learn from: a little larger errors, in an eighth of the time.
const PART_SAMPLES: f64 = 0.5;

/// A channel that less of the time is recorded is not used: the drives without would be too much to lose.
const LEAST_WITH_CHANNEL: f64 = 0.5;

impl DirectModel {
    /// Fits one regression per horizon to drives of the same sampling interval, and prediction intervals to the errors on
    /// every third drive, predicted from the others. Where most of the time the log says what the driver does, a second regression
    /// learns from it, see [`learn_channels`](Self::learn_channels).
    ///
    /// # Errors
    /// [`Error::TooFewMoments`] where there is not enough to learn from, [`Error::Option`] for settings out of range,
    /// [`Error::Steps`] for drives of different sampling intervals, [`Error::Subject`] for a model of anything else, and what the
    /// regressions refuse.
    pub fn fit(
        kind: ModelKind,
        motions: &[&Motion],
        settings: &DirectSettings,
    ) -> Result<Self, Error> {
        Self::fit_untold(kind, motions, settings)?.learn_channels(motions, settings)
    }

    /// As [`fit`](Self::fit) without the driver's channels.
    ///
    /// # Errors
    /// As [`fit`](Self::fit).
    pub fn fit_untold(
        kind: ModelKind,
        motions: &[&Motion],
        settings: &DirectSettings,
    ) -> Result<Self, Error> {
        if kind.subject() != Subject::SpeedAhead {
            return Err(Error::not_of(Subject::SpeedAhead, kind));
        }
        settings.check()?;
        let step_s = motions.first().map_or(1.0, |motion| motion.step_s());
        if let Some(other) = motions
            .iter()
            .find(|motion| (motion.step_s() - step_s).abs() > 1e-9)
        {
            return Err(Error::Steps {
                log: other.name().to_owned(),
                found_s: other.step_s(),
                expected_s: step_s,
            });
        }
        Ok(Self {
            kind,
            step_s,
            told: None,
            untold: Box::new(Knowledge::fit(kind, motions, settings, &[])?),
        })
    }

    /// Learns from the channels of `settings` that are recorded in more than half of the time, from the drives that have them all. Unchanged
    /// where there are none, or too few moments.
    ///
    /// # Errors
    /// As [`fit`](Self::fit).
    pub fn learn_channels(
        mut self,
        motions: &[&Motion],
        settings: &DirectSettings,
    ) -> Result<Self, Error> {
        let channels = settings.known_channels(motions);
        if channels.is_empty() || !self.kind.is_fitted() {
            return Ok(self);
        }
        let with: Vec<&Motion> = motions
            .iter()
            .filter(|motion| channels.iter().all(|channel| channel.is_known_in(motion)))
            .copied()
            .collect();
        self.told = match Knowledge::fit(self.kind, &with, settings, &channels) {
            Ok(told) => Some(Box::new(told)),
            Err(Error::TooFewMoments { .. }) => None,
            Err(error) => return Err(error),
        };
        Ok(self)
    }
}

impl DirectSettings {
    /// The channels that models fitted to these drives are told.
    #[must_use]
    pub fn known_channels(&self, motions: &[&Motion]) -> Vec<DriverChannel> {
        let time_s = |motion: &&Motion| motion.len() as f64 * motion.step_s();
        let all_s: f64 = motions.iter().map(time_s).sum();
        let is_known = |channel: &&DriverChannel| {
            let with = motions.iter().filter(|motion| channel.is_known_in(motion));
            with.map(time_s).sum::<f64>() > LEAST_WITH_CHANNEL * all_s
        };
        self.channels.iter().filter(is_known).copied().collect()
    }
}

impl Knowledge {
    fn fit(
        kind: ModelKind,
        motions: &[&Motion],
        settings: &DirectSettings,
        channels: &[DriverChannel],
    ) -> Result<Self, Error> {
        let mut knowledge = Self::fit_points(kind, motions, settings, channels)?;
        if kind.is_fitted() {
            knowledge.learn_from_errors(kind, motions, settings)?;
        }
        Ok(knowledge)
    }

    fn fit_points(
        kind: ModelKind,
        motions: &[&Motion],
        settings: &DirectSettings,
        channels: &[DriverChannel],
    ) -> Result<Self, Error> {
        let step_s = motions.first().map_or(1.0, |motion| motion.step_s());
        let limits = motions.iter().all(|motion| motion.limit_mps().is_some());
        let slope =
            settings.slope_ahead && motions.iter().all(|motion| motion.slope_rad().is_some());
        let weighted = predictors(step_s, limits, slope, channels);
        let horizon = |&horizon_s| Horizon {
            horizon_s,
            ridge: None,
            regression: None,
            trees: None,
            shares: match kind {
                ModelKind::Blend => Horizon::EVEN_SHARES.to_vec(),
                _ => vec![1.0; usize::from(kind.is_fitted())],
            },
            status: None,
        };
        let mut knowledge = Self {
            channels: channels.to_vec(),
            drives: motions.len(),
            samples: 0,
            predictors: weighted.iter().map(|(predictor, _)| *predictor).collect(),
            horizons: settings.horizons_s.iter().map(horizon).collect(),
            intervals: None,
        };
        if kind.is_fitted() {
            let weights = weighted.iter().map(|(_, weight)| *weight).collect();
            knowledge.learn(kind, motions, settings, weights)?;
        }
        Ok(knowledge)
    }

    fn learn(
        &mut self,
        kind: ModelKind,
        motions: &[&Motion],
        settings: &DirectSettings,
        weights: Vec<f64>,
    ) -> Result<(), Error> {
        let d = self.predictors.len();
        let training = Training::gather(motions, &self.predictors, settings)?;
        let samples = Samples::new(&training.rows, d)?;
        let responses = training
            .changes
            .iter()
            .map(|changes| Response::new(changes));
        let responses = responses.collect::<Result<Vec<_>, _>>()?;
        self.samples = samples.len();
        if kind == ModelKind::Blend {
            let ridges = ModelKind::Ridge.regressions(&samples, &responses, Vec::new())?;
            for (horizon, (ridge, _)) in self.horizons.iter_mut().zip(ridges) {
                horizon.ridge = Some(ridge);
            }
        }
        let mut regressions = kind.regressions(&samples, &responses, weights)?.into_iter();
        for horizon in &mut self.horizons {
            if let Some((regression, status)) = regressions.next() {
                (horizon.regression, horizon.status) = (Some(regression), status);
            }
        }
        if kind.has_trees() {
            let grow = |(horizon, changes): (&mut Horizon, &Vec<f64>)| {
                horizon.trees = Some(BoostedTrees::fit(&training.rows, d, changes, TREES)?);
                Ok::<(), Error>(())
            };
            let horizons = self.horizons.par_iter_mut();
            horizons.zip(&training.changes).try_for_each(grow)?;
        }
        Ok(())
    }

    /// Shares and intervals from errors on every third drive, predicted from the others: whole drives, since neighbours resemble each
    /// other. Parts of which the rest is too little to learn from teach nothing.
    fn learn_from_errors(
        &mut self,
        kind: ModelKind,
        motions: &[&Motion],
        settings: &DirectSettings,
    ) -> Result<(), Error> {
        let fewer = DirectSettings {
            max_samples: (PART_SAMPLES * settings.max_samples as f64) as usize,
            ..settings.clone()
        };
        let mut held = Vec::new();
        // One after the other: each may take a gigabyte.
        for part in 0..PARTS {
            let numbered = motions.iter().copied().enumerate();
            let (own, others): (Vec<_>, Vec<_>) = numbered.partition(|(i, _)| i % PARTS == part);
            let [own, others] =
                [own, others].map(|of| of.into_iter().map(|(_, m)| m).collect::<Vec<_>>());
            match Self::fit_points(kind, &others, &fewer, &self.channels) {
                Ok(others) => held.push(Held::of(&others, &own, settings.sample_step_s)?),
                Err(Error::TooFewMoments { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        for (k, horizon) in self.horizons.iter_mut().enumerate() {
            if let Some(shares) = shares(&held, k, horizon.shares.len()) {
                horizon.shares = shares;
            }
        }
        let shares: Vec<Vec<f64>> = self.horizons.iter().map(|h| h.shares.clone()).collect();
        let errors: Vec<HeldErrors> = held.into_iter().map(|held| held.errors(&shares)).collect();
        self.intervals = Intervals::fit(&errors, self.predictors.len(), settings.coverage)?;
        Ok(())
    }
}

/// What all horizons learn from.
struct Training {
    rows: Vec<f64>,
    /// Per horizon.
    changes: Vec<Vec<f64>>,
}

impl Training {
    fn gather(
        motions: &[&Motion],
        predictors: &[Predictor],
        settings: &DirectSettings,
    ) -> Result<Self, Error> {
        let longest_s = settings.longest_s();
        let origins: Vec<Vec<usize>> = motions
            .iter()
            .map(|motion| origins(motion, longest_s, settings.sample_step_s))
            .collect();
        let total: usize = origins.iter().map(Vec::len).sum();
        if total < LEAST_SAMPLES {
            return Err(Error::TooFewMoments {
                found: total,
                needed: LEAST_SAMPLES,
            });
        }
        let most = settings.max_samples.max(LEAST_SAMPLES);
        let mut seen = 0;
        let mut training = Self {
            rows: Vec::new(),
            changes: vec![Vec::new(); settings.horizons_s.len()],
        };
        for (motion, origins) in motions.iter().zip(origins) {
            let chosen = origins.into_iter().filter(|_| {
                seen += 1;
                total <= most || (seen - 1) * most / total != seen * most / total
            });
            let chosen: Vec<usize> = chosen.collect();
            training.rows.extend(rows(motion, predictors, &chosen));
            for (changes, &horizon_s) in training.changes.iter_mut().zip(&settings.horizons_s) {
                let ahead = motion.samples_in(horizon_s);
                changes.extend(
                    chosen
                        .iter()
                        .map(|&i| motion.speed_mps()[i + ahead] - motion.speed_mps()[i]),
                );
            }
        }
        Ok(training)
    }
}
