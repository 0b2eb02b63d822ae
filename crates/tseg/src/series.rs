use crate::error::{Error, check_finite, check_length};

/// Grid steps per unit: samples are rounded to multiples of 2⁻³².
pub(crate) const STEPS_PER_UNIT: f64 = 4_294_967_296.0;

/// `len · max|x|` may not exceed this (in units of the variable). On the grid that is 2⁶¹, so that a sum of
/// differences stays below 2⁶² and `n` times a sum of their squares below 2¹²⁴.
pub(crate) const LARGEST_SUM: f64 = 536_870_912.0;

/// The value as the grid has it, so that noise far below it decides no comparison.
pub(crate) fn on_grid(value: f64) -> f64 {
    // From here on, numbers are further apart than the grid.
    if value.abs() >= f64::from(1 << 21) {
        return value;
    }
    (value * STEPS_PER_UNIT).round_ties_even() / STEPS_PER_UNIT
}

fn check_weight(variable: usize, weight: f64) -> Result<(), Error> {
    if weight.is_finite() && weight >= 0.0 {
        Ok(())
    } else {
        Err(Error::Weight { variable, weight })
    }
}

/// A checked multivariate time series: `m` weighted variables of `n` samples each.
///
/// Samples are held as integer multiples of 2⁻³². On that grid every sum is exact, and whether a variable is constant
/// on a segment is decidable; in floating point, rounding noise on a mathematically constant variable costs as much
/// under [`Cost::ZScale`](crate::Cost::ZScale) as a real signal.
#[derive(Debug, Clone)]
pub struct Series {
    len: usize,
    variables: Vec<Variable>,
}

/// One variable on the grid; samples may be appended.
#[derive(Debug, Clone)]
pub(crate) struct Variable {
    pub(crate) weight: f64,
    /// Samples in grid steps, length `n`.
    pub(crate) steps: Vec<i64>,
    /// `sums[j] − sums[i]`, wrapping, is the sum of the samples `i..j`; length `n + 1`.
    sums: Vec<i64>,
    /// `run_len[i]` is how many samples up to and including sample `i` have its value without a break, length `n`.
    pub(crate) run_len: Vec<u32>,
    /// The largest magnitude of a sample, in grid steps.
    pub(crate) largest: i64,
}

impl Series {
    /// Checks the variables, given as (samples, weight), and rounds them to the grid.
    ///
    /// Units are the caller's. Costs add up over variables, so the weights must make their units comparable; a variable
    /// of weight 0 has no influence.
    ///
    /// # Errors
    ///
    /// [`Error::NoVariables`], [`Error::NoSamples`], [`Error::Length`], [`Error::NotFinite`], [`Error::Weight`], and
    /// [`Error::TooLarge`] for a magnitude above 2²⁹ / `n`.
    pub fn new(variables: &[(&[f64], f64)]) -> Result<Self, Error> {
        let (first, _) = variables.first().ok_or(Error::NoVariables)?;
        let len = first.len();
        if len == 0 {
            return Err(Error::NoSamples);
        }
        let mut variables: Vec<Variable> = variables
            .iter()
            .enumerate()
            .map(|(variable, &(samples, weight))| {
                check_length(variable, samples.len(), len)?;
                check_finite(variable, samples)?;
                check_weight(variable, weight)?;
                Variable::new(variable, samples, weight)
            })
            .collect::<Result<_, _>>()?;
        variables.retain(|variable| variable.weight > 0.0);
        Ok(Self { len, variables })
    }

    /// A series without samples, to append to, of as many variables as there are positive weights.
    pub(crate) fn growing(weights: &[f64]) -> Result<Self, Error> {
        if weights.is_empty() {
            return Err(Error::NoVariables);
        }
        for (variable, &weight) in weights.iter().enumerate() {
            check_weight(variable, weight)?;
        }
        let positive = weights.iter().filter(|&&weight| weight > 0.0);
        Ok(Self {
            len: 0,
            variables: positive.map(|&weight| Variable::empty(weight, 0)).collect(),
        })
    }

    /// Appends one value per variable; sums over all samples must stay below [`LARGEST_SUM`].
    pub(crate) fn push(&mut self, values: impl Iterator<Item = f64>) {
        self.len += 1;
        for (variable, value) in self.variables.iter_mut().zip(values) {
            variable.push(value);
        }
    }

    /// Drops the first `count` samples; the others move up.
    pub(crate) fn drop_front(&mut self, count: usize) {
        self.len -= count;
        for variable in &mut self.variables {
            variable.drop_front(count);
        }
    }

    /// Number of samples `n`, at least 1.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "a series is never empty")]
    pub fn len(&self) -> usize {
        self.len
    }

    /// The samples in reverse order.
    pub(crate) fn reversed(&self) -> Self {
        self.rearranged(self.len, |i| self.len - 1 - i)
    }

    /// The first sample and every `stride`-th after it.
    pub(crate) fn every(&self, stride: usize) -> Self {
        self.rearranged(self.len.div_ceil(stride), |i| i * stride)
    }

