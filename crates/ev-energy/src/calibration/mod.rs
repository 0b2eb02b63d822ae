//! Vehicle parameters from measured battery power.

mod parameter;
mod problem;
mod trip;

use nalgebra::{DMatrix, SymmetricEigen};
use serde::Serialize;

use crate::comparison::Comparison;
use crate::error::Error;
use crate::vehicle::{Confidence, Source, Vehicle};
use crate::weather::SUMMER_DEGC;
use parameter::{Bounded, with_values};
use problem::Problem;
pub use trip::CalibrationTrip;

/// A value this near to a bound, as a share of the width of the bounds, ran into it.
const AT_BOUND: f64 = 0.025;

/// An interval of this share of the bounds tells nothing.
const UNTOLD: f64 = 0.5;

/// Two parameters that correlate more than this cannot be told apart.
const ALIKE: f64 = 0.95;

/// A parameter with this share of the largest effect, over the width of its bounds, has none.
const NO_EFFECT: f64 = 1e-4;

/// Rise of a parameter by which its effect is measured.
const SENSITIVITY_SHARE: f64 = 0.1;

/// A vehicle fitted to measured power.
#[derive(Debug, Clone)]
#[must_use]
pub struct Calibration {
    /// The fitted vehicle.
    pub vehicle: Vehicle,
    /// What was fitted, in the order of the vehicle file.
    pub parameters: Vec<ParameterEstimate>,
    /// Correlation of the estimates by the curvature of the fit, a row per parameter.
    pub correlation: Vec<Vec<f64>>,
}

/// A fitted parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterEstimate {
    /// Dotted key, as in the vehicle file.
    pub key: &'static str,
    /// Unit, empty for 1.
    pub unit: &'static str,
    /// Value before.
    pub start: f64,
    /// Fitted value.
    pub value: f64,
    /// Smallest value allowed.
    pub lower: f64,
    /// Largest value allowed.
    pub upper: f64,
    /// Standard error by leaving out one trip after the other (jackknife); `None` with less than three trips.
    pub std_error: Option<f64>,
    /// 95 % confidence interval, cut to the bounds.
    pub ci95: Option<[f64; 2]>,
    /// Root mean square by which the power changes if the parameter rises by a tenth of its value, W.
    #[serde(rename = "sensitivity")]
    pub sensitivity_w: f64,
    /// Whether the trips tell the value.
    pub identified: bool,
    /// Why not, or what to know about it.
    pub remark: String,
}

/// Fits a vehicle to trips by robust least squares within bounds, see the methods page. Intervals are left open, see
/// [`Calibration::with_intervals`].
///
/// # Errors
/// [`Error::Calibration`] without measured power, or where the fit fails.
pub fn calibrate(vehicle: &Vehicle, trips: &[&CalibrationTrip]) -> Result<Calibration, Error> {
    let Fit { bounded, values } = fit(vehicle, None, trips)?;
    let mut spec = with_values(vehicle.spec(), &bounded, &values);
    for parameter in &bounded {
        let source = format!(
            "fitted to the measured battery power of {} trips",
            trips.len()
        );
        spec.sources.insert(
            parameter.key().to_owned(),
            Source {
                source,
                confidence: Confidence::Fitted,
            },
        );
    }
    spec.add_weather_source();
    let problem = Problem::new(vehicle.spec(), &values, &bounded, trips);
    let derivatives = problem.derivatives_at(&values);
    let parameters = bounded
        .iter()
        .zip(values)
        .map(|(parameter, value)| ParameterEstimate {
            key: parameter.key(),
            unit: parameter.unit(),
            start: parameter.start,
            value,
            lower: parameter.lower,
            upper: parameter.upper,
            std_error: None,
            ci95: None,
            sensitivity_w: 0.0,
            identified: true,
            remark: String::new(),
        })
        .collect();
    let mut calibration = Calibration {
        vehicle: Vehicle::new(spec)?,
        parameters,
        correlation: derivatives.map_or_else(Vec::new, |d| correlation(&d)),
    };
    calibration.add_sensitivity(&bounded, trips)?;
    calibration.judge();
    Ok(calibration)
}

/// Fitted values of the parameters that a vehicle and trips have.
struct Fit {
    bounded: Vec<Bounded>,
    values: Vec<f64>,
}

