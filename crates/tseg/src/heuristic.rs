use crate::error::Error;
use crate::segmentation::Segmentation;

/// Segments of equal neighbouring labels, one label per sample, and the label of each segment.
///
/// The heuristic method of the thesis (Algorithm 1): the caller labels every sample by its rules, for instance
/// Table 3.1, and adjacent samples of one group form a segment.
///
/// # Errors
///
/// [`Error::NoSamples`] if there is no label.
pub fn runs<L: PartialEq + Clone>(labels: &[L]) -> Result<(Segmentation, Vec<L>), Error> {
    if labels.is_empty() {
        return Err(Error::NoSamples);
    }
    let mut boundaries = vec![0];
    let mut run_labels = Vec::new();
    for run in labels.chunk_by(PartialEq::eq) {
        boundaries.push(boundaries[boundaries.len() - 1] + run.len());
        run_labels.push(run[0].clone());
    }
    Ok((Segmentation::from_ordered(boundaries), run_labels))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn one_segment_per_run() {
        let (segmentation, labels) = runs(&['a', 'a', 'b', 'a']).unwrap();
        assert_eq!(segmentation.boundaries(), [0, 2, 3, 4]);
        assert_eq!(labels, ['a', 'b', 'a']);
        assert_eq!(runs::<u8>(&[]).unwrap_err(), Error::NoSamples);
        // A label that equals nothing, itself included, still makes a run of one sample.
        assert_eq!(
            runs(&[f64::NAN, f64::NAN]).unwrap().0.boundaries(),
            [0, 1, 2]
        );
    }
}
