use std::ops::Range;

use crate::segmentation::Segmentation;

/// Merges similar neighbours in one pass from left to right.
///
/// `similar` gets the samples accumulated so far and the next segment; where it says yes the next segment joins the
/// accumulated one, else it starts a new one. It is called once per inner boundary, in order. Thesis section 3.1.5.
pub fn merge(
    segmentation: &Segmentation,
    mut similar: impl FnMut(Range<usize>, Range<usize>) -> bool,
) -> Segmentation {
    let mut boundaries = vec![0];
    let mut start = 0;
    for segment in segmentation.iter().skip(1) {
        let boundary = segment.start;
        if !similar(start..boundary, segment) {
            boundaries.push(boundary);
            start = boundary;
        }
    }
    boundaries.push(segmentation.sample_count());
    Segmentation::from_ordered(boundaries)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn compares_the_accumulated_segment_with_the_next() {
        let segmentation = Segmentation::from_boundaries(vec![0, 1, 3, 6, 7]).unwrap();
        let mut seen = Vec::new();
        let merged = merge(&segmentation, |accumulated, next| {
            seen.push((accumulated.clone(), next.clone()));
            accumulated.len() < next.len()
        });
        assert_eq!(seen, [(0..1, 1..3), (0..3, 3..6), (3..6, 6..7)]);
        assert_eq!(merged.boundaries(), [0, 3, 6, 7]);
        assert_eq!(merge(&segmentation, |_, _| true).boundaries(), [0, 7]);
        assert_eq!(merge(&segmentation, |_, _| false), segmentation);
    }
}
