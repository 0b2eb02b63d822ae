use std::ops::Range;

use drive_log::{Channel, DriveLog};

use crate::grid::below;

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
        .filter(|&(&gap_m, &v)| is_near(gap_m, v))
        .count();
    is_influenced(near, gap.len())
}

pub(crate) fn is_near(gap_m: f64, speed_mps: f64) -> bool {
    below(gap_m, INFLUENCE_GAP_S * speed_mps)
}

/// Whether so many samples with a near leader make a stretch of so many samples an influenced one.
pub(crate) fn is_influenced(near: usize, samples: usize) -> bool {
    near > 0 && near as f64 >= INFLUENCED_SHARE * samples as f64
}
