use crate::series::{STEPS_PER_UNIT, Variable};

/// How many samples are scanned between looks for a run of equal ones, and how many equal ones are worth a stop.
const CHUNK: usize = 32;

/// What [`scan`] takes from every deviation to learn its sign; for a chunk it adds up to less than half a grid step.
const NUDGE: f64 = 1.0 / 4096.0;

/// Integers up to `2⁵³` are exact.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// Samples up to this magnitude differ by no more than [`OFFSET`] can take.
const LARGEST: i64 = 1 << 50;

/// `1.5 · 2⁵²`: added to an integer below 2⁵¹ in magnitude, it has the integer in its last bits; added to any number of
/// that size and taken away again, it leaves the nearest integer.
const OFFSET: f64 = 6_755_399_441_055_744.0;

/// `Σ|x − x̄|` in grid steps, from integers alone: the mean is not rounded.
pub(crate) fn exact_absolute_deviation(variable: &Variable, start: usize, end: usize) -> f64 {
    let n = (end - start) as i128;
    let total = i128::from(variable.sum(start, end));
    let deviation = |&x: &i64| (i128::from(x) * n - total).abs();
    variable.steps[start..end]
        .iter()
        .map(deviation)
        .sum::<i128>() as f64
        / n as f64
}

/// `Σ|x − x̄|` of the samples `start..end`, with the mean rounded to the nearest `f64`, accurate to the last digits.
///
/// With `⌊x̄⌋` the mean rounded down to the grid, `Σ|x − x̄| = Σ|x − ⌊x̄⌋| + (x̄ − ⌊x̄⌋) (#{x ≤ x̄} − #{x > x̄})`, where the
/// first sum is one of integers and the fraction is below 1, so that nothing cancels.
pub(crate) fn absolute_deviation(variable: &Variable, start: usize, end: usize) -> f64 {
    if let [first, second] = variable.steps[start..end] {
        return (first - second).abs() as f64 / STEPS_PER_UNIT;
    }
    let total = variable.sum(start, end);
    let mean = total as f64 / (end - start) as f64;
    // A mean that is no integer stays apart from them in rounding: it is off by `1 / n` at least.
    let small = (total.unsigned_abs() as f64) < EXACT && variable.largest <= LARGEST;
    let scanned = small.then(|| scan(variable, start, end, mean)).flatten();
    let Sums { floor, sum, excess } =
        scanned.unwrap_or_else(|| scan_integers(variable, start, end));
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

/// All in floating point. Chunk by chunk out of `Σ|x − ⌊x̄⌋ − nudge|`, whose fraction is the excess times the nudge.
///
/// `None` where that is not exact.
fn scan(variable: &Variable, start: usize, mut end: usize, mean: f64) -> Option<Sums> {
    let nearest = (mean + OFFSET) - OFFSET;
    let floor = if nearest > mean {
        nearest - 1.0
    } else {
        nearest
    };
    let centre = OFFSET + floor;
    let (mut sum, mut fraction, mut largest) = (0.0, 0.0, 0.0);
    let mut add = |times: f64, total: f64| {
        let whole = (total + OFFSET) - OFFSET;
        sum += times * whole;
        fraction += times * (total - whole);
        largest = if total > largest { total } else { largest };
    };
    while end - start > CHUNK {
        let run = (variable.run_len[end - 1] as usize).min(end - start);
        if run > CHUNK {
            end -= run;
            add(run as f64, distance(variable.steps[end], centre));
        } else {
            add(1.0, scan_chunk(&variable.steps[end - CHUNK..end], centre));
            end -= CHUNK;
        }
    }
    add(1.0, scan_chunk(&variable.steps[start..end], centre));
    let exact = largest <= EXACT * NUDGE && sum <= EXACT;
    exact.then_some(Sums {
        floor,
        sum,
        excess: fraction / NUDGE,
    })
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
