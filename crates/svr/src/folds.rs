use std::ops::Range;

use crate::Error;

/// Which samples are held out at once and which are learnt from meanwhile.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fold {
    /// Indices to learn from, ascending.
    pub train: Vec<usize>,
    /// Indices held out, ascending.
    pub test: Vec<usize>,
}

/// Cuts samples in time order into `count` blocks and holds each out once. `gap` samples on either side of the block are
/// neither learnt from nor tested on, so that neighbours of a tested sample are not learnt.
///
/// # Errors
/// [`Error::Setting`] for fewer than 2 blocks or more than samples, or a gap that leaves nothing to learn from.
pub fn blocked_folds(samples: usize, count: usize, gap: usize) -> Result<Vec<Fold>, Error> {
    Error::unless(
        (2..=samples.max(2)).contains(&count) && samples >= 2,
        "the number of folds",
        count as f64,
        "at least 2 and at most the number of samples",
    )?;
    let block = |k: usize| k * samples / count..(k + 1) * samples / count;
    (0..count).map(|k| around(samples, block(k), gap)).collect()
}

/// Holds the last `share` of the samples out, with a gap before it as in [`blocked_folds`].
///
/// # Errors
/// [`Error::Setting`] for a share outside 0 to 1, or where one side is empty.
pub fn hold_out(samples: usize, share: f64, gap: usize) -> Result<Fold, Error> {
    Error::unless(
        share > 0.0 && share < 1.0,
        "the share held out",
        share,
        "between 0 and 1",
    )?;
    let held = (share * samples as f64).round() as usize;
    Error::unless(
        held >= 1 && held < samples,
        "the share held out",
        share,
        "such that either side has a sample",
    )?;
    around(samples, samples - held..samples, gap)
}

/// Holds out whole groups, dealt to `count` folds in order of their first sample: group `g` is tested in fold `g mod count`.
///
/// # Errors
/// [`Error::Setting`] for fewer than 2 folds or more folds than groups.
pub fn grouped_folds<G: PartialEq>(groups: &[G], count: usize) -> Result<Vec<Fold>, Error> {
    let mut seen: Vec<&G> = Vec::new();
    let number: Vec<usize> = groups
        .iter()
        .map(|group| {
            seen.iter()
                .position(|known| *known == group)
                .unwrap_or_else(|| {
                    seen.push(group);
                    seen.len() - 1
                })
        })
        .collect();
    Error::unless(
        count >= 2 && count <= seen.len(),
        "the number of folds",
        count as f64,
        "at least 2 and at most the number of groups",
    )?;
    let fold = |k: usize| {
        let (test, train) = (0..groups.len()).partition(|&i| number[i] % count == k);
        Fold { train, test }
    };
    Ok((0..count).map(fold).collect())
}

fn around(samples: usize, test: Range<usize>, gap: usize) -> Result<Fold, Error> {
    let before = 0..test.start.saturating_sub(gap);
    let after = test.end.saturating_add(gap).min(samples)..samples;
    let train: Vec<usize> = before.chain(after).collect();
    Error::unless(
        !train.is_empty(),
        "the gap between folds",
        gap as f64,
        "small enough to leave samples to learn from",
    )?;
    Ok(Fold {
        train,
        test: test.collect(),
    })
}

#[cfg(test)]
#[allow(clippy::expect_used)]
mod tests {
    use super::*;

    #[test]
    fn blocks_cover_all_samples_once_and_keep_their_distance() {
        for (samples, count, gap) in [(10, 2, 0), (103, 5, 3), (7, 7, 1), (2, 2, 0)] {
            let folds = blocked_folds(samples, count, gap).expect("folds");
            let tested: Vec<usize> = folds.iter().flat_map(|fold| fold.test.clone()).collect();
            assert_eq!(tested, (0..samples).collect::<Vec<_>>());
            for fold in folds {
                let near = fold
                    .train
                    .iter()
                    .any(|i| fold.test.iter().any(|j| i.abs_diff(*j) <= gap));
                assert!(!near, "{fold:?}");
            }
        }
    }

    #[test]
    fn groups_stay_together() {
        let folds = grouped_folds(&["a", "a", "b", "c", "a", "b"], 2).expect("folds");
        assert_eq!(folds[0].test, [0, 1, 3, 4]);
        assert_eq!(folds[1].test, [2, 5]);
    }

    #[test]
    fn impossible_folds_are_refused() {
        assert!(
            blocked_folds(10, 1, 0).is_err()
                && blocked_folds(1, 2, 0).is_err()
                && blocked_folds(10, 2, 9).is_err()
        );
        assert!(
            blocked_folds(0, 2, 0).is_err()
                && hold_out(1, 0.5, 0).is_err()
                && hold_out(10, f64::NAN, 0).is_err()
        );
        assert!(grouped_folds(&[1, 1], 2).is_err());
        assert_eq!(
            hold_out(10, 0.25, 2).expect("a fold").train,
            [0, 1, 2, 3, 4]
        );
    }
}
