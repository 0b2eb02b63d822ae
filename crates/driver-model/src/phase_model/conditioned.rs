use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use super::kernel_ridge::{Features, GaussianBasis, MAX_FEATURES, Regression};
use super::profile::{at, normalised};
use crate::{Error, Phase, TrainingSet};

/// The driver's normalised shape `(v − v0)/(v_end − v0)` over `t/T`, as it depends on the phase, with a predictive band.
///
/// The shape at every knot is a ridge regression on Gaussian bumps over `v0`, `ln T` and `ln(|v_end − v0|/T)`, and where it may
/// know them the acceleration and its last two changes just before the phase ([`crate::Onset`]). How far phases scatter is a
/// regression of the same kind, of the logarithm of the error of phases whose trip was held out; the quantiles of the errors
/// over that spread are the band, so that it holds its share on trips that are not among those fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConditionedProfile {
    /// Over 3 features, 6 with the onset, or 12 with what the driver does.
    pub basis: GaussianBasis,
    /// Mean shape at [`ConditionedProfile::KNOTS`] equal steps of `t/T`.
    pub mean_shape: Vec<f64>,
    /// What each bump adds to it, centres by knots.
    pub shape_coefficients: Vec<Vec<f64>>,
    /// Mean logarithm of the spread.
    pub mean_log_spread: f64,
    /// What each bump adds to it.
    pub log_spread_coefficients: Vec<f64>,
    /// Bands by rising level.
    pub bands: Vec<BandLevel>,
}

/// How far a share of phases lies from the shape, at every knot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BandLevel {
    /// Share of samples inside.
    pub level_pct: f64,
    /// Half-width at every knot, in units of the spread and the gain.
    pub half_width: Vec<f64>,
}

/// A predictive band around a predicted speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictiveBand {
    /// Share of samples inside.
    pub level_pct: f64,
    /// Half-width at the samples of the phase.
    pub half_width_mps: Vec<f64>,
}

impl PredictiveBand {
    /// The first of rising bands that holds at least 90 %.
    #[must_use]
    pub fn of_90_pct(bands: &[Self]) -> Option<&Self> {
        bands.iter().find(|band| band.level_pct >= 90.0)
    }
}

/// What a conditioned profile is told beside `v0`, `v_end` and `T`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Conditioning {
    /// Nothing.
    Outline,
    /// How the phase is entered.
    Onset,
    /// The same, and what the driver does as it begins.
    Input,
}

const LEVELS_PCT: [f64; 4] = [50.0, 80.0, 90.0, 95.0];

/// Blocks of trips that are held out in turn for the band.
const BLOCKS: usize = 10;

impl ConditionedProfile {
    /// Knots of the shape.
    pub const KNOTS: usize = 26;

    /// Fits shape and band.
    ///
    /// # Errors
    /// [`Error::TooFewPhases`] below ten phases, [`Error::Fit`] where the equations cannot be solved.
    pub fn fit(conditioning: Conditioning, training: &TrainingSet<'_>) -> Result<Self, Error> {
        let model = conditioning.model_name();
        let phases = &training.phases;
        if phases.len() < BLOCKS {
            return Err(Error::TooFewPhases {
                model,
                found: phases.len(),
                needed: BLOCKS,
                unit: conditioning.unit(),
            });
        }
        let features: Vec<Features> = phases
            .iter()
            .map(|p| features(&p.curve.outline()))
            .collect();
        let weights: Vec<f64> = phases.iter().map(|p| p.weight).collect();
        let basis = GaussianBasis::choose(&features, &weights, conditioning.dimensions());
        let regression =
            Regression::new(&basis, &features, &weights, &blocks(training)).ok_or(Error::Fit {
                model,
                reason: "the normal equations are not positive definite".to_owned(),
            })?;

        let rows: Vec<f64> = phases
            .iter()
            .flat_map(|p| normalised(p.curve, Self::KNOTS))
            .collect();
        let mut shapes = DMatrix::from_row_slice(phases.len(), Self::KNOTS, &rows);
        let mean_shape = subtract_mean(&mut shapes, &weights);
        let errors = &shapes - regression.held_out(&shapes);

        let log_spread =
            |i: usize, _| (errors.row(i).norm_squared() / Self::KNOTS as f64 + 1e-12).ln() * 0.5;
        let mut log_spreads = DMatrix::from_fn(phases.len(), 1, log_spread);
        let mean_log_spread = subtract_mean(&mut log_spreads, &weights)[0];
        let expected = regression.held_out(&log_spreads);
        let relative = DMatrix::from_fn(phases.len(), Self::KNOTS, |i, knot| {
            errors[(i, knot)].abs() / (mean_log_spread + expected[i]).exp()
        });
        let judges = judges(&weights);
        let bands = LEVELS_PCT.map(|level_pct| BandLevel {
            level_pct,
            half_width: (0..Self::KNOTS)
                .map(|knot| quantile(relative.column(knot).iter(), &judges, level_pct / 100.0))
                .collect(),
        });
        let shape_coefficients = regression.coefficients(&shapes);
        Ok(Self {
            shape_coefficients: shape_coefficients
                .row_iter()
                .map(|row| row.iter().copied().collect())
                .collect(),
            log_spread_coefficients: regression.coefficients(&log_spreads).as_slice().to_vec(),
            basis,
            mean_shape,
            mean_log_spread,
            bands: bands.to_vec(),
        })
    }

