use crate::phase::Verdict;
use crate::ratio_interval::RatioInterval;

/// Errors of one model at one horizon, summed per unit that is held out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HorizonErrors {
    /// Square sum, absolute sum and number per unit.
    units: Vec<(f64, f64, f64)>,
    /// Of the interval of each moment, and of the one that is the same at every moment.
    of_moment: IntervalSums,
    one_width: IntervalSums,
}

/// How intervals did.
#[derive(Debug, Clone, PartialEq)]
struct IntervalSums {
    /// Sum of interval scores, and number, per unit.
    units: Vec<(f64, f64)>,
    inside: usize,
    width_sum_mps: f64,
}

/// A prediction with its intervals.
#[derive(Debug, Clone, Copy)]
pub(super) struct Judged {
    pub(super) predicted_mps: f64,
    pub(super) measured_mps: f64,
    /// Bounds of the moment.
    pub(super) interval_mps: Option<(f64, f64)>,
    /// Half width of the interval that is the same at every moment.
    pub(super) one_width_mps: Option<f64>,
}

impl IntervalSums {
    fn none(units: usize) -> Self {
        Self {
            units: vec![(0.0, 0.0); units],
            inside: 0,
            width_sum_mps: 0.0,
        }
    }

    /// The interval score: the width, and for a value outside what it is outside by, over half of the share that may be (T. Gneiting,
    /// A. E. Raftery, Journal of the American Statistical Association 102, 2007).
    fn add(&mut self, unit: usize, (low, high): (f64, f64), measured: f64, coverage: f64) {
        let outside = (low - measured).max(measured - high).max(0.0);
        let score = high - low + 2.0 / (1.0 - coverage) * outside;
        self.units[unit] = (self.units[unit].0 + score, self.units[unit].1 + 1.0);
        self.inside += usize::from(outside == 0.0);
        self.width_sum_mps += high - low;
    }

    fn merge(&mut self, other: &Self) {
        for (sums, more) in self.units.iter_mut().zip(&other.units) {
            *sums = (sums.0 + more.0, sums.1 + more.1);
        }
        self.inside += other.inside;
        self.width_sum_mps += other.width_sum_mps;
    }

    /// 95 % interval of the difference of mean scores on the same moments.
    fn less(&self, other: &Self) -> Option<(f64, f64)> {
        let units = self.units.iter().zip(&other.units);
        let judged = units.filter(|(own, _)| own.1 > 0.0);
        let interval = RatioInterval::of(judged.map(|(a, b)| (a.0 - b.0, a.1)))?;
        Some((interval.low, interval.high))
    }

    fn figures(&self) -> Option<IntervalFigures> {
        let judged: f64 = self.units.iter().map(|unit| unit.1).sum();
        (judged > 0.0).then(|| IntervalFigures {
            half_width_mps: 0.5 * self.width_sum_mps / judged,
            coverage_pct: 100.0 * self.inside as f64 / judged,
            score_mps: self.units.iter().map(|unit| unit.0).sum::<f64>() / judged,
        })
    }
}

impl HorizonErrors {
    pub(super) fn none(units: usize) -> Self {
        Self {
            units: vec![(0.0, 0.0, 0.0); units],
            of_moment: IntervalSums::none(units),
            one_width: IntervalSums::none(units),
        }
    }

    pub(super) fn add(&mut self, unit: usize, judged: Judged, coverage: f64) {
        let Judged {
            predicted_mps,
            measured_mps,
            ..
        } = judged;
        let error_mps = predicted_mps - measured_mps;
        let sums = &mut self.units[unit];
        *sums = (
            sums.0 + error_mps * error_mps,
            sums.1 + error_mps.abs(),
            sums.2 + 1.0,
        );
        if let Some(interval) = judged.interval_mps {
            self.of_moment.add(unit, interval, measured_mps, coverage);
        }
        if let Some(half) = judged.one_width_mps {
            let interval = ((predicted_mps - half).max(0.0), predicted_mps + half);
            self.one_width.add(unit, interval, measured_mps, coverage);
        }
    }

    pub(super) fn merge(&mut self, other: &Self) {
        for (sums, more) in self.units.iter_mut().zip(&other.units) {
            *sums = (sums.0 + more.0, sums.1 + more.1, sums.2 + more.2);
        }
        self.of_moment.merge(&other.of_moment);
        self.one_width.merge(&other.one_width);
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
    /// Its prediction intervals, which know the moment.
    pub interval: Option<IntervalFigures>,
    /// Intervals of the same width at every moment, around the same predictions.
    pub one_width: Option<IntervalFigures>,
    /// 95 % interval over units of the interval score less that of one width; `None` for one unit.
    pub score_difference_interval_mps: Option<(f64, f64)>,
}

/// How prediction intervals did.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct IntervalFigures {
    /// Mean half width.
    pub half_width_mps: f64,
    /// Share of measured speeds inside.
    pub coverage_pct: f64,
    /// Mean interval score: the width, and a penalty for what is outside; less is better.
    pub score_mps: f64,
}

/// One model at all horizons.
#[derive(Debug, Clone, PartialEq)]
pub struct HorizonRow {
    /// Name of the model.
    pub model: String,
    /// Whether it is a baseline.
    pub baseline: bool,
    /// Whether it is told what the driver does.
    pub told: bool,
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
        told: bool,
        foresees: bool,
        errors: Vec<HorizonErrors>,
    ) -> Self {
        let figures = errors.iter().map(|errors| HorizonFigures {
            rmse_mps: errors.mean_square().sqrt(),
            mae_mps: errors.units.iter().map(|unit| unit.1).sum::<f64>() / errors.count(),
            skill_pct: 0.0,
            interval: errors.of_moment.figures(),
            one_width: errors.one_width.figures(),
            score_difference_interval_mps: errors.of_moment.less(&errors.one_width),
        });
        let origins = errors.first().map_or(0, |errors| errors.count() as usize);
        Self {
            model,
            baseline,
            told,
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

/// The best model against the best baseline that knows the same.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct HorizonVerdict {
    /// Seconds ahead.
    pub horizon_s: f64,
    /// Whether both are told what the driver does.
    pub told: bool,
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

/// Of the models that are not told what the driver does, then of those that are.
pub(super) fn verdicts(rows: &[HorizonRow], horizons_s: &[f64]) -> Vec<HorizonVerdict> {
    let horizons = || horizons_s.iter().enumerate();
    [false, true]
        .into_iter()
        .flat_map(|told| horizons().filter_map(move |(k, &h)| verdict(rows, told, k, h)))
        .collect()
}

fn verdict(
    rows: &[HorizonRow],
    told: bool,
    horizon: usize,
    horizon_s: f64,
) -> Option<HorizonVerdict> {
    let best = |baseline: bool| {
        let rows = rows.iter().filter(|row| {
            let rmse_mps = row.figures[horizon].rmse_mps;
            row.baseline == baseline && row.told == told && !row.foresees && rmse_mps.is_finite()
        });
        let rmse_mps = |row: &&HorizonRow| row.figures[horizon].rmse_mps;
        rows.min_by(|a, b| rmse_mps(a).total_cmp(&rmse_mps(b)))
    };
    let (model, baseline) = (best(false)?, best(true)?);
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
        told,
        model: model.model.clone(),
        baseline: baseline.model.clone(),
        difference_mps: model.figures[horizon].rmse_mps - baseline.figures[horizon].rmse_mps,
        square_difference_interval: interval.map(|interval| (interval.low, interval.high)),
        verdict: interval.as_ref().map_or(Verdict::Unclear, Verdict::of),
    })
}
