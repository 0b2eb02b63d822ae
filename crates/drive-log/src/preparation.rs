//! How a recording becomes drives.

use crate::Smoothing;

/// How a recording becomes drives. The default is the thesis's (section 3.4): 10 Hz, Hann window of
/// 5 samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Preparation {
    /// Step of the grid, s. Default 0.1.
    pub step_s: f64,
    /// Smoothing of the speed. Default `hann:5`.
    pub smooth: Smoothing,
    /// Longest time without a valid value that is interpolated, s; at longer ones the drive is cut.
    /// Default 2.
    pub max_gap_s: f64,
    /// Take a uniform recording as it is: no repair, no resampling, no smoothing. Default false.
    pub raw: bool,
}

impl Default for Preparation {
    fn default() -> Preparation {
        Preparation {
            step_s: 0.1,
            smooth: Smoothing::Hann(5),
            max_gap_s: 2.0,
            raw: false,
        }
    }
}