    /// Speed in m/s at every sample of the phase.
    #[must_use]
    pub fn speeds_mps(&self, outline: &Phase) -> Vec<f64> {
        let mut shape = self.mean_shape.clone();
        let values = self.basis.values(&features(outline));
        for (value, coefficients) in values.iter().zip(&self.shape_coefficients) {
            for (s, c) in shape.iter_mut().zip(coefficients) {
                *s += value * c;
            }
        }
        let speed = |share| outline.start_speed_mps + outline.gain_mps() * share;
        at_samples(&shape, outline).map(speed).collect()
    }

    /// The bands, by rising level.
    #[must_use]
    pub fn bands(&self, outline: &Phase) -> Vec<PredictiveBand> {
        let values = self.basis.values(&features(outline));
        let terms = values.iter().zip(&self.log_spread_coefficients);
        let log_spread = self.mean_log_spread + terms.map(|(v, c)| v * c).sum::<f64>();
        let scale = outline.gain_mps().abs() * log_spread.exp();
        let band = |band: &BandLevel| PredictiveBand {
            level_pct: band.level_pct,
            half_width_mps: at_samples(&band.half_width, outline)
                .map(|width| scale * width)
                .collect(),
        };
        self.bands.iter().map(band).collect()
    }

    pub(crate) fn check(&self, conditioning: Conditioning) -> Result<(), Error> {
        let model = conditioning.model_name();
        let dimensions = conditioning.dimensions();
        let centres = self.basis.centres.len();
        let sizes = [
            self.basis.mean.len() == dimensions,
            self.basis.deviation.len() == dimensions,
            self.basis.centres.iter().all(|c| c.len() == dimensions),
            (1..=10_000).contains(&centres),
            self.mean_shape.len() == Self::KNOTS,
            self.shape_coefficients.len() == centres,
            self.shape_coefficients
                .iter()
                .all(|c| c.len() == Self::KNOTS),
            self.log_spread_coefficients.len() == centres,
            self.bands.iter().all(|b| b.half_width.len() == Self::KNOTS),
            self.bands
                .windows(2)
                .all(|b| b[0].level_pct < b[1].level_pct),
        ];
        let lists_fit = sizes.into_iter().all(|fits| fits);
        super::parameter(
            model,
            "centres",
            centres as f64,
            lists_fit,
            "lists that fit each other",
        )?;
        let list = |name, values: &[f64], lowest: f64, highest: f64| {
            values.iter().try_for_each(|&value| {
                let usable = (lowest..=highest).contains(&value);
                super::parameter(model, name, value, usable, "a value that a fit can give")
            })
        };
        list("mean", &self.basis.mean, -1e6, 1e6)?;
        list("deviation", &self.basis.deviation, 1e-12, 1e6)?;
        list("mean_shape", &self.mean_shape, -10.0, 10.0)?;
        list("mean_log_spread", &[self.mean_log_spread], -20.0, 5.0)?;
        list(
            "log_spread_coefficients",
            &self.log_spread_coefficients,
            -1e6,
            1e6,
        )?;
        for (centre, coefficients) in self.basis.centres.iter().zip(&self.shape_coefficients) {
            list("centres", centre, -1e6, 1e6)?;
            list("shape_coefficients", coefficients, -1e6, 1e6)?;
        }
        for band in &self.bands {
            list("level_pct", &[band.level_pct], 1e-9, 100.0)?;
            list("half_width", &band.half_width, 0.0, 1e6)?;
        }
        Ok(())
    }
}

