//! Vehicles fitted to the measured battery power of trips.

mod bounds;
mod identification;
mod parameter;
mod problem;
mod trip;

use serde::Serialize;
use statrs::distribution::{ContinuousCDF as _, StudentsT};

use crate::comparison::Comparison;
use crate::error::Error;
use crate::vehicle::{Confidence, Source, Vehicle};
pub use bounds::Bounds;
use identification::{Curvature, Held, Untold, one_speed, untold_by};
use parameter::{Bounded, with_values};
use problem::Problem;
pub use trip::CalibrationTrip;

/// Rise of a parameter by which its effect is measured.
const SENSITIVITY_SHARE: f64 = 0.1;

/// A vehicle fitted to measured power.
#[derive(Debug, Clone)]
#[must_use]
pub struct Calibration {
    /// The fitted vehicle.
    pub vehicle: Vehicle,
    /// What was to be fitted, in the order of the vehicle file. What the trips do not tell has its value from before.
    pub parameters: Vec<ParameterEstimate>,
    /// Correlation of the estimates by the curvature of the fit of all parameters together, a row per parameter.
    pub correlation: Vec<Vec<f64>>,
    held: Vec<Held>,
}

/// A parameter of a fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterEstimate {
    /// Dotted key, as in the vehicle file.
    pub key: &'static str,
    /// Unit, empty for 1.
    pub unit: &'static str,
    /// Value before.
    pub start: f64,
    /// Fitted value; that from before where the trips do not tell it.
    pub value: f64,
    /// What a fit made of a parameter that the trips do not tell, `None` of the others.
    pub tried: Option<f64>,
    /// Smallest value allowed.
    pub lower: f64,
    /// Largest value allowed.
    pub upper: f64,
    /// Standard error by leaving out one trip after the other (jackknife); `None` with less than three trips, or where the trips do
    /// not tell the value.
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

/// Fits a vehicle to trips by robust least squares within bounds, see the methods page. Parameters that the trips do not tell by the
/// curvature of the fit keep their values. Intervals are left open, see [`Calibration::with_intervals`].
///
/// # Errors
/// [`Error::Calibration`] without measured power, or where the fit fails.
pub fn calibrate(vehicle: &Vehicle, trips: &[&CalibrationTrip]) -> Result<Calibration, Error> {
    if trips.is_empty() || trips.iter().any(|trip| trip.means() == 0) {
        return Err(Error::Calibration {
            problem: "there is no measured power, or a trip without; leave it out".to_owned(),
        });
    }
    let mut held = Vec::new();
    let all = Fit::of(vehicle, &held, trips)?;
    let correlation = all.curvature(vehicle, trips).map(|c| c.correlations());
    if let Some(speed_mps) = one_speed(vehicle, trips)? {
        held = all.hold(|_| Some(Untold::OneSpeed(speed_mps)));
    }
    Calibration::without(vehicle, held, correlation.unwrap_or_default(), trips)
}

/// Fitted values of the parameters that are free.
struct Fit {
    bounded: Vec<Bounded>,
    values: Vec<f64>,
}

impl Fit {
    /// Fits from the vehicle's own values.
    fn of(vehicle: &Vehicle, held: &[Held], trips: &[&CalibrationTrip]) -> Result<Self, Error> {
        let mut bounded = bounded(vehicle, trips);
        bounded.retain(|parameter| held.iter().all(|held| held.key != parameter.key()));
        let starts: Vec<f64> = bounded.iter().map(Bounded::begin).collect();
        Self::from(vehicle, bounded, &starts, trips)
    }

    fn from(
        vehicle: &Vehicle,
        bounded: Vec<Bounded>,
        starts: &[f64],
        trips: &[&CalibrationTrip],
    ) -> Result<Self, Error> {
        let values = match bounded.is_empty() {
            true => Vec::new(),
            false => Problem::new(vehicle.spec(), starts, &bounded, trips).solve()?,
        };
        Ok(Self { bounded, values })
    }

    fn curvature(&self, vehicle: &Vehicle, trips: &[&CalibrationTrip]) -> Option<Curvature> {
        let problem = Problem::new(vehicle.spec(), &self.values, &self.bounded, trips);
        let derivatives = problem.derivatives_at(&self.values)?;
        (!self.bounded.is_empty()).then(|| Curvature::of(&derivatives))
    }

    /// The parameters with a reason to be held, by their number.
    fn hold(&self, why: impl Fn(usize) -> Option<Untold>) -> Vec<Held> {
        let parameters = self.bounded.iter().zip(&self.values).enumerate();
        let held = parameters.filter_map(|(k, (parameter, &tried))| {
            Some(Held {
                key: parameter.key(),
                tried,
                why: why(k)?,
            })
        });
        held.collect()
    }
}

