//! Bounded nonlinear least squares for curves `y = f(x; p)` with two or three parameters.
//!
//! Minimises `½ Σ w_i (f(x_i; p) − y_i)²` subject to `lower ≤ p ≤ upper` (thesis 2.23, 2.24). The bounds are
//! removed by `p = lower + (upper − lower)(1 + sin q)/2`, and Levenberg and Marquardt's method works on `q`. At a bound the
//! slope in `q` vanishes whether or not the sum falls inward, and towards one the method is slow. So it runs twice: what
//! ended near a bound to which the sum falls is put on it, and what ended at a bound from which it falls is taken off it.

use ev_energy::calibration::Bounds;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::storage::Owned;
use nalgebra::{Const, DVector, Dyn, OMatrix, SVector};

use crate::{AccelPoint, Error};

/// Relative change of the sum of squares below which the fit has converged; gradients are then off by its root.
const SUM_TOLERANCE: f64 = 1e-14;

/// The same for the free parameters.
const PARAMETER_TOLERANCE: f64 = 1e-12;

/// Cosine between residuals and every column of the Jacobian below which it has converged.
const ANGLE_TOLERANCE: f64 = 1e-10;

/// Evaluations at most, per parameter. Ordinary fits take about ten in all, along a bound a hundred.
const PATIENCE: usize = 400;

/// First step at most, relative to the free parameters: the sine is no line over more.
const FIRST_STEP: f64 = 1.0;

/// Nearer to a bound than this, as a share of the width, a parameter may belong on it.
const NEAR_BOUND: f64 = 0.05;

/// Nearer than this it is at the bound, and where it does not belong there it starts again this far inside.
const AT_BOUND: f64 = 1e-9;
const OFF_BOUND: f64 = 0.02;

/// Sums this close to each other, relative, are the same.
const SAME_SUM: f64 = 1e-12;

/// Cosine between residuals and derivative by a parameter below which the sum does not fall along it.
const LEVEL: f64 = 1e-7;

/// Where to go on from a value, given the cosine of [`LEVEL`], which has the sign of the slope of the sum; `None` where
/// it is.
fn amended(bounds: Bounds, value: f64, cosine: f64) -> Option<f64> {
    let is_low = value - bounds.lower < bounds.upper - value;
    let bound = if is_low { bounds.lower } else { bounds.upper };
    let share = (value - bound).abs() / bounds.width();
    let falls_outward = (cosine > 0.0) == is_low;
    if cosine.abs() < LEVEL {
        None
    } else if falls_outward {
        (share > 0.0 && share < NEAR_BOUND).then(|| bounds.free(bound))
    } else {
        let inside = bound + (0.5 * (bounds.lower + bounds.upper) - bound) * 2.0 * OFF_BOUND;
        (share < AT_BOUND).then(|| bounds.free(inside))
    }
}

/// Why a fit is not one, `None` where the method converged.
pub(crate) fn unconverged(termination: &TerminationReason) -> Option<String> {
    (!termination.was_successful()).then(|| format!("it did not converge: {termination:?}"))
}

/// A curve `f(x; p)` and its gradient in `p`.
pub(crate) struct Curve<const N: usize> {
    /// Name of the model, for errors.
    pub(crate) model: &'static str,
    /// `f(x; p)`.
    pub(crate) value: fn(&[f64; N], f64) -> f64,
    /// `∂f/∂p` at `(x; p)`.
    pub(crate) gradient: fn(&[f64; N], f64) -> [f64; N],
    /// Lower bounds, strictly below `upper`.
    pub(crate) lower: [f64; N],
    /// Upper bounds.
    pub(crate) upper: [f64; N],
    /// Strictly inside the bounds; the best end point of all of them wins.
    pub(crate) starts: &'static [[f64; N]],
}

/// Where the optimiser ended.
#[derive(Debug)]
pub(crate) struct Fit<const N: usize> {
    pub(crate) parameters: [f64; N],
    /// `Σ w_i (f(x_i; p) − y_i)²`.
    pub(crate) residual_sum_of_squares: f64,
}

/// Where the method ended from one starting point.
struct End<const N: usize> {
    fit: Fit<N>,
    unconverged: Option<String>,
}

impl<const N: usize> Curve<N> {
    /// Fits the curve to `(x, y)` points. An error where the best end point is not one that the method converged to.
    pub(crate) fn fit(&self, points: &[AccelPoint]) -> Result<Fit<N>, Error> {
        let failure = |reason: String| Error::Fit {
            model: self.model,
            reason,
        };
        let sum = |end: &End<N>| end.fit.residual_sum_of_squares;
        let ends = self.starts.iter().map(|start| self.fit_from(start, points));
        let best = ends
            .filter(|end| sum(end).is_finite())
            .min_by(|a, b| sum(a).total_cmp(&sum(b)))
            .ok_or_else(|| failure("no finite sum of squares from any starting point".into()))?;
        match best.unconverged {
            Some(reason) => Err(failure(reason)),
            None => Ok(best.fit),
        }
    }

