//! Units that speeds are read in by mistake.

/// Speeds that are read in the wrong unit, and how many times too large they are then, from the
/// largest.
pub(super) const MISTAKES: [Mistake; 6] = [
    (3.6, "km/h read as m/s"),
    (1.0 / 0.44704, "mph read as m/s"),
    (1.609_344, "km/h read as mph"),
    (1.0 / 1.609_344, "mph read as km/h"),
    (0.44704, "m/s read as mph"),
    (1.0 / 3.6, "m/s read as km/h"),
];

/// A factor and what it stands for.
pub(super) type Mistake = (f64, &'static str);
