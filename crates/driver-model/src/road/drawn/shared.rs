//! Places that most of several drives share.

use std::collections::BTreeMap;

use crate::statistics::median;

/// Places of two drives this near to each other may be the same, m: a queue of cars before a line, and what distances are off by.
const SAME_PLACE_M: f64 = 50.0;

/// A place of one drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub(super) drive: usize,
    pub(super) position_m: f64,
    /// How long the car stood, or how fast it passed.
    pub(super) value: f64,
}

/// Places that more than half of the drives have, with medians of position and value; and where the others are. What one drive has several
/// times at a place is joined.
pub(super) fn shared(
    mut places: Vec<Place>,
    drives: usize,
    join: fn(f64, f64) -> f64,
) -> (Vec<(f64, f64)>, Vec<f64>) {
    if drives == 1 {
        return (
            places.iter().map(|p| (p.position_m, p.value)).collect(),
            Vec::new(),
        );
    }
    places.sort_by(|a, b| a.position_m.total_cmp(&b.position_m));
    let (mut found, mut alone_m) = (Vec::new(), Vec::new());
    let mut first = 0;
    while let Some(place) = places.get(first) {
        let beyond_m = place.position_m + SAME_PLACE_M;
        let here = &places[first..];
        let here = &here[..here.partition_point(|p| p.position_m <= beyond_m)];
        let mut by_drive: BTreeMap<usize, f64> = BTreeMap::new();
        for place in here {
            let value = by_drive.entry(place.drive);
            value
                .and_modify(|value| *value = join(*value, place.value))
                .or_insert(place.value);
        }
        if 2 * by_drive.len() <= drives {
            alone_m.push(place.position_m);
            first += 1;
            continue;
        }
        let position_m = median(here.iter().map(|p| p.position_m).collect());
        let value = median(by_drive.into_values().collect());
        found.extend(position_m.zip(value));
        first += here.len();
    }
    (found, alone_m)
}

#[cfg(test)]
#[allow(clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn most_drives_make_a_place_and_one_does_not() {
        let places = [
            (0, 100.0, 3.0),
            (1, 140.0, 5.0),
            (1, 145.0, 2.0),
            (2, 120.0, 9.0),
            (2, 400.0, 4.0),
        ];
        let places = places.map(|(drive, position_m, value)| Place {
            drive,
            position_m,
            value,
        });
        let (found, alone_m) = shared(places.to_vec(), 3, |a, b| a + b);
        assert_eq!((found, alone_m), (vec![(130.0, 7.0)], vec![400.0]));
        let (found, _) = shared(places[..3].to_vec(), 1, |a, b| a + b);
        assert_eq!(found.len(), 3);
        assert_eq!(shared(Vec::new(), 0, f64::min), (Vec::new(), Vec::new()));
    }
}