    /// `len` samples, the `i`-th of which is the `from(i)`-th here.
    fn rearranged(&self, len: usize, from: impl Fn(usize) -> usize) -> Self {
        let rearranged = |variable: &Variable| {
            let mut copy = Variable::empty(variable.weight, len);
            (0..len).for_each(|i| copy.push_step(variable.steps[from(i)]));
            copy
        };
        Self {
            len,
            variables: self.variables.iter().map(rearranged).collect(),
        }
    }

    pub(crate) fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// The first sample from which on every variable keeps its value up to the sample before `end`.
    pub(crate) fn constant_since(&self, end: usize) -> usize {
        let starts = self.variables.iter().map(|v| v.constant_since(end));
        starts.max().unwrap_or(0)
    }
}

impl Variable {
    fn new(index: usize, samples: &[f64], weight: f64) -> Result<Self, Error> {
        let limit = LARGEST_SUM / samples.len() as f64;
        if let Some(sample) = samples.iter().position(|x| x.abs() > limit) {
            return Err(Error::TooLarge {
                variable: index,
                sample,
                value: samples[sample],
                limit,
            });
        }
        let mut variable = Self::empty(weight, samples.len());
        for &x in samples {
            variable.push(x);
        }
        Ok(variable)
    }

    fn empty(weight: f64, capacity: usize) -> Self {
        let mut sums = Vec::with_capacity(capacity + 1);
        sums.push(0);
        Self {
            weight,
            steps: Vec::with_capacity(capacity),
            sums,
            run_len: Vec::with_capacity(capacity),
            largest: 0,
        }
    }

    fn push(&mut self, sample: f64) {
        self.push_step((sample * STEPS_PER_UNIT).round_ties_even() as i64);
    }

    fn push_step(&mut self, step: i64) {
        let run = match self.steps.last() {
            Some(&last) if last == step => self.run_len[self.steps.len() - 1].saturating_add(1),
            _ => 1,
        };
        self.run_len.push(run);
        self.steps.push(step);
        self.sums
            .push(self.sums[self.sums.len() - 1].wrapping_add(step));
        self.largest = self.largest.max(step.abs());
    }

    fn drop_front(&mut self, count: usize) {
        self.steps.drain(..count);
        self.sums.drain(..count);
        self.run_len.drain(..count);
        self.largest = self.steps.iter().fold(0, |largest, x| largest.max(x.abs()));
    }

    /// Sum of the samples `start..end` in grid steps.
    pub(crate) fn sum(&self, start: usize, end: usize) -> i64 {
        self.sums[end].wrapping_sub(self.sums[start])
    }

    /// The first sample from which on all before `end` are equal; `end` where there is none before or `end` is too large.
    pub(crate) fn constant_since(&self, end: usize) -> usize {
        let run = end.checked_sub(1).and_then(|last| self.run_len.get(last));
        end.saturating_sub(run.map_or(0, |&run| run as usize))
    }

    /// Whether the samples `start..end`, at least one, are equal. Misses runs of more than `u32::MAX` samples.
    pub(crate) fn is_constant(&self, start: usize, end: usize) -> bool {
        self.run_len[end - 1] as usize >= end - start
    }
}

#[cfg(test)]
#[allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp
)]
mod tests {
    use super::*;

    #[test]
    fn refuses_what_it_cannot_hold() {
        assert_eq!(Series::new(&[]).unwrap_err(), Error::NoVariables);
        assert_eq!(Series::new(&[(&[], 1.0)]).unwrap_err(), Error::NoSamples);
        assert_eq!(
            Series::new(&[(&[1.0, 2.0], 1.0), (&[1.0], 1.0)]).unwrap_err(),
            Error::Length {
                variable: 1,
                len: 1,
                expected: 2
            }
        );
        assert!(matches!(
            Series::new(&[(&[1.0, f64::NAN], 1.0)]),
            Err(Error::NotFinite {
                variable: 0,
                sample: 1,
                ..
            })
        ));
        for weight in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                Series::new(&[(&[1.0], weight)]),
                Err(Error::Weight { variable: 0, .. })
            ));
        }
    }

    #[test]
    fn bounds_the_magnitude_by_the_length() {
        assert!(Series::new(&[(&[LARGEST_SUM], 1.0)]).is_ok());
        assert_eq!(
            Series::new(&[(&[0.0, -LARGEST_SUM], 1.0)]).unwrap_err(),
            Error::TooLarge {
                variable: 0,
                sample: 1,
                value: -LARGEST_SUM,
                limit: LARGEST_SUM / 2.0
            }
        );
    }

    #[test]
    fn joint_runs_end_where_any_variable_changes() {
        let series =
            Series::new(&[(&[1.0, 1.0, 1.0, 2.0], 1.0), (&[0.0, 0.0, 5.0, 5.0], 1.0)]).unwrap();
        let starts: Vec<_> = (1..=4).map(|i| series.constant_since(i)).collect();
        assert_eq!(starts, [0, 0, 2, 3]);
    }
}
