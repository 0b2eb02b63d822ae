//! Figures of samples.

/// Correlation of pairs; NaN where one of the two does not vary.
pub(crate) fn correlation(pairs: &[(f64, f64)]) -> f64 {
    let Moments { xx, yy, xy } = Moments::of(pairs);
    xy / (xx * yy).sqrt()
}

/// Slope of the straight line that fits `y` over `x` best; NaN where `x` does not vary.
pub(crate) fn slope(pairs: &[(f64, f64)]) -> f64 {
    let Moments { xx, xy, .. } = Moments::of(pairs);
    xy / xx
}

/// Standard deviations by which a correlation of `count` pairs is off 0, after Fisher.
pub(crate) fn significance(correlation: f64, count: usize) -> f64 {
    correlation.atanh() * (count.max(3) as f64 - 3.0).sqrt()
}

/// The value below which a share of the values lies; `None` without values.
pub(crate) fn quantile(values: &mut [f64], share: f64) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    let at = (share * last as f64).round() as usize;
    Some(
        *values
            .select_nth_unstable_by(at.min(last), f64::total_cmp)
            .1,
    )
}

/// The mean of the values that are finite.
pub(crate) fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0_usize);
    for value in values.into_iter().filter(|v| v.is_finite()) {
        sum += value;
        count += 1;
    }
    (count > 0).then(|| sum / count as f64)
}

/// Sums of squares and products around the means.
struct Moments {
    xx: f64,
    yy: f64,
    xy: f64,
}

impl Moments {
    fn of(pairs: &[(f64, f64)]) -> Self {
        let n = pairs.len() as f64;
        let (mean_x, mean_y) = pairs
            .iter()
            .fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
        let zero = Self {
            xx: 0.0,
            yy: 0.0,
            xy: 0.0,
        };
        pairs.iter().fold(zero, |sum, (x, y)| Self {
            xx: sum.xx + (x - mean_x) * (x - mean_x),
            yy: sum.yy + (y - mean_y) * (y - mean_y),
            xy: sum.xy + (x - mean_x) * (y - mean_y),
        })
    }
}

/// Whether a value is a target but for a factor of up to `1 + tolerance`.
pub(crate) fn near(value: f64, target: f64, tolerance: f64) -> bool {
    (value / target).ln().abs() <= tolerance.ln_1p()
}

/// The (lower) median of the forward steps, s; 0 for fewer than two samples.
pub(crate) fn median_step_s(time_s: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time_s
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| *step > 0.0)
        .collect();
    if steps.is_empty() {
        return 0.0;
    }
    let middle = (steps.len() - 1) / 2;
    let step_s = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    // without the rounding of the difference of two times
    (step_s * 1e9).round() / 1e9
}

/// Standard deviation of a normal distribution over the median of its magnitude.
const DEVIATION_PER_MEDIAN: f64 = 1.4826;

/// Standard deviation of values around 0, from the median of their magnitudes, which outliers do not move; 0 without values.
pub(crate) fn deviation(values: impl Iterator<Item = f64>) -> f64 {
    let mut sizes: Vec<f64> = values.map(f64::abs).collect();
    DEVIATION_PER_MEDIAN * quantile(&mut sizes, 0.5).unwrap_or(0.0)
}

/// How far a point `(time, value)` is off the line from one before to one after it, scaled to the deviation of the noise of one value.
pub(crate) fn off_line(before: (f64, f64), here: (f64, f64), after: (f64, f64)) -> f64 {
    let share = (here.0 - before.0) / (after.0 - before.0);
    let off = here.1 - (before.1 + share * (after.1 - before.1));
    off / (1.0 + share * share + (1.0 - share) * (1.0 - share)).sqrt()
}

/// The largest of the values that are finite less the smallest; negative without any.
pub(crate) fn range<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    let finite = values.into_iter().filter(|value| value.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(*value), high.max(*value))
    });
    high - low
}