/// Fits, from the vehicle's own values or those of another fit, without effect on the bounds.
fn fit(
    vehicle: &Vehicle,
    from: Option<&Calibration>,
    trips: &[&CalibrationTrip],
) -> Result<Fit, Error> {
    if trips.is_empty() || trips.iter().any(|trip| trip.means() == 0) {
        return Err(Error::Calibration {
            problem: "there is no measured power, or a trip without; leave it out".to_owned(),
        });
    }
    let with_winter = trips.iter().any(|trip| trip.is_colder_than(SUMMER_DEGC));
    let bounded = Bounded::of(vehicle.spec(), with_winter);
    let starts: Vec<f64> = bounded
        .iter()
        .map(|parameter| {
            from.and_then(|fit| fit.value(parameter.key()))
                .unwrap_or(parameter.start)
        })
        .collect();
    let values = Problem::new(vehicle.spec(), &starts, &bounded, trips).solve()?;
    Ok(Fit { bounded, values })
}

/// What a fit without one trip says.
#[derive(Debug, Clone)]
pub struct Fold {
    /// Values of the parameters, in the order of [`Calibration::parameters`].
    pub values: Vec<f64>,
    /// Power of the trip that was left out, by the vehicle fitted to the others.
    pub held_out: Comparison,
}

/// Fits without the trip number `left_out`, starting from the fit to all of them, and compares the trip with the result.
///
/// # Errors
/// As [`calibrate`]; [`Error::Calibration`] also where there is no such trip, or no other.
pub fn leave_one_out(
    vehicle: &Vehicle,
    all: &Calibration,
    trips: &[&CalibrationTrip],
    left_out: usize,
) -> Result<Fold, Error> {
    let held_out = trips.get(left_out).ok_or_else(|| Error::Calibration {
        problem: format!("no trip number {left_out} to leave out"),
    })?;
    let mut others = trips.to_vec();
    others.remove(left_out);
    let Fit { bounded, values } = fit(vehicle, Some(all), &others)?;
    let without = Vehicle::new(with_values(vehicle.spec(), &bounded, &values))?;
    // Without the only cold trip the surcharge stays what it was before.
    let value = |parameter: &ParameterEstimate| {
        let mut fitted = bounded.iter().zip(&values);
        fitted
            .find(|(bounded, _)| bounded.key() == parameter.key)
            .map_or(parameter.start, |(_, value)| *value)
    };
    Ok(Fold {
        values: all.parameters.iter().map(value).collect(),
        held_out: held_out.compare(&without)?,
    })
}

impl Calibration {
    fn value(&self, key: &str) -> Option<f64> {
        let found = self.parameters.iter().find(|p| p.key == key);
        found.map(|found| found.value)
    }

    /// Adds standard errors and intervals by the jackknife over trips: `se² = (n − 1)/n Σ (p_k − p̄)²`, which holds however the
    /// errors within a trip depend on each other. Less than three folds say nothing.
    pub fn with_intervals(mut self, folds: &[Fold]) -> Self {
        let n = folds.len() as f64;
        if folds.len() >= 3 {
            for (k, parameter) in self.parameters.iter_mut().enumerate() {
                let mean = folds.iter().map(|fold| fold.values[k]).sum::<f64>() / n;
                let squares: f64 = folds.iter().map(|f| (f.values[k] - mean).powi(2)).sum();
                let std_error = ((n - 1.0) / n * squares).sqrt();
                let half = student_t_975(n - 1.0) * std_error;
                parameter.std_error = Some(std_error);
                parameter.ci95 = Some([
                    (parameter.value - half).max(parameter.lower),
                    (parameter.value + half).min(parameter.upper),
                ]);
            }
        }
        self.judge();
        self
    }

    /// Says of every parameter whether the trips tell it.
    fn judge(&mut self) {
        let keys: Vec<&'static str> = self.parameters.iter().map(|p| p.key).collect();
        for (k, parameter) in self.parameters.iter_mut().enumerate() {
            let width = parameter.upper - parameter.lower;
            let at_bound = if parameter.value - parameter.lower < AT_BOUND * width {
                Some("lower")
            } else if parameter.upper - parameter.value < AT_BOUND * width {
                Some("upper")
            } else {
                None
            };
            let untold = parameter
                .ci95
                .is_some_and(|[low, high]| high - low > UNTOLD * width);
            let alike = self
                .correlation
                .get(k)
                .into_iter()
                .flatten()
                .zip(&keys)
                .find(|(rho, key)| **key != parameter.key && rho.abs() > ALIKE);
            parameter.identified = at_bound.is_none() && !untold && parameter.sensitivity_w > 0.0;
            parameter.remark = if let Some(bound) = at_bound {
                format!("not identified: ran into its {bound} bound")
            } else if parameter.sensitivity_w == 0.0 {
                "not identified: without effect on these trips".to_owned()
            } else if untold {
                "not identified: the interval covers half of what is allowed".to_owned()
            } else if let Some((rho, key)) = alike {
                format!("cannot be told apart from {key} (correlation {rho:.2})")
            } else {
                String::new()
            };
        }
    }

