//! The five trials of section 4.2: speed, or its change, by support vector regression on speed limits and past speeds.
//!
//! ```text
//! 1  v^k  = f(limit, next and previous different limit, distances to them)       linear        (4.22)
//! 2  v^k  = f(limits over 10 s around k, v^{k−1})                                linear        (4.23)
//! 3  Δv^k = f(limits over 10 s around k, v^{k−1}, …, v^{k−j})                    linear        (4.24)
//! 4  as 3                                                                        quadratic
//! 5  as 3, predictors and response scaled to −1 … 1                              linear
//! ```
//!
//! Limits are 0 where the vehicle stands. The window is one of time: the limits that the vehicle will have reached 5 s later
//! are among its predictors. From trial 2 on a trip is predicted by recursion on predicted speeds, from the first
//! measured ones.

use svr::{Fit, Kernel, Penalty, Response, Samples, Scaling, Settings};

use super::FIT_MEMORY_BYTES;
use crate::{Error, Motion};

/// Fewer samples teach nothing.
const LEAST_SAMPLES: usize = 8;

/// One of the five trials.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Trial {
    /// Five predictors of place.
    Place,
    /// Window of limits and the last speed.
    Window,
    /// Change of speed.
    Change,
    /// Change of speed, quadratic kernel.
    Quadratic,
    /// Change of speed, scaled to −1 … 1.
    Scaled,
}

/// What all trials share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrialSettings {
    /// Width of the window of limits; 10 s.
    pub window_s: f64,
    /// Past speeds of trials 3 to 5; 5.
    pub past_speeds: usize,
    /// Training samples, spread evenly over the drives; 16,000.
    pub max_samples: usize,
    /// Share of the training samples held out for validation; a quarter.
    pub hold_out: f64,
}

impl Default for TrialSettings {
    fn default() -> Self {
        Self {
            window_s: 10.0,
            past_speeds: 5,
            max_samples: 16_000,
            hold_out: 0.25,
        }
    }
}

/// A trial fitted to drives.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedTrial {
    /// Which trial.
    pub trial: Trial,
    /// What it was fitted with.
    pub settings: TrialSettings,
    /// The regression, with how good an optimum it is.
    pub fit: Fit,
    /// Samples learnt from.
    pub samples: usize,
    /// Root mean square error of the response on the last quarter of the training samples, learnt from the others. In m/s.
    pub hold_out_rmse_mps: f64,
}

impl Trial {
    /// All five.
    pub const ALL: [Self; 5] = [
        Self::Place,
        Self::Window,
        Self::Change,
        Self::Quadratic,
        Self::Scaled,
    ];

    /// Number in the thesis.
    #[must_use]
    pub fn number(self) -> usize {
        self as usize + 1
    }

    fn settings(self) -> Settings {
        let scaled = self == Self::Scaled;
        Settings {
            kernel: if self == Self::Quadratic {
                Kernel::Quadratic
            } else {
                Kernel::Linear
            },
            predictor_scaling: if scaled {
                Scaling::Range
            } else {
                Scaling::Standardize
            },
            response_scaling: if scaled {
                Scaling::Range
            } else {
                Scaling::None
            },
            memory_limit_bytes: FIT_MEMORY_BYTES,
            ..Settings::default()
        }
    }

    fn past_speeds(self, settings: &TrialSettings) -> usize {
        match self {
            Self::Place => 0,
            Self::Window => 1,
            _ => settings.past_speeds,
        }
    }

    /// Fits the trial to drives with speed limits.
    ///
    /// # Errors
    /// [`Error::NoLimits`] for a drive without, [`Error::TooFewMoments`] where there is hardly a sample, and what the
    /// regression refuses.
    pub fn fit(self, motions: &[&Motion], settings: &TrialSettings) -> Result<FittedTrial, Error> {
        let past = self.past_speeds(settings);
        let (mut rows, mut responses) = (Vec::new(), Vec::new());
        let total: usize = motions
            .iter()
            .map(|motion| motion.len().saturating_sub(past))
            .sum();
        let most = settings.max_samples.max(LEAST_SAMPLES);
        let mut seen = 0;
        for motion in motions {
            let limits = Limits::of(motion, settings.window_s)?;
            for k in past..motion.len() {
                let chosen = total <= most || seen * most / total != (seen + 1) * most / total;
                seen += 1;
                if chosen {
                    self.row(&limits, k, &motion.speed_mps()[k - past..k], &mut rows);
                    responses
                        .push(motion.speed_mps()[k] - self.base(motion.speed_mps()[..k].last()));
                }
            }
        }
        if responses.len() < LEAST_SAMPLES {
            return Err(Error::TooFewMoments {
                found: responses.len(),
                needed: LEAST_SAMPLES,
            });
        }
        let d = rows.len() / responses.len();
        let samples = Samples::new(&rows, d)?;
        let fit = svr::fit(
            &samples,
            &Response::new(&responses)?,
            &self.settings(),
            &Penalty::default(),
        )?;
        let hold_out_rmse_mps = self.hold_out_rmse(&samples, &responses, settings)?;
        Ok(FittedTrial {
            trial: self,
            settings: *settings,
            fit,
            samples: responses.len(),
            hold_out_rmse_mps,
        })
    }

