use serde::{Deserialize, Serialize};

/// A standard driving cycle on a level road, one value a second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum Cycle {
    /// Urban Dynamometer Driving Schedule (40 CFR part 86, appendix I).
    Udds,
    /// Highway Fuel Economy Test (40 CFR part 600, appendix I).
    Hwfet,
    /// New European Driving Cycle (UN Regulation No. 83, annex 4a).
    Nedc,
}

impl Cycle {
    /// All cycles.
    pub const ALL: [Cycle; 3] = [Cycle::Udds, Cycle::Hwfet, Cycle::Nedc];

    /// Name, as vehicle files give it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Cycle::Udds => "UDDS",
            Cycle::Hwfet => "HWFET",
            Cycle::Nedc => "NEDC",
        }
    }

    /// Speed at every second, m/s.
    #[must_use]
    pub fn speed_mps(self) -> Vec<f64> {
        const MPS_PER_MPH: f64 = 0.44704;
        const MPS_PER_KMH: f64 = 1.0 / 3.6;
        let (text, mps, duration_s) = match self {
            Cycle::Udds => (
                include_str!("../../../fixtures/cycles/udds.csv"),
                MPS_PER_MPH,
                1369,
            ),
            Cycle::Hwfet => (
                include_str!("../../../fixtures/cycles/hwfet.csv"),
                MPS_PER_MPH,
                765,
            ),
            // The file goes on at standstill.
            Cycle::Nedc => (
                include_str!("../../../fixtures/cycles/nedc.csv"),
                MPS_PER_KMH,
                1180,
            ),
        };
        text.lines()
            .skip(1)
            .filter_map(|line| line.split(',').nth(1)?.parse::<f64>().ok())
            .take(duration_s + 1)
            .map(|speed| speed * mps)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cycles_have_their_length_and_distance() {
        for (cycle, duration_s, distance_km) in [
            (Cycle::Udds, 1369, 11.99),
            (Cycle::Hwfet, 765, 16.51),
            (Cycle::Nedc, 1180, 10.93),
        ] {
            let speed_mps = cycle.speed_mps();
            assert_eq!(speed_mps.len() - 1, duration_s, "{}", cycle.name());
            let distance_m: f64 = speed_mps.windows(2).map(|v| 0.5 * (v[0] + v[1])).sum();
            assert!(
                (distance_m / 1e3 - distance_km).abs() < 0.02,
                "{distance_m}"
            );
        }
    }
}
