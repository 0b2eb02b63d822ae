use serde::{Deserialize, Serialize};

use crate::grid::at_least;

/// Start and end speed of a phase, each in one of three bands: 0–50, 50–100 and from 100 km/h (Table 3.8).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpeedGroup {
    /// Band of the start speed, 0 to 2.
    pub start_band: u8,
    /// Band of the end speed, 0 to 2.
    pub end_band: u8,
}

const BAND_NAMES: [&str; 3] = ["0–50", "50–100", "100–300"];

fn band(speed_mps: f64) -> u8 {
    let kmh = speed_mps * 3.6;
    u8::from(at_least(kmh, 50.0)) + u8::from(at_least(kmh, 100.0))
}

impl SpeedGroup {
    /// The group of a phase from its start and end speed.
    #[must_use]
    pub fn of(start_speed_mps: f64, end_speed_mps: f64) -> Self {
        Self {
            start_band: band(start_speed_mps),
            end_band: band(end_speed_mps),
        }
    }

    /// As in Table 3.8, in km/h: `0–50 → 50–100`.
    #[must_use]
    pub fn name(self) -> String {
        let name = |band: u8| BAND_NAMES[usize::from(band.min(2))];
        format!("{} → {}", name(self.start_band), name(self.end_band))
    }

    pub(crate) fn distance(self, other: Self) -> u8 {
        self.start_band.abs_diff(other.start_band) + self.end_band.abs_diff(other.end_band)
    }
}
