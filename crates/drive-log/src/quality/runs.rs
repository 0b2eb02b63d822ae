//! Values that stay the same.

use std::ops::Range;

/// Runs of finite values that are the same to the last bit, longest possible, in order.
pub(super) fn constant_runs(values: &[f64]) -> impl Iterator<Item = Range<usize>> {
    let mut start = 0;
    std::iter::from_fn(move || {
        while start < values.len() && !values[start].is_finite() {
            start += 1;
        }
        let first = values.get(start)?.to_bits();
        let len = values[start..]
            .iter()
            .take_while(|v| v.to_bits() == first)
            .count();
        let run = start..start + len;
        start = run.end;
        Some(run)
    })
}
