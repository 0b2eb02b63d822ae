use svr::{Kernel, Penalty, Response, Samples, Settings, Status};

use crate::speed_ahead::FIT_MEMORY_BYTES;
use crate::{Error, ModelKind};

/// `λ` of ridge regression, `C = 1/λ`.
const RIDGE_BOX_CONSTRAINT: f64 = 0.1;

/// Box constraint of the least-squares support vector machine, and kernel scale beside the root of the sum of squared
/// predictor weights. Chosen on drives of `bmw-i3`; they serve other logs as well.
const LEAST_SQUARES_BOX_CONSTRAINT: f64 = 5.0;
const RBF_SCALE: f64 = 1.7;

/// Beside MATLAB's defaults, with which the regression learns medians: those lie too near to "no change".
const BOX_CONSTRAINT_FACTOR: f64 = 10.0;
const TUBE_FACTOR: f64 = 8.0;

/// A regression, and how its solver ended where it is one that might not.
type Solved = (svr::Model, Option<Status>);

impl ModelKind {
    pub(super) fn regressions(
        self,
        samples: &Samples<'_>,
        responses: &[Response<'_>],
        weights: Vec<f64>,
    ) -> Result<Vec<Solved>, Error> {
        let size = weights.iter().map(|w| w * w).sum::<f64>().sqrt();
        let kernel = match self {
            Self::Ridge => {
                let settings = Settings::default();
                let models =
                    svr::fit_least_squares(samples, responses, &settings, RIDGE_BOX_CONSTRAINT)?;
                return Ok(models.into_iter().map(|model| (model, None)).collect());
            }
            Self::LeastSquares | Self::Blend => {
                let settings = Settings {
                    kernel: Kernel::Rbf,
                    kernel_scale: Some(RBF_SCALE * size),
                    predictor_weights: weights,
                    ..Settings::default()
                };
                let models = svr::fit_least_squares(
                    samples,
                    responses,
                    &settings,
                    LEAST_SQUARES_BOX_CONSTRAINT,
                )?;
                return Ok(models.into_iter().map(|model| (model, None)).collect());
            }
            Self::SvrLinear => Kernel::Linear,
            Self::SvrQuadratic => Kernel::Quadratic,
            Self::SvrCubic => Kernel::Cubic,
            Self::SvrRbf => Kernel::Rbf,
            _ => return Ok(Vec::new()),
        };
        let settings = Settings {
            kernel,
            kernel_scale: Some(match kernel {
                Kernel::Linear => 1.0,
                Kernel::Rbf => RBF_SCALE * size,
                Kernel::Quadratic | Kernel::Cubic => size,
            }),
            predictor_weights: if kernel == Kernel::Linear {
                Vec::new()
            } else {
                weights
            },
            memory_limit_bytes: FIT_MEMORY_BYTES,
            ..Settings::default()
        };
        // Kernel rows are shared by all horizons; each starts from the one before.
        let mut trainer = svr::Trainer::new(samples, &settings)?;
        let mut before = None;
        let mut models = Vec::with_capacity(responses.len());
        for response in responses {
            let default = Penalty::default().resolve(response.values())?;
            let penalty = Penalty {
                box_constraint: Some(BOX_CONSTRAINT_FACTOR * default.box_constraint),
                tube_epsilon: Some(TUBE_FACTOR * default.tube_epsilon),
            };
            let fit = trainer.fit(response, &penalty, before.as_ref())?;
            models.push((fit.model.clone(), Some(fit.status)));
            before = Some(fit);
        }
        Ok(models)
    }
}