    /// Refuses parameters outside the bounds, which no fit can produce.
    pub(crate) fn check(
        &self,
        names: [&'static str; N],
        parameters: &[f64; N],
    ) -> Result<(), Error> {
        for (i, name) in names.into_iter().enumerate() {
            let (value, range) = (parameters[i], self.lower[i]..=self.upper[i]);
            if !range.contains(&value) {
                return Err(Error::Parameter {
                    model: self.model,
                    name,
                    value,
                    expected: format!("{} to {}", range.start(), range.end()),
                });
            }
        }
        Ok(())
    }

    fn fit_from(&self, start: &[f64; N], points: &[AccelPoint]) -> End<N> {
        let free = SVector::from_fn(|i, _| self.bounds(i).free(start[i]));
        let (first, free) = self.end_from(free, points);
        let Some(free) = self.amended(&first.fit, free, points) else {
            return first;
        };
        let (second, _) = self.end_from(free, points);
        let allowed = first.fit.residual_sum_of_squares * (1.0 + SAME_SUM);
        if second.fit.residual_sum_of_squares <= allowed {
            second
        } else {
            first
        }
    }

    /// Where the method ends, in free parameters too.
    fn end_from(&self, free: SVector<f64, N>, points: &[AccelPoint]) -> (End<N>, SVector<f64, N>) {
        let problem = Problem {
            curve: self,
            points,
            free,
        };
        let solver = LevenbergMarquardt::new()
            .with_ftol(SUM_TOLERANCE)
            .with_xtol(PARAMETER_TOLERANCE)
            .with_gtol(ANGLE_TOLERANCE)
            .with_stepbound(FIRST_STEP)
            .with_patience(PATIENCE)
            .with_scale_diag(false);
        let (solved, report) = solver.minimize(problem);
        let end = End {
            fit: Fit {
                parameters: solved.parameters(),
                residual_sum_of_squares: 2.0 * report.objective_function,
            },
            unconverged: unconverged(&report.termination),
        };
        (end, solved.free)
    }

    /// Where to start again so that the bounds are right, `None` where they are.
    fn amended(
        &self,
        fit: &Fit<N>,
        mut free: SVector<f64, N>,
        points: &[AccelPoint],
    ) -> Option<SVector<f64, N>> {
        let p = &fit.parameters;
        let (mut products, mut squares) = ([0.0; N], [0.0; N]);
        for point in points {
            let off = (self.value)(p, point.speed_mps) - point.accel_mps2;
            let gradient = (self.gradient)(p, point.speed_mps);
            for (i, g) in gradient.into_iter().enumerate() {
                products[i] += point.weight * off * g;
                squares[i] += point.weight * g * g;
            }
        }
        let mut any = false;
        for i in 0..N {
            let norm = (squares[i] * fit.residual_sum_of_squares).sqrt();
            let cosine = if norm > 0.0 { products[i] / norm } else { 0.0 };
            if let Some(amended) = amended(self.bounds(i), p[i], cosine) {
                free[i] = amended;
                any = true;
            }
        }
        any.then_some(free)
    }

    fn bounds(&self, i: usize) -> Bounds {
        Bounds {
            lower: self.lower[i],
            upper: self.upper[i],
        }
    }
}

struct Problem<'a, const N: usize> {
    curve: &'a Curve<N>,
    points: &'a [AccelPoint],
    free: SVector<f64, N>,
}

impl<const N: usize> Problem<'_, N> {
    fn parameters(&self) -> [f64; N] {
        std::array::from_fn(|i| self.curve.bounds(i).value(self.free[i]))
    }
}

