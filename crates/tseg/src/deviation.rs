use std::ops::Range;

use crate::series::{STEPS_PER_UNIT, Variable};

/// How many samples are scanned between looks for a run of equal ones, and how many equal ones are worth a stop.
const CHUNK: usize = 32;

/// What [`scan`] takes from every deviation to learn its sign.
const NUDGE: f64 = 1.0 / 4096.0;

/// Up to so many samples, half a nudge for each is less than half a grid step.
const NUDGED: usize = 2047;

/// Below this, multiples of the nudge are exact.
const EXACT: f64 = 2_199_023_255_552.0;

/// `Σ|x − x̄|` of the samples `start..end`, with the mean rounded to the nearest `f64`, accurate to the last digits.
///
/// With `⌊x̄⌋` the mean rounded down to the grid, `Σ|x − x̄| = Σ|x − ⌊x̄⌋| + (x̄ − ⌊x̄⌋) (#{x ≤ x̄} − #{x > x̄})`, where the
/// first sum is one of integers and the fraction is below 1, so that nothing cancels.
pub(crate) fn absolute_deviation(variable: &Variable, start: usize, end: usize) -> f64 {
    if let [first, second] = variable.steps[start..end] {
        return (first - second).abs() as f64 / STEPS_PER_UNIT;
    }
    let (mean, floor) = mean(variable, start, end);
    let (sum, excess) = scan(variable, start..end, floor)
        .unwrap_or_else(|| scan_integers(variable, start..end, floor));
    // Outside [0, 1] only where the mean has more than 53 bits.
    let fraction = (mean - floor as f64).clamp(0.0, 1.0);
    (sum + fraction * excess) / STEPS_PER_UNIT
}

/// `Σ|x − floor|` and `#{x ≤ floor} − #{x > floor}`, both out of `Σ|x − floor − nudge|`, whose fraction is the second
/// times the nudge. `None` where that is not exact in floating point.
fn scan(variable: &Variable, range: Range<usize>, floor: i64) -> Option<(f64, f64)> {
    if range.len() > NUDGED || variable.largest >= EXACT_STEPS {
        return None;
    }
    let Range { start, mut end } = range;
    let mut total = 0.0;
    while start < end {
        let run = (variable.run_len[end - 1] as usize).min(end - start);
        if run > CHUNK {
            end -= run;
            total += run as f64 * distance(variable.steps[end], floor);
        } else {
            let chunk = start.max(end.saturating_sub(CHUNK));
            total += scan_chunk(&variable.steps[chunk..end], floor);
            end = chunk;
        }
    }
    let sum = (total + 0.5) as i64 as f64;
    (total < EXACT).then_some((sum, (total - sum) / NUDGE))
}

fn scan_chunk(steps: &[i64], floor: i64) -> f64 {
    let (pairs, rest) = steps.as_chunks::<2>();
    let totals = pairs.iter().fold([0.0; 2], |totals, pair| {
        [
            totals[0] + distance(pair[0], floor),
            totals[1] + distance(pair[1], floor),
        ]
    });
    let rest = rest.first().map_or(0.0, |&x| distance(x, floor));
    totals[0] + totals[1] + rest
}

/// Samples of a smaller magnitude differ by less than 2⁵¹, as [`distance`] needs.
const EXACT_STEPS: i64 = 1 << 50;

/// `|x − floor − nudge|`, in operations that every vector unit has: `1.5 · 2⁵² + i` has `i` in its last bits.
fn distance(x: i64, floor: i64) -> f64 {
    const OFFSET: f64 = 6_755_399_441_055_744.0;
    let shifted = f64::from_bits(OFFSET.to_bits().wrapping_add_signed(x.wrapping_sub(floor)));
    (shifted - OFFSET - NUDGE).abs()
}

/// As [`scan`], for samples of any magnitude and number.
fn scan_integers(variable: &Variable, range: Range<usize>, floor: i64) -> (f64, f64) {
    let (mut sum, mut above) = (0_i64, 0_i64);
    let n = range.len() as i64;
    for &x in &variable.steps[range] {
        let deviation = x - floor;
        sum += deviation.abs();
        above += i64::from(deviation > 0);
    }
    (sum as f64, (n - 2 * above) as f64)
}

/// `Σ(x − x̄)²`, an exact integer but for the division by `n`.
pub(crate) fn squared_deviation(variable: &Variable, start: usize, end: usize) -> f64 {
    let n = (end - start) as i128;
    let (_, floor) = mean(variable, start, end);
    let (mut squares, mut sum) = (0_i128, 0_i128);
    for &x in &variable.steps[start..end] {
        let deviation = i128::from(x - floor);
        squares += deviation * deviation;
        sum += deviation;
    }
    (n * squares - sum * sum) as f64 / (n as f64 * STEPS_PER_UNIT * STEPS_PER_UNIT)
}

/// The mean in grid steps, as the nearest `f64` and rounded down to the grid.
fn mean(variable: &Variable, start: usize, end: usize) -> (f64, i64) {
    let sum = variable.sum(start, end);
    let n = end - start;
    (sum as f64 / n as f64, sum.div_euclid(n as i64))
}