    fn hold_out_rmse(
        self,
        samples: &Samples<'_>,
        responses: &[f64],
        settings: &TrialSettings,
    ) -> Result<f64, Error> {
        let d = samples.predictors();
        let fold = svr::hold_out(samples.len(), settings.hold_out, 1)?;
        // Both parts are contiguous.
        let (learnt, held) = (fold.train.len(), fold.test.len());
        let from = samples.len() - held;
        let train = Samples::new(&samples.values()[..learnt * d], d)?;
        let test = Samples::new(&samples.values()[from * d..], d)?;
        let fit = svr::fit(
            &train,
            &Response::new(&responses[..learnt])?,
            &self.settings(),
            &Penalty::default(),
        )?;
        let predicted = fit.model.predict(&test)?;
        let squares = predicted
            .iter()
            .zip(&responses[from..])
            .map(|(p, y)| (p - y) * (p - y));
        Ok((squares.sum::<f64>() / held as f64).sqrt())
    }

    /// What the response is counted from.
    fn base(self, last_speed_mps: Option<&f64>) -> f64 {
        match self {
            Self::Place | Self::Window => 0.0,
            _ => last_speed_mps.copied().unwrap_or(0.0),
        }
    }

    /// Appends the predictors of sample `k`; `past` are the speeds before it, the oldest first.
    fn row(self, limits: &Limits<'_>, k: usize, past: &[f64], row: &mut Vec<f64>) {
        match self {
            Self::Place => row.extend(limits.place(k)),
            _ => {
                limits.window(k, row);
                row.extend(past.iter().rev());
            }
        }
    }
}

impl FittedTrial {
    /// Predicts a whole drive from its limits and the first measured speeds.
    ///
    /// # Errors
    /// [`Error::NoLimits`] for a drive without.
    pub fn predict(&self, motion: &Motion) -> Result<Vec<f64>, Error> {
        let limits = Limits::of(motion, self.settings.window_s)?;
        let past = self.trial.past_speeds(&self.settings).min(motion.len());
        let mut speed_mps = motion.speed_mps()[..past].to_vec();
        let predictor = self.fit.model.predictor();
        let mut row = Vec::new();
        for k in past..motion.len() {
            row.clear();
            self.trial.row(&limits, k, &speed_mps[k - past..], &mut row);
            let Ok(samples) = Samples::new(&row, row.len()) else {
                // The recursion has run away beyond all numbers.
                speed_mps.resize(motion.len(), f64::NAN);
                break;
            };
            let change = predictor.predict(&samples)?[0];
            speed_mps.push(self.trial.base(speed_mps.last()) + change);
        }
        Ok(speed_mps)
    }

    /// Predicts `steps` samples ahead of every origin by recursion from measured speeds: row by row, one row per origin. An
    /// origin is the last sample known.
    ///
    /// # Errors
    /// [`Error::NoLimits`] for a drive without.
    pub fn predict_ahead(
        &self,
        motion: &Motion,
        origins: &[usize],
        steps: usize,
    ) -> Result<Vec<Vec<f64>>, Error> {
        let limits = Limits::of(motion, self.settings.window_s)?;
        let past = self.trial.past_speeds(&self.settings);
        let predictor = self.fit.model.predictor();
        let known = |origin: usize| {
            let known =
                (0..past).map(|back| motion.speed_mps()[origin.saturating_sub(past - 1 - back)]);
            known.collect::<Vec<f64>>()
        };
        let mut speeds: Vec<Vec<f64>> = origins.iter().map(|&origin| known(origin)).collect();
        let mut rows = Vec::new();
        for step in 1..=steps {
            rows.clear();
            for (&origin, speeds) in origins.iter().zip(&speeds) {
                let k = (origin + step).min(motion.len() - 1);
                self.trial
                    .row(&limits, k, &speeds[speeds.len() - past..], &mut rows);
            }
            let Ok(samples) = Samples::new(&rows, rows.len() / origins.len().max(1)) else {
                break;
            };
            let changes = predictor.predict(&samples)?;
            for (speeds, change) in speeds.iter_mut().zip(changes) {
                speeds.push(self.trial.base(speeds.last()) + change);
            }
        }
        for speeds in &mut speeds {
            speeds.resize(past + steps, f64::NAN);
            speeds.drain(..past);
        }
        Ok(speeds)
    }
}

