use std::ops::Range;

use crate::series::{STEPS_PER_UNIT, Variable};

/// How many samples are scanned between looks for a run of equal ones, and how many equal ones are worth a stop.
const CHUNK: usize = 32;

/// What [`scan`] takes from every deviation to learn its sign.
const NUDGE: f64 = 1.0 / 4096.0;

/// Up to so many samples, half a nudge for each is less than half a grid step.
const NUDGED: usize = 2047;

/// `1.5 · 2⁵²`: added to an integer below 2⁵¹ in magnitude, it has the integer in its last bits; added to any number of
/// that size and taken away again, it leaves the nearest integer.
const OFFSET: f64 = 6_755_399_441_055_744.0;

/// `Σ|x − x̄|` of the samples `start..end`, with the mean rounded to the nearest `f64`, accurate to the last digits.
///
/// With `⌊x̄⌋` the mean rounded down to the grid, `Σ|x − x̄| = Σ|x − ⌊x̄⌋| + (x̄ − ⌊x̄⌋) (#{x ≤ x̄} − #{x > x̄})`, where the
/// first sum is one of integers and the fraction is below 1, so that nothing cancels.
pub(crate) fn absolute_deviation(variable: &Variable, start: usize, end: usize) -> f64 {
    if let [first, second] = variable.steps[start..end] {
        return (first - second).abs() as f64 / STEPS_PER_UNIT;
    }
    let mean = variable.sum(start, end) as f64 / (end - start) as f64;
    let sums = scan(variable, start, end, mean);
    let Sums { floor, sum, excess } = sums.unwrap_or_else(|| scan_integers(variable, start, end));
    // Outside [0, 1] only where the mean has more than 53 bits.
    let fraction = (mean - floor).clamp(0.0, 1.0);
    (sum + fraction * excess) / STEPS_PER_UNIT
}

/// `⌊x̄⌋`, `Σ|x − ⌊x̄⌋|` and `#{x ≤ ⌊x̄⌋} − #{x > ⌊x̄⌋}`, exact.
struct Sums {
    floor: f64,
    sum: f64,
    excess: f64,
}

/// All in floating point, out of `Σ|x − ⌊x̄⌋ − nudge|`, whose fraction is the excess times the nudge.
///
/// `None` where that is not exact: many samples, or large ones.
fn scan(variable: &Variable, start: usize, mut end: usize, mean: f64) -> Option<Sums> {
    /// Multiples of the nudge are exact up to this; it keeps the mean apart from integers that it is not, too.
    const EXACT: f64 = 2_199_023_255_552.0;
    const EXACT_STEPS: i64 = 1 << 50;
    if end - start > NUDGED || mean.abs() > EXACT || variable.largest > EXACT_STEPS {
        return None;
    }
    let nearest = (mean + OFFSET) - OFFSET;
    let floor = if nearest > mean {
        nearest - 1.0
    } else {
        nearest
    };
    let mut total = 0.0;
    while end - start > CHUNK {
        let run = (variable.run_len[end - 1] as usize).min(end - start);
        if run > CHUNK {
            end -= run;
            total += run as f64 * distance(variable.steps[end], OFFSET + floor);
        } else {
            total += scan_chunk(&variable.steps[end - CHUNK..end], OFFSET + floor);
            end -= CHUNK;
        }
    }
    total += scan_chunk(&variable.steps[start..end], OFFSET + floor);
    let sum = (total + OFFSET) - OFFSET;
    let excess = (total - sum) / NUDGE;
    (total <= EXACT).then_some(Sums { floor, sum, excess })
}

fn scan_chunk(steps: &[i64], centre: f64) -> f64 {
    let (pairs, rest) = steps.as_chunks::<2>();
    let totals = pairs.iter().fold([0.0; 2], |totals, pair| {
        [
            totals[0] + distance(pair[0], centre),
            totals[1] + distance(pair[1], centre),
        ]
    });
    let rest = rest.first().map_or(0.0, |&x| distance(x, centre));
    totals[0] + totals[1] + rest
}

/// `|x − floor − nudge|` with `centre = OFFSET + floor`, in operations that every vector unit has.
fn distance(x: i64, centre: f64) -> f64 {
    let shifted = f64::from_bits(OFFSET.to_bits().wrapping_add_signed(x));
    (shifted - centre - NUDGE).abs()
}

/// For samples of any magnitude and number.
fn scan_integers(variable: &Variable, start: usize, end: usize) -> Sums {
    let n = (end - start) as i64;
    let floor = variable.sum(start, end).div_euclid(n);
    let (mut sum, mut above) = (0_i64, 0_i64);
    for &x in &variable.steps[start..end] {
        let deviation = x - floor;
        sum += deviation.abs();
        above += i64::from(deviation > 0);
    }
    Sums {
        floor: floor as f64,
        sum: sum as f64,
        excess: (n - 2 * above) as f64,
    }
}

/// `Σ(x − x̄)²`, an exact integer but for the division by `n`.
pub(crate) fn squared_deviation(variable: &Variable, start: usize, end: usize) -> f64 {
    let n = (end - start) as i128;
    let floor = variable.sum(start, end).div_euclid(n as i64);
    let (mut squares, mut sum) = (0_i128, 0_i128);
    for &x in &variable.steps[start..end] {
        let deviation = i128::from(x - floor);
        squares += deviation * deviation;
        sum += deviation;
    }
    (n * squares - sum * sum) as f64 / (n as f64 * STEPS_PER_UNIT * STEPS_PER_UNIT)
}