impl Conditioning {
    fn unit(self) -> &'static str {
        match self {
            Self::Outline | Self::Onset => "phases of its kind without a leader",
            Self::Input => {
                "phases of its kind without a leader whose log says what the driver does"
            }
        }
    }

    fn dimensions(self) -> usize {
        match self {
            Self::Outline => 3,
            Self::Onset => 6,
            Self::Input => MAX_FEATURES,
        }
    }

    fn model_name(self) -> &'static str {
        match self {
            Self::Outline => "profile-conditioned",
            Self::Onset => "profile-onset",
            Self::Input => "profile-pedal",
        }
    }
}

/// Start speed, duration, pace, the onset in the direction of the phase, and what the driver does.
fn features(outline: &Phase) -> Features {
    let gain_mps = outline.gain_mps();
    let duration_s = outline.duration_s();
    let sign = gain_mps.signum();
    let onset = outline.onset.map_or([f64::NAN; 3], |o| {
        [o.accel_mps2, o.jerk_mps3, o.previous_jerk_mps3].map(|value| sign * value)
    });
    let [accel, jerk, previous] = onset;
    let input = outline.input;
    let known = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let pace = (gain_mps.abs() / duration_s).ln();
    [
        outline.start_speed_mps,
        duration_s.ln(),
        pace,
        accel,
        jerk,
        previous,
        known(input.accelerator_pedal_pct),
        known(input.accelerator_pedal_change_pct),
        known(input.accelerator_pedal_slow_change_pct),
        known(input.brake_pct),
        known(input.motor_torque_nm),
        known(input.accelerometer_mps2),
    ]
}

/// Blocks of trips, or of single phases where they are all from one trip.
fn blocks(training: &TrainingSet<'_>) -> Vec<usize> {
    let trips = training.phases.iter().map(|p| p.trip);
    let one_trip = trips.clone().min() == trips.clone().max();
    let block = |(i, trip)| if one_trip { i } else { trip } % BLOCKS;
    trips.enumerate().map(block).collect()
}

/// Weights for the band: those of the driver's own phases, where there are enough of them. Other drivers tell how far this one
/// scatters no better than how he drives.
fn judges(weights: &[f64]) -> Vec<f64> {
    let highest = weights.iter().copied().fold(0.0, f64::max);
    let own: Vec<f64> = weights
        .iter()
        .map(|&w| if w < highest { 0.0 } else { w })
        .collect();
    let enough = own.iter().filter(|w| **w > 0.0).count() >= BLOCKS;
    if enough { own } else { weights.to_vec() }
}

/// Takes the weighted mean of every column off it.
fn subtract_mean(rows: &mut DMatrix<f64>, weights: &[f64]) -> Vec<f64> {
    let total: f64 = weights.iter().sum();
    let mut means = Vec::with_capacity(rows.ncols());
    for mut column in rows.column_iter_mut() {
        let mean = column.iter().zip(weights).map(|(v, w)| v * w).sum::<f64>() / total;
        column.add_scalar_mut(-mean);
        means.push(mean);
    }
    means
}

/// The smallest value that so large a share of the weight does not exceed, one further phase counted as exceeding it.
fn quantile<'a>(values: impl Iterator<Item = &'a f64>, weights: &[f64], share: f64) -> f64 {
    let weighted = values.copied().zip(weights.iter().copied());
    let mut pairs: Vec<(f64, f64)> = weighted.filter(|(_, weight)| *weight > 0.0).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = weights.iter().sum();
    let needed = share * total * (1.0 + 1.0 / pairs.len() as f64);
    let mut weight = 0.0;
    let reached = pairs.iter().find(|(_, w)| {
        weight += w;
        weight >= needed
    });
    reached.or(pairs.last()).map_or(0.0, |p| p.0)
}

/// A list over equal steps of `t/T`, at the samples of a phase.
fn at_samples(knots: &[f64], outline: &Phase) -> impl Iterator<Item = f64> {
    let scale = (knots.len() - 1) as f64 / (outline.samples.max(2) - 1) as f64;
    (0..outline.samples).map(move |k| at(knots, k as f64 * scale))
}