    fn add_sensitivity(
        &mut self,
        bounded: &[Bounded],
        trips: &[&CalibrationTrip],
    ) -> Result<(), Error> {
        let power_w = |vehicle: &Vehicle| -> Result<Vec<f64>, Error> {
            let mut power_w = Vec::new();
            for trip in trips {
                trip.for_each_mean(vehicle, |mean, _| power_w.push(mean.modelled_w))?;
            }
            Ok(power_w)
        };
        let here = power_w(&self.vehicle)?;
        for (parameter, estimate) in bounded.iter().zip(&mut self.parameters) {
            let moved = |value| {
                let parameter = std::slice::from_ref(parameter);
                Vehicle::new(with_values(self.vehicle.spec(), parameter, &[value]))
            };
            // Down, where a tenth more is out of range.
            let rise = SENSITIVITY_SHARE * estimate.value;
            let moved = moved(estimate.value + rise).or_else(|_| moved(estimate.value - rise))?;
            let squares: f64 = power_w(&moved)?
                .iter()
                .zip(&here)
                .map(|(there, here)| (there - here).powi(2))
                .sum();
            estimate.sensitivity_w = (squares / here.len() as f64).sqrt();
        }
        Ok(())
    }
}

/// Correlations of least-squares estimates with these derivatives of the residuals: those of `(JᵀJ)⁻¹`. Parameters next to without
/// effect correlate with nothing.
fn correlation(derivatives: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let mut scaled = derivatives.clone();
    let norms: Vec<f64> = scaled.column_iter().map(|column| column.norm()).collect();
    let largest = norms.iter().copied().fold(0.0, f64::max);
    for (mut column, norm) in scaled.column_iter_mut().zip(norms) {
        if norm > NO_EFFECT * largest {
            column /= norm;
        } else {
            column.fill(0.0);
        }
    }
    let curvature = SymmetricEigen::new(scaled.tr_mul(&scaled));
    let largest = curvature.eigenvalues.max();
    let inverse = curvature.eigenvalues.map(|value| {
        if value > 1e-12 * largest {
            1.0 / value
        } else {
            0.0
        }
    });
    let vectors = &curvature.eigenvectors;
    let covariance = vectors * DMatrix::from_diagonal(&inverse) * vectors.transpose();
    let n = covariance.nrows();
    let entry = |i: usize, j: usize| {
        let scale = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
        if i == j {
            1.0
        } else if scale > 0.0 {
            (covariance[(i, j)] / scale).clamp(-1.0, 1.0)
        } else {
            0.0
        }
    };
    (0..n)
        .map(|i| (0..n).map(|j| entry(i, j)).collect())
        .collect()
}

/// The 97.5 % quantile of Student's distribution, by its expansion around the normal one (Abramowitz and Stegun 26.7.5), to 1 %
/// from two degrees of freedom on.
fn student_t_975(degrees: f64) -> f64 {
    let z = 1.959_964_f64;
    let terms = [
        (z.powi(3) + z) / 4.0,
        (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0,
        (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0,
        (79.0 * z.powi(9) + 776.0 * z.powi(7) + 1482.0 * z.powi(5)
            - 1920.0 * z.powi(3)
            - 945.0 * z)
            / 92_160.0,
    ];
    let mut power = 1.0;
    terms.iter().fold(z, |sum, term| {
        power /= degrees;
        sum + term * power
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (degrees, quantile) in [(2.0, 4.303), (5.0, 2.571), (10.0, 2.228), (30.0, 2.042)] {
            assert!((student_t_975(degrees) / quantile - 1.0).abs() < 0.01);
        }
    }

    #[test]
    fn like_columns_correlate() {
        let derivatives = DMatrix::from_row_slice(
            4,
            3,
            &[1.0, 1.0, 0.0, 1.0, 1.01, 0.0, 0.0, 0.0, 1.0, 1.0, 0.99, 1.0],
        );
        let rho = correlation(&derivatives);
        assert!(rho[0][1] < -0.99 && rho[0][2].abs() < 0.9);
        assert!((0..3).all(|i| (rho[i][i] - 1.0).abs() < 1e-12));
    }
}
