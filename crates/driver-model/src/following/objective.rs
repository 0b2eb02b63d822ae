use super::simulation::root_mean_square;
use super::{FollowingModel, FollowingStretch};

/// Samples are compared this far apart, or further where the log has a longer step.
const COMPARE_STEP_S: f64 = 0.5;

/// Least scales in m and m/s, so that standing still has one.
const SMALLEST_SCALE: f64 = 1.0;

/// What a fit minimises: the mean over the samples of all stretches of `((ŝ − s)/S)² + ((v̂ − v)/V)²`, with one `S` and one
/// `V` for all of them, so that an error counts the same on every stretch.
#[derive(Debug, Clone)]
pub struct FollowingObjective<'a> {
    stretches: &'a [&'a FollowingStretch],
    gap_scale_m: f64,
    speed_scale_mps: f64,
    samples: usize,
}

impl<'a> FollowingObjective<'a> {
    /// `S` and `V` are the root mean squares of measured gap and speed over all samples, at least 1 m and 1 m/s.
    #[must_use]
    pub fn new(stretches: &'a [&'a FollowingStretch]) -> Self {
        let scale = |of: fn(&FollowingStretch) -> &[f64]| {
            let values = stretches.iter().flat_map(|stretch| of(stretch));
            root_mean_square(values).max(SMALLEST_SCALE)
        };
        Self {
            stretches,
            gap_scale_m: scale(FollowingStretch::gap_m),
            speed_scale_mps: scale(FollowingStretch::speed_mps),
            samples: stretches.iter().map(|s| compared_samples(s)).sum(),
        }
    }

    /// The mean for one model; infinite where it is none.
    #[must_use]
    pub fn mean_square(&self, model: &FollowingModel) -> f64 {
        let mut sum = 0.0;
        self.visit(model, |gap, speed| sum += gap * gap + speed * speed);
        let mean = sum / self.samples as f64;
        if mean.is_finite() {
            mean
        } else {
            f64::INFINITY
        }
    }

    pub(super) fn samples(&self) -> usize {
        self.samples
    }

    pub(super) fn stretches(&self) -> usize {
        self.stretches.len()
    }

    /// From first to last sample, of all stretches together.
    pub(super) fn duration_s(&self) -> f64 {
        self.stretches
            .iter()
            .map(|stretch| stretch.duration_s())
            .sum()
    }

    /// The same scales for some of the stretches.
    pub(super) fn of_some<'b>(
        &self,
        stretches: &'b [&'b FollowingStretch],
    ) -> FollowingObjective<'b> {
        FollowingObjective {
            stretches,
            gap_scale_m: self.gap_scale_m,
            speed_scale_mps: self.speed_scale_mps,
            samples: stretches.iter().map(|s| compared_samples(s)).sum(),
        }
    }

    /// Relative errors of gap and speed, one after the other; `None` where one is no number.
    pub(super) fn residuals(&self, model: &FollowingModel) -> Option<Vec<f64>> {
        let mut residuals = Vec::with_capacity(2 * self.samples);
        self.visit(model, |gap, speed| residuals.extend([gap, speed]));
        let finite = residuals.iter().all(|residual| residual.is_finite());
        finite.then_some(residuals)
    }

    /// Calls `visit` with the relative errors of gap and speed at every sample that is compared.
    fn visit(&self, model: &FollowingModel, mut visit: impl FnMut(f64, f64)) {
        for stretch in self.stretches {
            let every = compare_every(stretch);
            let (gaps_m, speeds_mps) = (stretch.gap_m(), stretch.speed_mps());
            let mut k = 0;
            model.drive(stretch, |speed_mps, gap_m| {
                if k % every == 0 && k > 0 {
                    let gap_off_m = gap_m - gaps_m[k];
                    let speed_off_mps = speed_mps - speeds_mps[k];
                    visit(
                        gap_off_m / self.gap_scale_m,
                        speed_off_mps / self.speed_scale_mps,
                    );
                }
                k += 1;
            });
        }
    }
}

fn compare_every(stretch: &FollowingStretch) -> usize {
    (COMPARE_STEP_S / stretch.step_s()).round().max(1.0) as usize
}

/// The first sample is where the simulation starts and not compared.
fn compared_samples(stretch: &FollowingStretch) -> usize {
    (stretch.speed_mps().len() - 1) / compare_every(stretch)
}
