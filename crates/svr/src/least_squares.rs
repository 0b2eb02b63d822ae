use crate::linear_rows::LinearRows;
use crate::model::Model;
use crate::nystrom::Nystrom;
use crate::scaler::Scaler;
use crate::{Error, Kernel, Landmarks, Response, Samples, Settings};

/// Landmarks where the settings leave the choice: as many as a second's work allows.
const DEFAULT_LANDMARKS: usize = 1500;

/// Least-squares support vector machines: `½‖w‖² + C/2 Σ (y − f(x))²` in place of the tube of (4.17), so that the mean is
/// learnt and not the median. For the linear kernel this is ridge regression with `λ = 1/C`. Kernels are approximated by
/// landmarks ([`Landmarks::Auto`]: 1500 of them), or exact where there are no fewer than samples. One factorisation serves all
/// responses. (J. Suykens, J. Vandewalle: Least squares support vector machine classifiers, Neural Processing Letters 9,
/// 1999.)
///
/// Weights of responses and a scaling of the response are not used.
///
/// # Errors
/// [`Error::Setting`], [`Error::Length`] where a response has not one value per sample, [`Error::NotPositiveDefinite`].
pub fn fit_least_squares(
    samples: &Samples<'_>,
    responses: &[Response<'_>],
    settings: &Settings,
    box_constraint: f64,
) -> Result<Vec<Model>, Error> {
    let (n, d) = (samples.len(), samples.predictors());
    settings.check(d)?;
    let positive = box_constraint.is_finite() && box_constraint > 0.0;
    Error::unless(
        positive,
        "box_constraint",
        box_constraint,
        "positive and finite",
    )?;
    if let Some(response) = responses
        .iter()
        .find(|response| response.values().len() != n)
    {
        return Err(Error::Length {
            what: "responses",
            found: response.values().len(),
            expected: n,
        });
    }
    let responses: Vec<&[f64]> = responses.iter().map(Response::values).collect();
    let kernel_scale = settings
        .kernel_scale
        .unwrap_or_else(|| settings.kernel.default_scale(d));
    let scaler = Scaler::of(samples, settings);
    let scaled = scaler.scale(samples, kernel_scale);
    let model = |coefficients, vectors, bias| {
        Model::new(
            settings.kernel,
            kernel_scale,
            scaler.clone(),
            Scaler::identity(),
            coefficients,
            vectors,
            bias,
        )
    };
    if settings.kernel == Kernel::Linear {
        let solved = LinearRows::new(&scaled, d).least_squares(&responses, box_constraint);
        let models = solved
            .ok_or(Error::NotPositiveDefinite)?
            .into_iter()
            .map(|mut omega| {
                let bias = omega.pop().unwrap_or(0.0);
                model(omega, Vec::new(), bias)
            });
        return Ok(models.collect());
    }
    let count = match settings.landmarks {
        Landmarks::Auto => DEFAULT_LANDMARKS,
        Landmarks::Never => n,
        Landmarks::Count(count) => count,
    };
    let nystrom = Nystrom::new(settings.kernel, &scaled, d, count)?;
    let rows = nystrom.features(&scaled);
    let solved = rows
        .least_squares(&responses, box_constraint)
        .ok_or(Error::NotPositiveDefinite)?;
    let models = solved.into_iter().map(|mut omega| {
        let bias = omega.pop().unwrap_or(0.0);
        model(
            nystrom.coefficients(&omega),
            nystrom.landmarks().to_vec(),
            bias,
        )
    });
    Ok(models.collect())
}
