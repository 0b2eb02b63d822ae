use rayon::prelude::*;

use crate::{Error, Fit, Fold, Penalty, Response, Samples, Settings, Trainer};

/// What to try: every kernel scale with every tube and every box constraint.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// None is the kernel's default scale.
    pub kernel_scales: Vec<Option<f64>>,
    /// None is the default of the training samples.
    pub tube_epsilons: Vec<Option<f64>>,
    /// Followed as a path: each fit starts from the one before.
    pub box_constraints: Vec<Option<f64>>,
}

impl Default for Grid {
    /// The defaults alone.
    fn default() -> Self {
        Self {
            kernel_scales: vec![None],
            tube_epsilons: vec![None],
            box_constraints: vec![None],
        }
    }
}

/// One point of a grid and its error on samples held out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Kernel scale tried.
    pub kernel_scale: Option<f64>,
    /// Penalties tried.
    pub penalty: Penalty,
    /// Root mean square error over all samples held out, in units of the response.
    pub rmse: f64,
    /// Folds in which the solver ended at the optimum.
    pub optimal: usize,
}

/// Fits every point of the grid in every fold and sorts by error, the least first. Chains of box constraints run in
/// parallel; the result does not depend on the number of threads.
///
/// # Errors
/// [`Error::Setting`] for a grid or folds without anything in them or folds of other samples, [`Error::Length`] where the
/// response has not one value per sample, and whatever a fit refuses.
pub fn search(
    samples: &Samples<'_>,
    response: &Response<'_>,
    settings: &Settings,
    grid: &Grid,
    folds: &[Fold],
) -> Result<Vec<Candidate>, Error> {
    let size = grid.kernel_scales.len() * grid.tube_epsilons.len() * grid.box_constraints.len();
    Error::unless(size > 0, "the size of the grid", size as f64, "at least 1")?;
    Error::unless(!folds.is_empty(), "the number of folds", 0.0, "at least 1")?;
    if response.values().len() != samples.len() {
        return Err(Error::Length {
            what: "responses",
            found: response.values().len(),
            expected: samples.len(),
        });
    }
    let indices = folds
        .iter()
        .flat_map(|fold| fold.train.iter().chain(&fold.test));
    if let Some(&most) = indices.max().filter(|&&most| most >= samples.len()) {
        return Err(Error::Setting {
            name: "an index in a fold",
            value: most as f64,
            must_be: "less than the number of samples",
        });
    }
    let scales = 0..grid.kernel_scales.len();
    let jobs: Vec<(&Fold, usize)> = folds
        .iter()
        .flat_map(|fold| scales.clone().map(move |scale| (fold, scale)))
        .collect();
    let scores: Result<Vec<Vec<Score>>, Error> = jobs
        .par_iter()
        .map(|(fold, scale)| {
            let settings = Settings {
                kernel_scale: grid.kernel_scales[*scale],
                ..settings.clone()
            };
            score_paths(samples, response, &settings, grid, fold)
        })
        .collect();
    let scores = scores?;
    let held_out: usize = folds.iter().map(|fold| fold.test.len()).sum();
    let mut candidates = Vec::with_capacity(size);
    for (k, &kernel_scale) in grid.kernel_scales.iter().enumerate() {
        for (point, penalty) in grid.penalties().enumerate() {
            let of_folds = scores
                .iter()
                .skip(k)
                .step_by(grid.kernel_scales.len())
                .map(|paths| paths[point]);
            let square_sum: f64 = of_folds.clone().map(|score| score.square_sum).sum();
            let rmse = (square_sum / held_out as f64).sqrt();
            candidates.push(Candidate {
                kernel_scale,
                penalty,
                // Predictions that overflow are the worst, whatever the sign of what comes out.
                rmse: if rmse.is_nan() { f64::INFINITY } else { rmse },
                optimal: of_folds.filter(|score| score.optimal).count(),
            });
        }
    }
    candidates.sort_by(|a, b| a.rmse.total_cmp(&b.rmse));
    Ok(candidates)
}

#[derive(Clone, Copy)]
struct Score {
    square_sum: f64,
    optimal: bool,
}

impl Grid {
    fn penalties(&self) -> impl Iterator<Item = Penalty> {
        self.tube_epsilons.iter().flat_map(|&tube_epsilon| {
            self.box_constraints
                .iter()
                .map(move |&box_constraint| Penalty {
                    box_constraint,
                    tube_epsilon,
                })
        })
    }
}

/// All penalties on one fold, with kernel rows shared.
fn score_paths(
    samples: &Samples<'_>,
    response: &Response<'_>,
    settings: &Settings,
    grid: &Grid,
    fold: &Fold,
) -> Result<Vec<Score>, Error> {
    let d = samples.predictors();
    let rows = |indices: &[usize]| -> Vec<f64> {
        indices
            .iter()
            .flat_map(|&i| &samples.values()[i * d..(i + 1) * d])
            .copied()
            .collect()
    };
    let pick =
        |indices: &[usize]| -> Vec<f64> { indices.iter().map(|&i| response.values()[i]).collect() };
    let (train, test) = (rows(&fold.train), rows(&fold.test));
    let test = Samples::new(&test, d)?;
    let (known, held_out) = (pick(&fold.train), pick(&fold.test));
    let weights: Vec<f64> = fold.train.iter().map(|&i| response.weight(i)).collect();
    let known = Response::new(&known)?.weighted(&weights)?;
    let mut trainer = Trainer::new(&Samples::new(&train, d)?, settings)?;
    let mut previous: Option<Fit> = None;
    let mut scores = Vec::new();
    for (point, penalty) in grid.penalties().enumerate() {
        if point.is_multiple_of(grid.box_constraints.len()) {
            previous = None;
        }
        let fit = trainer.fit(&known, &penalty, previous.as_ref())?;
        let predicted = fit.model.predict(&test)?;
        let square_sum = predicted
            .iter()
            .zip(&held_out)
            .map(|(p, y)| (p - y) * (p - y))
            .sum();
        scores.push(Score {
            square_sum,
            optimal: fit.status == crate::Status::Optimal,
        });
        previous = Some(fit);
    }
    Ok(scores)
}
