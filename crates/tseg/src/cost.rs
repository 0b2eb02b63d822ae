use std::ops::Range;

use strum::{EnumMessage, EnumString, IntoStaticStr, VariantArray};

use crate::deviation::{absolute_deviation, squared_deviation};
use crate::error::{Error, check_length};
use crate::segmentation::Segmentation;
use crate::series::{STEPS_PER_UNIT, Series};

/// How inhomogeneous a segment is; 0 for one sample and for a constant.
///
/// `x_ij` is sample `j` of variable `i` in a segment of `n` samples, `x̄_i` its mean there, `w_i` the variable's weight.
/// A variable that is exactly constant on the segment adds 0.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, EnumMessage, EnumString, IntoStaticStr, VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
pub enum Cost {
    /// `Σ_i w_i Σ_j |x_ij − x̄_i| / S_i` with `S_i = √(Σ_j (x_ij − x̄_i)² / (n − 1))`: thesis (3.19), (3.20).
    ///
    /// Blind to the scale of the variables; grows with the length of the segment.
    #[strum(message = "Sum of deviations over the standard deviation (3.19)")]
    ZScale,
    /// `Σ_i w_i Σ_j |x_ij − x̄_i| / n`, the weighted mean absolute deviation: thesis (3.22).
    ///
    /// In units of the variables; not monotone in the length of the segment.
    #[strum(message = "Mean deviation (3.22)")]
    MeanDeviation,
    /// `Σ_i w_i Σ_j (x_ij − x̄_i)²`, the weighted squared error: the cost of piecewise constant least squares.
    ///
    /// In squared units; splitting a segment never raises it.
    #[strum(message = "Sum of squared deviations")]
    SquaredError,
}

impl Cost {
    /// Cost of one segment.
    ///
    /// # Errors
    ///
    /// [`Error::Segment`] if the segment is empty or exceeds the series.
    pub fn of_segment(self, series: &Series, segment: Range<usize>) -> Result<f64, Error> {
        let Range { start, end } = segment;
        if start < end && end <= series.len() {
            Ok(self.between(series, start, end))
        } else {
            Err(Error::Segment {
                start,
                end,
                len: series.len(),
            })
        }
    }

    /// Sum of the costs of all segments, thesis (3.15).
    ///
    /// # Errors
    ///
    /// [`Error::Length`] if the segmentation is not one of this series.
    pub fn total(self, series: &Series, segmentation: &Segmentation) -> Result<f64, Error> {
        check_length(0, series.len(), segmentation.sample_count())?;
        Ok(segmentation
            .iter()
            .map(|segment| self.between(series, segment.start, segment.end))
            .fold(0.0, |total, cost| total + cost))
    }

    /// No segmentation costs more than about this, nor does anything on the way to its cost.
    pub(crate) fn bound(self, series: &Series) -> f64 {
        let n = series.len() as f64;
        series.variables().iter().fold(0.0, |sum, v| {
            let range = v.steps.iter().max().zip(v.steps.iter().min());
            let range = range.map_or(0.0, |(max, min)| {
                (*max as f64 - *min as f64) / STEPS_PER_UNIT
            });
            sum + n
                * v.weight
                * match self {
                    // The weighted deviation, in grid steps, before it is divided.
                    Self::ZScale => 1.0 + range * STEPS_PER_UNIT,
                    Self::MeanDeviation => range,
                    Self::SquaredError => range * range,
                }
        })
    }

    /// Cost of `start..end`, which must not be empty nor exceed the series.
    pub(crate) fn between(self, series: &Series, start: usize, end: usize) -> f64 {
        let varying = series
            .variables()
            .iter()
            .filter(|v| !v.is_constant(start, end));
        let n = (end - start) as f64;
        match self {
            Self::MeanDeviation => varying.fold(0.0, |sum, v| {
                sum + v.weight * absolute_deviation(v, start, end) / n
            }),
            Self::ZScale => varying.fold(0.0, |sum, v| {
                let variance = squared_deviation(v, start, end) / (n - 1.0);
                sum + v.weight * absolute_deviation(v, start, end) / variance.sqrt()
            }),
            Self::SquaredError => varying.fold(0.0, |sum, v| {
                sum + v.weight * squared_deviation(v, start, end)
            }),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let series =
            Series::new(&[(&[1.0, 2.0, 6.0, 6.0], 2.0), (&[0.0, 0.0, 0.0, 4.0], 1.0)]).unwrap();
        // First three samples: mean 3, deviations 2, 1, 3; the second variable is constant.
        assert_eq!(Cost::MeanDeviation.of_segment(&series, 0..3).unwrap(), 4.0);
        let s = 7.0_f64.sqrt();
        assert!((Cost::ZScale.of_segment(&series, 0..3).unwrap() - 12.0 / s).abs() < 1e-14);
        // Last two: the first variable is constant, the second deviates by 2 from its mean.
        assert_eq!(Cost::MeanDeviation.of_segment(&series, 2..4).unwrap(), 2.0);
        assert!((Cost::ZScale.of_segment(&series, 2..4).unwrap() - 2.0_f64.sqrt()).abs() < 1e-15);
        assert_eq!(Cost::SquaredError.of_segment(&series, 0..3).unwrap(), 28.0);
        let halves = Segmentation::from_boundaries(vec![0, 3, 4]).unwrap();
        assert_eq!(Cost::MeanDeviation.total(&series, &halves).unwrap(), 4.0);
    }

    #[test]
    fn one_sample_and_constants_cost_nothing() {
        let series = Series::new(&[(&[0.1; 7], 1.8), (&[-3.0; 7], 1.0)]).unwrap();
        for cost in [Cost::ZScale, Cost::MeanDeviation, Cost::SquaredError] {
            assert_eq!(cost.of_segment(&series, 3..4).unwrap(), 0.0);
            assert_eq!(cost.of_segment(&series, 0..7).unwrap(), 0.0);
        }
    }

    #[test]
    fn refuses_segments_outside_the_series() {
        let series = Series::new(&[(&[1.0, 2.0], 1.0)]).unwrap();
        for (start, end) in [(0, 3), (1, 1), (2, 1)] {
            assert_eq!(
                Cost::ZScale.of_segment(&series, start..end).unwrap_err(),
                Error::Segment { start, end, len: 2 }
            );
        }
        let other = Segmentation::from_boundaries(vec![0, 3]).unwrap();
        assert!(Cost::ZScale.total(&series, &other).is_err());
    }
}