/// Speed limits of a drive as the trials see them.
struct Limits<'a> {
    limit_mps: Vec<f64>,
    distance_m: &'a [f64],
    /// First sample of the run of equal limits that a sample is in, and the first after it.
    runs: Vec<(usize, usize)>,
    half_window: usize,
}

impl<'a> Limits<'a> {
    fn of(motion: &'a Motion, window_s: f64) -> Result<Self, Error> {
        let recorded = motion.limit_mps().ok_or_else(|| Error::NoLimits {
            log: motion.name().to_owned(),
        })?;
        let standing = |(limit, speed): (&f64, &f64)| if *speed > 0.0 { *limit } else { 0.0 };
        let limit_mps: Vec<f64> = recorded
            .iter()
            .zip(motion.speed_mps())
            .map(standing)
            .collect();
        let mut runs = Vec::with_capacity(limit_mps.len());
        for run in limit_mps.chunk_by(|a, b| a.to_bits() == b.to_bits()) {
            let start = runs.len();
            runs.extend(std::iter::repeat_n((start, start + run.len()), run.len()));
        }
        let half_window = motion.samples_in(0.5 * window_s);
        Ok(Self {
            limit_mps,
            distance_m: motion.distance_m(),
            runs,
            half_window,
        })
    }

    /// Limit, next and previous different limit, distances to them. Before the first and after the last change these are
    /// the limit itself and the distance to the end of the drive.
    fn place(&self, k: usize) -> [f64; 5] {
        let (start, end) = self.runs[k];
        let last = self.limit_mps.len() - 1;
        let (next, before) = (end.min(last), start.saturating_sub(1));
        [
            self.limit_mps[k],
            self.limit_mps[next],
            self.limit_mps[before],
            self.distance_m[next] - self.distance_m[k],
            self.distance_m[k] - self.distance_m[start],
        ]
    }

    fn window(&self, k: usize, row: &mut Vec<f64>) {
        let last = self.limit_mps.len() - 1;
        let half = self.half_window;
        let window = (k..=k + 2 * half).map(|at| at.saturating_sub(half).min(last));
        row.extend(window.map(|at| self.limit_mps[at]));
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use drive_log::Channel;

    use super::*;

    /// 100 s at 10 Hz; the limit falls after 40 s, the car stands from 70 s on.
    fn motion() -> Motion {
        let limit = |i: usize| if i < 400 { 20.0 } else { 10.0 };
        let speed = |i: usize| if i < 700 { limit(i) - 1.0 } else { 0.0 };
        let channels = [
            (Channel::Speed, (0..1000).map(speed).collect()),
            (Channel::SpeedLimit, (0..1000).map(limit).collect()),
        ];
        Motion::of_channels("test", 0.1, channels)
    }

    #[test]
    fn places_know_the_limits_around_them_and_a_standing_car_has_none() {
        let motion = motion();
        let limits = Limits::of(&motion, 10.0).unwrap();
        let [here, next, before, to_next, since] = limits.place(390);
        assert_eq!((here, next, before), (20.0, 10.0, 20.0));
        assert!((to_next - (motion.distance_m()[400] - motion.distance_m()[390])).abs() < 1e-9);
        assert!((since - motion.distance_m()[390]).abs() < 1e-9);
        let [here, next, before, ..] = limits.place(650);
        assert_eq!((here, next, before), (10.0, 0.0, 20.0));
        assert!(limits.place(999)[0].abs() < 1e-12);
    }

    #[test]
    fn windows_span_ten_seconds_and_are_held_at_the_ends() {
        let motion = motion();
        let limits = Limits::of(&motion, 10.0).unwrap();
        let window = |k| {
            let mut row = Vec::new();
            limits.window(k, &mut row);
            row
        };
        assert_eq!(window(400).len(), 101);
        assert_eq!((window(400)[49], window(400)[50]), (20.0, 10.0));
        assert!(window(0).iter().all(|limit| *limit == 20.0));
        assert_eq!(window(999)[100], 0.0);
    }

    #[test]
    fn one_step_ahead_is_the_first_step_of_the_recursion() {
        let motion = motion();
        for trial in Trial::ALL {
            let fitted = trial.fit(&[&motion], &TrialSettings::default()).unwrap();
            assert_eq!(fitted.fit.status, svr::Status::Optimal, "{trial:?}");
            let past = trial.past_speeds(&fitted.settings).max(1);
            let whole = fitted.predict(&motion).unwrap();
            let ahead = fitted.predict_ahead(&motion, &[past - 1], 20).unwrap();
            for (k, speed) in ahead[0].iter().enumerate() {
                assert!((speed - whole[past + k]).abs() < 1e-9, "{trial:?} {k}");
            }
        }
    }

    #[test]
    fn without_limits_there_is_no_trial() {
        let motion = motion().without_limits();
        let error = Trial::Place.fit(&[&motion], &TrialSettings::default());
        assert!(matches!(error, Err(Error::NoLimits { .. })));
    }
}
