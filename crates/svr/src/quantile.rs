/// Quantile `p` by the Hazen rule: sample `k` of `n`, counted from 1, stands at `(k − ½)/n`; linear between, constant
/// beyond.
pub(crate) fn hazen(values: &[f64], p: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let position = (p * sorted.len() as f64 - 0.5).clamp(0.0, (sorted.len() - 1) as f64);
    let below = position.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    let share = position - below as f64;
    (1.0 - share) * sorted[below] + share * sorted[above]
}
