use crate::phase::Verdict;
use crate::ratio_interval::RatioInterval;

/// Errors of one model at one horizon, summed per unit that is held out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HorizonErrors {
    /// Square sum, absolute sum and number per unit.
    units: Vec<(f64, f64, f64)>,
    /// Half width of the prediction interval, of the fold.
    interval_mps: Option<f64>,
    inside: usize,
    judged: usize,
    interval_sum_mps: f64,
}

impl HorizonErrors {
    pub(super) fn none(units: usize) -> Self {
        Self {
            units: vec![(0.0, 0.0, 0.0); units],
            interval_mps: None,
            inside: 0,
            judged: 0,
            interval_sum_mps: 0.0,
        }
    }

    pub(super) fn for_each(intervals: &[Option<f64>], units: usize) -> Vec<Self> {
        intervals
            .iter()
            .map(|&interval_mps| Self {
                interval_mps,
                ..Self::none(units)
            })
            .collect()
    }

    pub(super) fn add(&mut self, unit: usize, error_mps: f64) {
        let sums = &mut self.units[unit];
        *sums = (
            sums.0 + error_mps * error_mps,
            sums.1 + error_mps.abs(),
            sums.2 + 1.0,
        );
        if let Some(interval_mps) = self.interval_mps {
            self.judged += 1;
            self.inside += usize::from(error_mps.abs() <= interval_mps);
            self.interval_sum_mps += interval_mps;
        }
    }

    pub(super) fn merge(&mut self, other: &Self) {
        for (sums, more) in self.units.iter_mut().zip(&other.units) {
            *sums = (sums.0 + more.0, sums.1 + more.1, sums.2 + more.2);
        }
        self.inside += other.inside;
        self.judged += other.judged;
        self.interval_sum_mps += other.interval_sum_mps;
    }

    fn count(&self) -> f64 {
        self.units.iter().map(|unit| unit.2).sum()
    }

    fn mean_square(&self) -> f64 {
        self.units.iter().map(|unit| unit.0).sum::<f64>() / self.count()
    }
}

/// Figures of one model at one horizon.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct HorizonFigures {
    /// Root mean square error.
    pub rmse_mps: f64,
    /// Mean absolute error.
    pub mae_mps: f64,
    /// How much less the root mean square error is than that of persistence.
    pub skill_pct: f64,
    /// Mean half width of the prediction interval.
    pub interval_mps: Option<f64>,
    /// Share of measured speeds in it.
    pub coverage_pct: Option<f64>,
}

/// One model at all horizons.
#[derive(Debug, Clone, PartialEq)]
pub struct HorizonRow {
    /// Name of the model.
    pub model: String,
    /// Whether it is a baseline.
    pub baseline: bool,
    /// Whether it knows something of the future, as the trials do: no verdict counts it.
    pub foresees: bool,
    /// One per horizon.
    pub figures: Vec<HorizonFigures>,
    /// Moments predicted from.
    pub origins: usize,
    /// Seconds of fitting all folds.
    pub fit_seconds: f64,
    /// Seconds of predicting all folds.
    pub predict_seconds: f64,
    /// Regressions, over horizons and folds, whose solver stopped before the optimum.
    pub unfinished: usize,
    errors: Vec<HorizonErrors>,
}

impl HorizonRow {
    pub(super) fn new(
        model: String,
        baseline: bool,
        foresees: bool,
        errors: Vec<HorizonErrors>,
    ) -> Self {
        let figures = errors.iter().map(|errors| {
            let judged = errors.judged as f64;
            HorizonFigures {
                rmse_mps: errors.mean_square().sqrt(),
                mae_mps: errors.units.iter().map(|unit| unit.1).sum::<f64>() / errors.count(),
                skill_pct: 0.0,
                interval_mps: (errors.judged > 0).then(|| errors.interval_sum_mps / judged),
                coverage_pct: (errors.judged > 0).then(|| 100.0 * errors.inside as f64 / judged),
            }
        });
        let origins = errors.first().map_or(0, |errors| errors.count() as usize);
        Self {
            model,
            baseline,
            foresees,
            figures: figures.collect(),
            origins,
            fit_seconds: 0.0,
            predict_seconds: 0.0,
            unfinished: 0,
            errors,
        }
    }

    /// The first row is persistence.
    pub(super) fn compare_with_persistence(rows: &mut [Self]) {
        let Some(persistence) = rows.first().map(|row| row.figures.clone()) else {
            return;
        };
        for row in rows {
            for (figures, persistence) in row.figures.iter_mut().zip(&persistence) {
                figures.skill_pct = 100.0 * (1.0 - figures.rmse_mps / persistence.rmse_mps);
            }
        }
    }

    /// By how much the root mean square error per unit is below that of persistence, over the units of each fold.
    #[must_use]
    pub fn fold_skill_pct(&self, persistence: &Self, horizon: usize, folds: usize) -> Vec<f64> {
        let mean_square = |row: &Self, fold: usize| {
            let units = row.errors[horizon].units.iter().skip(fold).step_by(folds);
            units.clone().map(|unit| unit.0).sum::<f64>() / units.map(|unit| unit.2).sum::<f64>()
        };
        let skill = |fold| {
            100.0 * (1.0 - (mean_square(self, fold) / mean_square(persistence, fold)).sqrt())
        };
        (0..folds).map(skill).collect()
    }
}

/// The best model against the best baseline.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct HorizonVerdict {
    /// Seconds ahead.
    pub horizon_s: f64,
    /// The model with the least error, baselines and trials aside.
    pub model: String,
    /// The baseline with the least error.
    pub baseline: String,
    /// Root mean square error of the model less that of the baseline.
    pub difference_mps: f64,
    /// 95 % interval over units of the difference of mean square errors, in (m/s)²; `None` for one unit.
    pub square_difference_interval: Option<(f64, f64)>,
    /// What the interval says of the model.
    pub verdict: Verdict,
}

pub(super) fn verdicts(rows: &[HorizonRow], horizons_s: &[f64]) -> Vec<HorizonVerdict> {
    let best = |baseline: bool, horizon: usize| {
        let rows = rows.iter().filter(|row| {
            row.baseline == baseline && !row.foresees && row.figures[horizon].rmse_mps.is_finite()
        });
        rows.min_by(|a, b| {
            a.figures[horizon]
                .rmse_mps
                .total_cmp(&b.figures[horizon].rmse_mps)
        })
    };
    let verdict = |(horizon, &horizon_s): (usize, &f64)| {
        let (model, baseline) = (best(false, horizon)?, best(true, horizon)?);
        let units = model.errors[horizon]
            .units
            .iter()
            .zip(&baseline.errors[horizon].units);
        let units = units
            .filter(|(unit, _)| unit.2 > 0.0)
            .map(|(a, b)| (a.0 - b.0, a.2));
        let interval = RatioInterval::of(units);
        Some(HorizonVerdict {
            horizon_s,
            model: model.model.clone(),
            baseline: baseline.model.clone(),
            difference_mps: model.figures[horizon].rmse_mps - baseline.figures[horizon].rmse_mps,
            square_difference_interval: interval.map(|interval| (interval.low, interval.high)),
            verdict: interval.as_ref().map_or(Verdict::Unclear, Verdict::of),
        })
    };
    horizons_s.iter().enumerate().filter_map(verdict).collect()
}