/// The parameters of a vehicle that trips can have an effect on.
fn bounded(vehicle: &Vehicle, trips: &[&CalibrationTrip]) -> Vec<Bounded> {
    Bounded::of(vehicle.spec(), trips)
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
    let mut free = bounded(vehicle, &others);
    free.retain(|parameter| {
        all.parameters
            .iter()
            .any(|p| p.key == parameter.key() && p.identified)
    });
    let start = |parameter: &Bounded| all.value(parameter.key()).unwrap_or(parameter.start);
    let starts: Vec<f64> = free.iter().map(start).collect();
    let Fit { bounded, values } = Fit::from(vehicle, free, &starts, &others)?;
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
    /// Fits without the parameters that are held, and holds further ones until the trips tell those that are left.
    fn without(
        vehicle: &Vehicle,
        mut held: Vec<Held>,
        correlation: Vec<Vec<f64>>,
        trips: &[&CalibrationTrip],
    ) -> Result<Self, Error> {
        let fit = loop {
            let fit = Fit::of(vehicle, &held, trips)?;
            let curvature = fit.curvature(vehicle, trips);
            match curvature.and_then(|c| c.least_told(&fit.bounded, &fit.values)) {
                None => break fit,
                Some((least, why)) => {
                    held.extend(fit.hold(|k| (k == least).then(|| why.clone())));
                }
            }
        };
        let mut spec = with_values(vehicle.spec(), &fit.bounded, &fit.values);
        let count = match trips.len() {
            1 => "1 trip".to_owned(),
            count => format!("{count} trips"),
        };
        for parameter in &fit.bounded {
            let source = Source {
                source: format!("fitted to the measured battery power of {count}"),
                confidence: Confidence::Fitted,
            };
            spec.sources.insert(parameter.key().to_owned(), source);
        }
        spec.add_weather_source();
        spec.add_warm_up_source();
        let all = bounded(vehicle, trips);
        let mut calibration = Self {
            vehicle: Vehicle::new(spec)?,
            parameters: all
                .iter()
                .map(|parameter| fit.estimate(parameter, &held))
                .collect(),
            correlation,
            held,
        };
        calibration.add_sensitivity(&all, trips)?;
        Ok(calibration)
    }

    fn value(&self, key: &str) -> Option<f64> {
        let found = self.parameters.iter().find(|p| p.key == key);
        found.map(|found| found.value)
    }

    /// Adds standard errors and intervals by the jackknife over trips: `se² = (n − 1)/n Σ (p_k − p̄)²`, which holds however the
    /// errors within a trip depend on each other. Less than three folds say nothing.
    pub fn with_intervals(mut self, folds: &[Fold]) -> Self {
        let n = folds.len() as f64;
        if folds.len() < 3 {
            return self;
        }
        let student = StudentsT::new(0.0, 1.0, n - 1.0);
        let quantile_975 = student.map_or(f64::INFINITY, |t| t.inverse_cdf(0.975));
        for (k, parameter) in self.parameters.iter_mut().enumerate() {
            if !parameter.identified {
                continue;
            }
            let mean = folds.iter().map(|fold| fold.values[k]).sum::<f64>() / n;
            let squares: f64 = folds.iter().map(|f| (f.values[k] - mean).powi(2)).sum();
            let std_error = ((n - 1.0) / n * squares).sqrt();
            let half = quantile_975 * std_error;
            parameter.std_error = Some(std_error);
            parameter.ci95 = Some([
                (parameter.value - half).max(parameter.lower),
                (parameter.value + half).min(parameter.upper),
            ]);
        }
        self
    }

    /// Fits again without the parameter whose interval tells least, or without all that have none; `None` where the intervals tell
    /// every parameter that is free.
    ///
    /// # Errors
    /// As [`calibrate`].
    pub fn without_untold(
        &self,
        vehicle: &Vehicle,
        trips: &[&CalibrationTrip],
    ) -> Result<Option<Self>, Error> {
        let free = self
            .parameters
            .iter()
            .filter(|parameter| parameter.identified);
        let different = trip::different(trips);
        let untold: Vec<_> = free
            .filter_map(|p| {
                untold_by(p.ci95, different, [p.lower, p.upper]).map(|(why, share)| (p, why, share))
            })
            .collect();
        let widest = untold
            .iter()
            .map(|(_, _, share)| *share)
            .fold(0.0, f64::max);
        if untold.is_empty() {
            return Ok(None);
        }
        let least = untold.into_iter().filter(|(_, _, share)| *share >= widest);
        let mut held = self.held.clone();
        held.extend(least.map(|(parameter, why, _)| Held {
            key: parameter.key,
            tried: parameter.value,
            why,
        }));
        Self::without(vehicle, held, self.correlation.clone(), trips).map(Some)
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

impl Fit {
    /// A parameter as this fit leaves it.
    fn estimate(&self, parameter: &Bounded, held: &[Held]) -> ParameterEstimate {
        let key = parameter.key();
        let mut free = self.bounded.iter().zip(&self.values);
        let fitted = free.find(|(bounded, _)| bounded.key() == key);
        let held_itself = held.iter().find(|held| held.key == key);
        ParameterEstimate {
            key,
            unit: parameter.unit(),
            start: parameter.start,
            value: fitted.map_or(parameter.start, |(_, value)| *value),
            tried: held_itself.map(|held| held.tried),
            lower: parameter.lower,
            upper: parameter.upper,
            std_error: None,
            ci95: None,
            sensitivity_w: 0.0,
            identified: held_itself.is_none(),
            remark: held_itself.map_or_else(
                || depends_on(key, held),
                |held| format!("not identified: {}", held.why),
            ),
        }
    }
}

/// What is told of two parameters that are alike is told only as far as the other one is right.
fn depends_on(key: &str, held: &[Held]) -> String {
    let alike = held
        .iter()
        .filter(|held| matches!(held.why, Untold::Alike { key: other, .. } if other == key));
    let keys: Vec<&str> = alike.map(|held| held.key).collect();
    match keys.is_empty() {
        true => String::new(),
        false => format!("told as far as {} is right", keys.join(", ")),
    }
}
