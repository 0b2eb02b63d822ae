use std::ops::Range;

use drive_log::{Channel, DriveLog};

/// A leader matters when its gap in m is under this many times the speed in m/s (thesis 3.28).
pub const INFLUENCE_GAP_S: f64 = 5.0;

/// A stretch counts as influenced from this share of its samples on; below it, radar noise would decide.
const INFLUENCED_SHARE: f64 = 0.1;

/// Whether a leader influences the samples of `range`: `gap < 5·v` on at least a tenth of them.
///
/// `false` where the log has no gap; samples without a gap (no vehicle ahead) do not count as influenced.
#[must_use]
pub fn lead_influenced(log: &DriveLog, range: Range<usize>) -> bool {
    let (Some(gap), Some(speed)) = (
        log.channel(Channel::LeadGap)
            .and_then(|g| g.get(range.clone())),
        log.speed_mps().get(range),
    ) else {
        return false;
    };
    let near = gap
        .iter()
        .zip(speed)
        .filter(|&(&gap_m, &v)| gap_m < INFLUENCE_GAP_S * v)
        .count();
    near > 0 && near as f64 >= INFLUENCED_SHARE * gap.len() as f64
}