impl<const N: usize> LeastSquaresProblem<f64, Dyn, Const<N>> for Problem<'_, N> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Const<N>>;
    type ParameterStorage = Owned<f64, Const<N>>;

    fn set_params(&mut self, free: &SVector<f64, N>) {
        self.free = *free;
    }

    fn params(&self) -> SVector<f64, N> {
        self.free
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let p = self.parameters();
        let residual = |point: &AccelPoint| {
            let off = (self.curve.value)(&p, point.speed_mps) - point.accel_mps2;
            point.weight.sqrt() * off
        };
        let residuals = self.points.iter().map(residual);
        Some(DVector::from_iterator(self.points.len(), residuals))
    }

    fn jacobian(&self) -> Option<OMatrix<f64, Dyn, Const<N>>> {
        let p = self.parameters();
        let slopes: [f64; N] = std::array::from_fn(|i| self.curve.bounds(i).slope(self.free[i]));
        let mut jacobian = OMatrix::<f64, Dyn, Const<N>>::zeros(self.points.len());
        for (mut row, point) in jacobian.row_iter_mut().zip(self.points) {
            let root = point.weight.sqrt();
            let gradient = (self.curve.gradient)(&p, point.speed_mps);
            for (place, (g, slope)) in row.iter_mut().zip(gradient.iter().zip(slopes)) {
                *place = root * slope * g;
            }
        }
        Some(jacobian)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const BOUNDS: Bounds = Bounds {
        lower: -1.0,
        upper: 3.0,
    };

    #[test]
    fn values_within_bounds_come_back_and_others_are_clamped() {
        for value in [-1.0, -0.999, 0.0, 1.0, 2.5, 3.0] {
            assert!((BOUNDS.value(BOUNDS.free(value)) - value).abs() < 1e-12);
        }
        assert!((BOUNDS.value(BOUNDS.free(7.0)) - 3.0).abs() < 1e-12);
        for free in [-40.0, -1.0, 0.3, 2.0, 1e9] {
            assert!((-1.0..=3.0).contains(&BOUNDS.value(free)));
            let step = 1e-6;
            let rise = BOUNDS.value(0.3 + step) - BOUNDS.value(0.3 - step);
            assert!((BOUNDS.slope(0.3) - rise / (2.0 * step)).abs() < 1e-6);
        }
    }

    /// A line whose parameters are its values at 0 and 1.
    const LINE: Curve<2> = Curve {
        model: "line",
        value: |p, x| p[0] + (p[1] - p[0]) * x,
        gradient: |_, x| [1.0 - x, x],
        lower: [-1.0, -1.0],
        upper: [1.0, 1.0],
        starts: &[[0.5, 0.5], [-0.9, 0.1]],
    };

    #[test]
    fn a_line_is_found_and_one_outside_ends_at_the_bound() {
        let points = |at_0: f64, at_1: f64| {
            let on_line = |x: f64| AccelPoint::new(x, at_0 + (at_1 - at_0) * x);
            [0.0, 0.5, 1.0].map(on_line)
        };
        let fit = LINE.fit(&points(0.3, -0.2)).unwrap();
        assert!((fit.parameters[0] - 0.3).abs() < 1e-9);
        assert!((fit.parameters[1] + 0.2).abs() < 1e-9);
        // From 1 at x = 0: y(0.5) is 0.5·p1 − 1 too high and y(1) is p1, least at p1 = 0.4.
        let fit = LINE.fit(&points(3.0, 0.0)).unwrap();
        assert!((fit.parameters[0] - 1.0).abs() < 1e-9);
        assert!((fit.parameters[1] - 0.4).abs() < 1e-6, "{fit:?}");
    }

    #[test]
    fn a_bound_that_the_sum_falls_away_from_does_not_hold() {
        // Starting on the bound of the amplitude, where the slope by the free parameter is 0.
        let decay = Curve::<2> {
            model: "decay",
            value: |p, x| p[0] * (-p[1] * x).exp(),
            gradient: |p, x| {
                let e = (-p[1] * x).exp();
                [e, -x * p[0] * e]
            },
            lower: [0.0, 0.0],
            upper: [10.0, 2.0],
            starts: &[[0.0, 0.5]],
        };
        let on_curve = |x: f64| AccelPoint::new(x, 3.0 * (-0.2 * x).exp());
        let fit = decay.fit(&[0.0, 1.0, 2.0, 5.0].map(on_curve)).unwrap();
        assert!((fit.parameters[0] - 3.0).abs() < 1e-6, "{fit:?}");
        assert!((fit.parameters[1] - 0.2).abs() < 1e-6, "{fit:?}");
    }

    #[test]
    fn a_parameter_that_belongs_on_its_bound_is_put_there() {
        let on_line = |x: f64| AccelPoint::new(x, 3.0 - 3.0 * x);
        let fit = LINE.fit(&[0.0, 0.5, 1.0].map(on_line)).unwrap();
        assert!(fit.parameters[0].to_bits() == 1.0_f64.to_bits(), "{fit:?}");
    }

    #[test]
    fn a_method_that_does_not_converge_is_an_error() {
        // A root of order 40, of which every step leaves 39 fortieths.
        let flat = Curve::<1> {
            model: "flat",
            value: |p, _| (300.0 * p[0]).powi(40),
            gradient: |p, _| [12_000.0 * (300.0 * p[0]).powi(39)],
            lower: [-1.0],
            upper: [1.0],
            starts: &[[0.9]],
        };
        let reason = flat.fit(&[AccelPoint::new(0.0, 0.0)]).unwrap_err();
        let reason = reason.to_string();
        assert!(
            reason.contains("flat") && reason.contains("LostPatience"),
            "{reason}"
        );
    }

    #[test]
    fn points_that_are_no_numbers_are_an_error() {
        let points = [AccelPoint::new(0.0, f64::NAN), AccelPoint::new(1.0, 0.2)];
        let reason = LINE.fit(&points).unwrap_err().to_string();
        assert!(reason.contains("no finite sum"), "{reason}");
    }
}
